"""Shader networks, followed from an input to what it comes to."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdShade

from . import layers
from .layers import Jail
from .report import Report
from .terms import Coordinates, Image, Term, UnsupportedError, constant

DEEPEST = 100
TYPES = "float|color[34]|vector[234]|integer|boolean|surfaceshader|material"
# Names of MaterialX's node definitions: ND_multiply_color3FA, ND_UsdTransform2d_23.
TYPED = re.compile(rf"^ND_(.+?)_(?:{TYPES})(?:[A-Z]+|_.*)?$|^ND_(\w+?)(?:_\d+)?$")


def category(shader: UsdShade.Shader) -> str:
    """The node's name: `multiply` of MaterialX's `ND_multiply_color3`, `UsdUVTexture` as it is."""
    name = str(shader.GetShaderId() or shader.GetPrim().GetAttribute("info:id").Get() or "")
    typed = TYPED.match(name)
    if typed:
        name = typed[1] or typed[2]
    return name.removeprefix("arnold:")


class Network:
    """Reads inputs of the shaders of one stage."""

    def __init__(self, time: Usd.TimeCode, jail: Jail, report: Report) -> None:
        self.time, self.jail, self.report = time, jail, report
        self.depth = 0

    def input(self, shader: UsdShade.Shader, name: str, default: Any) -> Term:
        """What an input comes to; `default` where nothing is said, or with a warning where it cannot be followed."""
        try:
            return self.follow(shader, name, default)
        except UnsupportedError as unsupported:
            self.report.approximate(shader.GetPath(), f"{category(shader)}: {name!r} has its default: {unsupported}")
            return constant(default)

    def follow(self, shader: UsdShade.Shader, name: str, default: Any) -> Term:
        """As `input`, but raises what cannot be followed."""
        value, output = self.value(shader, name)
        if output is not None:
            return self.evaluate(output)
        if value is None:
            if default is None:
                raise UnsupportedError(f"the input {name!r} is missing")
            return constant(default)
        return self.number(value, shader.GetInput(name).GetAttr().GetColorSpace())

    def value(self, shader: UsdShade.Shader, name: str) -> tuple[Any, Any]:
        """The value of an input, or the output of the shader that makes it."""
        found = shader.GetInput(name)
        if not found:
            return None, None
        attributes = found.GetValueProducingAttributes()
        if not attributes:
            return None, None
        attribute = attributes[0]
        if UsdShade.Output.IsOutput(attribute):
            return None, UsdShade.Output(attribute)
        return attribute.Get(self.time), None

    def number(self, value: Any, space: str = "") -> Term:
        """A constant."""
        try:
            values = np.array(value, dtype=float).reshape(-1)
        except (TypeError, ValueError) as error:
            raise UnsupportedError(f"{value!r} is no number") from error
        if not np.all(np.isfinite(values)):
            raise UnsupportedError("a value is not finite")
        if space in ("srgb_texture", "sRGB") and len(values) >= 3:
            low = values[:3] / 12.92
            values[:3] = np.where(values[:3] <= 0.04045, low, ((np.maximum(values[:3], 0) + 0.055) / 1.055) ** 2.4)
        return constant(values.tolist())

    def evaluate(self, output: UsdShade.Output) -> Term:
        """What a shader's output comes to."""
        from .nodes import NODES

        shader = UsdShade.Shader(output.GetPrim())
        name = category(shader)
        node = NODES.get(name)
        if node is None:
            raise UnsupportedError(f"nodes {name or output.GetPrim().GetTypeName()!r} are not read")
        if self.depth > DEEPEST:
            raise UnsupportedError("a network that is too deep, or a loop")
        self.depth += 1
        try:
            return node(self, shader, output)
        finally:
            self.depth -= 1

    def text(self, shader: UsdShade.Shader, name: str, default: str) -> str:
        """A token or string."""
        value, _ = self.value(shader, name)
        return str(value) if value not in (None, "") else default

    def coordinates(self, shader: UsdShade.Shader, name: str, default: str = "st") -> Coordinates:
        """Texture coordinates that an input is connected to."""
        from .uv import NODES

        _, output = self.value(shader, name)
        if output is None:
            return Coordinates(default)
        source = UsdShade.Shader(output.GetPrim())
        node = NODES.get(category(source))
        if node is None:
            raise UnsupportedError(f"texture coordinates of nodes {category(source)!r} are not read")
        if self.depth > DEEPEST:
            raise UnsupportedError("a network that is too deep, or a loop")
        self.depth += 1
        try:
            return node(self, source)
        finally:
            self.depth -= 1

    def image(self, shader: UsdShade.Shader, **how: Any) -> Image | None:
        """The image file of a shader's `file`, or None if none is named."""
        found = shader.GetInput("file")
        attributes = found.GetValueProducingAttributes() if found else []
        value = attributes[0].Get(self.time) if attributes else None
        if not isinstance(value, Sdf.AssetPath) or not value.path:
            return None
        space = attributes[0].GetColorSpace()
        how.setdefault("color_space", "srgb" if space in ("srgb_texture", "sRGB") else "raw")
        return Image(located(attributes[0], value, self.jail, self.report), **how)


def located(attribute: Usd.Attribute, asset: Sdf.AssetPath, jail: Jail, report: Report) -> str:
    """Where a file lies; checked, and told to who watches."""
    path = asset.resolvedPath
    place = str(attribute.GetPrim().GetPath())
    if not path:
        layer = next((spec.layer for spec in attribute.GetPropertyStack() if spec.layer.realPath), None)
        path = layers.located(layer, asset.path, place) if layer else asset.path
    jail.check(path, place)
    report.file(path.split("[")[0])
    if "<UDIM>" in path:
        path = path.replace("<UDIM>", "1001")
        report.approximate(place, "of the tiles of a UDIM texture, only 1001 is read")
        jail.check(path, place)
    elif not asset.resolvedPath:
        raise UnsupportedError(f"the file {asset.path} is not there")
    return path
