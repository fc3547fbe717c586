"""Mutants must fail, at the gate that is there for them; twins must pass. All on images whose noise is known."""

import datetime
import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from ajar_tools import Outcome, Settings, Verdict, compare, read
from ajar_tools.comparison import compare_pictures
from ajar_tools.gates import statistical
from ajar_tools.settings import ExcusedGate
from ajar_tools.verdict import Status
from synthetic import File, Recipe, brighter, file

TWINS = 40


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return file(seed=1000, rounds=64).write(tmp_path_factory.mktemp("reference") / "reference.exr")


def gates(verdict: Verdict) -> dict[str, Status]:
    return {gate.gate: gate.status for gate in verdict.gates}


def colors(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[File], None]:
    """A mutant of the colours."""

    def mutate(mutant: File) -> None:
        mutant.pixels[..., :3] = change(mutant.pixels[..., :3])

    return mutate


def one_pixel(value: float) -> Callable[[File], None]:
    def mutate(mutant: File) -> None:
        mutant.pixels[20, 30, 1] = value

    return mutate


def without_a_light(image: np.ndarray) -> np.ndarray:
    """A light that gave the right third a tenth of its brightness."""
    image[:, 64:] *= 0.9
    return image


MUTANTS: dict[str, tuple[Callable[[File], None], str]] = {
    "energy +2 %": (colors(lambda image: image * 1.02), "statistics"),
    "energy -2 %": (colors(lambda image: image * 0.98), "statistics"),
    "a light off": (colors(without_a_light), "statistics"),
    "albedo swapped": (colors(lambda image: image[..., ::-1]), "statistics"),
    "shifted by a pixel": (colors(lambda image: np.roll(image, 1, axis=1)), "statistics"),
    "empty": (colors(lambda image: image * 0), "statistics"),
    "one NaN": (one_pixel(np.nan), "finite"),
    "one infinity": (one_pixel(np.inf), "finite"),
    "one negative": (one_pixel(-1e-3), "finite"),
    "renamed channel": (lambda mutant: setattr(mutant, "channels", ("R", "G", "B", "Z")), "structure"),
    "half floats": (lambda mutant: setattr(mutant, "kind", oiio.HALF), "structure"),
    "alpha lost": (lambda mutant: mutant.pixels.__setitem__((..., 3), 0.0), "numbers"),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_mutant_fails_at_its_gate(name: str, reference: Path, tmp_path: Path) -> None:
    mutate, gate = MUTANTS[name]
    mutant = file(seed=7)
    mutate(mutant)
    verdict = compare(mutant.write(tmp_path / "new.exr"), reference)
    assert verdict.outcome is Outcome.FAIL
    assert gates(verdict)[gate] is Status.FAIL, verdict.text()


def test_equal_rounds_fail_for_their_variance(reference: Path, tmp_path: Path) -> None:
    verdict = compare(file(seed=7, equal_rounds=True).write(tmp_path / "new.exr"), reference)
    assert gates(verdict)["variance"] is Status.FAIL


def test_noise_shared_by_neighbours_fails_for_its_variance(reference: Path, tmp_path: Path) -> None:
    """Threads with the same seed: every pixel is as noisy as before, blocks are not."""
    verdict = compare(file(seed=7, shared=0.5).write(tmp_path / "new.exr"), reference)
    assert gates(verdict)["variance"] is Status.FAIL


def test_half_the_rounds_claimed_as_all_scatter_too_much(tmp_path: Path) -> None:
    big = Recipe(width=256, height=192)
    honest = file(big, seed=1, rounds=32).write(tmp_path / "reference.exr")
    half = file(big, seed=2, rounds=16)
    half.variances = {side: variance / 2 for side, variance in half.variances.items()}
    half.recipe = replace(half.recipe, rounds=32)
    verdict = compare(half.write(tmp_path / "new.exr"), honest)
    assert gates(verdict)["statistics"] is Status.FAIL
    assert "scatter" in verdict.failures[0].message


def test_twins_pass(reference: Path, tmp_path: Path) -> None:
    """None of 40 may fail at alpha 0.001; their smallest probabilities are spread as chance spreads them."""
    failed, suspicious = [], 0
    for seed in range(TWINS):
        new = read(file(seed=seed).write(tmp_path / "new.exr"))
        verdict = compare_pictures(new, read(reference), Settings())
        if verdict.outcome is not Outcome.PASS:
            failed.append(verdict.text())
        strict = statistical.check(new, read(reference), Settings(alpha=0.3))
        suspicious += strict.status is Status.FAIL
    assert not failed
    # Alpha 0.3 with Bonferroni's correction, over channels and levels that are correlated: fewer than 12 on average.
    assert 0 < suspicious <= 20


def test_correlated_twins_pass(tmp_path: Path) -> None:
    recipe = Recipe(shared=0.5, noise=0.6)
    reference = file(recipe, seed=1000, rounds=48).write(tmp_path / "reference.exr")
    for seed in range(10):
        verdict = compare(file(recipe, seed=seed).write(tmp_path / "new.exr"), reference)
        assert verdict.outcome is Outcome.PASS, verdict.text()


def test_equal_pixels_end_the_comparison(reference: Path) -> None:
    verdict = compare(reference, reference)
    assert verdict.outcome is Outcome.PASS
    assert [gate.gate for gate in verdict.gates] == ["structure", "finite", "exact"]


def test_equal_nans_do_not_pass(tmp_path: Path) -> None:
    spoiled = file(seed=1)
    spoiled.pixels[:] = np.nan
    path = spoiled.write(tmp_path / "nan.exr")
    assert compare(path, path).outcome is Outcome.FAIL


def test_images_without_statistics_say_so_and_are_judged_by_flip(tmp_path: Path) -> None:
    plain = file(seed=1, noise=0.05)
    plain.variances = {}
    reference = plain.write(tmp_path / "reference.exr")
    verdict = compare(file(seed=2, noise=0.05).write(tmp_path / "new.exr"), reference)
    assert gates(verdict)["statistics"] is Status.SKIP
    assert "does not declare its noise" in verdict.gates[3].message
    assert verdict.outcome is Outcome.PASS
    other = file(seed=2, noise=0.05)
    other.pixels[..., :3] *= 1.5
    verdict = compare(other.write(tmp_path / "new.exr"), reference)
    assert gates(verdict)["flip"] is Status.FAIL


def test_place_and_amount_are_found(reference: Path, tmp_path: Path) -> None:
    spot = file(seed=3)
    spot.pixels[40:48, 16:24, 1] *= 1.5
    verdict = compare(spot.write(tmp_path / "new.exr"), reference)
    numbers = verdict.failures[0].numbers
    assert numbers["block"] == [16, 40, 24, 48]
    assert numbers["relative_difference"] == pytest.approx(0.5, abs=0.1)
    assert "brighter in G" in verdict.headline()


@pytest.mark.parametrize("rounds", [2, 4, 7])
def test_few_rounds_are_not_believed_and_flip_judges(rounds: int, reference: Path, tmp_path: Path) -> None:
    few = file(seed=3, rounds=rounds, noise=0.05)
    verdict = compare(few.write(tmp_path / "new.exr"), reference)
    assert gates(verdict)["statistics"] is Status.SKIP
    assert gates(verdict)["flip"] in (Status.PASS, Status.FAIL)
    few.pixels[..., :3] = 0
    black = few.write(tmp_path / "black.exr")
    for pair in ((black, reference), (reference, black)):
        verdict = compare(*pair)
        assert [gate.gate for gate in verdict.failures] == ["flip"], verdict.text()
        assert f"is the mean of {rounds} rounds, 8 are needed" in verdict.headline()


def test_flip_judges_where_more_rounds_are_asked_for_than_there_are(reference: Path, tmp_path: Path) -> None:
    black = file(seed=3, change=np.zeros_like).write(tmp_path / "black.exr")
    verdict = compare(black, reference, Settings(min_rounds=1000))
    assert [gate.gate for gate in verdict.failures] == ["flip"], verdict.text()


def test_flip_judges_where_statistics_are_excused(reference: Path, tmp_path: Path) -> None:
    black = file(seed=3, change=np.zeros_like).write(tmp_path / "black.exr")
    verdict = compare(black, reference, excusing("statistics"))
    assert [gate.gate for gate in verdict.failures] == ["flip"], verdict.text()
    assert verdict.exceptions


def test_pictures_that_no_gate_may_judge_do_not_pass(reference: Path, tmp_path: Path) -> None:
    black = file(seed=3, change=np.zeros_like).write(tmp_path / "black.exr")
    verdict = compare(black, reference, excusing("statistics", "flip"))
    assert verdict.outcome is Outcome.FAIL
    assert "no gate is left" in verdict.headline()


def test_a_short_render_that_missed_light_is_judged_by_the_noise_of_the_long_one(
    reference: Path, tmp_path: Path
) -> None:
    short = file(seed=3)
    short.pixels[40:48, 16:24, :3] *= 0.97
    short.variances[8][5, 2] *= 1e-4
    new, right = read(short.write(tmp_path / "new.exr")), read(reference)
    new.attributes["ajar:mutationsPerSample"] = 3.0
    assert statistical.check(new, right, Settings()).status is Status.PASS
    new.attributes["ajar:integrator"] = "bdpt"
    assert statistical.check(new, right, Settings()).status is Status.FAIL


def test_the_smallest_change_that_could_be_found_is_told(reference: Path, tmp_path: Path) -> None:
    """Half of it is hardly ever found, half as much again nearly always."""
    right = read(reference)
    twins = [read(file(seed=seed).write(tmp_path / "new.exr")) for seed in range(20)]
    told = statistical.check(twins[0], right, Settings())
    change = told.numbers["smallest_change"]
    assert f"{100 * change:.2g} % more or less light would have been seen" in told.message

    def found(factor: float) -> int:
        mutants = [brighter(twin, 1 + factor * change) for twin in twins]
        return sum(statistical.check(mutant, right, Settings()).status is Status.FAIL for mutant in mutants)

    assert found(0.5) <= 3
    assert found(1.5) >= 17


def test_noise_that_hides_everything_is_a_warning(reference: Path, tmp_path: Path) -> None:
    black = file(seed=3, change=np.zeros_like)
    black.integrator = "bdpt"
    verdict = compare(black.write(tmp_path / "new.exr"), reference)
    assert verdict.outcome is Outcome.FAIL
    black.variances = {side: 1e6 * variance for side, variance in black.variances.items()}
    verdict = compare(black.write(tmp_path / "new.exr"), reference)
    assert gates(verdict)["statistics"] is Status.PASS
    assert verdict.as_dict()["warnings"]
    # What would have let twice the light pass has not judged.
    assert gates(verdict)["flip"] is Status.FAIL
    assert "so much noise is declared that twice the light" in verdict.text()


def silent(seed: int, change: Callable[[np.ndarray], np.ndarray], rows: int = 72) -> File:
    """An image of little noise that declares none."""
    image = file(Recipe(height=rows, noise=0.01), seed=seed)
    image.variances = {}
    image.pixels[..., :3] = change(image.pixels[..., :3])
    return image


@pytest.mark.parametrize("factor", [10, 100, 1e4])
def test_bright_images_are_seen_without_statistics(factor: float, tmp_path: Path) -> None:
    bright = silent(1, lambda image: factor * image).write(tmp_path / "reference.exr")
    same = silent(2, lambda image: factor * image).write(tmp_path / "same.exr")
    assert compare(same, bright).outcome is Outcome.PASS
    for change in (lambda image: 2 * factor * image, lambda image: factor * image * [3, 1, 1]):
        other = silent(2, change).write(tmp_path / "other.exr")
        assert gates(compare(other, bright))["flip"] is Status.FAIL


def test_negative_light_of_other_renderers_is_no_picture(tmp_path: Path) -> None:
    black = silent(1, np.zeros_like).write(tmp_path / "reference.exr")
    negative = silent(1, lambda image: -50 * image).write(tmp_path / "new.exr")
    verdict = compare(negative, black, Settings(other_renderer=True))
    assert gates(verdict)["finite"] is Status.FAIL


@pytest.mark.parametrize("size", [(3, 200_000), (400_000, 1), (1, 400_000)])
def test_the_edges_of_averaged_images_count(size: tuple[int, int], tmp_path: Path) -> None:
    right = silent(1, lambda image: image)
    right.pixels = np.ones((*size, 4), np.float32)
    reference = right.write(tmp_path / "reference.exr")
    assert compare(right.write(tmp_path / "same.exr"), reference).outcome is Outcome.PASS
    right.pixels[-1:, :, :3] = right.pixels[:, -1:, :3] = 0
    verdict = compare(right.write(tmp_path / "new.exr"), reference)
    assert verdict.flip is not None
    assert verdict.flip.errors[-1, -1] > 0.5


def test_statistics_that_are_lost_fail(reference: Path, tmp_path: Path) -> None:
    lost = file(seed=7, rounds=64)
    lost.variances = {}
    verdict = compare(lost.write(tmp_path / "new.exr"), reference)
    assert gates(verdict)["structure"] is Status.FAIL
    assert "does not declare its noise" in verdict.text()


def excusing(*gates: str) -> Settings:
    return Settings(excused=tuple(ExcusedGate(gate, "renamed", datetime.date(2999, 1, 1)) for gate in gates))


def test_an_excused_structure_leaves_the_other_gates_to_judge(reference: Path, tmp_path: Path) -> None:
    renamed = file(seed=7)
    renamed.channels = ("R", "G", "B", "Z")
    same = compare(renamed.write(tmp_path / "same.exr"), reference, excusing("structure"))
    assert same.outcome is Outcome.PASS
    assert same.exceptions
    equal = file(seed=1000, rounds=64)
    equal.channels = renamed.channels
    verdict = compare(equal.write(tmp_path / "equal.exr"), reference, excusing("structure"))
    assert verdict.outcome is Outcome.PASS
    assert gates(verdict) == {"structure": Status.REPORT, "finite": Status.PASS, "exact": Status.PASS}
    assert verdict.exceptions
    renamed.pixels[..., :3] = 0
    black = compare(renamed.write(tmp_path / "black.exr"), reference, excusing("structure"))
    assert black.outcome is Outcome.FAIL


def test_another_window_cannot_be_excused(reference: Path, tmp_path: Path) -> None:
    small = file(seed=7, width=64).write(tmp_path / "new.exr")
    assert compare(small, reference, excusing("structure")).outcome is not Outcome.PASS


def test_a_pixel_whose_square_is_no_float_fails(reference: Path, tmp_path: Path) -> None:
    mutant = file(seed=7)
    mutant.pixels[20, 30, 1] = 1e30
    assert compare(mutant.write(tmp_path / "new.exr"), reference).outcome is Outcome.FAIL


def test_verdicts_are_json_without_infinity(reference: Path, tmp_path: Path) -> None:
    """Where only coverage differs the colours' PSNR is infinite."""
    mutant = file(seed=1000, rounds=64)
    mutant.pixels[..., 3] = 0.5
    verdict = compare(mutant.write(tmp_path / "new.exr"), reference)
    json.dumps(verdict.as_dict(), allow_nan=False)
    assert any(gate.numbers.get("psnr") == math.inf for gate in verdict.gates)


def test_negative_lobes_of_other_renderers_are_no_failure(reference: Path, tmp_path: Path) -> None:
    mutant = file(seed=7)
    mutant.pixels[20, 30, 1] = -1e-4
    new = mutant.write(tmp_path / "new.exr")
    assert compare(new, reference).outcome is Outcome.FAIL
    assert gates(compare(new, reference, Settings(other_renderer=True)))["finite"] is Status.PASS
