"""Round tubes along polylines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class Tubes:
    """Quadrilaterals with smooth normals."""

    positions: np.ndarray
    normals: np.ndarray
    faces: np.ndarray


def tubes(points: np.ndarray, radii: np.ndarray, is_closed: bool, sides: int) -> Tubes:
    """Tubes around (curves, samples, 3) points with (curves, samples) radii; ends stay open."""
    curves, samples, _ = points.shape
    tangents = directions(points, is_closed)
    across = frames(tangents)
    up = np.cross(tangents, across)
    angles = 2 * np.pi * np.arange(sides) / sides
    circle = np.cos(angles)[:, None] * across[:, :, None] + np.sin(angles)[:, None] * up[:, :, None]
    positions = points[:, :, None] + radii[:, :, None, None] * circle
    ring = np.arange(samples if is_closed else samples - 1)[:, None]
    side = np.arange(sides)
    lower, upper = ring * sides, (ring + 1) % samples * sides
    after = (side + 1) % sides
    quads = np.stack([lower + side, lower + after, upper + after, upper + side], axis=-1).reshape(-1, 4)
    faces = (np.arange(curves)[:, None, None] * samples * sides + quads).reshape(-1, 4)
    return Tubes(positions.reshape(-1, 3).astype(np.float32), circle.reshape(-1, 3).astype(np.float32), faces)


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors of length 1; those without length point along Z."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 0, vectors / np.where(lengths > 0, lengths, 1), [0.0, 0.0, 1.0])


def directions(points: np.ndarray, is_closed: bool) -> np.ndarray:
    """Tangents, from both neighbours."""
    if is_closed:
        return unit(np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1))
    inner = points[:, 2:] - points[:, :-2]
    return unit(np.concatenate([points[:, 1:2] - points[:, :1], inner, points[:, -1:] - points[:, -2:-1]], axis=1))


def frames(tangents: np.ndarray) -> np.ndarray:
    """A vector across each tangent, turned as little as possible from one sample to the next."""
    across = np.empty_like(tangents)
    first = np.cross(tangents[:, 0], np.eye(3)[np.argmin(np.abs(tangents[:, 0]), axis=1)])
    across[:, 0] = unit(first)
    for i in range(1, tangents.shape[1]):
        before, tangent = across[:, i - 1], tangents[:, i]
        across[:, i] = unit(before - np.sum(before * tangent, axis=1, keepdims=True) * tangent)
    return across


def joined(parts: list[Tubes]) -> Tubes:
    """All together."""
    starts = np.cumsum([0] + [len(part.positions) for part in parts])
    return Tubes(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.faces + start for part, start in zip(parts, starts)]),
    )
