"""What a file says about the noise in it: docs/image-statistics.md is the definition.

An image that is the mean of n independent renders (rounds) stores the estimated variance of the mean of every block of
8×8, 16×16 and 64×64 pixels and of the whole image. Variances of single pixels would not do: pixels may be correlated.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

SIDES = (8, 16, 64)
WHOLE = 0
"""Stands for the whole image where a side is asked for."""
NAMES = {side: f"ajar:blockVariance{side}" for side in SIDES} | {WHOLE: "ajar:imageVariance"}


@dataclass(frozen=True)
class BlockStatistics:
    """Variances of block means, estimated from `rounds` independent renders."""

    rounds: int
    variances: dict[int, np.ndarray]
    """By side: block rows × block columns × RGB."""


def read_statistics(attributes: Mapping[str, Any], size: tuple[int, int]) -> BlockStatistics | None:
    """The statistics of an image of `size` (width, height); `None` where they are missing or not well formed."""
    rounds = attributes.get("ajar:rounds")
    if not isinstance(rounds, int) or rounds < 2:
        return None
    variances = {}
    for side, name in NAMES.items():
        rows, columns = grid(size, side)
        values = np.asarray(attributes.get(name, ()), np.float64).reshape(-1)
        if values.size != rows * columns * 3 or not np.isfinite(values).all() or (values < 0).any():
            return None
        variances[side] = values.reshape(rows, columns, 3)
    return BlockStatistics(rounds, variances)


def as_attributes(statistics: BlockStatistics) -> dict[str, np.ndarray]:
    """The attributes that say the same, `ajar:rounds` excepted."""
    return {NAMES[side]: v.astype(np.float32).reshape(-1) for side, v in statistics.variances.items()}


def grid(size: tuple[int, int], side: int) -> tuple[int, int]:
    """Rows and columns of blocks of a side."""
    width, height = size
    return (1, 1) if side == WHOLE else (-(-height // side), -(-width // side))


def block_means(pixels: np.ndarray, side: int) -> np.ndarray:
    """Means of the blocks of `pixels` (rows × columns × channels); blocks at the right and bottom may be smaller."""
    height, width, channels = pixels.shape
    side = side or max(height, width)
    # First down: whole rows are added, which is ten times faster than squares, in pieces that caches hold.
    flat = np.ascontiguousarray(pixels).reshape(height, width * channels)
    whole = height - height % side
    sums = flat[:whole].reshape(-1, side, width * channels).sum(axis=1, dtype=np.float64)
    if whole < height:
        sums = np.concatenate([sums, flat[whole:].sum(axis=0, dtype=np.float64)[None]])
    lefts = np.arange(0, width, side)
    sums = np.add.reduceat(sums.reshape(-1, width, channels), lefts, axis=1)
    return np.asarray(sums / block_sizes((width, height), side)[..., None])


def block_sizes(size: tuple[int, int], side: int) -> np.ndarray:
    """Pixels in each block of an image of `size` (width, height): block rows × block columns."""
    width, height = size
    side = side or max(size)
    heights = np.minimum(side, height - np.arange(0, height, side))
    widths = np.minimum(side, width - np.arange(0, width, side))
    return heights[:, None] * widths[None, :]


def over_channels(combine: np.ufunc, pixels: np.ndarray) -> np.ndarray:
    """`combine.reduce(pixels, axis=2)`, several times faster for the few channels of an image."""
    return np.asarray(functools.reduce(combine, np.moveaxis(pixels, 2, 0)))


def from_rounds(rounds: np.ndarray) -> BlockStatistics:
    """Statistics of the mean of `rounds` (rounds × rows × columns × RGB): for other renderers, and the definition."""
    count = len(rounds)
    variances = {}
    for side in NAMES:
        means = np.stack([block_means(image, side) for image in rounds])
        variances[side] = means.var(axis=0, ddof=1) / count
    return BlockStatistics(count, variances)
