"""Nodes that make texture coordinates."""

from __future__ import annotations

import math
from collections.abc import Callable

from pxr import UsdShade

from .network import Network
from .terms import Coordinates, UnsupportedError, numbers


def pair(network: Network, shader: UsdShade.Shader, name: str, default: float) -> tuple[float, float]:
    """Two constants."""
    values = numbers(network.follow(shader, name, (default, default)))
    return values[0], values[-1]


def reader(network: Network, shader: UsdShade.Shader) -> Coordinates:
    """UsdPrimvarReader_float2, and MaterialX's geompropvalue."""
    name = network.text(shader, "varname", "") or network.text(shader, "geomprop", "st")
    return Coordinates(name)


def texcoord(network: Network, shader: UsdShade.Shader) -> Coordinates:
    """MaterialX's texcoord: set 0 is "st" in USD."""
    index = int(numbers(network.follow(shader, "index", 0))[0])
    return Coordinates("st" if index == 0 else f"st{index}")


def transform2d(network: Network, shader: UsdShade.Shader) -> Coordinates:
    """UsdTransform2d: scaled, rotated counter-clockwise, moved."""
    x, y = pair(network, shader, "scale", 1.0)
    u, v = pair(network, shader, "translation", 0.0)
    angle = math.radians(numbers(network.follow(shader, "rotation", 0.0))[0])
    c, s = math.cos(angle), math.sin(angle)
    return network.coordinates(shader, "in").then(c * x, -s * y, u, s * x, c * y, v)


def turned(at: Coordinates, degrees: float) -> Coordinates:
    """MaterialX's rotate2d, clockwise."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return at.then(c, s, 0, -s, c, 0)


def place2d(network: Network, shader: UsdShade.Shader) -> Coordinates:
    """MaterialX's place2d, in the order of its `operationorder`."""
    at = network.coordinates(shader, "texcoord")
    x, y = pair(network, shader, "pivot", 0.0)
    sx, sy = pair(network, shader, "scale", 1.0)
    dx, dy = pair(network, shader, "offset", 0.0)
    if not sx or not sy:
        raise UnsupportedError("a scale of 0")
    degrees = numbers(network.follow(shader, "rotate", 0.0))[0]
    at = at.then(1, 0, -x, 0, 1, -y)
    if numbers(network.follow(shader, "operationorder", 0))[0]:
        at = turned(at.then(1, 0, -dx, 0, 1, -dy), degrees).then(1 / sx, 0, 0, 0, 1 / sy, 0)
    else:
        at = turned(at.then(1 / sx, 0, 0, 0, 1 / sy, 0), degrees).then(1, 0, -dx, 0, 1, -dy)
    return at.then(1, 0, x, 0, 1, y)


def rotate2d(network: Network, shader: UsdShade.Shader) -> Coordinates:
    """MaterialX's rotate2d."""
    return turned(network.coordinates(shader, "in"), numbers(network.follow(shader, "amount", 0.0))[0])


def dot(network: Network, shader: UsdShade.Shader) -> Coordinates:
    """Nothing changes."""
    return network.coordinates(shader, "in")


def scaled(power: float) -> Callable[[Network, UsdShade.Shader], Coordinates]:
    """multiply and divide by constants."""

    def node(network: Network, shader: UsdShade.Shader) -> Coordinates:
        x, y = pair(network, shader, "in2", 1.0)
        if power < 0 and not (x and y):
            raise UnsupportedError("a division by 0")
        return network.coordinates(shader, "in1").then(x**power, 0, 0, 0, y**power, 0)

    return node


def moved(sign: float) -> Callable[[Network, UsdShade.Shader], Coordinates]:
    """add and subtract constants."""

    def node(network: Network, shader: UsdShade.Shader) -> Coordinates:
        x, y = pair(network, shader, "in2", 0.0)
        return network.coordinates(shader, "in1").then(1, 0, sign * x, 0, 1, sign * y)

    return node


NODES: dict[str, Callable[[Network, UsdShade.Shader], Coordinates]] = {
    "UsdPrimvarReader_float2": reader,
    "UsdPrimvarReader": reader,
    "UsdTransform2d": transform2d,
    "geompropvalue": reader,
    "texcoord": texcoord,
    "place2d": place2d,
    "rotate2d": rotate2d,
    "dot": dot,
    "multiply": scaled(1),
    "divide": scaled(-1),
    "add": moved(1),
    "subtract": moved(-1),
}
"""Who reads which node."""
