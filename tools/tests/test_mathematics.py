"""Tail probabilities, FLIP and block means against independent values."""

import numpy as np
import pytest
from ajar_tools.flip import exposures_for, hdr_flip
from ajar_tools.statistics import SIDES, WHOLE, block_means, from_rounds
from ajar_tools.student import critical_t, two_sided_t, upper_f

flip_evaluator = pytest.importorskip("flip_evaluator")


@pytest.mark.parametrize(
    ("t", "freedom", "critical"),
    # Table of Student's t, Abramowitz & Stegun 26.10.
    [
        (12.706, 1, 0.05),
        (4.032, 5, 0.01),
        (2.845, 20, 0.01),
        (3.850, 20, 0.001),
        (3.460, 60, 0.001),
        (1.980, 120, 0.05),
    ],
)
def test_students_t_has_the_tabulated_values(t: float, freedom: int, critical: float) -> None:
    assert two_sided_t(np.array([t]), np.array([freedom]))[0] == pytest.approx(critical, rel=2e-3)
    assert critical_t(critical, np.array([freedom]))[0] == pytest.approx(t, rel=2e-3)


def test_far_tails_of_students_t_follow_the_density() -> None:
    """With two degrees of freedom the tail is 1 - t / sqrt(2 + t²), for large t 1 / t²."""
    assert two_sided_t(np.array([1e6]), np.array([2.0]))[0] == pytest.approx(1e-12, rel=1e-6)
    assert two_sided_t(np.array([0.0]), np.array([9.0]))[0] == pytest.approx(1)


@pytest.mark.parametrize(
    ("f", "above", "below", "p"), [(4.35, 1, 20, 0.05), (2.98, 10, 10, 0.05), (2.52, 15, 30, 0.0151)]
)
def test_fishers_f_has_the_tabulated_values(f: float, above: int, below: int, p: float) -> None:
    assert upper_f(f, above, below) == pytest.approx(p, rel=0.02)


@pytest.mark.parametrize("ppd", [67.02064, 22.3])
def test_flip_is_that_of_its_authors(ppd: float) -> None:
    rng = np.random.default_rng(3)
    y, x = np.mgrid[:50, :70]
    reference = np.stack([2 * np.sin(x / 9) ** 2, np.cos(y / 11) ** 2, (x + y) / 100], axis=-1).astype(np.float32)
    test = (reference * rng.normal(1, 0.2, reference.shape)).clip(0).astype(np.float32)
    test[10:20, 30:50] *= [1.5, 0.5, 1]
    stops = exposures_for(2.0, 0.18)
    parameters = {"startExposure": stops[0], "stopExposure": stops[-1], "numExposures": len(stops), "ppd": ppd}
    theirs, mean, _ = flip_evaluator.evaluate(reference, test, "HDR", applyMagma=False, parameters=parameters)
    ours = hdr_flip(reference, test, stops, ppd)
    assert ours.mean() == pytest.approx(mean, rel=1e-4)
    assert np.abs(ours - theirs[..., 0]).max() < 1e-4


def test_block_means_count_smaller_blocks_by_their_own_size() -> None:
    pixels = np.random.default_rng(5).random((13, 21, 3))
    means = block_means(pixels, 8)
    assert means.shape == (2, 3, 3)
    assert means[1, 2] == pytest.approx(pixels[8:, 16:].mean((0, 1)))
    assert block_means(pixels, WHOLE)[0, 0] == pytest.approx(pixels.mean((0, 1)))


def test_variances_of_rounds_are_those_of_their_blocks() -> None:
    rounds = np.random.default_rng(6).random((5, 20, 30, 3))
    statistics = from_rounds(rounds)
    assert set(statistics.variances) == {*SIDES, WHOLE}
    expected = rounds[:, 8:16, 16:24].mean((1, 2)).var(axis=0, ddof=1) / 5
    assert statistics.variances[8][1, 2] == pytest.approx(expected)
