"""What cannot be compared is exit code 2 and a sentence; never a pass, never a trace."""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from ajar_tools import CannotCompareError, Outcome, Settings, __version__, cli, compare, picture, read
from synthetic import file


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return file(seed=1).write(tmp_path_factory.mktemp("good") / "good.exr")


def write(path: Path, spec: oiio.ImageSpec) -> Path:
    image = oiio.ImageBuf(spec)
    image.set_pixels(spec.roi, np.ones((spec.height, spec.width, spec.nchannels), np.float32))
    assert image.write(str(path)), image.geterror()
    return path


def refused(path: Path, good: Path) -> str:
    """The sentence, the same whichever side the file is on."""
    for pair in ((path, good), (good, path)):
        verdict = compare(*pair)
        assert verdict.outcome is Outcome.CANNOT, verdict.text()
    assert verdict.problem.count("\n") == 0
    return verdict.problem


def test_missing(good: Path, tmp_path: Path) -> None:
    assert "does not exist" in refused(tmp_path / "missing.exr", good)


def test_folder(good: Path, tmp_path: Path) -> None:
    assert "is not a file" in refused(tmp_path, good)


def test_empty_file(good: Path, tmp_path: Path) -> None:
    (tmp_path / "empty.exr").touch()
    assert "is empty" in refused(tmp_path / "empty.exr", good)


def test_not_an_image(good: Path, tmp_path: Path) -> None:
    (tmp_path / "text.exr").write_text("not an image")
    assert "not an OpenEXR file" in refused(tmp_path / "text.exr", good)


def test_another_format(good: Path, tmp_path: Path) -> None:
    assert "not an OpenEXR file" in refused(write(tmp_path / "a.png", oiio.ImageSpec(8, 8, 3, oiio.UINT8)), good)


def test_truncated_anywhere(good: Path, tmp_path: Path) -> None:
    data = good.read_bytes()
    path = tmp_path / "cut.exr"
    for length in [5, 8, 40, 200, 800, *range(1500, len(data), len(data) // 12), len(data) - 1]:
        path.write_bytes(data[:length])
        assert refused(path, good)


def test_other_size(good: Path, tmp_path: Path) -> None:
    assert "never resampled" in refused(file(seed=1, width=95).write(tmp_path / "a.exr"), good)


def test_cropped(good: Path, tmp_path: Path) -> None:
    spec = oiio.ImageSpec(96, 72, 4, oiio.FLOAT)
    spec.x, spec.full_width = 8, 104
    assert "data windows differ" in refused(write(tmp_path / "a.exr", spec), good)


def test_crops_of_other_renderers_at_different_places(tmp_path: Path) -> None:
    """They have one size, and no pixel in common."""
    paths = []
    for left in (0, 20):
        spec = oiio.ImageSpec(50, 50, 3, oiio.FLOAT)
        spec.x, spec.full_width, spec.full_height = left, 96, 72
        paths.append(write(tmp_path / f"{left}.exr", spec))
    verdict = compare(*paths, Settings(other_renderer=True))
    assert verdict.outcome is Outcome.CANNOT
    assert "data windows differ: 50×50 at (0, 0)" in verdict.problem


def test_chromaticities_are_rounded_by_who_writes_them(tmp_path: Path) -> None:
    def primaries(name: str, white: float) -> Path:
        spec = oiio.ImageSpec(8, 8, 3, oiio.FLOAT)
        spec.attribute("chromaticities", "float[8]", (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, white))
        return write(tmp_path / name, spec)

    reference = primaries("a.exr", 0.329)
    assert compare(primaries("b.exr", 0.32902), reference).outcome is Outcome.PASS
    assert "chromaticities" in compare(primaries("c.exr", 0.3295), reference).headline()


def test_no_colours(good: Path, tmp_path: Path) -> None:
    spec = oiio.ImageSpec(96, 72, 1, oiio.FLOAT)
    spec.channelnames = ("Z",)
    with pytest.raises(CannotCompareError, match="neither"):
        _ = read(write(tmp_path / "z.exr", spec)).color


def test_a_report_of_files_without_colours(good: Path, tmp_path: Path) -> None:
    """A layer by its name alone: another picture where only one file has it, none to compare where both do."""
    spec = oiio.ImageSpec(96, 72, 3, oiio.FLOAT)
    spec.channelnames = ("beauty.R", "beauty.G", "beauty.B")
    layer = write(tmp_path / "layer.exr", spec)
    for pair, code in (((layer, good), 1), ((good, layer), 1), ((layer, layer), 2)):
        command = [sys.executable, "-m", "ajar_tools", "compare", *pair, "--html", tmp_path / "report.html"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120)
        assert done.returncode == code, done.stderr
        assert "beauty.R" in done.stdout + done.stderr
        assert "Traceback" not in done.stderr


def test_luminance_alone_has_no_statistics_of_colours(good: Path, tmp_path: Path) -> None:
    paths = []
    for seed, scale in ((1, 1.0), (2, 1.0), (3, 3.0)):
        grey = file(seed=seed, scale=scale, noise=0.05)
        grey.pixels, grey.channels = grey.pixels[..., :1], ("Y",)
        paths.append(grey.write(tmp_path / f"{seed}.exr"))
    reference, twin, other = paths
    verdict = compare(twin, reference)
    assert verdict.outcome is Outcome.PASS, verdict.text()
    assert compare(other, reference).outcome is Outcome.FAIL


def test_colours_of_whole_numbers(good: Path, tmp_path: Path) -> None:
    assert "whole numbers" in refused(write(tmp_path / "a.exr", oiio.ImageSpec(96, 72, 4, oiio.UINT)), good)


@pytest.mark.parametrize("name", ["samplesPerPixel", "ajar:mutationsPerSample"])
def test_attributes_that_should_be_numbers(name: str, good: Path, tmp_path: Path) -> None:
    image = oiio.ImageBuf(str(good))
    image.specmod().attribute(name, "many")
    path = tmp_path / "a.exr"
    assert image.write(str(path)), image.geterror()
    other = file(seed=2).write(tmp_path / "other.exr")
    assert f"{name} is no number" in refused(path, other)


def test_a_folder_that_cannot_be_written(good: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "ajar_tools", "compare", good, good, "--html", tmp_path / "no/folder/report.html"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2
    assert "cannot be written" in done.stderr


def test_several_parts(good: Path, tmp_path: Path) -> None:
    path, spec = tmp_path / "parts.exr", oiio.ImageSpec(8, 8, 3, oiio.FLOAT)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), (spec, spec))
    out.write_image(np.ones((8, 8, 3), np.float32))
    assert out.open(str(path), spec, "AppendSubimage")
    out.write_image(np.ones((8, 8, 3), np.float32))
    out.close()
    assert "several parts" in refused(path, good)


def test_deep(good: Path, tmp_path: Path) -> None:
    path, spec = tmp_path / "deep.exr", oiio.ImageSpec(4, 4, 2, oiio.FLOAT)
    spec.channelnames, spec.deep = ("A", "Z"), True
    samples = oiio.DeepData()
    samples.init(spec)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec)
    out.write_deep_image(samples)
    out.close()
    assert "deep" in refused(path, good)


def test_huge(good: Path) -> None:
    with pytest.raises(CannotCompareError, match="too large"):
        read(good, most_samples=1000)


def test_large_for_the_memory_that_is_there(good: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture, "LARGE", 1000)
    monkeypatch.setattr(picture, "available_memory", lambda: 1e5)
    with pytest.raises(CannotCompareError, match=r"27,648 samples need 0\.0 GB of memory, of which 0\.0 GB are there"):
        read(good)
    monkeypatch.setattr(picture, "available_memory", lambda: 1e9)
    assert read(good).channels


def test_the_memory_that_is_there_is_known() -> None:
    assert picture.available_memory() > 1e8


def test_huge_by_its_header_alone(good: Path, tmp_path: Path) -> None:
    """The windows promise 10⁹ pixels that the file does not have; nobody may ask for the memory."""
    data = bytearray(good.read_bytes())
    for name in (b"dataWindow\0box2i\0", b"displayWindow\0box2i\0"):
        at = data.index(name) + len(name) + 4
        data[at + 8 : at + 16] = (39_999).to_bytes(4, "little") + (24_999).to_bytes(4, "little")
    path = tmp_path / "huge.exr"
    path.write_bytes(data)
    assert refused(path, good)


def test_random_damage_never_passes_unnoticed(good: Path, tmp_path: Path) -> None:
    """Damaged pixels are an error or another picture; only bytes that mean nothing may pass."""
    data, rng = good.read_bytes(), np.random.default_rng(11)
    path = tmp_path / "damaged.exr"
    clean = read(good).pixels
    for _ in range(60):
        spoiled = bytearray(data)
        for at in rng.integers(2000, len(data), 3):
            spoiled[at] ^= int(rng.integers(1, 256))
        path.write_bytes(spoiled)
        verdict = compare(path, good)
        if verdict.outcome is Outcome.PASS:
            assert np.abs(read(path).pixels - clean).mean() < 1e-3


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text here")
def test_names_that_are_no_text(good: Path) -> None:
    name = good.with_name("\udcff.exr")
    name.write_bytes(good.read_bytes())
    assert "has a name that is not UTF-8" in refused(name, good)


def test_terminals_that_cannot_show_a_verdict(good: Path) -> None:
    command = [sys.executable, "-m", "ajar_tools", "compare", good, good]
    done = subprocess.run(command, capture_output=True, env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0, done.stderr


def test_a_verdict_as_json_stands_alone(good: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = file(seed=1, scale=2).write(tmp_path / "other.exr")
    assert cli.main([str(other), str(good), "--json", "-", "--github"]) == 1
    said = capsys.readouterr()
    assert json.loads(said.out)["outcome"] == "fail"
    assert said.err.startswith("::error")


def test_the_version_is_that_of_ajar(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(["--version"])
    assert end.value.code == 0
    assert capsys.readouterr().out == f"ajar-compare {__version__}\n"
    cargo = tomllib.loads((Path(__file__).parents[2] / "Cargo.toml").read_text("utf-8"))
    assert cargo["workspace"]["package"]["version"] == __version__


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["good", "good"], 0),
        (["good", "missing.exr"], 2),
        (["good"], 2),
        (["good", "good", "--alpha", "3"], 2),
        (["good", "good", "--alpha", "0"], 2),
    ],
)
def test_exit_codes(arguments: list[str], code: int, good: Path) -> None:
    arguments = [str(good) if word == "good" else word for word in arguments]
    command = [sys.executable, "-m", "ajar_tools", "compare", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == code
    assert "Traceback" not in done.stderr
