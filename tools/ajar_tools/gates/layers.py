"""Layers besides colour and its variance: first hits, almost without noise.

Coverage, albedo and normals are averages over a pixel, sampled at a few points: at edges they depend on where these
lie. So a value counts as another one only where it is beyond what the pixels around it hold in the other image.
"""

from __future__ import annotations

from functools import reduce

import numpy as np

from ajar_tools.picture import Picture
from ajar_tools.settings import Settings

# Differences up to this, relative to the larger value, are none; values below the least count as the least.
TOLERANCE, LEAST = 0.01, 0.01
# What a few samples may miss of an edge: of the range of the 3×3 pixels around, and of the largest value there.
OF_RANGE, OF_VALUE = 0.5, 0.125


def layer_problems(new: Picture, reference: Picture, settings: Settings) -> list[str]:
    """Layers in which more pixels differ than may."""
    colors = set(new.color_channels)
    problems = []
    for name in new.channels:
        if name in colors or name.startswith("variance.") or name not in reference.channels:
            continue
        planes = new.plane(name), reference.plane(name)
        # Numbers of objects: near ones have nothing in common.
        if new.types[name].startswith("uint") or all(map(whole, planes)):
            fraction = float(np.not_equal(*planes).mean())
        else:
            fraction = differing(*planes, settings.layer_pixels)
        if fraction > settings.layer_pixels:
            problems.append(
                f"channel {name} differs in {100 * fraction:.3g} % of the pixels, {100 * settings.layer_pixels:g} % may"
            )
    return problems


def differing(a: np.ndarray, b: np.ndarray, enough: float) -> float:
    """The fraction of pixels that differ; where it is less than `enough`, at most that."""
    tolerance = TOLERANCE * np.maximum(np.maximum(np.abs(a), np.abs(b)), LEAST)
    far = np.abs(a - b) > tolerance
    if far.mean() > enough:
        far &= beyond_neighbours(a, b, tolerance) | beyond_neighbours(b, a, tolerance)
    return float(far.mean())


def whole(plane: np.ndarray) -> bool:
    """Whether all values are whole numbers."""
    return np.array_equal(plane, np.rint(plane))


def beyond_neighbours(a: np.ndarray, b: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
    """Where `a` is out of the range of the 3×3 pixels of `b` around, which is wider where there is an edge."""
    low, high = around(b, np.minimum), around(b, np.maximum)
    edge = OF_RANGE * (high - low) + OF_VALUE * np.maximum(np.abs(low), np.abs(high))
    slack = np.where(high - low > tolerance, edge, tolerance)
    return np.asarray((a < low - slack) | (a > high + slack))


def around(plane: np.ndarray, extreme: np.ufunc) -> np.ndarray:
    """The least or largest of 3×3 pixels; beyond the border is what lies on it."""
    for axis in (0, 1):
        padded = np.pad(plane, [(1, 1) if axis == i else (0, 0) for i in (0, 1)], mode="edge")
        parts = (np.take(padded, range(i, i + plane.shape[axis]), axis=axis) for i in range(3))
        plane = reduce(extreme, parts)
    return plane
