"""UsdGeomPoints: balls in one mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pxr import Usd, UsdGeom

from . import mesh, primvars

if TYPE_CHECKING:
    from .walk import Walk

GOLDEN = (1 + 5**0.5) / 2
# An icosahedron: 12 corners, 20 faces.
CORNERS = [
    *((-1, GOLDEN, 0), (1, GOLDEN, 0), (-1, -GOLDEN, 0), (1, -GOLDEN, 0), (0, -1, GOLDEN), (0, 1, GOLDEN)),
    *((0, -1, -GOLDEN), (0, 1, -GOLDEN), (GOLDEN, 0, -1), (GOLDEN, 0, 1), (-GOLDEN, 0, -1), (-GOLDEN, 0, 1)),
]
FACES = [
    *((0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6)),
    *((7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10)),
    *((8, 6, 7), (9, 8, 1)),
]
# Triangles of all balls together, at most, unless each is an icosahedron.
MOST = 2_000_000
FINEST = 4


def points(walk: Walk, prim: Usd.Prim, bound: str | None) -> list[int]:
    """The mesh of all balls of a prim; a point without width has none."""
    schema = UsdGeom.Points(prim)
    centres = np.array(schema.GetPointsAttr().Get(walk.time) or [], dtype=np.float32).reshape(-1, 3)
    given = schema.GetWidthsAttr().Get(walk.time)
    if given is None or not len(given):
        walk.report.warn(prim.GetPath(), "points without widths are dropped")
        return []
    sizes = primvars.Sizes(len(centres), 1, len(centres))
    read = primvars.fitted(walk, prim, "widths", given, None, schema.GetWidthsInterpolation(), 1, sizes)
    if read is None or not len(centres) or not np.all(np.isfinite(centres)):
        walk.report.warn(prim.GetPath(), "the points are dropped: positions or widths cannot be used")
        return []
    radii = np.broadcast_to(read.values / 2, (len(centres), 1))
    level = 0
    while level < FINEST and len(centres) * 20 * 4 ** (level + 1) <= MOST:
        level += 1
    ball, faces = icosphere(level)
    walk.document.check(len(centres) * (ball.nbytes * 2 + faces.nbytes))
    positions = (centres[:, None] + radii[:, None] * ball).reshape(-1, 3)
    corners = (np.arange(len(centres))[:, None, None] * len(ball) + faces).reshape(-1)
    topology = mesh.Topology(positions, np.full(len(corners) // 3, 3), corners, None)
    item = mesh.geometry(walk, topology, prim.GetName())
    item["normals"] = {"values": walk.document.array(np.tile(ball, (len(centres), 1)), 3), "per": "position"}
    mesh.finish(walk, prim, topology, item, [bound], np.repeat(np.arange(len(centres)), len(ball)))
    return [walk.document.add("meshes", item)]


def icosphere(level: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions on the unit sphere, and triangles."""
    corners = np.array(CORNERS, dtype=np.float64)
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    faces = np.array(FACES)
    for _ in range(level):
        edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        pairs, which = np.unique(edges, axis=0, return_inverse=True)
        middles = corners[pairs].sum(axis=1)
        middles /= np.linalg.norm(middles, axis=1, keepdims=True)
        a, b, c = (which.reshape(-1, 3) + len(corners)).T
        corners = np.vstack([corners, middles])
        x, y, z = faces.T
        faces = np.concatenate([np.stack(f, axis=1) for f in ((x, a, c), (y, b, a), (z, c, b), (a, b, c))])
    return corners.astype(np.float32), faces
