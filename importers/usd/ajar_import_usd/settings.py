"""UsdRender: what the stage says about its picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pxr import Gf, Usd, UsdRender, Vt

if TYPE_CHECKING:
    from .walk import Walk

LARGEST = 65535

KEPT = {
    "aspectRatioConformPolicy": "expandAperture",
    "dataWindowNDC": Gf.Vec4f(0, 0, 1, 1),
    "materialBindingPurposes": Vt.TokenArray(["full", ""]),
    "pixelAspectRatio": 1.0,
    "productType": "raster",
    "renderingColorSpace": "lin_rec709_scene",
}
"""What is done whatever the settings say."""

USUAL_PURPOSES = ("default", "render")
"""What is drawn where no settings say it."""


def chosen(walk: Walk) -> list[Usd.Prim]:
    """The settings that the stage names, or its only ones, and their first product, which goes before them."""
    chosen = UsdRender.Settings.GetStageRenderSettings(walk.stage)
    if not chosen:
        every = [prim for prim in walk.stage.Traverse() if prim.IsA(UsdRender.Settings)]
        if len(every) != 1:
            if every:
                walk.report.note(None, f"{len(every)} RenderSettings, none of them named by the stage; ignored")
            return []
        chosen = UsdRender.Settings(every[0])
    products = [walk.stage.GetPrimAtPath(path) for path in chosen.GetProductsRel().GetForwardedTargets()]
    products = [prim for prim in products if prim]
    if len(products) > 1:
        walk.report.note(chosen.GetPath(), f"the first of {len(products)} render products is used")
    return [chosen.GetPrim(), *products[:1]]


def purposes(walk: Walk, prims: list[Usd.Prim]) -> tuple[str, ...]:
    """Purposes of geometry that the settings among `prims` want to be drawn."""
    for prim in prims:
        attribute = prim.GetAttribute("includedPurposes")
        included = attribute.Get(walk.time) if attribute and attribute.HasAuthoredValue() else None
        if isinstance(included, Vt.TokenArray):
            if set(included) != set(USUAL_PURPOSES):
                walk.report.note(prim.GetPath(), f"only what has one of these purposes is drawn: {said(included)}")
            return tuple(included)
        if included is not None:
            walk.report.warn(prim.GetPath(), "includedPurposes is ignored: it is no list of tokens")
    return USUAL_PURPOSES


def take(walk: Walk, prim: Usd.Prim) -> None:
    """Camera, size and lens that settings or a product say themselves."""
    base = UsdRender.SettingsBase(prim)
    attribute = base.GetResolutionAttr()
    size = attribute.Get(walk.time) if attribute and attribute.HasAuthoredValue() else None
    if size is not None and not isinstance(size, Gf.Vec2i):
        walk.report.warn(prim.GetPath(), f"resolution is ignored: {size} is no pair of integers")
    elif size is not None:
        width, height = size
        if 0 < width <= LARGEST and 0 < height <= LARGEST:
            walk.document.render["size"] = [int(width), int(height)]
        else:
            walk.report.warn(prim.GetPath(), f"a resolution of {width} × {height} is ignored")
    name_what_is_ignored(walk, prim)
    if prim.GetAttribute("disableDepthOfField").Get(walk.time):
        for camera in walk.document.lists.get("cameras", []):
            camera["projection"].get("perspective", {})["lens_radius"] = 0.0
    for path in base.GetCameraRel().GetForwardedTargets()[:1]:
        name = walk.cameras.get(path)
        if name is None:
            walk.report.warn(prim.GetPath(), f"the camera {path} is not there")
        else:
            walk.document.render["camera"] = name


def name_what_is_ignored(walk: Walk, prim: Usd.Prim) -> None:
    """Names what settings or a product say that Ajar does otherwise."""
    for name, kept in KEPT.items():
        attribute = prim.GetAttribute(name)
        if attribute and attribute.HasAuthoredValue():
            value = attribute.Get(walk.time)
            if isinstance(value, Vt.TokenArray):
                # Houdini writes the name of the token for what the schema calls "".
                value = Vt.TokenArray(["" if token == "allPurpose" else token for token in value])
            if value not in (kept, None, ""):
                walk.report.warn(prim.GetPath(), f"{name} is ignored: it is {said(value)}, and taken as {said(kept)}")
    if prim.GetAttribute("productName").Get(walk.time):
        walk.report.warn(prim.GetPath(), "productName is ignored: the command line says where the image is written")
    if prim.GetRelationship("orderedVars").GetForwardedTargets():
        walk.report.warn(prim.GetPath(), "orderedVars is ignored: the command line says which layers images have")


def said(value: object) -> str:
    """A value in words."""
    if isinstance(value, Vt.TokenArray):
        return ", ".join(token or "all" for token in value) or "none"
    return str(value)
