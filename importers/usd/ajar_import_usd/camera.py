"""UsdGeomCamera."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from pxr import Usd, UsdGeom

if TYPE_CHECKING:
    from .walk import Walk

# Apertures and focal lengths are in tenths of the scene's unit.
TENTH = 0.1


def camera(walk: Walk, prim: Usd.Prim) -> int | None:
    """The index of the camera, or None with a warning."""
    schema = UsdGeom.Camera(prim)

    def get(name: str) -> float:
        return float(prim.GetAttribute(name).Get(walk.time) or 0.0)

    width, height, focal = get("horizontalAperture"), get("verticalAperture"), get("focalLength")
    is_perspective = schema.GetProjectionAttr().Get(walk.time) != UsdGeom.Tokens.orthographic
    values = (width, height, focal)
    if not all(math.isfinite(value) and value > 0 for value in (values if is_perspective else values[:2])):
        walk.report.warn(prim.GetPath(), "the camera is dropped: its aperture or focal length is not positive")
        return None
    shift = [2 * get("horizontalApertureOffset") / height, 2 * get("verticalApertureOffset") / height]
    if is_perspective:
        projection: dict[str, Any] = {"perspective": perspective(walk, prim, get, shift)}
    else:
        projection = {"orthographic": {"half_height": height * TENTH * walk.unit / 2}}
        if any(shift):
            walk.report.warn(prim.GetPath(), "aperture offsets of an orthographic camera are ignored")
    exposure = schema.ComputeLinearExposureScale(walk.time)
    item = {"name": walk.camera_name(prim), "projection": projection, "aspect": width / height, "exposure": exposure}
    if schema.GetClippingPlanesAttr().Get(walk.time):
        walk.report.warn(prim.GetPath(), "clipping planes are ignored")
    if get("shutter:close") > get("shutter:open"):
        walk.report.warn(prim.GetPath(), "the shutter is ignored: there is no motion blur")
    return walk.document.add("cameras", item)


def perspective(walk: Walk, prim: Usd.Prim, get: Any, shift: list[float]) -> dict[str, Any]:
    """Angle, lens and focus."""
    focal = get("focalLength") * TENTH
    stop, focus = get("fStop"), get("focusDistance")
    lens = focal / (2 * stop) * walk.unit if stop > 0 and focus > 0 else 0.0
    if stop > 0 and focus <= 0:
        walk.report.warn(prim.GetPath(), "fStop without focusDistance is ignored: everything is sharp")
    return {
        "yfov": 2 * math.atan(get("verticalAperture") * TENTH / (2 * focal)),
        "lens_radius": lens,
        "focus_distance": focus * walk.unit if focus > 0 else 1.0,
        "shift": shift,
    }
