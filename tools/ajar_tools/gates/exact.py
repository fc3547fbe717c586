"""Gate 3: equal pixels end the comparison. The same program with the same settings gives the same bytes."""

from __future__ import annotations

import numpy as np

from ajar_tools.picture import Picture
from ajar_tools.settings import Settings
from ajar_tools.statistics import over_channels
from ajar_tools.verdict import GateResult, Status


def check(new: Picture, reference: Picture, settings: Settings) -> GateResult:
    """Passes if no value differs; otherwise it only says so, and later gates judge."""
    if settings.other_renderer:
        a, b = new.color, reference.color
    else:
        common = [name for name in new.channels if name in reference.channels]
        a = select(new, common)
        b = select(reference, common)
    whole = [] if settings.other_renderer else [name for name in new.integers if name in reference.integers]
    others = [new.integers[name] != reference.integers[name] for name in whole]
    if a.shape == b.shape and np.array_equal(a, b) and not any(map(np.any, others)):
        return GateResult("exact", Status.PASS, "all pixels are equal")
    differs = over_channels(np.logical_or, a != b)
    differing = int(np.logical_or.reduce([differs, *others]).sum())
    count = a.shape[0] * a.shape[1]
    message = f"{differing} of {count} pixels are not equal to the last bit"
    return GateResult("exact", Status.REPORT, message, {"differing_pixels": differing, "pixels": count})


def select(picture: Picture, names: list[str]) -> np.ndarray:
    """The planes of `names`, without copying where that is all of them."""
    if names == picture.channels:
        return picture.pixels
    return picture.pixels[..., [picture.channels.index(name) for name in names]]
