"""Implicit shapes as polygons: bodies of revolution, cubes and planes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from pxr import Usd, UsdGeom

from . import mesh

if TYPE_CHECKING:
    from .walk import Walk

SEGMENTS = 96
# Rings of half a circle.
RINGS = 48

Profile = np.ndarray
"""Rows of radius, height and their normal's radial and axial part, from below upwards."""

CUBE = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
CUBE_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
# Columns of (x, y, z) for a shape whose axis is Z, put along the axis.
AXES = {"X": [2, 0, 1], "Y": [1, 2, 0], "Z": [0, 1, 2]}


def shape(walk: Walk, prim: Usd.Prim, bound: str | None) -> list[int]:
    """The mesh of an implicit shape."""
    kind = prim.GetTypeName().removesuffix("_1")
    if kind == "Cube":
        half = value(walk, prim, "size") / 2
        topology, normals = polygons(np.array(CUBE) * half, CUBE_FACES), None
    elif kind == "Plane":
        topology, normals = plane(walk, prim)
    else:
        topology, normals = revolved(walk, prim, profiles(walk, prim, kind))
    if not np.all(np.isfinite(topology.positions)) or np.ptp(topology.positions, axis=0).max() == 0:
        walk.report.warn(prim.GetPath(), f"the {kind} is dropped: it has no size")
        return []
    item = mesh.geometry(walk, topology, prim.GetName())
    if normals is not None:
        item["normals"] = {"values": walk.document.array(normals, 3), "per": "position"}
    mesh.finish(walk, prim, topology, item, [bound])
    return [walk.document.add("meshes", item)]


def value(walk: Walk, prim: Usd.Prim, name: str) -> float:
    """A number of the prim."""
    return float(prim.GetAttribute(name).Get(walk.time) or 0.0)


def polygons(positions: np.ndarray, faces: Sequence[tuple[int, ...]]) -> mesh.Topology:
    """Faces given by their corners."""
    corners = np.array([corner for face in faces for corner in face])
    return mesh.Topology(positions.astype(np.float32), np.array([len(face) for face in faces]), corners, None)


def plane(walk: Walk, prim: Usd.Prim) -> tuple[mesh.Topology, None]:
    """A rectangle that faces along its axis."""
    width, length = value(walk, prim, "width") / 2, value(walk, prim, "length") / 2
    axis = UsdGeom.Plane(prim).GetAxisAttr().Get(walk.time)
    # Width lies along X, or along Z where X is the axis; length along Y, or along Z where Y is the axis.
    corners = {
        "X": [(0, -length, -width), (0, length, -width), (0, length, width), (0, -length, width)],
        "Y": [(-width, 0, length), (width, 0, length), (width, 0, -length), (-width, 0, -length)],
    }.get(axis, [(-width, -length, 0), (width, -length, 0), (width, length, 0), (-width, length, 0)])
    return polygons(np.array(corners), [(0, 1, 2, 3)]), None


def profiles(walk: Walk, prim: Usd.Prim, kind: str) -> list[Profile]:
    """Parts of the outline; edges between parts are sharp."""
    if kind == "Sphere":
        radius = value(walk, prim, "radius")
        return [arc(radius, 0.0, -np.pi / 2, np.pi / 2)]
    half = value(walk, prim, "height") / 2
    if prim.HasAttribute("radiusTop"):
        top, bottom = value(walk, prim, "radiusTop"), value(walk, prim, "radiusBottom")
    else:
        bottom = value(walk, prim, "radius")
        top = 0.0 if kind == "Cone" else bottom
    side = np.array([2 * half, bottom - top])
    normal = side / (np.linalg.norm(side) or 1.0)
    wall = np.array([[bottom, -half, *normal], [top, half, *normal]])
    if kind == "Capsule":
        tilt = float(np.arctan2(normal[1], normal[0]))
        return [np.vstack([arc(bottom, -half, -np.pi / 2, tilt), arc(top, half, tilt, np.pi / 2)])]
    base = np.array([[0, -half, 0, -1], [bottom, -half, 0, -1]])
    lid = np.array([[top, half, 0, 1], [0, half, 0, 1]])
    return [base, wall] if kind == "Cone" else [base, wall, lid]


def arc(radius: float, height: float, start: float, end: float) -> Profile:
    """Part of a circle around a point of the axis."""
    angles = np.linspace(start, end, RINGS + 1)
    around, along = np.cos(angles), np.sin(angles)
    around[np.isclose(np.abs(angles), np.pi / 2)] = 0
    return np.stack([radius * around, height + radius * along, around, along], axis=1)


def revolved(walk: Walk, prim: Usd.Prim, parts: list[Profile]) -> tuple[mesh.Topology, np.ndarray]:
    """Bodies of revolution about the prim's axis, with normals."""
    angles = 2 * np.pi * np.arange(SEGMENTS) / SEGMENTS
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    positions, normals, faces, first = [], [], [], 0
    for part in parts:
        for radius, height, around, along in part:
            positions.append(np.column_stack([radius * circle, np.full(SEGMENTS, height)]))
            normals.append(np.column_stack([around * circle, np.full(SEGMENTS, along)]))
        for ring in range(len(part) - 1):
            lower = first + ring * SEGMENTS
            faces += strip(lower, lower + SEGMENTS, part[ring, 0] == 0, part[ring + 1, 0] == 0)
        first += len(part) * SEGMENTS
    axis = prim.GetAttribute("axis").Get(walk.time) if prim.HasAttribute("axis") else "Z"
    columns = AXES.get(axis, AXES["Z"])
    return polygons(np.vstack(positions)[:, columns], faces), np.vstack(normals)[:, columns]


def strip(lower: int, upper: int, is_lower_point: bool, is_upper_point: bool) -> list[tuple[int, ...]]:
    """Faces between two rings, of which one may be a point."""
    faces: list[tuple[int, ...]] = []
    for i in range(SEGMENTS):
        j = (i + 1) % SEGMENTS
        if is_lower_point:
            faces.append((lower + i, upper + j, upper + i))
        elif is_upper_point:
            faces.append((lower + i, lower + j, upper + i))
        else:
            faces.append((lower + i, lower + j, upper + j, upper + i))
    return faces
