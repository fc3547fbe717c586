"""Gate 6: what a person would see, by ꟻLIP (Andersson et al. 2020; for high dynamic range, 2021).

The exposures follow from a fixed luminance, not from each reference, so that numbers can be compared between images;
only where an image is brighter there are more of them, for what is white at all exposures looks the same. Images of
more than 0.3 megapixels are averaged over squares first, and the viewing distance grows accordingly: the same picture
at the same size, without its finest detail. That is what makes the gate affordable.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ajar_tools.flip import exposures_for, hdr_flip
from ajar_tools.picture import Picture
from ajar_tools.settings import Settings
from ajar_tools.statistics import block_means
from ajar_tools.verdict import GateResult, Status

MOST_PIXELS = 300_000
# Pixels a degree: a 0.7 m wide display of 3840 pixels seen from 0.7 m, FLIP's default.
PIXELS_PER_DEGREE = 67.02064
# A grey that every picture has, the other end of the exposures.
MEDIAN_LUMINANCE = 0.18
# Light beyond this is white at all exposures.
MOST_LUMINANCE = 1e6
DEFAULT_MEAN = 0.05
DEFAULT_P95 = 0.2


@dataclass(frozen=True)
class FlipMap:
    """Errors from 0 to 1, averaged over `factor`² pixels each."""

    errors: np.ndarray
    factor: int

    @property
    def mean(self) -> float:
        """Mean error."""
        return float(self.errors.mean())

    @property
    def p95(self) -> float:
        """95th percentile."""
        return float(np.percentile(self.errors, 95))


def check(found: FlipMap, settings: Settings, alone: str = "") -> GateResult:
    """Judges by the case's limits; by defaults where it is `alone`, for gate 4 did not judge; else it reports.

    `alone` says why, in words.
    """
    numbers = {"mean": found.mean, "p95": found.p95, "averaged_over": found.factor}
    text = f"mean {found.mean:.4f}, 95th percentile {found.p95:.4f}"
    mean, p95 = settings.flip_mean, settings.flip_p95
    if alone:
        mean = DEFAULT_MEAN if mean is None else mean
        p95 = DEFAULT_P95 if p95 is None else p95
    if mean is None and p95 is None:
        return GateResult("flip", Status.REPORT, text, numbers)
    failed = [
        f"FLIP's {name} is {value:.4f}, more than {limit:g}"
        for name, value, limit in (("mean", found.mean, mean), ("95th percentile", found.p95, p95))
        if limit is not None and value > limit
    ]
    if not failed:
        return GateResult("flip", Status.PASS, text, numbers)
    note = f" (noise counts too: statistics did not judge, for {alone})" if alone else ""
    return GateResult("flip", Status.FAIL, "; ".join(failed) + note, numbers)


def flip_map(new: Picture, reference: Picture, settings: Settings) -> FlipMap:
    """The errors of every pixel, or square of pixels."""
    factor = factor_for(reference, MOST_PIXELS)
    theirs, ours = (shrunk(picture.color, factor) for picture in (reference, new))
    brightest = min(max(float(image.mean(axis=2).max()) for image in (theirs, ours)), MOST_LUMINANCE)
    exposures = exposures_for(max(settings.max_luminance, brightest), MEDIAN_LUMINANCE)
    return FlipMap(hdr_flip(theirs, ours, exposures, PIXELS_PER_DEGREE / factor), factor)


def factor_for(picture: Picture, most: int) -> int:
    """The least side of the squares over which to average an image, so that no more than `most` are left."""
    height, width = picture.pixels.shape[:2]
    factor = 1
    while -(-width // factor) * -(-height // factor) > most:
        factor += 1
    return factor


def shrunk(color: np.ndarray, factor: int) -> np.ndarray:
    """RGB averaged over squares, which may be smaller at the right and lower edge."""
    if color.shape[2] == 1:
        color = np.repeat(color, 3, axis=2)
    if factor > 1:
        color = block_means(color, factor)
    return np.ascontiguousarray(np.maximum(color, 0), np.float32)
