"""Curves as tubes: UsdGeomBasisCurves, linear and cubic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from pxr import Usd, UsdGeom

from . import mesh, tubes

if TYPE_CHECKING:
    from .walk import Walk

# Rows are powers 1, t, t², t³; columns are control points.
BASES = {
    "bezier": np.array([[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]], dtype=float),
    "bspline": np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]], dtype=float) / 6,
    "catmullRom": np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]], dtype=float) / 2,
}
# Many curves are hair: coarse tubes do.
MANY = 1000


@dataclass
class Kind:
    """How control points are read, and how fine tubes are."""

    basis: str | None
    wrap: str
    sides: int
    steps: int

    @property
    def is_closed(self) -> bool:
        """Whether curves return to where they begin."""
        return self.wrap == "periodic"


def curves(walk: Walk, prim: Usd.Prim, bound: str | None) -> list[int]:
    """The mesh of all curves of a prim."""
    schema = UsdGeom.BasisCurves(prim)
    if not schema:
        walk.report.warn(prim.GetPath(), f"{prim.GetTypeName()} geometry is dropped")
        return []
    counts = np.array(schema.GetCurveVertexCountsAttr().Get(walk.time) or [], dtype=np.int64)
    controls = np.array(schema.GetPointsAttr().Get(walk.time) or [], dtype=np.float64).reshape(-1, 3)
    if not len(counts) or counts.min() < 2 or counts.sum() != len(controls) or not np.all(np.isfinite(controls)):
        walk.report.warn(prim.GetPath(), "the curves are dropped: points and curveVertexCounts do not fit")
        return []
    if schema.GetNormalsAttr().HasValue():
        walk.report.approximate(prim.GetPath(), "ribbons are approximated by tubes: normals of curves are ignored")
    is_hair = len(counts) > MANY
    basis = schema.GetBasisAttr().Get(walk.time) if schema.GetTypeAttr().Get(walk.time) == "cubic" else None
    kind = Kind(basis, schema.GetWrapAttr().Get(walk.time), 4 if is_hair else 12, 4 if is_hair else 8)
    widths = read_widths(walk, schema, counts, kind)
    starts = np.cumsum(counts) - counts
    made, curve_of = [], []
    for count in np.unique(counts):
        which = np.nonzero(counts == count)[0]
        if segments(int(count), kind) < 1:
            walk.report.warn(prim.GetPath(), f"cubic curves with {count} points are dropped")
            continue
        points = sampled(controls[starts[which][:, None] + np.arange(count)], kind)
        made.append(tubes.tubes(points, widths.radii(which, int(count), kind), kind.is_closed, kind.sides))
        curve_of.append(np.repeat(which, len(made[-1].positions) // len(which)))
    if not made:
        return []
    together = tubes.joined(made)
    topology = mesh.Topology(together.positions, np.full(len(together.faces), 4), together.faces.reshape(-1), None)
    item = mesh.geometry(walk, topology, prim.GetName())
    item["normals"] = {"values": walk.document.array(together.normals, 3), "per": "position"}
    mesh.finish(walk, prim, topology, item, [bound], np.concatenate(curve_of))
    return [walk.document.add("meshes", item)]


def segments(count: int, kind: Kind) -> int:
    """Pieces of a curve with so many control points."""
    if kind.basis is None:
        return count if kind.is_closed else count - 1
    if kind.basis == "bezier":
        return count // 3 if kind.is_closed else (count - 1) // 3
    if kind.is_closed:
        return count
    return count - 1 if kind.wrap == "pinned" else count - 3


def sampled(points: np.ndarray, kind: Kind) -> np.ndarray:
    """Points on curves: (curves, samples, 3) from (curves, control points, 3)."""
    count = points.shape[1]
    if kind.basis is None:
        return points
    if kind.wrap == "pinned" and kind.basis != "bezier":
        before, after = 2 * points[:, :1] - points[:, 1:2], 2 * points[:, -1:] - points[:, -2:-1]
        points = np.concatenate([before, points, after], axis=1)
    step = 3 if kind.basis == "bezier" else 1
    pieces = segments(count, kind)
    windows = (np.arange(pieces)[:, None] * step + np.arange(4)) % points.shape[1]
    t = np.arange(kind.steps) / kind.steps
    weights = np.stack([t**0, t, t**2, t**3], axis=1) @ BASES[kind.basis]
    samples = np.einsum("sk,cpkx->cpsx", weights, points[:, windows]).reshape(len(points), -1, points.shape[2])
    if kind.is_closed:
        return samples
    last = np.ones(4) @ BASES[kind.basis]
    return np.concatenate([samples, np.einsum("k,ckx->cx", last, points[:, windows[-1]])[:, None]], axis=1)


@dataclass
class Widths:
    """Diameters, and where those of each curve begin."""

    per: str
    values: np.ndarray
    starts: np.ndarray

    def radii(self, which: np.ndarray, count: int, kind: Kind) -> np.ndarray:
        """Radii at the samples of the curves `which`, which have `count` control points each."""
        if self.per == "vertex":
            given = self.values[self.starts[which][:, None] + np.arange(count)]
            return sampled(given[..., None], kind)[..., 0] / 2
        pieces = segments(count, kind)
        if self.per == "varying":
            ends = self.values[self.starts[which][:, None] + np.arange(pieces + (not kind.is_closed))]
            at = np.arange(pieces * kind.steps + (not kind.is_closed)) / kind.steps
            low = np.minimum(at.astype(int), ends.shape[1] - 1)
            high = (low + 1) % ends.shape[1] if kind.is_closed else np.minimum(low + 1, ends.shape[1] - 1)
            return (ends[:, low] + (ends[:, high] - ends[:, low]) * (at - low)) / 2
        samples = count if kind.basis is None else pieces * kind.steps + (not kind.is_closed)
        each = self.values[which] if self.per == "uniform" else np.repeat(self.values, len(which))
        return np.repeat(each[:, None], samples, axis=1) / 2


def read_widths(walk: Walk, schema: UsdGeom.BasisCurves, counts: np.ndarray, kind: Kind) -> Widths:
    """The widths; USD's fallback is 1."""
    values = np.array(schema.GetWidthsAttr().Get(walk.time) or [], dtype=np.float64)
    per = schema.GetWidthsInterpolation()
    if per == "varying" and kind.basis is None:
        per = "vertex"
    ends = np.array([max(segments(int(count), kind), 0) + (not kind.is_closed) for count in counts])
    of_curve = {"vertex": counts, "varying": ends}.get(per, np.ones(len(counts), int))
    if len(values) == 1:
        return Widths("constant", values, counts)
    if per == "constant" or len(values) != of_curve.sum() or not np.all(np.isfinite(values)):
        walk.report.approximate(schema.GetPath(), "curves without widths that fit are drawn with width 1")
        return Widths("constant", np.ones(1), counts)
    return Widths(per, values, np.cumsum(of_curve) - of_curve)
