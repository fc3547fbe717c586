"""Makes docs/door-ajar.jpg, figure 6 of Veach and Guibas (1997) made again, and prints the errors of its halves.

    cargo build --release && .venv/bin/python tools/proof/door_ajar.py [--seconds 150] [--reference 600]

`bdpt` and `mlt` render `scenes/door-ajar` side by side, each on one thread for the same time. The reference is `ajar`
on all threads with another seed, for longer; `mlt` with a third seed, as long, says how sure it is. Errors are
(x - r)^2 / (r^2 + (0.1 m)^2) of blocks of 2 x 2 pixels, means of the channels, with m the mean of the reference.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from ajar_tools.picture import read
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "scenes" / "door-ajar" / "scene.toml"
PICTURE = ROOT / "docs" / "door-ajar.jpg"
HALVES = ("bdpt", "mlt")
SIZE = "320x240"
GAP = 8


def start(program: str, exr: Path, integrator: str, seconds: float, seed: int, *flags: str) -> subprocess.Popen[bytes]:
    command = [program, "render", str(SCENE), "-o", str(exr), "--integrator", integrator, "--size", SIZE, "--float"]
    return subprocess.Popen([*command, "-q", "--time", f"{seconds}s", "--seed", str(seed), *flags])


def finish(*renders: subprocess.Popen[bytes]) -> None:
    for render in renders:
        if render.wait() != 0:
            raise SystemExit(f"{render.args} ended with {render.returncode}")


def blocks(exr: Path) -> np.ndarray:
    """Means of 2 x 2 pixels."""
    rgb = read(exr).color
    height, width, channels = rgb.shape
    return rgb.reshape(height // 2, 2, width // 2, 2, channels).mean((1, 3), dtype=np.float64)


def errors(image: np.ndarray, reference: np.ndarray) -> str:
    error = np.sort(((image - reference) ** 2 / (reference**2 + (0.1 * reference.mean()) ** 2)).mean(-1).reshape(-1))
    most = error[: int(0.99 * len(error))]
    values = (np.median(error), most.mean(), error.mean())
    return " | ".join(f"{value:.2g}" for value in values) + f" | {image.mean() / reference.mean():.3f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--seconds", type=float, default=150)
    parser.add_argument("--reference", type=float, default=600)
    parser.add_argument("--ajar", default=str(ROOT / "target" / "release" / "ajar"))
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        exr = {name: Path(folder, f"{name}.exr") for name in (*HALVES, "reference", "other")}
        finish(*(start(given.ajar, exr[it], it, given.seconds, 1, "--threads", "1") for it in HALVES))
        finish(start(given.ajar, exr["reference"], "ajar", given.reference, 2))
        finish(start(given.ajar, exr["other"], "mlt", given.reference, 3))
        reference = blocks(exr["reference"])
        print("| | median | mean of all but the worst percent | mean | brightness |\n|---|---|---|---|---|")
        for name in (*HALVES, "other"):
            print(f"| `{name}` | {errors(blocks(exr[name]), reference)} |")
        halves = [Image.open(exr[name].with_suffix(".png")).convert("RGB") for name in HALVES]
    width, height = halves[0].size
    picture = Image.new("RGB", (2 * width + GAP, height), "white")
    for at, half in zip((0, width + GAP), halves, strict=True):
        picture.paste(half, (at, 0))
    picture.save(PICTURE, quality=92)


if __name__ == "__main__":
    main()
