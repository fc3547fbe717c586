"""Comparison across renderers: the Cornell box by Ajar against Mitsuba's and Cycles' images of it (peers/README.md)."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from ajar_tools import Outcome, Picture, Settings, Verdict, compare, read
from ajar_tools.comparison import compare_pictures
from ajar_tools.verdict import Status
from synthetic import brighter

PEERS = Path(__file__).parent / "peers"
MITSUBA, PASSES, CYCLES = (PEERS / f"cornell-{name}.exr" for name in ("mitsuba", "mitsuba-passes", "cycles"))
SIZE, DEPTH = 48, 16
OTHER = Settings(other_renderer=True)
# The importer of Cycles makes other surfaces, some percent brighter, and its lamp covers a tenth of a pixel more.
LIMITS = {MITSUBA: OTHER, CYCLES: replace(OTHER, flip_mean=0.08)}


@pytest.fixture(scope="module")
def ours(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return render(tmp_path_factory.mktemp("peers"), SIZE)


def render(folder: Path, size: int, *arguments: str) -> Path:
    """The scene that the others were given, by Ajar."""
    binary = os.environ.get("AJAR_BIN")
    if not binary:
        pytest.skip("AJAR_BIN does not name an ajar program")
    sys.path.insert(0, str(PEERS.parents[1] / "bench" / "peers"))
    from make import make

    make("cornell", folder, size, DEPTH)
    command = [binary, "render", folder / "scene.toml", "-o", folder / "ajar.exr", "--quiet", "--integrator", "path"]
    subprocess.run([*command, "--spp", "480", *arguments], check=True, timeout=300)
    return folder / "ajar.exr"


def statuses(verdict: Verdict) -> dict[str, Status]:
    return {gate.gate: gate.status for gate in verdict.gates}


@pytest.mark.parametrize("theirs", LIMITS, ids=["mitsuba", "cycles"])
def test_images_of_other_renderers_agree(theirs: Path, ours: Path) -> None:
    """They declare no noise, so that FLIP judges; the other gates that can be asked report."""
    verdict = compare(ours, theirs, LIMITS[theirs])
    assert verdict.outcome is Outcome.PASS, verdict.text()
    found = statuses(verdict)
    assert [found[gate] for gate in ("structure", "finite", "flip", "numbers")] == [Status.PASS] * 4
    assert [found[gate] for gate in ("statistics", "variance")] == [Status.SKIP] * 2
    assert theirs.name in verdict.text()
    numbers = verdict.gates[-1].numbers
    assert numbers["mean_new"] == pytest.approx(numbers["mean_reference"], rel=0.005 if theirs == MITSUBA else 0.05)


def test_passes_of_another_renderer_are_asked_for_statistics(ours: Path) -> None:
    verdict = compare(ours, PASSES, OTHER)
    assert verdict.outcome is Outcome.PASS, verdict.text()
    assert statuses(verdict)["statistics"] is Status.PASS


def redder(picture: Picture, factor: float) -> Picture:
    """With more red, and no other change."""
    red = picture.channels.index("R")
    mutant = brighter(picture, 1.0)
    mutant.pixels[..., red] *= factor
    return mutant


def test_three_percent_more_red_are_found_by_statistics(ours: Path) -> None:
    verdict = compare_pictures(redder(read(ours), 1.03), read(PASSES), OTHER)
    assert verdict.outcome is Outcome.FAIL
    assert "in R" in verdict.failures[0].message


@pytest.mark.parametrize("theirs", LIMITS, ids=["mitsuba", "cycles"])
def test_what_a_person_sees_is_found_without_statistics(theirs: Path, ours: Path) -> None:
    verdict = compare_pictures(redder(read(ours), 1.5), read(theirs), LIMITS[theirs])
    assert [gate.gate for gate in verdict.failures] == ["flip"]


# What pbrt-v4's GBufferFilm writes beside R, G and B (src/pbrt/film.cpp).
PBRT = [f"{layer}.{c}" for layer in ("Albedo", "Variance", "RelativeVariance") for c in "RGB"]
PBRT += [f"{layer}.{c}" for layer in ("P", "N", "Ns") for c in "XYZ"] + ["u", "v", "dzdx", "dzdy"]


@pytest.fixture
def in_layout_of_pbrt(tmp_path: Path) -> Path:
    """No image by pbrt: Mitsuba's pixels, with the channels, types, windows and attributes that pbrt gives a file."""
    colors = read(MITSUBA).color
    height, width = colors.shape[:2]
    spec = oiio.ImageSpec(width, height, 3 + len(PBRT), oiio.HALF)
    spec.channelnames = ("R", "G", "B", *PBRT)
    spec.attribute("renderTimeSeconds", 12.5)
    spec.attribute("samplesPerPixel", 4096)
    for name in ("worldToCamera", "worldToNDC"):
        spec.attribute(name, "matrix", tuple(np.eye(4, dtype=np.float32).reshape(-1)))
    image = oiio.ImageBuf(spec)
    layers = np.full((height, width, len(PBRT)), 0.5)
    image.set_pixels(spec.roi, np.ascontiguousarray(np.concatenate([colors, layers], axis=2), np.float32))
    assert image.write(str(tmp_path / "pbrt.exr")), image.geterror()
    return tmp_path / "pbrt.exr"


def test_the_layout_of_pbrt_is_understood(ours: Path, in_layout_of_pbrt: Path) -> None:
    assert set(PBRT) < set(read(in_layout_of_pbrt).channels)
    verdict = compare(ours, in_layout_of_pbrt, OTHER)
    assert verdict.outcome is Outcome.PASS, verdict.text()
    assert statuses(verdict)["flip"] is Status.PASS
    mutant = redder(read(ours), 1.5)
    assert compare_pictures(mutant, read(in_layout_of_pbrt), OTHER).outcome is Outcome.FAIL
    verdict = compare(ours, in_layout_of_pbrt)
    assert [gate.gate for gate in verdict.failures] == ["structure"]
    assert "--other-renderer" in verdict.headline()


@pytest.mark.parametrize("theirs", [MITSUBA, PASSES, CYCLES], ids=["mitsuba", "passes", "cycles"])
def test_another_size_is_refused(theirs: Path, tmp_path: Path) -> None:
    verdict = compare(render(tmp_path, SIZE + 16, "--rounds", "1"), theirs, OTHER)
    assert verdict.outcome is Outcome.CANNOT
    assert "never resampled" in verdict.problem


def test_without_the_flag_the_structure_differs(ours: Path) -> None:
    verdict = compare(ours, CYCLES)
    assert [gate.gate for gate in verdict.failures] == ["structure"]
    assert "--other-renderer" in verdict.headline()
