"""Shapes given by signed distance, meshed with naive surface nets (Gibson 1998).

One vertex for each cell that the surface crosses, pulled onto the surface by
Newton steps; normals are the gradient of the distance. Meshes are closed and
face outwards, so they may bound glass.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from .mesh import Array, Mesh, normalize

Distance = Callable[[Array], Array]


def smooth_union(a: Array, b: Array, radius: float) -> Array:
    """The union of two distances with a fillet of about `radius` (polynomial minimum)."""
    h = np.clip(0.5 + 0.5 * (b - a) / radius, 0.0, 1.0)
    return b + (a - b) * h - radius * h * (1.0 - h)


def capsule_chain(points: Array, path: Array, radii: Array) -> Array:
    """Distance to a bent rod: the nearest of tapered capsules along a path."""
    nearest = np.full(points.shape[:-1], np.inf)
    for a, b, ra, rb in zip(path[:-1], path[1:], radii[:-1], radii[1:], strict=True):
        edge = b - a
        t = np.clip((points - a) @ edge / (edge @ edge), 0.0, 1.0)
        offset = points - a - t[..., None] * edge
        nearest = np.minimum(nearest, np.linalg.norm(offset, axis=-1) - (ra + (rb - ra) * t))
    return nearest


def surface_net(distance: Distance, low: Sequence[float], high: Sequence[float], cell: float) -> Mesh:
    """Meshes the zero set of `distance` inside a box that holds it entirely."""
    lower = np.asarray(low, dtype=float)
    shape = np.ceil((np.asarray(high, dtype=float) - lower) / cell).astype(int) + 1
    axes = [lower[i] + cell * np.arange(shape[i]) for i in range(3)]
    corners = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    inside = distance(corners) < 0.0
    cells = np.stack([inside[_shift(bits, inside.shape)] for bits in range(8)])
    crossed = cells.any(axis=0) & ~cells.all(axis=0)
    index = np.full(crossed.shape, -1, dtype=np.int64)
    index[crossed] = np.arange(crossed.sum())
    positions = lower + cell * (np.argwhere(crossed) + 0.5)
    centres = positions.copy()
    for _ in range(6):
        gradient = _gradient(distance, positions, cell)
        slope = np.einsum("ij,ij->i", gradient, gradient)[:, None]
        positions = positions - gradient * distance(positions)[:, None] / np.maximum(slope, 0.05)
        # Vertices stay in their cell, which keeps the net free of folds.
        positions = np.clip(positions, centres - cell / 2, centres + cell / 2)
    triangles = np.concatenate([_quads(inside, index, axis) for axis in range(3)])
    normals = normalize(_gradient(distance, positions, cell))
    return Mesh(positions, normals, np.zeros((len(positions), 2)), triangles)


def _shift(bits: int, shape: tuple[int, ...]) -> tuple[slice, ...]:
    """The corner of every cell that lies at the high end of the axes named by `bits`."""
    return tuple(slice(bits >> i & 1, shape[i] - 1 + (bits >> i & 1)) for i in range(3))


def _gradient(distance: Distance, points: Array, cell: float) -> Array:
    """Central differences over half a cell."""
    offsets = np.eye(3) * (cell / 4)
    return np.stack([(distance(points + o) - distance(points - o)) / (cell / 2) for o in offsets], axis=-1)


def _quads(inside: Array, index: Array, axis: int) -> Array:
    """Two triangles across each grid edge along `axis` that changes side."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    moved = np.moveaxis(inside, (axis, first, second), (0, 1, 2))
    names = np.moveaxis(index, (axis, first, second), (0, 1, 2))
    start, end = moved[:-1, 1:-1, 1:-1], moved[1:, 1:-1, 1:-1]
    around = np.stack([names[:, :-1, :-1], names[:, 1:, :-1], names[:, 1:, 1:], names[:, :-1, 1:]], axis=-1)
    leaving, entering = start & ~end, ~start & end
    quads = np.concatenate([around[leaving], around[entering][:, ::-1]])
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
