"""Which images say enough of their noise, and whose noise should be alike."""

from __future__ import annotations

import math

from ajar_tools.picture import CannotCompareError, Picture
from ajar_tools.settings import Settings
from ajar_tools.statistics import BlockStatistics

# Relative difference up to which numbers of mutations count as equal.
SAME_PLAN = 0.01


def unusable(picture: Picture, statistics: BlockStatistics | None, settings: Settings) -> str:
    """Why an image's statistics cannot be used; empty if they can."""
    if statistics is None:
        return f"{picture.path} does not declare its noise (ajar:blockVariance8 and so on)"
    if statistics.rounds < settings.min_rounds:
        return f"{picture.path} is the mean of {statistics.rounds} rounds, {settings.min_rounds} are needed"
    return ""


def other_rounds(new: Picture, reference: Picture) -> str:
    """Why rounds of two renders have nothing in common; empty if they are of one kind."""
    for name, what in (("ajar:integrator", "integrators"), ("ajar:sceneHash", "scenes")):
        a, b = new.attributes.get(name), reference.attributes.get(name)
        if a != b:
            return f"the {what} differ ({str(a)[:8]}, {str(b)[:8]}), so their noise may"
    samples = [samples_per_round(picture) for picture in (new, reference)]
    if samples[0] != samples[1]:
        return f"rounds of {samples[0]:.4g} and {samples[1]:.4g} samples a pixel have different noise"
    return ""


def incomparable(new: Picture, reference: Picture) -> str:
    """Why the noise of two renders has no reason to be equal; empty if it has."""
    if reason := other_rounds(new, reference):
        return reason
    # `ajar` finds out by itself how many pay, by the seed.
    mutations = [number(picture, "ajar:mutationsPerSample") for picture in (new, reference)]
    if not math.isclose(*mutations, rel_tol=SAME_PLAN):
        return f"{mutations[0]:.3g} and {mutations[1]:.3g} mutations a sample have different noise"
    return ""


def samples_per_round(picture: Picture) -> float:
    """Mean samples a pixel in a round."""
    return number(picture, "samplesPerPixel") / number(picture, "ajar:rounds")


def number(picture: Picture, name: str) -> float:
    """An attribute that is a number; 0 if it is not there.

    Raises:
        CannotCompareError: it is something else.
    """
    value = picture.attributes.get(name, 0)
    if isinstance(value, (int, float)):
        return float(value)
    raise CannotCompareError(f"{picture.path}: {name} is no number")
