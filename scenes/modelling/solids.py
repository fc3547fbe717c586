"""Flat and boxy shapes: quads, boxes, rounded boxes, and walls with openings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .mesh import Array, Mesh, merge, normalize


def quad(corner: Sequence[float], u_edge: Sequence[float], v_edge: Sequence[float]) -> Mesh:
    """A parallelogram seen from its front: `corner` is top left, u runs right, v runs down.

    Texture coordinates are metres.
    """
    origin, u, v = (np.asarray(vector, dtype=float) for vector in (corner, u_edge, v_edge))
    positions = np.array([origin, origin + u, origin + u + v, origin + v])
    normal = normalize(np.cross(v, u))
    width, height = np.linalg.norm(u), np.linalg.norm(v)
    uvs = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    return Mesh(positions, np.tile(normal, (4, 1)), uvs, np.array([[0, 3, 2], [0, 2, 1]]))


def floor(width: float, depth: float) -> Mesh:
    """A horizontal rectangle about the origin, facing up; u along x, v along z, in metres."""
    return quad((-width / 2, 0.0, -depth / 2), (width, 0.0, 0.0), (0.0, 0.0, depth))


# For each face: axis of the normal, its sign, and the u and v axes with signs, such that v × u is the normal.
_FACES = (
    (0, 1, (2, -1), (1, -1)),
    (0, -1, (2, 1), (1, -1)),
    (1, 1, (0, 1), (2, 1)),
    (1, -1, (0, 1), (2, -1)),
    (2, 1, (0, 1), (1, -1)),
    (2, -1, (0, -1), (1, -1)),
)


def box(low: Sequence[float], high: Sequence[float]) -> Mesh:
    """A box between two corners, faces outwards, sharp edges, texture coordinates in metres."""
    lower, upper = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    return rounded_box(upper - lower, 0.0).moved(*((lower + upper) / 2))


def rounded_box(size: Sequence[float], radius: float, steps: int = 2) -> Mesh:
    """A box about the origin whose edges are rounded; radius 0 gives a plain box.

    Texture coordinates are metres along each face.
    """
    half = np.asarray(size, dtype=float) / 2
    inner = half - radius
    slopes = np.tan(np.linspace(0.0, np.pi / 4, steps + 1))[::-1] * radius if radius > 0 else np.zeros(1)
    return merge(_face(inner, radius, slopes, *face) for face in _FACES)


def _face(
    inner: Array, radius: float, slopes: Array, axis: int, sign: int, u_axis: tuple[int, int], v_axis: tuple[int, int]
) -> Mesh:
    """One face of a rounded box with its half of the rounded edges around it."""

    def line(which: int) -> Array:
        return np.concatenate([-inner[which] - slopes, inner[which] + slopes[::-1]])

    us, vs = line(u_axis[0]), line(v_axis[0])
    grid_v, grid_u = np.meshgrid(vs, us, indexing="ij")
    points = np.zeros((grid_u.size, 3))
    points[:, u_axis[0]] = grid_u.reshape(-1) * u_axis[1]
    points[:, v_axis[0]] = grid_v.reshape(-1) * v_axis[1]
    points[:, axis] = sign * (inner[axis] + radius)
    normals = np.zeros_like(points)
    normals[:, axis] = sign
    if radius > 0:
        core = np.clip(points, -inner, inner)
        normals = normalize(points - core)
        points = core + normals * radius
    uvs = np.column_stack([grid_u.reshape(-1) - us[0], grid_v.reshape(-1) - vs[0]])
    columns = len(us)
    row, column = np.meshgrid(np.arange(len(vs) - 1), np.arange(columns - 1), indexing="ij")
    a = (row * columns + column).reshape(-1)
    b, c, d = a + columns, a + columns + 1, a + 1
    return Mesh(points, normals, uvs, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]))


def wall(
    width: float, height: float, thickness: float, openings: Sequence[tuple[float, float, float, float]] = ()
) -> Mesh:
    """A wall in the xy plane with rectangular holes, between z = 0 and z = -thickness.

    Openings are (left, bottom, right, top), left to right without overlap in
    x. The reveals are closed, so no light passes through the body of the
    wall. Texture coordinates are metres from the lower left corner.
    """
    parts: list[Mesh] = []
    edge = 0.0
    for left, bottom, right, top in openings:
        parts += [_slab(edge, 0.0, left, height, thickness)]
        if bottom > 0.0:
            parts += [_slab(left, 0.0, right, bottom, thickness)]
        if top < height:
            parts += [_slab(left, top, right, height, thickness)]
        edge = right
    parts += [_slab(edge, 0.0, width, height, thickness)]
    return merge(parts)


def _slab(left: float, bottom: float, right: float, top: float, thickness: float) -> Mesh:
    """One block of a wall, textured continuously with its neighbours."""
    block = box((left, bottom, -thickness), (right, top, 0.0))
    return block.with_uv_offset(left, -top)
