"""Reference, new image and difference side by side, as a picture small enough for a list."""

from __future__ import annotations

import numpy as np

from ajar_tools.gates.flip import shrunk
from ajar_tools.picture import Picture
from ajar_tools.report.encode import png

# Rows of pixels that a picture of a list has at most, nearly.
MOST_ROWS = 144
GAP = 4


def strip(new: Picture, reference: Picture | None, stops: float) -> bytes:
    """A PNG, as bright as the report is at first; the difference is that of planes.js. The new image alone without
    reference.
    """
    factor = max(1, new.data_window.height // MOST_ROWS)
    ours = shrunk(new.color, factor)
    if reference is None:
        return png(toned(ours, stops))
    theirs = shrunk(reference.color, factor)
    white = np.full((ours.shape[0], GAP, 3), 255.0)
    return png(np.hstack([toned(theirs, stops), white, toned(ours, stops), white, difference(ours, theirs)]))


def toned(color: np.ndarray, stops: float) -> np.ndarray:
    """sRGB, 0 to 255."""
    x = np.clip(color * 2.0**stops, 0, 1)
    return np.rint(255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055))


def difference(new: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Red where the new image is brighter, blue where it is darker; half as much again is a full colour."""
    a, b = new.sum(axis=2), reference.sum(axis=2)
    d = np.clip(2 * (a - b) / (b + 0.1 * b.mean() + 1e-30), -1, 1)
    fade = 255 * (1 - np.abs(d))
    return np.stack([np.where(d > 0, 255, fade), fade, np.where(d > 0, fade, 255)], axis=-1)
