"""Opening a stage: which variants, which time, which units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom

from .document import Matrix
from .report import Report, StageError, commentary

DEFAULT_RATE = 24.0


@dataclass
class Opened:
    """A composed stage at one time."""

    stage: Usd.Stage
    time: Usd.TimeCode
    # Metres per unit of the stage.
    unit: float
    z_up: bool

    @property
    def upright(self) -> Matrix:
        """From the stage to metres and +Y up."""
        matrix = np.eye(4)
        if self.z_up:
            matrix = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], dtype=float)
        matrix[:3] *= self.unit
        return matrix


@dataclass(frozen=True)
class Moment:
    """When, as the user says it; nothing of it must be said."""

    frame: float | None = None
    seconds: float | None = None
    # Frames per second, over what the stage says.
    rate: float | None = None


def open_stage(file: Path, variants: list[str], moment: Moment, report: Report) -> Opened:
    """Composes the stage in `file`."""
    try:
        stage = Usd.Stage.Open(str(file))
    except Tf.ErrorException as error:
        raise StageError(f"is no USD that can be read: {commentary(error)}") from error
    stage.SetEditTarget(stage.GetSessionLayer())
    for variant in variants:
        select(stage, variant)
    time = time_code(stage, moment, report)
    opened = Opened(stage, time, unit(stage, report), z_up(stage, report))
    bake_skins(stage, time)
    return opened


def select(stage: Usd.Stage, variant: str) -> None:
    """Selects `/Prim:set=choice`."""
    path, _, rest = variant.partition(":")
    name, is_set, choice = rest.partition("=")
    if not is_set or not Sdf.Path.IsValidPathString(path) or not Sdf.Path(path).IsAbsolutePath():
        hint = f"variants are written /Prim:set=choice; {available(stage)}"
        raise StageError(f"the variant {variant!r} is none", hint=hint, cause="usage")
    prim = stage.GetPrimAtPath(path)
    if not prim:
        raise StageError(f"the variant {variant!r} is of no prim", hint=available(stage), cause="usage")
    chosen = prim.GetVariantSets().GetVariantSet(name)
    if choice not in chosen.GetVariantNames():
        raise StageError(f"there is no variant {variant!r}", place=path, hint=available(stage), cause="usage")
    chosen.SetVariantSelection(choice)


def variant_sets(stage: Usd.Stage) -> list[dict[str, Any]]:
    """The variants of a stage, as `select` takes them, and which are selected."""
    found = []
    for prim in stage.Traverse():
        sets = prim.GetVariantSets()
        for name in sets.GetNames():
            chosen, of = sets.GetVariantSet(name), f"{prim.GetPath()}:{name}"
            selection = chosen.GetVariantSelection()
            names = [f"{of}={choice}" for choice in chosen.GetVariantNames()]
            found.append({"name": of, "choices": names, "chosen": f"{of}={selection}" if selection else None})
    return found


def available(stage: Usd.Stage) -> str:
    """The variants of a stage in words, some of them."""
    found = []
    for of in variant_sets(stage):
        choices = ", ".join(choice.partition("=")[2] for choice in of["choices"])
        found.append(f"{of['name']}={{{choices}}}")
    more = f" and {len(found) - 10} more" if len(found) > 10 else ""
    return f"there are {'; '.join(found[:10])}{more}" if found else "the stage has no variants"


def time_code(stage: Usd.Stage, moment: Moment, report: Report) -> Usd.TimeCode:
    """The time that is asked for, else the start, else the first samples."""
    rate = stage.GetTimeCodesPerSecond()
    if not (math.isfinite(rate) and rate > 0):
        report.approximate(None, f"timeCodesPerSecond is {rate:g}, taken as {DEFAULT_RATE:g}")
        rate = DEFAULT_RATE
    start, end = stage.GetStartTimeCode(), stage.GetEndTimeCode()
    if stage.HasAuthoredTimeCodeRange() and end < start:
        report.approximate(None, f"endTimeCode {end:g} is before startTimeCode {start:g}")
    if moment.seconds is not None:
        return Usd.TimeCode(moment.seconds * rate)
    if moment.frame is not None:
        # Where nothing is said about frames, each is one time code.
        played = moment.rate or (stage.GetFramesPerSecond() if stage.HasAuthoredMetadata("framesPerSecond") else rate)
        return Usd.TimeCode(moment.frame * rate / played if played > 0 else moment.frame)
    if stage.HasAuthoredTimeCodeRange() and math.isfinite(start):
        return Usd.TimeCode(start)
    return Usd.TimeCode.EarliestTime()


def unit(stage: Usd.Stage, report: Report) -> float:
    """Metres per unit; USD itself says centimetres where nothing is said."""
    metres = UsdGeom.GetStageMetersPerUnit(stage)
    if not UsdGeom.StageHasAuthoredMetersPerUnit(stage):
        report.note(None, "metersPerUnit is not said: a unit is taken as 0.01 m")
    if not (math.isfinite(metres) and metres > 0):
        report.approximate(None, f"metersPerUnit is {metres:g}, taken as 0.01")
        metres = 0.01
    for layer in stage.GetUsedLayers():
        other = layer.pseudoRoot.GetInfo(UsdGeom.Tokens.metersPerUnit)
        if layer.pseudoRoot.HasInfo(UsdGeom.Tokens.metersPerUnit) and not math.isclose(other, metres, rel_tol=1e-6):
            name = Path(layer.realPath or layer.identifier).name
            message = f"made in units of {other:g} m, the scene in {metres:g} m; USD does not rescale"
            report.approximate(name, message)
    return metres


def z_up(stage: Usd.Stage, report: Report) -> bool:
    """Whether +Z is up. Nothing but Y and Z is allowed."""
    root = stage.GetRootLayer().pseudoRoot
    said = root.GetInfo(UsdGeom.Tokens.upAxis) if root.HasInfo(UsdGeom.Tokens.upAxis) else "Y"
    if said not in ("Y", "Z"):
        report.approximate(None, f"upAxis is {said!r}, taken as Y")
    return bool(said == "Z")


def bake_skins(stage: Usd.Stage, time: Usd.TimeCode) -> None:
    """Writes the points of skinned meshes at `time` into the session layer."""
    everything = Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies())
    roots = [prim.GetPath() for prim in everything if prim.IsA("SkelRoot")]
    if not roots:
        return
    # Loaded where it is needed: it takes as long as a million corners.
    from pxr import UsdSkel

    for root in roots:
        # Points of instances cannot be written: what holds a skeleton is an instance no more.
        for path in root.GetPrefixes():
            prim = stage.GetPrimAtPath(path)
            if prim.IsInstance():
                prim.SetInstanceable(False)
    for prim in stage.Traverse():
        # Many files do not say that the schema is applied.
        if prim.IsA(UsdGeom.PointBased) and UsdSkel.BindingAPI(prim).GetJointIndicesPrimvar().HasValue():
            move_normals(prim, time)
    value = time.GetValue() if time.IsNumeric() else 0.0
    UsdSkel.BakeSkinning(Usd.PrimRange(stage.GetPseudoRoot()), Gf.Interval(value, value))


def move_normals(prim: Usd.Prim, time: Usd.TimeCode) -> None:
    """Makes the primvar `normals` the attribute, for skinning bends that and leaves the primvar, which would count."""
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals")
    if primvar and primvar.HasValue():
        shape = UsdGeom.PointBased(prim)
        shape.CreateNormalsAttr(primvar.ComputeFlattened(time))
        shape.SetNormalsInterpolation(primvar.GetInterpolation())
        primvar.GetAttr().Block()
