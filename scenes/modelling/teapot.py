"""A teapot as a signed distance, so that one closed surface serves china, metal and glass."""

from __future__ import annotations

import numpy as np

from .curved import smooth_profile
from .implicit import capsule_chain, smooth_union, surface_net
from .mesh import Array, Mesh

_SPOUT = np.array([[0.062, 0.052, 0], [0.100, 0.068, 0], [0.124, 0.098, 0], [0.140, 0.132, 0], [0.156, 0.142, 0]])
_HANDLE = np.array(
    [
        [-0.072, 0.122, 0],
        [-0.108, 0.132, 0],
        [-0.138, 0.112, 0],
        [-0.134, 0.074, 0],
        [-0.105, 0.05, 0],
        [-0.078, 0.042, 0],
    ]
)
_LOW, _HIGH = (-0.165, -0.01, -0.115), (0.18, 0.205, 0.115)


def _body(points: Array) -> Array:
    """A squat belly that is flattened below, with a shoulder ring."""
    radius = np.hypot(points[..., 0], points[..., 2])
    belly = np.stack([radius / 0.1, (points[..., 1] - 0.078) / 0.078], axis=-1)
    length = np.linalg.norm(belly, axis=-1)
    # Distance to an ellipse to first order: value over gradient.
    slope = np.sqrt((radius / 0.1**2) ** 2 + ((points[..., 1] - 0.078) / 0.078**2) ** 2)
    shape = length * (length - 1.0) / np.maximum(slope, 1.0)
    foot = np.hypot(np.maximum(radius - 0.057, 0.0), np.maximum(np.abs(points[..., 1] - 0.006) - 0.001, 0.0)) - 0.005
    return smooth_union(shape, foot, 0.012)


def _lid(points: Array) -> Array:
    """A low dome with a knob."""
    radius = np.hypot(points[..., 0], points[..., 2])
    rim = np.hypot(np.maximum(radius - 0.052, 0.0), points[..., 1] - 0.146) - 0.0055
    knob = np.sqrt(radius**2 + (points[..., 1] - 0.18) ** 2) - 0.014
    neck = np.maximum(radius - 0.007, np.abs(points[..., 1] - 0.16) - 0.015)
    return smooth_union(rim, smooth_union(knob, neck, 0.012), 0.012)


def _outline(points: Array) -> Array:
    """Distance to the whole pot."""
    spout, handle = smooth_profile(_SPOUT, 4), smooth_profile(_HANDLE, 5)
    flare = np.interp(np.linspace(0, 1, len(spout)), [0.0, 0.5, 0.9, 1.0], [0.026, 0.0155, 0.0115, 0.0125])
    pot = smooth_union(_body(points), capsule_chain(points, spout, flare), 0.014)
    pot = smooth_union(pot, capsule_chain(points, handle, np.full(len(handle), 0.0085)), 0.010)
    return smooth_union(pot, _lid(points), 0.007)


def teapot(cell: float = 0.0034) -> Mesh:
    """A teapot 0.19 m high that stands on the origin, spout towards +X."""
    return surface_net(_outline, _LOW, _HIGH, cell)


def hollow_teapot(wall: float = 0.007, cell: float = 0.0034) -> Mesh:
    """The teapot with an empty belly: closed inner and outer surfaces, for glass."""

    def shell(points: Array) -> Array:
        return np.maximum(_outline(points), -(_body(points) + wall))

    return surface_net(shell, _LOW, _HIGH, cell)
