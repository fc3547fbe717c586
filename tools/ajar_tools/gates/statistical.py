"""Gate 4: means of blocks differ by no more than the noise that both images declare.

Welch's t-test for every block and channel on four levels (the whole image, 64×64, 16×16, 8×8), with Bonferroni's
correction within a level: large blocks see small changes everywhere, small blocks see large changes in one place. A
fifth test asks whether all blocks together scatter more than declared, which no single one need show.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from ajar_tools.gates.noise import other_rounds, unusable
from ajar_tools.picture import Picture
from ajar_tools.settings import Settings
from ajar_tools.statistics import SIDES, WHOLE, BlockStatistics, block_means
from ajar_tools.student import critical_t, two_sided_t
from ajar_tools.verdict import GateResult, Status

LEVELS = (WHOLE, 64, 16, 8)
# Of alpha: each of the levels, the scatter, and what is left is for the gate of variances.
LEVEL_SHARE = 0.2
SCATTER_SHARE = 0.1
# Fewest blocks whose scatter is judged.
MIN_BLOCKS = 24
# Probabilities are computed for this many blocks and channels, those with the largest |t|.
MOST_TESTED = 4096


@dataclass(frozen=True)
class Finding:
    """The block of a level that differs most."""

    side: int
    row: int
    column: int
    channel: int
    t: float
    p: float
    limit: float
    relative: float
    failing: int
    """Number of blocks beyond the limit."""


def check(new: Picture, reference: Picture, settings: Settings) -> GateResult:
    """Tests all levels; skipped with a reason where an image declares no noise."""
    ours, theirs = new.statistics, reference.statistics
    if reason := unusable(new, ours, settings) or unusable(reference, theirs, settings):
        return GateResult("statistics", Status.SKIP, reason)
    assert ours is not None
    assert theirs is not None
    tests = {side: Level(new, reference, ours, theirs, side) for side in LEVELS}
    findings = [worst(test, settings.alpha * LEVEL_SHARE) for test in tests.values()]
    scatter = excess_scatter(tests[8], settings)
    change = smallest_change(tests[WHOLE], settings.alpha * LEVEL_SHARE)
    numbers = {
        "blocks": {str(f.side or "image"): {"t": f.t, "p": f.p, "limit": f.limit} for f in findings},
        "scatter": scatter.value if scatter else None,
        "smallest_change": change,
        "rounds": [ours.rounds, theirs.rounds],
    }
    failing = [f for f in findings if f.p < f.limit]
    if failing:
        # The smallest blocks tell best where, the clearest ones that it is so.
        smallest, clearest = failing[-1], max(failing, key=lambda f: abs(f.t))
        numbers |= {"block": place(smallest, new), "relative_difference": smallest.relative}
        told = [smallest] if clearest is smallest else [smallest, clearest]
        return GateResult("statistics", Status.FAIL, " and ".join(describe(f, new) for f in told), numbers)
    if scatter and scatter.fails:
        message = f"blocks scatter {scatter.value:.2f} times as much as the noise that the files declare"
        return GateResult("statistics", Status.FAIL, message, numbers)
    weakest = min(findings, key=lambda f: f.p / f.limit)
    message = f"no block differs by more than noise; {summary(weakest)}"
    if math.isfinite(change):
        message += f"; {100 * change:.2g} % more or less light would have been seen"
    return GateResult("statistics", Status.PASS, message, numbers)


class Level:
    """Differences of block means of one side in standard errors: `t`, with degrees of `freedom`.

    A short render that missed rare bright paths is too dark and knows little of its noise. Where the other one is made
    of rounds of the same kind, it knows; then the larger counts of the standard errors of Welch and of Student.
    """

    def __init__(
        self, new: Picture, reference: Picture, ours: BlockStatistics, theirs: BlockStatistics, side: int
    ) -> None:
        self.side = side
        a, b = block_means(new.color, side), block_means(reference.color, side)
        variance, self.freedom = welch(ours, theirs, side)
        if not other_rounds(new, reference):
            pooled, freedom = student(ours, theirs, side)
            self.freedom = np.where(pooled > variance, freedom, self.freedom)
            variance = np.maximum(pooled, variance)
        rounding = (max(new.rounding(), reference.rounding()) * np.maximum(a, b)) ** 2
        # What the last bits of another processor do to a pixel without noise is no difference.
        floor = rounding + (1e-6 * max(float(a.mean()), float(b.mean()))) ** 2 + 1e-70
        difference, error = a - b, np.sqrt(variance + floor)
        self.t = difference / error
        base = np.maximum(b, 1e-6 * float(b.mean()) + 1e-35)
        self.relative, self.relative_error = difference / base, error / base


def welch(ours: BlockStatistics, theirs: BlockStatistics, side: int) -> tuple[np.ndarray, np.ndarray]:
    """Variances of differences, and degrees of freedom, whatever the noise of each image."""
    va, vb = ours.variances[side], theirs.variances[side]
    freedom = (va + vb) ** 2 / np.maximum(va**2 / (ours.rounds - 1) + vb**2 / (theirs.rounds - 1), 1e-300)
    return va + vb, np.clip(freedom, min(ours.rounds, theirs.rounds) - 1, None)


def student(ours: BlockStatistics, theirs: BlockStatistics, side: int) -> tuple[np.ndarray, int]:
    """The same for images whose rounds have the same noise."""
    n, m = ours.rounds, theirs.rounds
    of_round = ((n - 1) * n * ours.variances[side] + (m - 1) * m * theirs.variances[side]) / (n + m - 2)
    return of_round * (1 / n + 1 / m), n + m - 2


def worst(test: Level, alpha: float) -> Finding:
    """The most significant block, and how many are significant."""
    size = test.t.size
    limit = alpha / size
    count = min(MOST_TESTED, size)
    interesting = np.argpartition(np.abs(test.t).reshape(-1), size - count)[size - count :]
    p = two_sided_t(test.t.reshape(-1)[interesting], test.freedom.reshape(-1)[interesting])
    index = int(interesting[int(p.argmin())])
    row, column, channel = (int(i) for i in np.unravel_index(index, test.t.shape))
    t, relative = float(test.t[row, column, channel]), float(test.relative[row, column, channel])
    failing = np.unique(interesting[p < limit] // 3).size
    return Finding(test.side, row, column, channel, t, float(p.min()), limit, relative, failing)


def smallest_change(whole: Level, alpha: float) -> float:
    """The relative change of all light that the level of the whole image sees every other time, in its best channel."""
    freedom = np.broadcast_to(whole.freedom, whole.t.shape).reshape(-1)
    return float((critical_t(alpha / freedom.size, freedom) * whole.relative_error.reshape(-1)).min())


@dataclass(frozen=True)
class Scatter:
    """Mean squared difference of blocks in standard errors, 1 where the declared noise is the true one."""

    value: float
    fails: bool


def excess_scatter(test: Level, settings: Settings) -> Scatter | None:
    """Whether blocks scatter more than declared; `None` with too few blocks.

    The variance of t² over its mean counts neighbours' covariances too, for blocks beside each other may be lit by the
    same chain. Blocks without noise say nothing and are left out.
    """
    squares = np.minimum(test.t**2, 100.0) * (test.freedom - 2) / test.freedom
    mean = squares.mean(axis=2)
    noisy = (np.abs(test.t) > 0).any(axis=2)
    count = int(noisy.sum())
    if count < MIN_BLOCKS:
        return None
    value = float(mean[noisy].mean())
    error = math.sqrt(max(neighbour_covariance(np.where(noisy, mean - value, 0.0)), 1e-12)) / count
    limit = settings.dispersion - NormalDist().inv_cdf(settings.alpha * SCATTER_SHARE) * error
    return Scatter(value, value > limit)


def neighbour_covariance(residuals: np.ndarray) -> float:
    """Sum of the products of every residual with itself and its eight neighbours, at least that with itself."""
    padded = np.pad(residuals, 1)
    rows, columns = residuals.shape
    around = sum(padded[i : i + rows, j : j + columns] for i in range(3) for j in range(3))
    return float(max((residuals * around).sum(), (residuals**2).sum()))


def place(finding: Finding, picture: Picture) -> list[int]:
    """Left, top, right, bottom of a finding's block in the full frame, the end excluded."""
    window = picture.data_window
    side = finding.side or max(window.width, window.height)
    left, top = finding.column * side, finding.row * side
    right, bottom = min(left + side, window.width), min(top + side, window.height)
    return [window.x + left, window.y + top, window.x + right, window.y + bottom]


def describe(finding: Finding, picture: Picture) -> str:
    """A failing level in words."""
    x0, y0, x1, y1 = place(finding, picture)
    channel = picture.color_channels[min(finding.channel, len(picture.color_channels) - 1)]
    direction = "brighter" if finding.t > 0 else "darker"
    amount = f"{abs(finding.relative) * 100:.3g} % {direction} in {channel} than the reference"
    if finding.side == WHOLE:
        where = "the whole image is"
    else:
        where = f"the block from pixel ({x0}, {y0}) to ({x1 - 1}, {y1 - 1}) is"
    others = f", as are {finding.failing - 1} others of its size" if finding.failing > 1 else ""
    return f"{where} {amount} ({abs(finding.t):.1f} standard errors){others}"


def summary(finding: Finding) -> str:
    """The least unlikely finding in words."""
    name = f"{finding.side}×{finding.side} block" if finding.side in SIDES else "image"
    chance = f"probability {finding.p:.2g}, limit {finding.limit:.2g}"
    return f"the {name} that differs most: {abs(finding.t):.1f} standard errors, {chance}"
