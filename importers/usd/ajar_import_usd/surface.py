"""A material in the making: terms become inputs of Ajar's principled material."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pxr import UsdShade

from .network import category
from .terms import Component, Image, Primvar, Term, UnsupportedError, constant, is_constant, numbers, product

if TYPE_CHECKING:
    from .material import Materials

CHANNELS = "rgba"
# The normal that is the surface's.
UP = (0.0, 0.0, 1.0)


class Surface:
    """What a surface shader says, and the item of the document that it becomes."""

    def __init__(self, materials: Materials, path: str) -> None:
        self.materials, self.path = materials, path
        self.shader = UsdShade.Shader()
        self.item: dict[str, Any] = {}
        self.uv_names: set[str] = set()
        self.color_primvar: str | None = None

    def approximate(self, message: str) -> None:
        """The shader is not shown as it says."""
        self.materials.report.approximate(self.shader.GetPath(), f"{category(self.shader)}: {message}")

    def warn(self, message: str) -> None:
        """Something of the shader is dropped."""
        self.materials.report.warn(self.shader.GetPath(), f"{category(self.shader)}: {message}")

    def term(self, name: str, default: float | Sequence[float]) -> Term:
        """What an input comes to."""
        return self.materials.network.input(self.shader, name, default)

    def numbers(self, name: str, default: float | Sequence[float]) -> list[float]:
        """An input that must be constant."""
        term = self.term(name, default)
        if is_constant(term):
            return numbers(term)
        self.approximate(f"{name!r} cannot have an image here, it has its default")
        return numbers(constant(default))

    def number(self, name: str, default: float) -> float:
        """One number."""
        return self.numbers(name, default)[0]

    def says(self, name: str) -> bool:
        """Whether an input has a value or a shader that feeds it."""
        return self.materials.network.value(self.shader, name) != (None, None)

    def product(self, name: str, factor: str, a: Term, b: Term) -> Term:
        """a · b, or a alone with a warning where both are images."""
        try:
            return product(a, b)
        except UnsupportedError:
            self.approximate(f"images of both {name!r} and {factor!r} cannot be multiplied; the second is taken as 1")
            return a

    def ignored(self, **defaults: float) -> None:
        """Names inputs that do something which Ajar cannot do."""
        for name, default in defaults.items():
            term = self.term(name, default)
            if not is_constant(term) or any(v != default for v in numbers(term)):
                self.warn(f"{name!r} is ignored")

    def set_number(self, key: str, term: Term, most: float = 1.0) -> None:
        """A scalar input of the material."""
        self.guarded(key, lambda: self.scalar(key, term[0], most))

    def set_color(self, key: str, term: Term, most: float = 1.0) -> None:
        """A colour input of the material."""
        self.guarded(key, lambda: self.colors(key, (term * 3)[:3] if len(term) == 1 else term[:3], most))

    def guarded(self, key: str, make: Any) -> None:
        """Names what cannot be said."""
        try:
            self.item[key] = make()
        except UnsupportedError as unsupported:
            self.approximate(f"{key.replace('_', ' ')} has its default: {unsupported}")

    def scalar(self, key: str, component: Component, most: float) -> Any:
        """A number, or a channel of a texture."""
        if component.source is None:
            return self.limited(key, component.bias, most)
        at = CHANNELS.index(component.channel)
        scale, bias = [1.0] * 4, [0.0] * 4
        scale[at], bias[at] = component.scale, component.bias
        texture = self.texture(component.source, scale, bias)
        return {"value": 1.0, "texture": {"texture": texture, "channel": component.channel}}

    def colors(self, key: str, term: Term, most: float) -> Any:
        """A colour, or a texture's, or that of the mesh."""
        if is_constant(term):
            return [self.limited(key, c.bias, most) for c in term]
        sources = {c.source for c in term if c.source is not None}
        if len(sources) > 1:
            raise UnsupportedError("channels of several images")
        (one,) = sources
        if isinstance(one, Primvar):
            return self.mesh_color(key, one, term)
        channels = [c.channel for c in term if c.source is not None]
        wanted = [CHANNELS[i] for i, c in enumerate(term) if c.source is not None]
        if channels != wanted and set(channels) != {"r"}:
            raise UnsupportedError(f"channels in the order {''.join(channels)}")
        if channels != wanted:
            # Images of one channel are the same in all; of others it is approximated.
            self.materials.report.note(self.shader.GetPath(), f"{key}: one channel of an image, taken as grey")
        scale = [c.scale for c in term] + [1.0]
        bias = [c.bias for c in term] + [0.0]
        return {"value": [1.0] * 3, "texture": {"texture": self.texture(one, scale, bias)}}

    def mesh_color(self, key: str, primvar: Primvar, term: Term) -> list[float]:
        """The mesh's colours multiply the base colour, and nothing else."""
        if key != "base_color" or any(c.bias for c in term) or [c.channel for c in term] != list("rgb"):
            raise UnsupportedError(f"the primvar {primvar.name!r} can only be the base colour")
        self.color_primvar = primvar.name
        return [self.limited(key, c.scale, 1.0) for c in term]

    def texture(self, image: Image | Primvar, scale: list[float], bias: list[float]) -> int:
        """A texture, whose coordinates meshes have to bring."""
        if isinstance(image, Primvar):
            raise UnsupportedError(f"the primvar {image.name!r} can only be the base colour")
        self.uv_names.add(image.coordinates.primvar)
        return self.materials.texture(image, scale, bias)

    def limited(self, key: str, value: float, most: float) -> float:
        """Values that Ajar takes."""
        kept = min(max(value, 0.0), most)
        if not math.isclose(kept, value, abs_tol=1e-6):
            self.approximate(f"{key.replace('_', ' ')} {value:g} is limited to {kept:g}")
        return kept

    def set_normal(self, name: str, key: str = "normal_map") -> None:
        """A normal map from an input of decoded normals, −1 to 1."""
        term = self.term(name, UP)
        if is_constant(term):
            # Houdini writes zeros where no normal is meant.
            if tuple(numbers(term)) not in (UP, (0.0, 0.0, 0.0)):
                self.warn(f"{name!r} is ignored: it is no image")
            return
        sources = {c.source for c in term[:3]}
        if len(term) < 3 or len(sources) > 1 or [c.channel for c in term[:3]] != ["r", "g", "b"]:
            self.warn(f"{name!r} is ignored: it is not one image")
            return
        scale, bias = [c.scale / 2 for c in term[:3]], [(c.bias + 1) / 2 for c in term[:3]]
        if all(c.scale == 1 and c.bias == 0 for c in term[:3]):
            self.approximate(f"{name!r} has no scale and bias, taken as 2 and −1")
            scale, bias = [1.0] * 3, [0.0] * 3
        texture = self.texture(next(iter(sources)), [*scale, 1.0], [*bias, 0.0])  # type: ignore[arg-type]
        self.item[key] = {"texture": texture}
