"""Control cages of subdivision surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from .mesh import Array, Triangles


@dataclass(frozen=True)
class Cage:
    """Polygons with a texture coordinate for each corner, and the edges (pairs of points) that stay sharp."""

    points: Array
    counts: Triangles
    corners: Triangles
    uvs: Array
    creases: Triangles
    sharpness: float = 10.0


def turned(profile: ArrayLike, segments: int = 16, sharp: Sequence[int] = (), sharpness: float = 4.0) -> Cage:
    """A profile of (radius, height) points about the y axis, the outside to its right going up; its ends are closed.

    Rings of the profile with the indices `sharp` are creases. u runs once around, v along the profile from 1 to 0.
    """
    rings = np.asarray(profile, dtype=float)
    angles = 2 * np.pi * np.arange(segments) / segments
    circle = np.stack([np.cos(angles), -np.sin(angles)], axis=1)
    points = np.stack(
        [
            np.outer(rings[:, 0], circle[:, 0]),
            np.repeat(rings[:, 1:], segments, 1),
            np.outer(rings[:, 0], circle[:, 1]),
        ],
        axis=-1,
    ).reshape(-1, 3)
    side = np.arange(segments)
    after = (side + 1) % segments
    quads = [np.column_stack([r + side, r + after, r + segments + after, r + segments + side])
             for r in range(0, (len(rings) - 1) * segments, segments)]  # fmt: skip
    corners = [np.concatenate(quads).reshape(-1), side[::-1], (len(rings) - 1) * segments + side]
    along = 1 - np.arange(len(rings)) / (len(rings) - 1)
    ring_uvs = [np.stack(np.broadcast_arrays(
        np.column_stack([side, side + 1, side + 1, side]) / segments, [low, low, high, high]), -1).reshape(-1, 2)
        for low, high in pairwise(along)]  # fmt: skip
    ends = [np.tile([0.5, level], (segments, 1)) for level in (1.0, 0.0)]
    counts = np.concatenate([np.full(len(quads) * segments, 4), [segments, segments]])
    creases = [np.column_stack([ring * segments + side, ring * segments + after]) for ring in sharp]
    edges = np.concatenate(creases) if creases else np.zeros((0, 2), np.int64)
    return Cage(points, counts, np.concatenate(corners), np.concatenate([*ring_uvs, *ends]), edges, sharpness)
