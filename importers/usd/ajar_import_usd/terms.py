"""What a shader input comes to: numbers, each of which may be a channel of an image times a factor plus an offset."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace


class UnsupportedError(Exception):
    """Something that cannot be said with one image, a factor and an offset."""


@dataclass(frozen=True)
class Coordinates:
    """Coordinates of a primvar, then (u, v) → (a u + b v + x, c u + d v + y). The origin is at the bottom left."""

    primvar: str = "st"
    matrix: tuple[float, float, float, float, float, float] = (1, 0, 0, 0, 1, 0)

    def then(self, a: float, b: float, x: float, c: float, d: float, y: float) -> Coordinates:
        """Another transform after this one."""
        e, f, u, g, h, v = self.matrix
        first = (a * e + b * g, a * f + b * h, a * u + b * v + x)
        return replace(self, matrix=(*first, c * e + d * g, c * f + d * h, c * u + d * v + y))

    def top_left(self) -> list[float]:
        """Images of U and V, and the origin, where the origin is at the top left on both sides."""
        a, b, x, c, d, y = self.matrix
        return [a, -c, -b, d, b + x, 1 - d - y]


@dataclass(frozen=True)
class Image:
    """An image file as a shader reads it."""

    path: str
    coordinates: Coordinates
    color_space: str = "auto"
    wrap_u: str = "repeat"
    wrap_v: str = "repeat"
    filter: str = "linear"


@dataclass(frozen=True)
class Primvar:
    """Colours of the mesh."""

    name: str


@dataclass(frozen=True)
class Component:
    """scale · channel + bias, or bias alone."""

    bias: float = 0.0
    source: Image | Primvar | None = None
    channel: str = "r"
    scale: float = 0.0

    def scaled(self, factor: float, offset: float = 0.0) -> Component:
        """factor · this + offset."""
        return replace(self, scale=self.scale * factor, bias=self.bias * factor + offset)


Term = tuple[Component, ...]
"""As many components as the type has."""


def constant(value: float | Sequence[float]) -> Term:
    """Numbers alone."""
    values = [value] if isinstance(value, (int, float)) else value
    return tuple(Component(float(v)) for v in values)


def source(image: Image | Primvar, channels: str) -> Term:
    """Channels as they are."""
    return tuple(Component(0.0, image, channel, 1.0) for channel in channels)


def is_constant(term: Term) -> bool:
    """Whether no image has a part in it."""
    return all(c.source is None for c in term)


def numbers(term: Term) -> list[float]:
    """The values of a constant."""
    if not is_constant(term):
        raise UnsupportedError("an image where only a number can be")
    return [c.bias for c in term]


def is_zero(term: Term) -> bool:
    """Whether nothing is left of a weight."""
    return is_constant(term) and all(v <= 0 for v in numbers(term))


def widened(a: Term, b: Term) -> tuple[Term, Term]:
    """Both with as many components as the longer one; one component stands for all."""
    size = max(len(a), len(b))
    return (a * size if len(a) == 1 else a), (b * size if len(b) == 1 else b)


def product(a: Term, b: Term) -> Term:
    """a · b; one of them must be constant."""

    def each(x: Component, y: Component) -> Component:
        if x.source is None:
            x, y = y, x
        if y.source is not None:
            raise UnsupportedError("a product of two images")
        return x.scaled(y.bias)

    return tuple(each(x, y) for x, y in zip(*widened(a, b)))


def total(a: Term, b: Term, sign: float = 1.0) -> Term:
    """a + sign · b; both may read the same channel."""

    def each(x: Component, y: Component) -> Component:
        y = y.scaled(sign)
        if y.source is None:
            return x.scaled(1, y.bias)
        if x.source is None:
            return y.scaled(1, x.bias)
        if (x.source, x.channel) != (y.source, y.channel):
            raise UnsupportedError("a sum of two images")
        return replace(x, scale=x.scale + y.scale, bias=x.bias + y.bias)

    return tuple(each(x, y) for x, y in zip(*widened(a, b)))


def mixed(back: Term, front: Term, share: Term) -> Term:
    """back + share · (front − back)."""
    return total(back, product(total(front, back, -1), share))


def computed(function: Callable[..., float], *terms: Term) -> Term:
    """A function of constants, component by component."""
    size = max(map(len, terms))
    values = [numbers(term) * (size if len(term) == 1 else 1) for term in terms]
    try:
        return constant([function(*components) for components in zip(*values)])
    except (ArithmeticError, ValueError) as error:
        raise UnsupportedError(f"a value that is none: {error}") from error
