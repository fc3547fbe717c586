"""Gate 2: every pixel is a number, and light is not negative. Both images are checked.

Reconstruction filters of other renderers have negative lobes: of these, a trace beside the light is let through.
"""

from __future__ import annotations

import numpy as np

from ajar_tools.picture import Picture
from ajar_tools.settings import Settings
from ajar_tools.verdict import GateResult, Status

# Negative light, over all light, that filters may leave behind.
LOBES = 0.01


def check(new: Picture, reference: Picture, settings: Settings) -> GateResult:
    """Looks for NaN and infinity in all channels that are compared, and for negative colours."""
    problems = [text for picture in (new, reference) if (text := problem(picture, settings))]
    if problems:
        return GateResult("finite", Status.FAIL, "; ".join(problems))
    signs = "" if settings.other_renderer else ", no colour is negative"
    return GateResult("finite", Status.PASS, f"all pixels are finite{signs}")


def problem(picture: Picture, settings: Settings) -> str:
    """The first kind of pixel that is wrong, in words; empty if there is none."""
    colors = picture.color_channels
    names = colors if settings.other_renderer else picture.channels
    pixels = picture.color if settings.other_renderer else picture.pixels
    finite = np.isfinite(pixels)
    if not finite.all():
        return describe(picture, ~finite, names, "not finite")
    if float(picture.color.min()) < 0 and not (settings.other_renderer and is_trace(picture.color)):
        return describe(picture, picture.color < 0, colors, "negative")
    return ""


def is_trace(color: np.ndarray) -> bool:
    """Whether negative values are a small part of all."""
    negative = -np.minimum(color, 0).sum(dtype=np.float64)
    return bool(negative <= LOBES * np.abs(color).sum(dtype=np.float64))


def describe(picture: Picture, bad: np.ndarray, names: list[str], what: str) -> str:
    """How many pixels, and where the first one is."""
    row, column, channel = np.unravel_index(int(bad.argmax()), bad.shape)
    window = picture.data_window
    place = f"first {names[channel]} at pixel ({window.x + column}, {window.y + row})"
    return f"{int(bad.any(axis=2).sum())} pixels of {picture.path} are {what}, {place}"
