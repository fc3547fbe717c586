"""Gate 5: the noise is what it was. More of it is a lost speed-up, less of it a random generator that repeats itself.

Noise of a round is compared, so renders of different length can be compared as long as their rounds hold equally many
samples. Of each level the median block's ratio is judged, for single variances from few rounds are wild; the ratio must
leave the tolerated range by more than its own error. The whole image has but one ratio, judged by the F distribution.
"""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np

from ajar_tools.gates.statistical import unusable
from ajar_tools.picture import Picture
from ajar_tools.settings import Settings
from ajar_tools.statistics import SIDES, WHOLE, BlockStatistics
from ajar_tools.student import upper_f
from ajar_tools.verdict import GateResult, Status

# Of alpha, for each of the four levels.
SHARE = 0.025
# Fewest blocks whose median is judged.
MIN_BLOCKS = 12


def check(new: Picture, reference: Picture, settings: Settings) -> GateResult:
    """Compares the variances of rounds on all levels that have enough blocks."""
    ours, theirs = new.statistics, reference.statistics
    reason = unusable(new, ours, settings) or unusable(reference, theirs, settings) or incomparable(new, reference)
    if reason:
        return GateResult("variance", Status.SKIP, reason)
    assert ours is not None
    assert theirs is not None
    ratios: dict[str, float] = {}
    problems = []
    for side in (*SIDES, WHOLE):
        judged = median_ratio(ours, theirs, side) if side != WHOLE else whole_ratio(ours, theirs)
        if judged is None:
            continue
        ratio, error = judged
        name = f"{side}×{side} blocks" if side else "the whole image"
        ratios[name] = ratio
        if abs(math.log(max(ratio, 1e-300))) > math.log(settings.variance_ratio) + critical(error, settings):
            problems.append(f"the variance of {name} is {ratio:.3g} times the reference's")
    if problems:
        return GateResult("variance", Status.FAIL, "; ".join(problems), {"ratios": ratios})
    text = ", ".join(f"{name} {ratio:.2f}" for name, ratio in ratios.items()) or "the images have no noise"
    return GateResult("variance", Status.PASS, f"ratio to the reference's variance: {text}", {"ratios": ratios})


def critical(error: float, settings: Settings) -> float:
    """How far from the tolerated range chance may lead an estimate of this standard error."""
    return NormalDist().inv_cdf(1 - settings.alpha * SHARE / 2) * error


def incomparable(new: Picture, reference: Picture) -> str:
    """Why the noise of two renders has no reason to be alike; empty if it has."""
    for name, what in (("ajar:integrator", "integrators"), ("ajar:sceneHash", "scenes")):
        a, b = new.attributes.get(name), reference.attributes.get(name)
        if a != b:
            return f"the {what} differ ({a}, {b}), so their noise may"
    samples = [samples_per_round(picture) for picture in (new, reference)]
    if samples[0] != samples[1]:
        return f"rounds of {samples[0]:.4g} and {samples[1]:.4g} samples a pixel have different noise"
    return ""


def samples_per_round(picture: Picture) -> float:
    """Mean samples a pixel in a round."""
    return float(picture.attributes.get("samplesPerPixel", 0)) / float(picture.attributes["ajar:rounds"])


def median_ratio(ours: BlockStatistics, theirs: BlockStatistics, side: int) -> tuple[float, float] | None:
    """The median ratio of the blocks that have noise in either image, and the standard error of its logarithm."""
    a = ours.variances[side].sum(axis=2).reshape(-1) * ours.rounds
    b = theirs.variances[side].sum(axis=2).reshape(-1) * theirs.rounds
    noisy = (a > 0) | (b > 0)
    if int(noisy.sum()) < MIN_BLOCKS:
        return None
    # A variance of nothing, as equal rounds have it, must not vanish from the list.
    floor = 1e-12 * max(float(a.max()), float(b.max()))
    logs = np.log(np.maximum(a[noisy], floor)) - np.log(np.maximum(b[noisy], floor))
    spread = 1.4826 * float(np.median(np.abs(logs - np.median(logs))))
    # The median's error is 1.25 times the mean's; neighbouring blocks are not independent, hence twice that.
    return float(np.exp(np.median(logs))), 2.5 * spread / math.sqrt(logs.size)


def whole_ratio(ours: BlockStatistics, theirs: BlockStatistics) -> tuple[float, float] | None:
    """The ratio for the whole image with the error of the logarithm of a variance ratio of Gaussians."""
    a = float(ours.variances[WHOLE].sum()) * ours.rounds
    b = float(theirs.variances[WHOLE].sum()) * theirs.rounds
    if a <= 0 and b <= 0:
        return None
    ratio = a / b if b > 0 else math.inf
    above, below = (ours.rounds - 1, theirs.rounds - 1) if ratio >= 1 else (theirs.rounds - 1, ours.rounds - 1)
    p = upper_f(max(ratio, 1 / ratio if ratio else math.inf), above, below)
    # The error that makes a Gaussian test agree with the F distribution's.
    z = NormalDist().inv_cdf(1 - min(max(p, 1e-15), 0.499))
    return min(max(ratio, 1e-12), 1e12), abs(math.log(max(ratio, 1e-300))) / z if ratio != 1 else 1.0
