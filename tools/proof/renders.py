"""Small renders of the repository's scenes, kept in target/proof for as long as the program stays the same."""

from __future__ import annotations

import hashlib
import os
import subprocess
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from ajar_tools import Picture, read
from synthetic import File, Recipe

ROOT = Path(__file__).parents[2]
SIZE = (48, 32)
ROUNDS = 16
LAYERS = "albedo,normal,depth"
# Edges of the longest path: enough for glass and doors, and cheap.
DEPTH = 6
# Seed of what others are compared with, and how much longer it is rendered.
REFERENCE, LONGER = 1000, 4


@dataclass(frozen=True)
class Render:
    """What is asked of Ajar."""

    scene: str
    integrator: str
    seed: int
    rounds: int = ROUNDS
    changes: tuple[str, ...] = ()
    samples: int = 1
    """A pixel, in a round: few make renders cheap and their noise as skewed as it gets."""

    @property
    def path(self) -> Path:
        """Where it is kept."""
        changes = hashlib.sha256(repr(self.changes).encode()).hexdigest()[:8] if self.changes else ""
        return folder() / f"{self.scene}-{self.integrator}-{self.seed}-{self.rounds}x{self.samples}{changes}.exr"

    def run(self) -> None:
        """Renders, on one thread."""
        width, height = SIZE
        scene = ROOT / "scenes" / self.scene / "scene.toml"
        begun = self.path.with_name(f"part-{self.path.name}")
        arguments = ["--integrator", self.integrator, "--seed", str(self.seed), "--size", f"{width}x{height}"]
        arguments += ["--threads", "1", "--max-depth", str(DEPTH), "--aov", LAYERS, *sets(self.changes)]
        in_rounds(scene, begun, self.rounds, self.samples, arguments)
        begun.rename(self.path)

    def file(self) -> File:
        """The image, to be spoiled and written again."""
        picture = read(self.path)
        assert picture.attributes["samplesPerPixel"] == self.samples * self.rounds
        return spoilable(picture)


def sets(changes: Iterable[str]) -> list[str]:
    """Arguments that change a scene."""
    return [word for change in changes for word in ("--set", change)]


def in_rounds(scene: Path, output: Path, rounds: int, samples: int, arguments: list[str]) -> None:
    """Renders so many rounds of so many samples a pixel: one of them, and then the other ones as that one is."""
    saved = output.with_suffix(".checkpoint")
    command = [program(), "render", str(scene), "-o", str(output), "--quiet", *arguments]
    first = ["--spp", str(8 * samples), "--rounds", "1", "--checkpoint", str(saved)]
    subprocess.run([*command, *first], check=True)
    subprocess.run([*command, "--rounds", str(rounds), "--resume", str(saved)], check=True)
    saved.unlink()


def spoilable(picture: Picture) -> File:
    """An image of Ajar's, to be spoiled and written again."""
    assert picture.statistics is not None
    colors = ("R", "G", "B", "A")
    channels = (*colors, *(name for name in picture.channels if name not in colors))
    pixels = np.stack([picture.plane(name) for name in channels], axis=2)
    window, rounds = picture.data_window, picture.statistics.rounds
    recipe = Recipe(window.width, window.height, rounds=rounds, seed=int(picture.attributes["ajar:seed"]))
    return File(
        pixels, dict(picture.statistics.variances), recipe, channels, oiio.FLOAT, picture.attributes["ajar:integrator"]
    )


def program() -> str:
    """The `ajar` to render with."""
    return os.environ.get("AJAR_BIN") or str(ROOT / "target/release/ajar")


@cache
def folder() -> Path:
    """The images of this program."""
    digest = hashlib.sha256(Path(program()).read_bytes()).hexdigest()[:12]
    path = ROOT / "target" / "proof" / digest
    path.mkdir(parents=True, exist_ok=True)
    return path


def make(renders: Iterable[Render]) -> None:
    """Renders what is missing, as many at once as there are cores."""
    missing = [render for render in dict.fromkeys(renders) if not render.path.exists()]
    print(f"{len(missing)} renders", flush=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(Render.run, missing))
