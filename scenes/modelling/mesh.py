"""Triangle meshes as plain arrays, with the few operations modelling needs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]


@dataclass(frozen=True)
class Mesh:
    """Vertices with normals and texture coordinates, and the triangles between them.

    Operations return a new mesh. `tangents`, where present, is (n, 4): a unit
    vector along increasing u, and the sign of the bitangent.
    """

    positions: Array
    normals: Array
    uvs: Array
    triangles: Triangles
    tangents: Array | None = None

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mesh:
        """The mesh moved by a vector."""
        return Mesh(self.positions + np.array([x, y, z]), self.normals, self.uvs, self.triangles, self.tangents)

    def transformed(self, matrix: ArrayLike) -> Mesh:
        """The mesh under a 3×3 linear map; a mirroring map also turns the winding."""
        linear = np.asarray(matrix, dtype=float)
        normals = normalize(self.normals @ np.linalg.inv(linear))
        triangles = self.triangles if np.linalg.det(linear) > 0.0 else self.triangles[:, ::-1]
        tangents = self.tangents
        if tangents is not None:
            sign = tangents[:, 3:] * np.sign(np.linalg.det(linear))
            tangents = np.hstack([normalize(tangents[:, :3] @ linear.T), sign])
        return Mesh(self.positions @ linear.T, normals, self.uvs, triangles, tangents)

    def scaled(self, x: float, y: float | None = None, z: float | None = None) -> Mesh:
        """The mesh scaled about the origin; one number scales all axes."""
        return self.transformed(np.diag([x, x if y is None else y, x if z is None else z]))

    def rotated(self, axis: str, degrees: float) -> Mesh:
        """The mesh rotated counter-clockwise about the axis `x`, `y` or `z`."""
        return self.transformed(rotation(axis, degrees))

    def with_uv_scale(self, u: float, v: float | None = None) -> Mesh:
        """The mesh with texture coordinates multiplied."""
        scale = np.array([u, u if v is None else v])
        return Mesh(self.positions, self.normals, self.uvs * scale, self.triangles, self.tangents)

    def with_uv_offset(self, u: float, v: float) -> Mesh:
        """The mesh with texture coordinates moved, so that equal parts do not look alike."""
        return Mesh(self.positions, self.normals, self.uvs + np.array([u, v]), self.triangles, self.tangents)

    def with_uv_swapped(self) -> Mesh:
        """The mesh with u and v exchanged: turns the grain of a texture."""
        return Mesh(self.positions, self.normals, self.uvs[:, ::-1].copy(), self.triangles, self.tangents)

    def reversed(self) -> Mesh:
        """The mesh with its faces pointing the other way."""
        return Mesh(self.positions, -self.normals, self.uvs, self.triangles[:, ::-1], self.tangents)

    def is_closed(self) -> bool:
        """Whether every edge is met once in each direction, after welding equal positions."""
        _, welded = np.unique(np.round(self.positions * 1e7).astype(np.int64), axis=0, return_inverse=True)
        corners = welded.reshape(-1)[self.triangles]
        corners = corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]
        edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
        keys, opposite = edges @ [1 << 32, 1], edges @ [1, 1 << 32]
        return bool(np.array_equal(np.sort(keys), np.sort(opposite)) and len(np.unique(keys)) == len(keys))

    def volume(self) -> float:
        """Signed volume of a closed mesh; positive when faces point outwards."""
        a, b, c = (self.positions[self.triangles[:, i]] for i in range(3))
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def merge(meshes: Iterable[Mesh]) -> Mesh:
    """One mesh of all the parts; tangents survive only where every part has them."""
    parts = list(meshes)
    offsets = np.cumsum([0] + [len(part.positions) for part in parts[:-1]])
    tangents = [part.tangents for part in parts if part.tangents is not None]
    return Mesh(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.uvs for part in parts]),
        np.concatenate([part.triangles + offset for part, offset in zip(parts, offsets, strict=True)]),
        np.concatenate(tangents) if len(tangents) == len(parts) else None,
    )


def normalize(vectors: Array) -> Array:
    """Rows scaled to length one; zero rows stay zero."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(lengths > 0.0, lengths, 1.0)


def rotation(axis: str, degrees: float) -> Array:
    """Matrix that turns counter-clockwise about an axis, seen from its tip."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrices = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return np.array(matrices[axis], dtype=float)
