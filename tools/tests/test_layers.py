"""Layers besides colour: first hits, almost without noise."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from ajar_tools import Outcome, Verdict, compare, read
from ajar_tools.verdict import Status
from synthetic import File, file


def gates(verdict: Verdict) -> dict[str, Status]:
    return {gate.gate: gate.status for gate in verdict.gates}


def test_edges_of_layers_may_be_sampled_anew(tmp_path: Path) -> None:
    """Coverage of an edge by 16 points scatters; where it is flat, or gone, every difference counts."""
    rng = np.random.default_rng(3)

    def covered(name: str, spoil: Callable[[np.ndarray], None] = lambda alpha: None) -> Path:
        image = file(seed=1)
        alpha = image.pixels[..., 3]
        alpha[:, 48:] = 0
        alpha[:, 48] = rng.binomial(16, 0.5, 72) / 16
        alpha[20] = rng.binomial(16, 0.9, 96) / 16
        spoil(alpha)
        return image.write(tmp_path / name)

    reference = covered("reference.exr")
    assert compare(covered("sampled.exr"), reference).outcome is Outcome.PASS
    spoiled = {
        "thinner.exr": lambda alpha: alpha.__setitem__((slice(40, 60), slice(0, 40)), 0.97),
        "gone.exr": lambda alpha: alpha.__setitem__((slice(40, 60), slice(40, 60)), 0),
        "moved.exr": lambda alpha: alpha.__setitem__((slice(None), slice(48, 51)), 1),
    }
    for name, spoil in spoiled.items():
        assert "channel A differs" in compare(covered(name, spoil), reference).text(), name


@pytest.mark.parametrize("kind", [oiio.FLOAT, oiio.UINT])
def test_numbers_of_objects_are_equal_or_not(kind: oiio.TypeDesc, tmp_path: Path) -> None:
    def numbered(name: str, index: int) -> Path:
        spec = oiio.ImageSpec(16, 16, 4, oiio.FLOAT)
        spec.channelnames, spec.channelformats = ("R", "G", "B", "objectId"), (oiio.FLOAT, oiio.FLOAT, oiio.FLOAT, kind)
        image = oiio.ImageBuf(spec)
        # Integers are fractions of the largest one to OpenImageIO.
        value = index if kind == oiio.FLOAT else index / 2**32
        image.set_pixels(spec.roi, np.full((16, 16, 4), [1.0, 1.0, 1.0, value], np.float32))
        assert image.write(str(tmp_path / name)), image.geterror()
        return tmp_path / name

    reference = numbered("a.exr", 500)
    assert compare(numbered("b.exr", 500), reference).outcome is Outcome.PASS
    verdict = compare(numbered("c.exr", 501), reference)
    assert "channel objectId differs in 100 %" in verdict.text()


def test_numbers_beyond_floats_are_told_apart(tmp_path: Path) -> None:
    def numbered(name: str, number: int) -> Path:
        spec = oiio.ImageSpec(8, 8, 4, oiio.FLOAT)
        spec.channelnames = ("R", "G", "B", "id.I")
        spec.channelformats = (oiio.FLOAT, oiio.FLOAT, oiio.FLOAT, oiio.UINT32)
        pixels = np.zeros((8, 8, 4), np.uint32)
        pixels[..., 3] = number
        output = oiio.ImageOutput.create(str(tmp_path / name))
        assert output.open(str(tmp_path / name), spec)
        assert output.write_image(pixels), output.geterror()
        output.close()
        return tmp_path / name

    right = numbered("reference.exr", 0x12345678)
    assert read(right).plane("id.I")[0, 0] == 0x12345678
    assert gates(compare(numbered("same.exr", 0x12345678), right))["exact"] is Status.PASS
    verdict = compare(numbered("new.exr", 0x1234567F), right)
    assert gates(verdict)["numbers"] is Status.FAIL


def test_layers_that_are_brighter_as_a_whole_are_found(tmp_path: Path) -> None:
    # Where neighbours differ, one value may be any that lies between them, but not all may be larger.
    checks = 0.45 + 0.05 * (-1.0) ** np.add.outer(np.arange(72), np.arange(96))

    def textured(seed: int, gain: float) -> File:
        image = file(seed=seed)
        layer = gain * checks * (1 + 0.001 * np.random.default_rng(seed).normal(size=checks.shape))
        image.pixels = np.concatenate([image.pixels, layer[..., None]], axis=2)
        image.channels = (*image.channels, "albedo.R")
        return image

    right = textured(1, 1).write(tmp_path / "reference.exr")
    assert compare(textured(2, 1).write(tmp_path / "same.exr"), right).outcome is Outcome.PASS
    verdict = compare(textured(2, 1.12).write(tmp_path / "new.exr"), right)
    assert gates(verdict)["numbers"] is Status.FAIL
    assert "the mean of channel albedo.R differs" in verdict.text()
