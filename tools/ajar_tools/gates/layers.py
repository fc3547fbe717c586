"""Layers besides colour and its variance: first hits, almost without noise.

Coverage, albedo and normals are averages over a pixel, sampled at a few points: at edges they depend on where these
lie. So a value counts as another one only where it is beyond what the pixels around it hold in the other image. What
that lets through scatters to both sides: the mean of a block of pixels stays as it is, and is judged too.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from ajar_tools.picture import Picture
from ajar_tools.settings import Settings
from ajar_tools.statistics import block_means, block_sizes

# Differences up to this, relative to the larger value, are none; values below the least count as the least.
TOLERANCE, LEAST = 0.01, 0.01
# What a few samples may miss of an edge: of the range of the 3×3 pixels around, and of the largest value there.
OF_RANGE, OF_VALUE = 0.5, 0.125
# Side of the blocks whose means are judged, and fewest pixels of one.
SIDE, FEWEST = 64, 256
# What their means may differ by: this part of the values' mean size, and so many standard errors of the difference.
OF_MEAN, DEVIATIONS = 0.03, 4


def layer_problems(new: Picture, reference: Picture, settings: Settings) -> list[str]:
    """What is wrong with each layer that is."""
    colors = set(new.color_channels)
    names = [n for n in new.channels if n not in colors and not n.startswith("variance.") and n in reference.channels]
    allowed = settings.layer_pixels

    def problem(name: str) -> str:
        # Channels lie interleaved: one that is looked at often is taken out first.
        a, b = (np.ascontiguousarray(picture.plane(name)) for picture in (new, reference))
        # Numbers of objects: near ones have nothing in common.
        numbers = new.types[name].startswith("uint") or (whole(a) and whole(b))
        part = float(np.not_equal(a, b).mean()) if numbers else differing(a, b, allowed)
        if part > allowed:
            return f"channel {name} differs in {100 * part:.3g} % of the pixels, {100 * allowed:g} % may"
        if not numbers and (count := other_blocks(a, b)):
            return f"the mean of channel {name} differs in {count} blocks of {SIDE}×{SIDE} pixels"
        return ""

    # numpy works without the interpreter's lock.
    with ThreadPoolExecutor() as pool:
        return list(filter(None, pool.map(problem, names)))


def differing(a: np.ndarray, b: np.ndarray, enough: float) -> float:
    """The fraction of pixels that differ; where it is less than `enough`, at most that."""
    tolerance = TOLERANCE * np.maximum(np.maximum(np.abs(a), np.abs(b)), LEAST)
    places = np.nonzero(np.abs(a - b) > tolerance)
    if len(places[0]) <= enough * a.size:
        return len(places[0]) / a.size
    others = tolerance[places]
    beyond = beyond_neighbours(a, b, places, others) | beyond_neighbours(b, a, places, others)
    return float(beyond.sum()) / a.size


def other_blocks(a: np.ndarray, b: np.ndarray) -> int:
    """The number of blocks whose means differ by more than edges explain."""
    difference = (a - b)[..., None]
    # In doubles: the square of a large float is none any more.
    mean, square = (block_means(values, SIDE) for values in (difference, np.square(difference, dtype=np.float64)))
    size = block_means(np.maximum(np.abs(a), np.abs(b))[..., None], SIDE)
    pixels = block_sizes((a.shape[1], a.shape[0]), SIDE)[..., None]
    error = np.sqrt(np.maximum(square - mean * mean, 0) / pixels)
    differs = np.abs(mean) > OF_MEAN * np.maximum(size, LEAST) + DEVIATIONS * error
    return int((differs & (pixels >= FEWEST)).sum())


def whole(plane: np.ndarray) -> bool:
    """Whether all values are whole numbers."""
    # Most layers tell by their first row.
    return all(np.array_equal(part, np.rint(part)) for part in (plane[:1], plane))


def beyond_neighbours(
    a: np.ndarray, b: np.ndarray, places: tuple[np.ndarray, ...], tolerance: np.ndarray
) -> np.ndarray:
    """At which places `a` is out of the range of the 3×3 pixels of `b` around, which is wider at edges."""
    low, high = around(b, places)
    edge = OF_RANGE * (high - low) + OF_VALUE * np.maximum(np.abs(low), np.abs(high))
    slack = np.where(high - low > tolerance, edge, tolerance)
    value = a[places]
    return np.asarray((value < low - slack) | (value > high + slack))


def around(plane: np.ndarray, places: tuple[np.ndarray, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The least and the largest of the 3×3 pixels around each place; beyond the border is what lies on it."""
    rows, columns = (
        [np.clip(places[axis] + step, 0, extent - 1) for step in (-1, 0, 1)] for axis, extent in enumerate(plane.shape)
    )
    low = high = plane[places]
    for row in rows:
        for column in columns:
            value = plane[row, column]
            low, high = np.minimum(low, value), np.maximum(high, value)
    return low, high
