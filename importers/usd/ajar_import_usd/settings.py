"""UsdRender: what the stage says about its picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pxr import Usd, UsdRender

if TYPE_CHECKING:
    from .walk import Walk

LARGEST = 65535


def settings(walk: Walk) -> None:
    """Camera and size of the settings that the stage names, or its only ones; the first product goes before them."""
    chosen = UsdRender.Settings.GetStageRenderSettings(walk.stage)
    if not chosen:
        every = [prim for prim in walk.stage.Traverse() if prim.IsA(UsdRender.Settings)]
        if len(every) != 1:
            if every:
                walk.report.note(None, f"{len(every)} RenderSettings, none of them named by the stage; ignored")
            return
        chosen = UsdRender.Settings(every[0])
    products = [walk.stage.GetPrimAtPath(path) for path in chosen.GetProductsRel().GetForwardedTargets()]
    products = [prim for prim in products if prim]
    if len(products) > 1:
        walk.report.note(chosen.GetPath(), f"the first of {len(products)} render products is used")
    for prim in [chosen.GetPrim(), *products[:1]]:
        take(walk, prim)


def take(walk: Walk, prim: Usd.Prim) -> None:
    """What settings or a product say themselves."""
    base = UsdRender.SettingsBase(prim)
    size = base.GetResolutionAttr()
    if size and size.HasAuthoredValue():
        width, height = size.Get(walk.time)
        if 0 < width <= LARGEST and 0 < height <= LARGEST:
            walk.document.render["size"] = [int(width), int(height)]
        else:
            walk.report.warn(prim.GetPath(), f"a resolution of {width} × {height} is ignored")
    for attribute, whole in ((base.GetDataWindowNDCAttr(), (0, 0, 1, 1)), (base.GetPixelAspectRatioAttr(), 1)):
        value = attribute.Get(walk.time)
        if value is not None and value != whole:
            walk.report.warn(prim.GetPath(), f"{attribute.GetName()} is ignored")
    for path in base.GetCameraRel().GetForwardedTargets()[:1]:
        name = walk.cameras.get(path)
        if name is None:
            walk.report.warn(prim.GetPath(), f"the camera {path} is not there")
        else:
            walk.document.render["camera"] = name
