"""Passes of any renderer become one image that declares its noise."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from ajar_tools import Outcome, Settings, compare, read
from ajar_tools.average import main
from ajar_tools.statistics import from_rounds
from ajar_tools.verdict import Status
from synthetic import Recipe, gamma_noise, scene

DISPLAY_P3 = (0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329)
RECIPE = Recipe(width=64, height=48, noise=0.3)


def passes(folder: Path, seeds: range, scale: float = 1.0) -> list[str]:
    """Images as another renderer writes them: colours, and nothing about noise."""
    paths = []
    for seed in seeds:
        noise = gamma_noise(np.random.default_rng(seed), RECIPE, 1 / RECIPE.noise**2)
        spec = oiio.ImageSpec(RECIPE.width, RECIPE.height, 3, oiio.FLOAT)
        image = oiio.ImageBuf(spec)
        image.specmod().attribute("colorInteropID", "lin_p3d65_scene")
        image.specmod().attribute("chromaticities", oiio.TypeDesc("float[8]"), DISPLAY_P3)
        image.set_pixels(spec.roi, np.float32(scale * scene(RECIPE.width, RECIPE.height) * noise))
        paths.append(str(folder / f"pass{seed}.exr"))
        assert image.write(paths[-1])
    return paths


def averaged(folder: Path, seeds: range, scale: float = 1.0) -> Path:
    output = folder / f"mean{seeds.start}.exr"
    assert main([*passes(folder, seeds, scale), "-o", str(output)]) == 0
    return output


def test_it_stores_the_mean_and_the_spread_of_blocks(tmp_path: Path) -> None:
    picture = read(averaged(tmp_path, range(5)))
    rounds = np.stack([read(tmp_path / f"pass{seed}.exr").color for seed in range(5)])
    assert picture.color == pytest.approx(rounds.mean(axis=0), rel=1e-6)
    assert picture.statistics is not None
    assert picture.attributes["colorInteropID"] == "lin_p3d65_scene"
    assert picture.attributes["chromaticities"] == pytest.approx(DISPLAY_P3)
    expected = from_rounds(rounds)
    assert picture.statistics.rounds == 5
    for side, variance in expected.variances.items():
        assert picture.statistics.variances[side] == pytest.approx(variance, rel=1e-5)


def test_images_of_two_renderers_are_compared_by_statistics(tmp_path: Path) -> None:
    ours, settings = averaged(tmp_path, range(16)), Settings(other_renderer=True)
    verdict = compare(averaged(tmp_path, range(100, 116)), ours, settings)
    assert verdict.outcome is Outcome.PASS, verdict.text()
    assert verdict.gates[3].status is Status.PASS
    verdict = compare(averaged(tmp_path, range(200, 216), scale=1.02), ours, settings)
    assert verdict.gates[3].status is Status.FAIL, verdict.text()
    limits = replace(settings, min_rounds=17)
    assert compare(averaged(tmp_path, range(100, 116)), ours, limits).gates[3].status is Status.SKIP


def test_what_cannot_be_averaged_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = passes(tmp_path, range(2))
    output = str(tmp_path / "out.exr")
    for images, says in (
        ([first], "does not tell its noise"),
        ([first, first], "equal to another pass"),
        ([first, str(tmp_path / "missing.exr")], "does not exist"),
    ):
        assert main([*images, "-o", output]) == 2
        assert says in capsys.readouterr().err
    grey = [str(tmp_path / f"grey{i}.exr") for i in range(2)]
    for path, value in zip(grey, (1.0, 2.0), strict=True):
        spec = oiio.ImageSpec(8, 8, 1, oiio.FLOAT)
        spec.channelnames = ("Y",)
        image = oiio.ImageBuf(spec)
        image.set_pixels(spec.roi, np.full((8, 8, 1), value, np.float32))
        assert image.write(path)
    assert main([*grey, "-o", output]) == 2
    assert "no R, G and B" in capsys.readouterr().err
    assert main([first, second, "-o", str(tmp_path / "no/folder/out.exr")]) == 2
    assert "cannot be written" in capsys.readouterr().err
