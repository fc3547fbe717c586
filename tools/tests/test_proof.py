"""Twins and mutants of real renders, by each integrator: tools/proof at the size of a test.

Rounds have one sample a pixel. Few of them show most changes, and more of them small ones. Images that claim less noise
than they have are betrayed by scatter alone; that of half their rounds takes more blocks than these have, and is found
in synthetic images (test_gates.py).
"""

import os
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import twins
from ajar_tools import Outcome, Verdict, compare, read
from ajar_tools.statistics import from_rounds
from mutants import EDITS, Edit
from renders import ROOT, in_rounds, sets, spoilable
from synthetic import File, Recipe

SCENE = ROOT / "tools" / "proof" / "box.toml"
INTEGRATORS = ("path", "bdpt", "mlt", "ajar")
SIZE = "192x144"
FEW = 8
# The brightness of an image by `mlt` has noise of its own in each round.
MANY = {"path": 32, "bdpt": 32, "mlt": 128, "ajar": 32}
REFERENCE = 100

Renderer = Callable[..., Path]


@pytest.fixture(scope="module")
def render(tmp_path_factory: pytest.TempPathFactory) -> Renderer:
    """Renders the box once for each demand."""
    if not os.environ.get("AJAR_BIN"):
        pytest.skip("AJAR_BIN does not name an ajar program")
    home = tmp_path_factory.mktemp("renders")

    @cache
    def rendered(integrator: str, seed: int, rounds: int = FEW, changes: tuple[str, ...] = ()) -> Path:
        target = home / f"{len(list(home.iterdir()))}.exr"
        arguments = ["--integrator", integrator, "--seed", str(seed), "--size", SIZE, "--allow", str(ROOT / "scenes")]
        in_rounds(SCENE, target, rounds, 1, [*arguments, *sets(changes)])
        return target

    return rendered


@pytest.fixture(params=INTEGRATORS)
def integrator(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def reference(integrator: str, render: Renderer) -> Path:
    # The box needs no chains, and `ajar` renders it as `path` does, as a test below asserts.
    integrator = "path" if integrator == "ajar" else integrator
    return render(integrator, REFERENCE, MANY[integrator])


def failing(verdict: Verdict) -> set[str]:
    """The gates that fail."""
    assert verdict.outcome is Outcome.FAIL, verdict.text()
    return {gate.gate for gate in verdict.failures}


def test_other_seeds_are_twins(integrator: str, reference: Path, render: Renderer) -> None:
    first, second = (render(integrator, seed) for seed in (1, 2))
    for pair in ((first, reference), (second, reference), (first, second)):
        verdict = compare(*pair)
        assert verdict.outcome is Outcome.PASS, verdict.text()
        assert "statistics" in {gate.gate for gate in verdict.gates}


@pytest.mark.skipif(
    not {"AJAR_BIN", "AJAR_RELEASE_TESTS"} <= set(os.environ),
    reason="renders 492 images: AJAR_RELEASE_TESTS=1, with AJAR_BIN naming a release build, makes them",
)
def test_false_alarms_of_forty_twins_of_each_kind_are_chance() -> None:
    twins.render(40)
    _, problems = twins.section(40)
    assert problems == []


def test_two_percent_more_energy_are_found(integrator: str, reference: Path, render: Renderer) -> None:
    brighter = render(integrator, 1, MANY[integrator], changes=("camera.main.exposure=1.02",))
    assert energy(brighter, reference) == pytest.approx(1.02, abs=0.012)
    assert "statistics" in failing(compare(brighter, reference))


def energy(new: Path, reference: Path) -> float:
    """Of an image, over that of another one."""
    return float(read(new).color.mean() / read(reference).color.mean())


CHANGES = {
    "a light off": ("light.fill.radiance=0",),
    "albedo swapped": ("material.Red.base_color=[0.13,0.44,0.10]", "material.Green.base_color=[0.60,0.055,0.045]"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_changed_scenes_are_found(change: str, integrator: str, reference: Path, render: Renderer) -> None:
    new = render(integrator, 1, changes=CHANGES[change])
    assert 0.7 < energy(new, reference) < 1.1
    assert "statistics" in failing(compare(new, reference))


def mean(passes: list[Path], integrator: str) -> File:
    """The mean of renders of one round, each a round, with the noise that they show."""
    images = [read(path) for path in passes]
    rounds = np.stack([image.color for image in images])
    pixels = np.concatenate([rounds.mean(axis=0), images[0].plane("A")[..., None]], axis=2)
    recipe = Recipe(pixels.shape[1], pixels.shape[0], rounds=len(passes))
    return File(pixels, dict(from_rounds(rounds).variances), recipe, integrator=integrator)


def test_noise_that_is_not_declared_is_found(
    integrator: str, reference: Path, render: Renderer, tmp_path: Path
) -> None:
    right = written(reference, tmp_path)
    passes = [render(integrator, seed, 1) for seed in (1, 2)]
    repeated = mean(passes * (FEW // 2), integrator)
    claiming = mean(passes, integrator)
    claiming.variances = {side: variance * 2 / FEW for side, variance in claiming.variances.items()}
    claiming.recipe = repeated.recipe
    for name, mutant in {
        "every seed used four times": repeated,
        "a quarter of the rounds claimed as all": claiming,
    }.items():
        assert "statistics" in failing(compare(mutant.write(tmp_path / "new.exr"), right)), name


def test_ajar_renders_the_box_as_path_does(render: Renderer) -> None:
    assert np.array_equal(*(read(render(integrator, 1)).color for integrator in ("ajar", "path")))


# Which gate has to see it; `None`: there is nothing to compare.
GATES = {
    "shifted by a pixel": "statistics",
    "one NaN": "finite",
    "all NaN": "finite",
    "empty": "statistics",
    "a channel renamed": "structure",
    "cropped": None,
}


@pytest.mark.parametrize("name", GATES)
def test_spoiled_images_are_found(
    name: str, integrator: str, reference: Path, render: Renderer, tmp_path: Path
) -> None:
    right, edit = written(reference, tmp_path), EDITS[name]
    verdict = compare(spoiled(render(integrator, 1), edit, tmp_path / "new.exr"), right)
    if GATES[name] is None:
        assert verdict.outcome is Outcome.CANNOT
    else:
        assert GATES[name] in failing(verdict)


def written(path: Path, folder: Path) -> Path:
    """The image with what mutants have: colours and statistics."""
    return spoiled(path, lambda image: None, folder / "reference.exr")


def spoiled(path: Path, edit: Edit, target: Path) -> Path:
    """An image written again, changed."""
    image = spoilable(read(path))
    edit(image)
    return image.write(target)


def test_unspoiled_images_written_again_pass(
    integrator: str, reference: Path, render: Renderer, tmp_path: Path
) -> None:
    verdict = compare(
        spoiled(render(integrator, 1), lambda image: None, tmp_path / "new.exr"), written(reference, tmp_path)
    )
    assert verdict.outcome is Outcome.PASS, verdict.text()
