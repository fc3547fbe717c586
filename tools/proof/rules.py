"""How others decide whether two images are the same: rules to hold ajar-compare against."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist

import numpy as np
from ajar_tools import CannotCompareError, Outcome, Picture, Settings, compare, read
from ajar_tools.comparison import unjudged
from ajar_tools.gates import finite, numbers, statistical, structure, variance
from ajar_tools.verdict import Status

Rule = Callable[[Path, Path], bool]


def ajar_compare(new: Path, reference: Path) -> bool:
    """This package, as it comes."""
    return compare(new, reference, Settings()).outcome is Outcome.PASS


def is_too_noisy(new: Picture, reference: Picture) -> bool:
    """Whether both declare so much noise that statistics do not judge and FLIP does."""
    return unjudged(statistical.check(new, reference, Settings()), Settings()) != ""


def differ(new: Picture, reference: Picture, settings: Settings) -> bool:
    """The same, without FLIP, which costs most and judges only images with no noise declared, or too much."""
    gates = (structure.check, finite.check, statistical.check, variance.check, numbers.check)
    return any(gate(new, reference, settings).status is Status.FAIL for gate in gates)


def idiff(*arguments: str) -> Rule:
    """OpenImageIO's program; codes 0 and 1 (warnings) pass."""
    program = str(Path(sys.executable).with_name("idiff"))

    def rule(new: Path, reference: Path) -> bool:
        done = subprocess.run([program, "-q", *arguments, str(new), str(reference)], capture_output=True, timeout=60)
        return done.returncode in (0, 1)

    return rule


@dataclass(frozen=True)
class FixedThreshold:
    """`assert rms(new - reference) < limit`, the limit being a tenth above the worst of some twins."""

    limit: float

    def __call__(self, new: Path, reference: Path) -> bool:
        return rms(new, reference) < self.limit


def rms(new: Path, reference: Path) -> float:
    """Root mean square of the difference; infinite where it cannot be formed."""
    try:
        a, b = read(new).color, read(reference).color
    except CannotCompareError:
        return np.inf
    return float(np.sqrt(np.mean((a - b) ** 2))) if a.shape == b.shape else np.inf


@dataclass(frozen=True)
class PixelZ:
    """Mitsuba 3's rule (src/render/tests/test_renders.py): a z-test of every pixel by the variance of one sample, with
    Šidák's correction at a level of 1 %; the image passes if 99.75 % of the pixels do.
    """

    variance: np.ndarray
    """Of a round, rows × columns × RGB."""
    rounds: int

    def __call__(self, new: Path, reference: Path) -> bool:
        try:
            a, b = read(new).color, read(reference).color
        except CannotCompareError:
            return False
        if a.shape != b.shape:
            return False
        z = np.abs(a - b) * np.sqrt(self.rounds / np.maximum(self.variance, 1e-4))
        level = 1 - 0.99 ** (1 / (a.shape[0] * a.shape[1]))
        return bool(np.count_nonzero(z < NormalDist().inv_cdf(1 - level / 2)) >= 0.9975 * z.size)
