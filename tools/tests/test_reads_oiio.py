"""Ajar reads what OpenImageIO writes, which shares no code with its reader; and the other way round, by `oiiotool`.

A light with the image as its texture fills the frame of an orthographic camera, one texel a pixel.
"""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from ajar_tools import Outcome, compare, read

WIDTH, HEIGHT = 32, 24
SCENE = """
[[camera]]
position = [0, 0, 1]
target = [0, 0, 0]
half_height = 0.5

[[light]]
type = "rect"
rotate = [0, 180, 0]
width = {width}
height = 1
texture = {{ file = "texture.exr", filter = "nearest" }}

[render]
size = [{size[0]}, {size[1]}]
"""
# Of OpenImageIO: type, compression, tile side (0: lines), relative error that the compression may make.
KINDS = {
    "half, no compression": (oiio.HALF, "none", 0, 0.0),
    "float, no compression, tiles": (oiio.FLOAT, "none", 16, 0.0),
    "half, zip": (oiio.HALF, "zip", 0, 0.0),
    "float, zip, tiles": (oiio.FLOAT, "zip", 16, 0.0),
    "float, zips": (oiio.FLOAT, "zips", 0, 0.0),
    "half, piz": (oiio.HALF, "piz", 0, 0.0),
    "float, piz, tiles": (oiio.FLOAT, "piz", 8, 0.0),
    "half, rle, tiles": (oiio.HALF, "rle", 16, 0.0),
    "float, rle": (oiio.FLOAT, "rle", 0, 0.0),
    "half, pxr24": (oiio.HALF, "pxr24", 0, 0.0),
    "float, pxr24": (oiio.FLOAT, "pxr24", 0, 1e-4),
    "half, b44": (oiio.HALF, "b44", 0, 0.1),
    "half, dwaa": (oiio.HALF, "dwaa", 0, 0.1),
    "float, dwab": (oiio.FLOAT, "dwab", 0, 0.1),
}


def spec_of(channels: str | list[str], kind: oiio.TypeDesc = oiio.HALF, compression: str = "zip") -> oiio.ImageSpec:
    spec = oiio.ImageSpec(WIDTH, HEIGHT, len(channels), kind)
    spec.channelnames = tuple(channels)
    spec.attribute("compression", compression)
    return spec


def write(path: Path, spec: oiio.ImageSpec) -> np.ndarray:
    """Writes values of all sizes, smooth enough for any compression; returns what OpenImageIO itself reads."""
    y, x = np.mgrid[: spec.height, : spec.width]
    scale = 2.0 ** np.arange(-2, spec.nchannels - 2)
    pixels = scale * (1.1 + np.sin(x / 5)[..., None] * np.cos(y / 7)[..., None]) + (x > y)[..., None]
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    assert output.write_image(np.ascontiguousarray(pixels, np.float32)), output.geterror()
    assert output.close()
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))


def ajar(*arguments: object) -> subprocess.CompletedProcess[str]:
    binary = os.environ.get("AJAR_BIN")
    if not binary:
        pytest.skip("AJAR_BIN does not name an ajar program")
    return subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True, timeout=300)


def show(folder: Path, width: int = WIDTH, height: int = HEIGHT) -> subprocess.CompletedProcess[str]:
    """Renders the light."""
    (folder / "scene.toml").write_text(SCENE.format(width=width / height, size=(width, height)))
    options = ("--integrator", "path", "--spp", 1, "--float", "--quiet")
    return ajar("render", folder / "scene.toml", "-o", folder / "out.exr", *options)


def shown(folder: Path, width: int = WIDTH, height: int = HEIGHT) -> np.ndarray:
    """Its pixels."""
    done = show(folder, width, height)
    assert done.returncode == 0, done.stderr
    return read(folder / "out.exr").color


@pytest.mark.parametrize("name", KINDS)
def test_types_compressions_lines_and_tiles(name: str, tmp_path: Path) -> None:
    kind, compression, tile, error = KINDS[name]
    spec = spec_of("RGB", kind, compression)
    spec.tile_width = spec.tile_height = tile
    written = write(tmp_path / "texture.exr", spec)
    assert shown(tmp_path) == pytest.approx(written, rel=max(error, 1e-6))


@pytest.mark.parametrize(
    ("channels", "seen"),
    [
        (["R", "G", "B", "A"], ["R", "G", "B"]),
        (["Y"], ["Y", "Y", "Y"]),
        (["height"], ["height", "height", "height"]),
        (["Z", "B", "albedo.R", "G", "N.X", "R"], ["R", "G", "B"]),
    ],
)
def test_channels_are_found_by_name(channels: list[str], seen: list[str], tmp_path: Path) -> None:
    written = write(tmp_path / "texture.exr", spec_of(channels))
    stored = list(oiio.ImageBuf(str(tmp_path / "texture.exr")).spec().channelnames)
    assert shown(tmp_path) == pytest.approx(written[..., [stored.index(name) for name in seen]], rel=1e-6)


@pytest.mark.parametrize("window", [(4, 3, 40, 32), (-5, -2, 20, 16), (-4, 6, 32, 24)])
def test_pixels_lie_in_the_display_window(window: tuple[int, int, int, int], tmp_path: Path) -> None:
    """A part of the frame, more than the frame, and both."""
    x, y, width, height = window
    spec = spec_of("RGB")
    spec.x, spec.y, spec.full_x, spec.full_y, spec.full_width, spec.full_height = x, y, 0, 0, width, height
    written = write(tmp_path / "texture.exr", spec)
    frame = np.zeros((HEIGHT + 100, WIDTH + 100, 3), np.float32)
    frame[50 + y : 50 + y + HEIGHT, 50 + x : 50 + x + WIDTH] = written
    assert shown(tmp_path, width, height) == pytest.approx(frame[50 : 50 + height, 50 : 50 + width], rel=1e-6)


def test_of_several_parts_the_first_is_read(tmp_path: Path) -> None:
    spec, path = spec_of("RGB", oiio.FLOAT), tmp_path / "texture.exr"
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), (spec, spec))
    assert output.write_image(np.full((HEIGHT, WIDTH, 3), 3.0, np.float32))
    assert output.open(str(path), spec, "AppendSubimage")
    assert output.write_image(np.full((HEIGHT, WIDTH, 3), 5.0, np.float32))
    assert output.close()
    assert shown(tmp_path) == pytest.approx(3.0)


def truncated(path: Path) -> None:
    write(path, spec_of("RGB", compression="none"))
    path.write_bytes(path.read_bytes()[:-900])


UNREADABLE: dict[str, Callable[[Path], object]] = {
    "channels of which none is a colour": lambda path: write(path, spec_of(["N.X", "N.Y", "N.Z"])),
    "truncated": truncated,
    "no image": lambda path: path.write_text("picture"),
    "empty": Path.touch,
}


@pytest.mark.parametrize("name", UNREADABLE)
def test_what_cannot_be_read_is_an_error_that_names_the_file(name: str, tmp_path: Path) -> None:
    UNREADABLE[name](tmp_path / "texture.exr")
    done = show(tmp_path)
    assert done.returncode == 3
    assert "texture.exr" in done.stderr
    assert not (tmp_path / "out.exr").exists()


@pytest.mark.parametrize("arguments", [["--compression", "piz"], ["--tile", "16", "16"], ["-d", "float"]])
def test_what_oiiotool_makes_of_a_render_is_the_same_picture(arguments: list[str], tmp_path: Path) -> None:
    """Ajar to OpenImageIO to the comparison, noise and all; and as a texture back into Ajar."""
    write(tmp_path / "texture.exr", spec_of("RGB"))
    shown(tmp_path)
    rendered, copy = tmp_path / "out.exr", tmp_path / "copy.exr"
    tool = Path(sys.executable).with_name("oiiotool")
    subprocess.run([tool, rendered, *arguments, "-o", copy], check=True, timeout=60)
    verdict = compare(copy, rendered)
    assert verdict.outcome is Outcome.PASS, verdict.text()
    assert verdict.gates[-1].gate == "exact"
    before = read(rendered).color
    copy.replace(tmp_path / "texture.exr")
    assert shown(tmp_path) == pytest.approx(before, rel=1e-6)
