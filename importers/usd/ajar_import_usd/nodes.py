"""Nodes that make colours and numbers: those of UsdPreviewSurface, and MaterialX's as far as one image can say them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from pxr import UsdShade

from .network import Network
from .terms import (
    Component,
    Primvar,
    Term,
    UnsupportedError,
    computed,
    constant,
    is_constant,
    mixed,
    numbers,
    product,
    source,
    total,
)

Node = Callable[[Network, UsdShade.Shader, UsdShade.Output], Term]

SIZES = {"float": 1, "float2": 2, "float3": 3, "float4": 4, "color3f": 3, "color4f": 4, "vector3f": 3, "normal3f": 3}
WRAPS = {"useMetadata": "black", "constant": "black", "periodic": "repeat"}
CHANNELS = {"r": 0, "g": 1, "b": 2, "a": 3, "x": 0, "y": 1, "z": 2, "w": 3}


def size(output: UsdShade.Output) -> int:
    """Numbers that the output's type has."""
    return SIZES.get(str(output.GetTypeName()), 3)


def uv_texture(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """UsdUVTexture."""

    def four(name: str, default: float) -> Term:
        return network.follow(shader, name, (default,) * 4)

    names = output.GetBaseName().replace("rgba", "rgb")
    image = None
    try:
        image = network.image(
            shader,
            coordinates=network.coordinates(shader, "st"),
            color_space={"sRGB": "srgb", "raw": "raw"}.get(network.text(shader, "sourceColorSpace", "auto"), "auto"),
            wrap_u=wrap(network.text(shader, "wrapS", "useMetadata")),
            wrap_v=wrap(network.text(shader, "wrapT", "useMetadata")),
        )
    except UnsupportedError as unsupported:
        if network.value(shader, "fallback")[0] is None:
            raise
        network.report.approximate(shader.GetPath(), f"the texture has its fallback colour: {unsupported}")
    if image is None:
        rgba = network.follow(shader, "fallback", (0, 0, 0, 1))
    else:
        rgba = total(product(source(image, "rgba"), four("scale", 1.0)), four("bias", 0.0))
    return tuple(rgba[CHANNELS[name]] for name in names if name in CHANNELS)


def wrap(name: str) -> str:
    """Ajar's word."""
    return WRAPS.get(name, name if name in ("repeat", "mirror", "clamp", "black") else "repeat")


def primvar_reader(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """UsdPrimvarReader and geompropvalue of colours: those of the mesh."""
    name = network.text(shader, "varname", "") or network.text(shader, "geomprop", "")
    if size(output) < 3 or not name:
        raise UnsupportedError(f"the primvar {name!r} is no colour")
    return source(Primvar(name), "rgb")


def image(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """MaterialX's image and tiledimage."""
    at = network.coordinates(shader, "texcoord")
    if category_is_tiled(shader):
        at = tiled(network, shader, at)
    nearest = network.text(shader, "filtertype", "linear") == "closest"
    try:
        found = network.image(
            shader,
            coordinates=at,
            wrap_u=wrap(network.text(shader, "uaddressmode", "periodic")),
            wrap_v=wrap(network.text(shader, "vaddressmode", "periodic")),
            filter="nearest" if nearest else "linear",
        )
    except UnsupportedError:
        found = None
        if network.value(shader, "default")[0] is None:
            raise
        network.report.approximate(shader.GetPath(), "an image that is not there has its default colour")
    if found is None:
        return network.follow(shader, "default", (0.0,) * size(output))
    return source(found, "rgba"[: size(output)])


def category_is_tiled(shader: UsdShade.Shader) -> bool:
    """Whether it is a tiledimage."""
    return "tiledimage" in str(shader.GetShaderId())


def tiled(network: Network, shader: UsdShade.Shader, at: Any) -> Any:
    """Coordinates of a tiledimage."""
    from .uv import pair

    x, y = pair(network, shader, "uvtiling", 1.0)
    dx, dy = pair(network, shader, "uvoffset", 0.0)
    image_x, image_y = pair(network, shader, "realworldimagesize", 1.0)
    tile_x, tile_y = pair(network, shader, "realworldtilesize", 1.0)
    if not image_x or not image_y:
        raise UnsupportedError("an image without size")
    return at.then(x, 0, -dx, 0, y, -dy).then(tile_x / image_x, 0, 0, 0, tile_y / image_y, 0)


def of_two(function: Callable[[Term, Term], Term], default: float) -> Node:
    """A node with the inputs in1 and in2."""

    def node(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
        return function(network.follow(shader, "in1", 0.0), network.follow(shader, "in2", default))

    return node


def of_one(function: Callable[[Term], Term]) -> Node:
    """A node with the input in."""

    def node(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
        return function(network.follow(shader, "in", (0.0,) * size(output)))

    return node


def math_of(function: Callable[..., float], *names: str) -> Node:
    """A function of constants."""

    def node(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
        return computed(function, *(network.follow(shader, name, None) for name in names))

    return node


def mix(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """MaterialX's mix."""
    back, front = network.follow(shader, "bg", 0.0), network.follow(shader, "fg", 0.0)
    return mixed(back, front, network.follow(shader, "mix", 0.0))


def remap(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """remap and range without gamma or clamp."""
    low, high = network.follow(shader, "inlow", 0.0), network.follow(shader, "inhigh", 1.0)
    out_low, out_high = network.follow(shader, "outlow", 0.0), network.follow(shader, "outhigh", 1.0)
    if any(v != 1 for v in numbers(network.follow(shader, "gamma", 1.0))):
        raise UnsupportedError("a gamma")
    slope = computed(lambda a, b, c, d: (d - c) / (b - a), low, high, out_low, out_high)
    return total(product(total(network.follow(shader, "in", 0.0), low, -1), slope), out_low)


def clamp(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """Of images, values lie within the limits as a rule."""
    term = network.follow(shader, "in", 0.0)
    if not is_constant(term):
        network.report.note(shader.GetPath(), "a clamp of an image is left out")
        return term
    low, high = network.follow(shader, "low", 0.0), network.follow(shader, "high", 1.0)
    return computed(lambda x, a, b: min(max(x, a), b), term, low, high)


def separate(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """One channel, named by the output: outr, outx."""
    term = network.follow(shader, "in", None)
    return (term[min(CHANNELS.get(output.GetBaseName()[-1:], 0), len(term) - 1)],)


def extract(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """One channel, named by its number."""
    term = network.follow(shader, "in", None)
    return (term[min(max(int(numbers(network.follow(shader, "index", 0))[0]), 0), len(term) - 1)],)


def combine(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """Channels, or a colour and its alpha."""
    parts: list[Component] = []
    for name in ("in1", "in2", "in3", "in4"):
        if shader.GetInput(name):
            parts += network.follow(shader, name, 0.0)
    return tuple(parts)


def convert(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """More or fewer channels."""
    term, wanted = network.follow(shader, "in", 0.0), size(output)
    if len(term) == 1:
        return term * min(wanted, 3) + ((Component(1.0),) if wanted == 4 else ())
    return (term + (Component(1.0),) * 4)[:wanted]


def normal_map(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """MaterialX's normalmap: colours are 0 to 1; the scale acts on x and y."""
    decoded = total(product(network.follow(shader, "in", (0.5, 0.5, 1.0)), constant(2.0)), constant(-1.0))
    scale = numbers(network.follow(shader, "scale", 1.0))
    return product(decoded, constant([scale[0], scale[-1], 1.0]))


def plain(network: Network, shader: UsdShade.Shader, output: UsdShade.Output) -> Term:
    """MaterialX's constant."""
    return network.follow(shader, "value", 0.0)


def reciprocal(term: Term) -> Term:
    """1 / term, of constants."""
    return computed(lambda x: 1 / x, term)


NODES: dict[str, Node] = (
    {
        "UsdUVTexture": uv_texture,
        "UsdPrimvarReader_float3": primvar_reader,
        "UsdPrimvarReader_float4": primvar_reader,
        "UsdPrimvarReader": primvar_reader,
        "geompropvalue": primvar_reader,
        "image": image,
        "tiledimage": image,
        "constant": plain,
        "dot": of_one(lambda term: term),
        "multiply": of_two(product, 1.0),
        "divide": of_two(lambda a, b: product(a, reciprocal(b)), 1.0),
        "add": of_two(total, 0.0),
        "subtract": of_two(lambda a, b: total(a, b, -1), 0.0),
        "power": math_of(math.pow, "in1", "in2"),
        "max": math_of(max, "in1", "in2"),
        "min": math_of(min, "in1", "in2"),
        "sqrt": math_of(math.sqrt, "in"),
        "absval": math_of(abs, "in"),
        "invert": of_one(lambda term: total(constant(1.0), term, -1)),
        "mix": mix,
        "remap": remap,
        "range": remap,
        "clamp": clamp,
        "extract": extract,
        "convert": convert,
        "normalmap": normal_map,
    }
    | dict.fromkeys(["separate2", "separate3", "separate4"], separate)
    | dict.fromkeys(["combine2", "combine3", "combine4"], combine)
)
"""Who reads which node."""
