"""Makes docs/agreement.md: do all integrators, and each mutation beside the bidirectional one, show the same image?

    cargo build --release && .venv/bin/python tools/proof/agreement.py [--seconds 10] [SCENE...]

Every scene is rendered small by `bdpt`, for three times as long, and by every other way. Blocks of 8 x 8 pixels and
the whole image are compared by Welch's t-test from the spread of rounds. The table holds the largest |t| of all
blocks and channels, as the standard score that is as unlikely. What is beyond `LIMIT` is rendered again with other
seeds, both sides four times as long: a true difference doubles its score, what rare bright paths leave loses it.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from statistics import NormalDist

import numpy as np
from agreement_scenes import SCENES, write
from ajar_tools.gates.statistical import Level
from ajar_tools.picture import Picture, read
from ajar_tools.statistics import WHOLE
from ajar_tools.student import two_sided_t

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "agreement.md"
OURS = {
    "cornell": "scene.toml",
    "caustic-glass": "scene.toml",
    "door-ajar": "scene.toml",
    "many-lights": "scene.toml",
    "materials": "scene.toml",
    "reading-corner": "scene.toml",
    "tea-table": "look.toml",
    "window-room": "scene.toml",
}
MUTATIONS = (
    "bidirectional",
    "lens",
    "caustic",
    "multi-chain",
    "window",
    "technique",
    "eye-chain",
    "light-chain",
    "lens-subpath",
    "manifold",
)
SIZE = "64x48"
DEPTH = "10"
# Some hundred blocks and channels a scene, some hundred images: one score beyond it in a hundred tables.
LIMIT = 5.2
# How much longer what is beyond it is rendered again, and what is added to the seeds.
LONGER = 4
OTHER_SEEDS = 100


def ways() -> dict[str, list[str]]:
    """Columns of the table and the flags that make them."""
    columns = {"path": ["--integrator", "path"]}
    for name in MUTATIONS:
        off = [f"render.mutations.{other}=0" for other in MUTATIONS if other not in (name, "bidirectional")]
        flags = [word for setting in off for word in ("--set", setting)]
        columns[name if name == "bidirectional" else f"+ {name}"] = ["--integrator", "mlt", *flags]
    columns["mlt"] = ["--integrator", "mlt"]
    columns["ajar"] = ["--integrator", "ajar"]
    return columns


def render(program: str, scene: Path, exr: Path, seconds: float, seed: int, flags: Sequence[str]) -> Picture:
    command = [program, "render", str(scene), "-o", str(exr), "--size", SIZE, "--max-depth", DEPTH, "--float", "-q"]
    command += ["--time", f"{seconds}s", "--seed", str(seed), *flags, "--stats-json", str(stats_of(exr))]
    subprocess.run(command, check=True)
    return read(exr)


def stats_of(exr: Path) -> Path:
    return exr.with_suffix(".json")


def ran_chains(exr: Path) -> bool:
    return "chains" in json.loads(stats_of(exr).read_text())["details"]


def score(a: Picture, b: Picture, side: int) -> float:
    """The largest |t| of blocks and channels, as a standard score."""
    assert a.statistics is not None
    assert b.statistics is not None
    level = Level(a, b, a.statistics, b.statistics, side)
    p = two_sided_t(np.abs(level.t).reshape(-1), level.freedom.reshape(-1))
    return -NormalDist().inv_cdf(max(float(p.min()), 1e-300) / 2)


@dataclass(frozen=True)
class Trial:
    """One scene, its references and all ways beside them."""

    program: str
    name: str
    scene: Path
    seconds: float
    work: Path

    @cached_property
    def reference(self) -> Picture:
        return self.bdpt(1, 1)

    @cached_property
    def long_reference(self) -> Picture:
        return self.bdpt(LONGER, 1 + OTHER_SEEDS)

    def bdpt(self, longer: int, seed: int) -> Picture:
        seconds = 3 * longer * self.seconds
        return render(self.program, self.scene, self.work / "bdpt.exr", seconds, seed, ["--integrator", "bdpt"])

    def scores(self, way: str, flags: list[str], seed: int, longer: int = 1) -> tuple[float, float]:
        """Of blocks and of the whole image."""
        exr = self.work / f"{way}.exr"
        picture = render(self.program, self.scene, exr, longer * self.seconds, seed + (longer > 1) * OTHER_SEEDS, flags)
        reference = self.reference if longer == 1 else self.long_reference
        found = score(picture, reference, 8), score(picture, reference, WHOLE)
        print(f"{self.name:14} {way:14} {longer} blocks {found[0]:.2f} image {found[1]:.2f}", flush=True)
        return found

    def cell(self, way: str, flags: list[str], seed: int) -> str:
        found = self.scores(way, flags, seed)
        text = "{:.1f} / {:.1f}".format(*found)
        if way == "ajar" and not ran_chains(self.work / f"{way}.exr"):
            text += " °"
        if max(found) <= LIMIT:
            return text
        again = self.scores(way, flags, seed, LONGER)
        mark = " **!**" if max(again) > LIMIT else ""
        return f"{text}, then {again[0]:.1f} / {again[1]:.1f}{mark}"

    def row(self) -> str:
        cells = (self.cell(way, flags, seed) for seed, (way, flags) in enumerate(ways().items(), 2))
        return f"| {self.name} | " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("scenes", nargs="*", help="whose rows to make anew; default: all, and the page")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--ajar", default=str(ROOT / "target" / "release" / "ajar"))
    given = parser.parse_args()
    names = given.scenes or [*OURS, *SCENES]
    rows = {}
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            work = Path(folder, name)
            work.mkdir()
            scene = ROOT / "scenes" / name / OURS[name] if name in OURS else write(name, work)
            rows[name] = Trial(given.ajar, name, scene, given.seconds, work).row()
    if given.scenes:
        lines = PAGE.read_text().splitlines()
        PAGE.write_text("".join(rows.get(first_cell(line), line) + "\n" for line in lines))
    else:
        columns = ["scene", *ways()]
        head = HEAD.format(seconds=given.seconds, size=SIZE, depth=DEPTH, limit=LIMIT, longer=LONGER)
        table = [f"| {' | '.join(columns)} |", "|" + "---|" * len(columns), *rows.values()]
        PAGE.write_text(head + "\n".join(table) + "\n")
    print(f"wrote {PAGE}")


def first_cell(line: str) -> str:
    return line.removeprefix("| ").partition(" |")[0]


HEAD = """# All integrators show the same image

Made by `.venv/bin/python tools/proof/agreement.py --seconds {seconds:g}`: images of {size} pixels and paths of at
most {depth} edges, each way for {seconds:g} seconds, against `bdpt` for three times as long. A cell holds the
largest difference among blocks of 8×8 pixels and that of the whole image, as standard scores; both come from the
spread of independent rounds. Chance alone makes the largest of some hundred blocks and channels about 3. What is
beyond {limit} was rendered again with other seeds, both sides {longer} times as long, and stands after "then": a true
difference doubles its score by that, while rare bright paths, which short renders miss without knowing how much they
miss, come closer. What stays beyond {limit} is marked. The columns from `bidirectional` to `+ manifold` are `mlt` with
the bidirectional mutation and one other. Where `ajar` has a °, its first look found that chains would not pay: that
image is by path tracing alone.

Path tracing seldom finds the light that glass or water gathers from a lamp: in `caustic-glass` and `pool` its blocks
stay too dark for longer than this, and know too little of their noise.

`lens` has depth of field; `lattice` textures, normal maps, cut-outs and a half-transparent sheet; `pool` light that
reaches the camera through moving water both ways; `window-room` sun and sky; `many-lights` some hundred lamps.

"""

if __name__ == "__main__":
    sys.exit(main())
