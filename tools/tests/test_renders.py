"""The comparison on real renders: other seeds and integrators are twins, changed scenes are mutants."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from ajar_tools import Outcome, compare, read
from ajar_tools.statistics import SIDES, WHOLE, grid
from ajar_tools.verdict import Status

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "cornell" / "scene.toml"
SIZE = (48, 32)


def render(target: Path, *arguments: str) -> Path:
    binary = os.environ.get("AJAR_BIN")
    if not binary:
        pytest.skip("AJAR_BIN does not name an ajar program")
    command = [binary, "render", SCENE, "--size", f"{SIZE[0]}x{SIZE[1]}", "--rounds", "16", "-o", target, "--quiet"]
    if not any("max_depth" in argument for argument in arguments):
        command += ["--max-depth", "6"]
    integrator = [] if "--integrator" in arguments else ["--integrator", "path"]
    subprocess.run([*command, *integrator, *arguments], check=True, timeout=1200)
    return target


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return render(tmp_path_factory.mktemp("reference") / "reference.exr", "--seed", "100")


def test_renders_declare_their_noise(reference: Path) -> None:
    statistics = read(reference).statistics
    assert statistics is not None
    assert statistics.rounds == 16
    for side in (*SIDES, WHOLE):
        assert statistics.variances[side].shape == (*grid(SIZE, side), 3)
        middle = statistics.variances[side].shape[0] // 2, statistics.variances[side].shape[1] // 2
        assert (statistics.variances[side][middle] > 0).all()


def test_block_variances_follow_from_pixels_where_pixels_are_independent(tmp_path: Path) -> None:
    """Path tracing in rounds of other random points: a block's variance is its pixels' over its size."""
    picture = read(render(tmp_path / "new.exr", "--aov", "variance", "--float"))
    statistics = picture.statistics
    assert statistics is not None
    pixels = picture.plane("variance.G")[8:16, 24:32].mean() / 64
    assert 0.4 < statistics.variances[8][1, 3, 1] / pixels < 2.5


@pytest.mark.parametrize("arguments", [["--seed", "3"], ["--seed", "4"], ["--integrator", "bdpt"]])
def test_twins_pass(arguments: list[str], reference: Path, tmp_path: Path) -> None:
    verdict = compare(render(tmp_path / "new.exr", *arguments), reference)
    assert verdict.outcome is Outcome.PASS, verdict.text()
    assert {gate.gate: gate.status for gate in verdict.gates}["statistics"] is Status.PASS


def test_the_same_command_gives_the_same_pixels(reference: Path, tmp_path: Path) -> None:
    verdict = compare(render(tmp_path / "new.exr", "--seed", "100"), reference)
    assert verdict.gates[-1].gate == "exact"
    assert verdict.outcome is Outcome.PASS


@pytest.mark.parametrize(
    ("change", "energy"),
    [("camera.main.exposure=1.05", 1.05), ("camera.main.yfov=30.2", 0.97), ("render.max_depth=3", 0.9)],
)
def test_mutants_fail(change: str, energy: float, reference: Path, tmp_path: Path) -> None:
    """5 % more energy, 2 % more field of view, indirect light cut off."""
    new = render(tmp_path / "new.exr", "--seed", "3", "--set", change)
    assert read(new).color.mean() / read(reference).color.mean() == pytest.approx(energy, abs=0.03)
    verdict = compare(new, reference)
    assert verdict.outcome is Outcome.FAIL
    assert {gate.gate: gate.status for gate in verdict.gates}["statistics"] is Status.FAIL, verdict.text()


def test_ajar_diff_hands_over(reference: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AJAR_DIFF_PYTHON", sys.executable)
    brighter = render(tmp_path / "new.exr", "--seed", "3", "--set", "camera.main.exposure=1.3")
    report = tmp_path / "report.html"
    for new, code in ((reference, 0), (tmp_path / "missing.exr", 2), (brighter, 1)):
        command = [os.environ["AJAR_BIN"], "diff", new, reference, "--html", report]
        assert subprocess.run(command, timeout=60).returncode == code
    assert f"ajar diff {brighter}" in report.read_text("utf-8")
