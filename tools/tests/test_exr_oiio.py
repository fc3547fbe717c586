"""OpenImageIO, which shares no code with the writer, reads what `ajar render` wrote.

The scene is the Cornell box: its camera stands at (0, 1, 4.8) and looks along -Z with a vertical angle of 29.6 degrees.
"""

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from ajar_tools import read

SCENE = Path(__file__).parents[2] / "scenes" / "cornell" / "scene.toml"
HALF_EXTENT = 4.8 * math.tan(math.radians(29.6) / 2)


def render(target: Path, *arguments: str) -> Path:
    binary = os.environ.get("AJAR_BIN")
    if not binary:
        pytest.skip("AJAR_BIN does not name an ajar program")
    command = [binary, "render", SCENE, "--size", "32x32", "--spp", "4", *arguments, "-o", target]
    subprocess.run(command, check=True, timeout=300)
    return target


@pytest.fixture(scope="module")
def full_frame(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return render(tmp_path_factory.mktemp("full") / "out.exr", "--aov", "albedo,normal,depth")


@pytest.fixture(scope="module")
def spec(full_frame: Path) -> oiio.ImageSpec:
    return oiio.ImageBuf(str(full_frame)).spec()


def transformed(point: tuple[float, float, float], spec: oiio.ImageSpec, name: str) -> np.ndarray:
    """The point as a row vector times the matrix attribute, divided by w."""
    image = np.array([*point, 1.0]) @ np.array(spec.getattribute(name)).reshape(4, 4)
    return image[:3] / image[3]


LAYERS = "albedo,normal,geometric_normal,depth,position,uv,material_id,object_id,variance"
KINDS = {
    "all layers": ["--aov", LAYERS],
    "floats": ["--aov", LAYERS, "--float"],
    "crop": ["--crop", "0.25,0.75,0.5,1", "--aov", LAYERS],
    "one round": ["--rounds", "1"],
    "bdpt": ["--integrator", "bdpt"],
    "mlt": ["--integrator", "mlt"],
    "ajar": ["--integrator", "ajar"],
}


@pytest.mark.parametrize("kind", KINDS)
def test_oiiotool_reads_every_kind_and_finds_every_pixel_finite(kind: str, tmp_path: Path) -> None:
    tool = Path(sys.executable).with_name("oiiotool")
    command = [tool, "--info", "-v", "--stats", render(tmp_path / "out.exr", *KINDS[kind])]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    assert done.stderr == ""
    counts = {name: set(line.split()[2:]) for line in done.stdout.splitlines() for name in [line.strip()[6:14]]}
    assert counts["NanCount"] == {"0"}
    assert counts["InfCount"] == {"0"}
    read(tmp_path / "out.exr")


def test_what_is_merged_is_read_too(tmp_path: Path) -> None:
    saved = [tmp_path / f"{i}.ckpt" for i in range(2)]
    for i, path in enumerate(saved):
        render(tmp_path / "part.exr", "--shard", f"{i}/2", "--rounds", "4", "--checkpoint", str(path))
    merged = tmp_path / "merged.exr"
    subprocess.run([os.environ["AJAR_BIN"], "merge", *saved, "-o", merged], check=True, capture_output=True)
    image = oiio.ImageBuf(str(merged))
    assert image.spec().full_width == 32
    assert np.isfinite(image.get_pixels(oiio.FLOAT)).all()
    assert read(merged).attributes["ajar:rounds"] == 4


def test_beauty_comes_first_then_named_layers(spec: oiio.ImageSpec) -> None:
    names = list(spec.channelnames)
    assert names[:4] == ["R", "G", "B", "A"]
    assert {"albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "Z"} <= set(names)


def test_colour_is_half_and_depth_is_float(spec: oiio.ImageSpec) -> None:
    formats = {name: str(spec.channelformat(i)) for i, name in enumerate(spec.channelnames)}
    assert {formats[name] for name in ("R", "G", "B", "A", "albedo.R")} == {"half"}
    assert formats["Z"] == "float"


def test_the_walls_have_light(full_frame: Path) -> None:
    pixels = oiio.ImageBuf(str(full_frame)).get_pixels(oiio.FLOAT)
    assert pixels.shape[:2] == (32, 32)
    assert (pixels[..., :3].mean(axis=(0, 1)) > 0.01).all()


def test_metadata(spec: oiio.ImageSpec) -> None:
    assert spec.getattribute("software").startswith("ajar ")
    assert spec.getattribute("samplesPerPixel") == 4
    assert spec.getattribute("renderTimeSeconds") > 0
    assert spec.getattribute("renderTime").count(":") == 2
    assert spec.getattribute("DateTime")
    assert spec.getattribute("colorInteropID") == "lin_rec709_scene"
    assert spec.getattribute("chromaticities")[:2] == pytest.approx((0.64, 0.33))
    assert spec.getattribute("compression") == "zip"
    assert spec.getattribute("ajar:integrator") == "path"
    assert spec.getattribute("ajar:complete") == 1
    assert spec.getattribute("ajar:rounds") > 0
    assert spec.getattribute("ajar:seed").isdigit()
    assert spec.getattribute("ajar:sceneHash")
    assert spec.getattribute("ajar:shard") is None
    assert spec.getattribute("owner") is None


def test_world_to_camera_is_left_handed_and_looks_along_z(spec: oiio.ImageSpec) -> None:
    seen = transformed((0.25, 1.5, 1.0), spec, "worldToCamera")
    assert seen == pytest.approx((0.25, 0.5, 3.8), abs=1e-5)


@pytest.mark.parametrize(
    ("point", "corner"),
    [
        ((0, 1, 0), (0.5, 0.5)),
        ((-HALF_EXTENT, 1 + HALF_EXTENT, 0), (0, 0)),
        ((HALF_EXTENT, 1 - HALF_EXTENT, 0), (1, 1)),
    ],
)
def test_world_to_ndc_has_its_origin_at_the_upper_left(
    spec: oiio.ImageSpec, point: tuple[float, float, float], corner: tuple[float, float]
) -> None:
    assert transformed(point, spec, "worldToNDC")[:2] == pytest.approx(corner, abs=1e-5)


def test_windows_of_a_full_frame(spec: oiio.ImageSpec) -> None:
    assert (spec.x, spec.y, spec.width, spec.height) == (0, 0, 32, 32)
    assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, 32, 32)


def test_windows_of_a_crop(tmp_path: Path) -> None:
    crop = render(tmp_path / "crop.exr", "--crop", "0.25,0.75,0.5,1")
    spec = oiio.ImageBuf(str(crop)).spec()
    assert (spec.x, spec.y, spec.width, spec.height) == (8, 16, 16, 16)
    assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, 32, 32)
