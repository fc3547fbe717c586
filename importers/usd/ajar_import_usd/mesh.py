"""UsdGeomMesh: topology, subsets, normals, subdivision."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

from . import primvars
from .blocks import are_finite, normalized, squared_lengths

if TYPE_CHECKING:
    from .walk import Walk

BOUNDARY = {"none": "none", "edgeOnly": "edges", "edgeAndCorner": "corners"}
LINEAR = {
    "all": "all",
    "none": "none",
    "boundaries": "boundary",
    "cornersOnly": "corners",
    "cornersPlus1": "corners",
    "cornersPlus2": "corners",
}
# Refined as long as there are at most so many faces, so that silhouettes look round.
FINE = 16_384
# Squares of lengths that differ from 1 by less are those of unit vectors in 32 bits.
UNIT = 1e-6
MOST_LEVELS = 5


@dataclass
class Topology:
    """Faces of a mesh. `order` is set where corners have another order than in USD."""

    positions: np.ndarray
    faces: np.ndarray
    corners: np.ndarray
    order: np.ndarray | None

    @property
    def is_triangles(self) -> bool:
        """Whether all faces have three corners."""
        return bool(self.faces.min() == self.faces.max() == 3)

    @property
    def sizes(self) -> primvars.Sizes:
        """What attributes must have."""
        return primvars.Sizes(len(self.positions), len(self.faces), len(self.corners))


def mesh(walk: Walk, prim: Usd.Prim, bound: str | None) -> list[int]:
    """The mesh of a prim, or nothing with a warning."""
    schema = UsdGeom.Mesh(prim)
    topology = read_topology(walk, schema)
    if topology is None:
        return []
    item = geometry(walk, topology, prim.GetName())
    parts = subsets(walk, prim, topology, bound)
    if parts:
        item["parts"] = [{"material": walk.materials.index(name), "faces": faces} for name, faces in parts]
    holes = np.array(schema.GetHoleIndicesAttr().Get(walk.time) or [], dtype=np.int64)
    if len(holes) and holes.min() >= 0 and holes.max() < len(topology.faces):
        item["holes"] = walk.document.indices(holes)
    elif len(holes):
        walk.report.warn(prim.GetPath(), f"holes are dropped: an index is beyond the {len(topology.faces)} faces")
    scheme = schema.GetSubdivisionSchemeAttr().Get(walk.time)
    if scheme in ("catmullClark", "loop"):
        item["subdivision"] = subdivision(walk, schema, topology)
        if scheme == "loop":
            walk.report.approximate(prim.GetPath(), "Loop subdivision is approximated by that of Catmull and Clark")
    else:
        if scheme == "bilinear":
            walk.report.note(prim.GetPath(), "bilinear subdivision is left out; faces are what they are")
        add_normals(walk, schema, topology, item)
    finish(walk, prim, topology, item, [bound, *(name for name, _ in parts)])
    return [walk.document.add("meshes", item)]


def geometry(walk: Walk, topology: Topology, name: str) -> dict[str, Any]:
    """A mesh of the document with nothing but positions; `finish` adds the rest."""
    return {"name": name, "positions": walk.document.array(topology.positions, 3)}


def finish(
    walk: Walk,
    prim: Usd.Prim,
    topology: Topology,
    item: dict[str, Any],
    names: list[str | None],
    parents: np.ndarray | None = None,
) -> None:
    """Adds material, and what the materials read, texture coordinates and colours; then the faces.

    `parents` names the point or curve that each position was made for: primvars belong to those.
    """
    sizes = topology.sizes
    if parents is not None:
        each = int(parents.max()) + 1
        sizes = primvars.Sizes(each, each, each)

    def fit(found: primvars.Values) -> dict[str, Any]:
        return (found.reordered(topology.order) if parents is None else found.spread(parents)).form(walk)

    if names[0] is None:
        item["material"] = walk.materials.display(prim, walk.time)
        shown: str | None = "displayColor"
    else:
        item["material"] = walk.materials.index(names[0])
        shown = None
    for name in filter(None, names):
        shown = shown or walk.materials.color_primvar(name)
    needed = [walk.materials.coordinates(name) for name in filter(None, names)]
    sets = walk.materials.uv_names[: max((max(indices, default=-1) for indices in needed), default=-1) + 1]
    wanted = set().union(*needed)
    uvs = []
    found: primvars.Values | None
    for index, name in enumerate(sets):
        found = primvars.texture_coordinates(walk, prim, name, sizes) if index in wanted else None
        if found is None and index in wanted:
            walk.report.approximate(
                prim.GetPath(), f"there are no texture coordinates {name!r}, which the material reads"
            )
        found = found or primvars.Values(np.zeros((1, 2), np.float32), None, "mesh")
        uvs.append(fit(found))
    if uvs:
        item["uvs"] = uvs
    found = primvars.colors(walk, prim, shown, sizes) if shown else None
    if found:
        item["colors"] = fit(found)
    add_faces(walk, topology, item)


def add_faces(walk: Walk, topology: Topology, item: dict[str, Any]) -> None:
    """Faces as triangles where they are and all attributes belong to positions, else as polygons."""
    corners = walk.document.indices(topology.corners)
    attributes = [item[key] for key in ("normals", "colors") if key in item] + item.get("uvs", [])
    is_plain = not item.keys() & {"parts", "holes", "subdivision"} and all(
        form["per"] == "position" and "indices" not in form for form in attributes
    )
    if not (is_plain and topology.is_triangles):
        item |= {"faces": walk.document.indices(topology.faces), "corners": corners}
        return
    item["triangles"] = corners | {"count": corners["count"] // 3}
    item |= {key: item[key]["values"] for key in ("normals", "colors") if key in item}
    if "uvs" in item:
        item["uvs"] = [form["values"] for form in item["uvs"]]


def read_topology(walk: Walk, schema: UsdGeom.Mesh) -> Topology | None:
    """Positions and faces, checked."""

    def dropped(why: str) -> None:
        walk.report.warn(schema.GetPath(), f"the mesh is dropped: {why}")

    positions = np.asarray(schema.GetPointsAttr().Get(walk.time) or [], dtype=np.float32).reshape(-1, 3)
    faces = np.asarray(schema.GetFaceVertexCountsAttr().Get(walk.time) or [], dtype=np.int32)
    corners = np.asarray(schema.GetFaceVertexIndicesAttr().Get(walk.time) or [], dtype=np.int32)
    if not len(positions) or not len(faces):
        dropped("it has no faces")
        return None
    if not are_finite(positions):
        dropped("a position is not finite")
        return None
    wanted = faces.sum(dtype=np.int64)
    if faces.min() < 0 or wanted != len(corners):
        dropped(f"its faces have {wanted} corners, there are {len(corners)}")
        return None
    if len(corners) and (corners.min() < 0 or corners.max() >= len(positions)):
        dropped(f"a corner is beyond its {len(positions)} points")
        return None
    order = None
    if schema.GetOrientationAttr().Get(walk.time) == UsdGeom.Tokens.leftHanded:
        order = reversed_corners(faces)
        corners = corners[order]
    return Topology(positions, faces, corners, order)


def area(walk: Walk, prim: Usd.Prim, to_stage: np.ndarray) -> float:
    """Area of the faces of a mesh, not subdivided, in units of the stage; `to_stage` holds the images of X, Y, Z."""
    topology = read_topology(walk, UsdGeom.Mesh(prim)) if prim.IsA(UsdGeom.Mesh) else None
    if topology is None:
        return 0.0
    corners = topology.positions[topology.corners] @ to_stage
    ends = np.cumsum(topology.faces)
    starts = np.repeat(ends - topology.faces, topology.faces)
    after = np.arange(len(corners)) + 1
    after[ends[topology.faces > 0] - 1] = (ends - topology.faces)[topology.faces > 0]
    crosses = np.cross(corners - corners[starts], corners[after] - corners[starts])
    face = np.repeat(np.arange(len(topology.faces)), topology.faces)
    sums = np.stack([np.bincount(face, crosses[:, axis], len(topology.faces)) for axis in range(3)], axis=1)
    return float(np.linalg.norm(sums, axis=1).sum() / 2)


def reversed_corners(faces: np.ndarray) -> np.ndarray:
    """Indices of all corners, with those of each face in reverse order."""
    ends = np.cumsum(faces)
    starts = np.repeat(ends - faces, faces)
    return starts + np.repeat(ends, faces) - 1 - np.arange(faces.sum())


def subsets(walk: Walk, prim: Usd.Prim, topology: Topology, bound: str | None) -> list[tuple[str, dict[str, int]]]:
    """Faces with a material of their own."""
    parts = []
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        if subset.GetElementTypeAttr().Get() != UsdGeom.Tokens.face:
            walk.report.warn(subset.GetPath(), "a subset of something else than faces is dropped")
            continue
        name = walk.materials.bound(subset.GetPrim())
        faces = np.array(subset.GetIndicesAttr().Get(walk.time) or [], dtype=np.int64)
        fits = (faces >= 0) & (faces < len(topology.faces))
        if not fits.all():
            walk.report.warn(subset.GetPath(), f"indices beyond the {len(topology.faces)} faces are dropped")
        if name and name != bound and fits.any():
            parts.append((name, walk.document.indices(faces[fits])))
    return parts


def add_normals(walk: Walk, schema: UsdGeom.Mesh, topology: Topology, item: dict[str, Any]) -> None:
    """Authored normals; primvars go before the attribute."""
    prim = schema.GetPrim()
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals")
    if primvar and primvar.HasValue():
        found = primvars.read(walk, prim, primvar, 3, topology.sizes)
    else:
        given, interpolation = schema.GetNormalsAttr().Get(walk.time), schema.GetNormalsInterpolation()
        given = given if given is not None and len(given) else None
        found = primvars.fitted(walk, prim, "normals", given, None, interpolation, 3, topology.sizes)
    if found is None:
        return
    least, most = squared_lengths(found.values)
    if least <= 0:
        walk.report.warn(prim.GetPath(), "normals are dropped: some have no length")
        return
    if least < 1 - UNIT or most > 1 + UNIT:
        found.values = normalized(found.values)
    item["normals"] = found.reordered(topology.order).form(walk)


def subdivision(walk: Walk, schema: UsdGeom.Mesh, topology: Topology) -> dict[str, Any]:
    """Rules of refinement."""
    levels = 1
    while len(topology.faces) * 4 ** (levels + 1) <= FINE and levels < MOST_LEVELS:
        levels += 1
    boundary = schema.GetInterpolateBoundaryAttr().Get(walk.time)
    linear = schema.GetFaceVaryingLinearInterpolationAttr().Get(walk.time)
    form: dict[str, Any] = {
        "levels": levels,
        "boundary": BOUNDARY.get(boundary, "corners"),
        "linear": LINEAR.get(linear, "corners"),
    }
    pairs, sharpness = creases(walk, schema, len(topology.positions))
    if len(pairs):
        form["creases"] = walk.document.indices(pairs, 2)
        form["crease_sharpness"] = walk.document.array(sharpness)
    sharp = np.array(schema.GetCornerIndicesAttr().Get(walk.time) or [], dtype=np.int64)
    sharpness = np.array(schema.GetCornerSharpnessesAttr().Get(walk.time) or [], dtype=np.float32)
    if len(sharp) != len(sharpness) or np.any((sharp < 0) | (sharp >= len(topology.positions))):
        walk.report.warn(schema.GetPath(), "sharp corners are dropped: indices and sharpnesses do not fit")
    elif len(sharp):
        form["sharp_positions"] = walk.document.indices(sharp)
        form["position_sharpness"] = walk.document.array(sharpness)
    return form


def creases(walk: Walk, schema: UsdGeom.Mesh, positions: int) -> tuple[np.ndarray, np.ndarray]:
    """Creased edges and the sharpness of each. USD writes chains, with one sharpness each or one an edge."""
    chain = np.array(schema.GetCreaseIndicesAttr().Get(walk.time) or [], dtype=np.int64)
    lengths = np.array(schema.GetCreaseLengthsAttr().Get(walk.time) or [], dtype=np.int64)
    sharpness = np.array(schema.GetCreaseSharpnessesAttr().Get(walk.time) or [], dtype=np.float32)
    edges = lengths - 1
    none = np.zeros((0, 2), np.int64), np.zeros(0, np.float32)
    if not len(lengths):
        return none
    within = not np.any((chain < 0) | (chain >= positions))
    if (
        lengths.min() < 2
        or lengths.sum() != len(chain)
        or not within
        or len(sharpness) not in (len(edges), edges.sum())
    ):
        walk.report.warn(schema.GetPath(), "creases are dropped: indices, lengths and sharpnesses do not fit")
        return none
    ends = np.zeros(len(chain), bool)
    ends[np.cumsum(lengths) - 1] = True
    first = np.nonzero(~ends)[0]
    each = sharpness if len(sharpness) == edges.sum() else np.repeat(sharpness, edges)
    return np.stack([chain[first], chain[first + 1]], axis=1), each
