"""The same still through every format renders the same picture, but for noise."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from ajar_tools.cases import ajar
from ajar_tools.comparison import compare
from ajar_tools.verdict import Outcome

sys.path.insert(0, str(Path(__file__).parent))

import still

SCENE = """
[[import]]
file = "{file}"

[[camera]]
position = [0, 1.6, 4.6]
target = [0, 0.55, 0]
yfov = 40

[render]
integrator = "path"
size = [64, 48]
rounds = 16
"""


def usdc(path: Path) -> None:
    """Binary USD."""
    pxr = pytest.importorskip("pxr.Sdf", reason="usd-core is not installed")
    still.stage(path.with_suffix(".text.usda"))
    pxr.Layer.FindOrOpen(str(path.with_suffix(".text.usda"))).Export(str(path))


def usdz(path: Path) -> None:
    """USD in a package, with its image."""
    pxr = pytest.importorskip("pxr.UsdUtils", reason="usd-core is not installed")
    still.stage(path.with_suffix(".usda"))
    assert pxr.CreateNewUsdzPackage(str(path.with_suffix(".usda")), str(path))


def package(path: Path) -> None:
    """USD in a package, with MaterialX and its image."""
    pxr = pytest.importorskip("pxr.Sdf", reason="usd-core is not installed")
    still.materialx(path.with_suffix(".usda"), "standard_surface")
    writer = pxr.ZipFileWriter.CreateNew(str(path))
    for file in (path.with_suffix(".usda"), path.with_suffix(".mtlx"), path.with_name("print.png")):
        writer.AddFile(str(file), file.name)
    writer.Save()


FORMATS: dict[str, tuple[str, Callable[[Path], None]]] = {
    "gltf": ("still.gltf", still.gltf),
    "obj": ("still.obj", still.obj),
    "usda": ("still.usda", still.stage),
    "usdc": ("still.usdc", usdc),
    "usdz": ("still.usdz", usdz),
    "standard_surface": ("still.usda", lambda path: still.materialx(path, "standard_surface")),
    "package_of_materialx": ("still.usdz", package),
    "open_pbr": ("still.usda", lambda path: still.materialx(path, "open_pbr_surface")),
}


def render(folder: Path, file: str, make: Callable[[Path], None], seed: int) -> Path:
    """The picture of the still in one format."""
    folder.mkdir(exist_ok=True)
    still.save_picture(folder)
    make(folder / file)
    (folder / "scene.toml").write_text(SCENE.format(file=file), "utf-8")
    image = folder / "still.exr"
    # The importer of USD files runs on the packages that run this test.
    variables = {"AJAR_USD_PYTHON": sys.executable} | os.environ
    command = [ajar(), "render", str(folder / "scene.toml"), "-o", str(image), "--quiet", "--seed", str(seed)]
    done = subprocess.run([*command, "--strict"], capture_output=True, text=True, env=variables)
    assert done.returncode == 0, done.stderr
    return image


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The picture that all are compared with: that of the GLB, by another seed."""
    return render(tmp_path_factory.mktemp("glb"), "still.glb", still.glb, 100)


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_shows_the_same(name: str, reference: Path, tmp_path: Path) -> None:
    file, make = FORMATS[name]
    image = render(tmp_path, file, make, 1 + list(FORMATS).index(name))
    verdict = compare(image, reference)
    assert verdict.outcome is Outcome.PASS, [(gate.gate, gate.numbers) for gate in verdict.failures]


def test_two_percent_more_light_is_noticed(reference: Path, tmp_path: Path) -> None:
    image = render(tmp_path, "still.glb", lambda path: still.glb(path, 1.02), 50)
    assert compare(image, reference).outcome is Outcome.FAIL
