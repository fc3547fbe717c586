"""Gate 5: the noise is what it was. More of it is a lost speed-up, less of it a random generator that repeats itself.

Noise of a round is compared, so renders of different length can be compared as long as their rounds are alike. Light
is skewed: a few rounds hold most of what a block receives, and a variance estimated from few rounds may be off by a
factor. So the median of all blocks of a level is judged, by the spread that they show, not by the F distribution.
"""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np

from ajar_tools.gates.noise import incomparable, unusable
from ajar_tools.picture import Picture
from ajar_tools.settings import Settings
from ajar_tools.statistics import SIDES, BlockStatistics
from ajar_tools.verdict import GateResult, Status

# Of alpha, for each of the three levels.
SHARE = 1 / 30
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
    critical = -NormalDist().inv_cdf(settings.alpha * SHARE / 2)
    ratios: dict[str, float] = {}
    problems = []
    for side in SIDES:
        judged = median_ratio(ours, theirs, side)
        if judged is None:
            continue
        ratio, error = judged
        name = f"{side}×{side} blocks"
        ratios[name] = ratio
        if abs(math.log(ratio)) > math.log(settings.variance_ratio) + critical * error:
            problems.append(f"the variance of {name} is {ratio:.3g} times the reference's")
    if problems:
        return GateResult("variance", Status.FAIL, "; ".join(problems), {"ratios": ratios})
    if not ratios:
        return GateResult("variance", Status.SKIP, f"fewer than {MIN_BLOCKS} blocks have noise")
    text = ", ".join(f"{name} {ratio:.2f}" for name, ratio in ratios.items())
    return GateResult("variance", Status.PASS, f"ratio to the reference's variance: {text}", {"ratios": ratios})


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
    # Estimates from fewer rounds have a lower median, though the same mean: by half of the logarithm's variance, if it
    # is normal. Of the variance of `logs`, each image has its part in the ratio of the other one's rounds.
    shift = 0.5 * spread**2 * (theirs.rounds - ours.rounds) / (theirs.rounds + ours.rounds)
    # The median's error is 1.25 times the mean's; neighbouring blocks are not independent, hence twice that.
    return float(np.exp(np.median(logs) + shift)), 2.5 * spread / math.sqrt(logs.size)
