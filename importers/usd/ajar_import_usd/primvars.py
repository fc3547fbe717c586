"""Primvars as attributes of polygon meshes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Usd, UsdGeom

from .blocks import are_finite

if TYPE_CHECKING:
    from .walk import Walk

PER = {"constant": "mesh", "uniform": "face", "vertex": "position", "varying": "position", "faceVarying": "corner"}


@dataclass
class Sizes:
    """How many entries an attribute has, by what it belongs to."""

    position: int
    face: int
    corner: int
    mesh: int = 1


@dataclass
class Values:
    """The values of an attribute, an index for each entry if there are indices, and what entries belong to.

    The values are often the stage's own, which cannot be written to.
    """

    values: np.ndarray
    indices: np.ndarray | None
    per: str

    def reordered(self, corners: np.ndarray | None) -> Values:
        """With corners in another order."""
        if corners is None or self.per != "corner":
            return self
        if self.indices is not None:
            return replace(self, indices=self.indices[corners])
        return replace(self, values=self.values[corners])

    def spread(self, parents: np.ndarray) -> Values:
        """From points or curves to the positions that were made for each."""
        if self.per == "mesh":
            return self
        return replace(self, indices=parents if self.indices is None else self.indices[parents], per="position")

    def form(self, walk: Walk) -> dict[str, Any]:
        """As the document wants it."""
        form: dict[str, Any] = {"values": self.written(walk), "per": self.per}
        if self.indices is not None:
            form["indices"] = walk.document.indices(self.indices)
        return form

    def written(self, walk: Walk) -> dict[str, int]:
        """Where the document has the values."""
        return walk.document.array(self.values, self.values.shape[1])


class Coordinates(Values):
    """Texture coordinates with the origin at the bottom left, as USD has them."""

    def written(self, walk: Walk) -> dict[str, int]:
        return walk.document.coordinates(self.values)


def read(walk: Walk, prim: Usd.Prim, primvar: UsdGeom.Primvar, width: int, sizes: Sizes) -> Values | None:
    """A primvar of `width` numbers, or None with a warning where it does not fit."""
    return fitted(
        walk,
        prim,
        primvar.GetPrimvarName(),
        primvar.Get(walk.time),
        primvar.GetIndices(walk.time) if primvar.IsIndexed() else None,
        primvar.GetInterpolation(),
        width,
        sizes,
    )


def fitted(
    walk: Walk, prim: Usd.Prim, name: str, given: Any, indices: Any, interpolation: str, width: int, sizes: Sizes
) -> Values | None:
    """Values and indices that were checked against the mesh."""

    def dropped(why: str) -> None:
        walk.report.warn(prim.GetPath(), f"primvar {name!r} is dropped: {why}")

    if given is None:
        return None
    try:
        values = np.asarray(given, dtype=np.float32).reshape(-1, width)
    except (TypeError, ValueError):
        dropped(f"its values are not {width} numbers each")
        return None
    if not are_finite(values):
        dropped("some of its values are not finite")
        return None
    per = PER.get(interpolation)
    if per is None:
        dropped(f"interpolation {interpolation!r} is not known")
        return None
    order = None if indices is None else np.array(indices, dtype=np.int64)
    if order is not None and len(order) and (order.min() < 0 or order.max() >= len(values)):
        dropped(f"an index is beyond its {len(values)} values")
        return None
    entries, wanted = len(values) if order is None else len(order), getattr(sizes, per)
    if entries != wanted:
        dropped(f"it has {entries} entries, {wanted} are needed for interpolation {interpolation!r}")
        return None
    return Values(values, order, per)


def texture_coordinates(walk: Walk, prim: Usd.Prim, name: str, sizes: Sizes) -> Coordinates | None:
    """Texture coordinates by name."""
    primvar = find(prim, name)
    found = read(walk, prim, primvar, 2, sizes) if primvar else None
    return Coordinates(found.values, found.indices, found.per) if found else None


def find(prim: Usd.Prim, name: str) -> UsdGeom.Primvar | None:
    """A primvar of the prim or inherited; "st" may have another name where there is only one of its kind."""
    api = UsdGeom.PrimvarsAPI(prim)
    primvar = api.FindPrimvarWithInheritance(name)
    if primvar and primvar.HasValue():
        return primvar
    if name == "st":
        pairs = [p for p in api.FindPrimvarsWithInheritance() if str(p.GetTypeName().scalarType).endswith("2f")]
        coordinates = [p for p in pairs if "exCoord" in str(p.GetTypeName().role) or "texCoord" in str(p.GetTypeName())]
        found = coordinates or pairs
        if len(found) == 1:
            return found[0]
    return None


def colors(walk: Walk, prim: Usd.Prim, name: str, sizes: Sizes) -> Values | None:
    """A colour primvar with alpha 1; `displayOpacity` is not part of it."""
    primvar = find(prim, name)
    found = read(walk, prim, primvar, 3, sizes) if primvar else None
    if found:
        found.values = np.hstack([found.values, np.ones((len(found.values), 1), np.float32)])
    return found
