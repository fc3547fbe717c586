#!/usr/bin/env python3
"""How long `ajar-compare` needs for large images, with a report.

    .venv/bin/python tools/bench/compare.py [WIDTHxHEIGHT...]        default: 1920x1080 3840x2160

Images are synthetic, of half floats in Ajar's layout with albedo, normals and depth, and differ in one block and at the
edges of layers, so that all gates are asked. A last line holds FLIP against the program of its authors, at the size to
which large images are averaged for it.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import flip_evaluator
import numpy as np
import OpenImageIO as oiio

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from ajar_tools.flip import exposures_for, hdr_flip
from ajar_tools.gates.flip import MEDIAN_LUMINANCE, PIXELS_PER_DEGREE
from ajar_tools.settings import Settings
from ajar_tools.statistics import NAMES, block_means
from synthetic import File, Recipe, scene

NOISE = 0.1
LAYERS = ("albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "Z")
# Every so many rows one is an edge, whose samples scatter.
EDGES = 50


def image(width: int, height: int, seed: int) -> File:
    """An image whose pixels have independent noise, with the variances that follow."""
    rng = np.random.default_rng(seed)
    truth = scene(width, height).astype(np.float32)
    pixels = truth * rng.gamma(1 / NOISE**2, NOISE**2, (height, width, 1)).astype(np.float32)
    square = (NOISE * truth) ** 2
    # The variance of a mean of n is n times smaller.
    variances = {side: block_means(square, side) / block_means_count(width, height, side) for side in NAMES}
    alpha = np.ones((height, width, 1), np.float32)
    albedo = truth.copy()
    albedo[::EDGES] *= rng.uniform(0.5, 1, (albedo[::EDGES].shape[0], width, 1)).astype(np.float32)
    layers = (pixels, alpha, albedo, 2 * albedo - 1, 3 * albedo.sum(axis=2, keepdims=True))
    channels = ("R", "G", "B", "A", *LAYERS)
    return File(np.concatenate(layers, axis=2), variances, Recipe(width, height), channels, oiio.HALF)


def block_means_count(width: int, height: int, side: int) -> np.ndarray:
    """Pixels of every block."""
    if not side:
        return np.full((1, 1, 1), width * height)
    columns = np.diff(np.append(np.arange(0, width, side), width))
    rows = np.diff(np.append(np.arange(0, height, side), height))
    return (rows[:, None] * columns[None, :])[..., None]


def main(sizes: list[str]) -> None:
    """Prints a line a size."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        for size in sizes:
            width, height = map(int, size.split("x"))
            reference = image(width, height, 1).write(home / "reference.exr")
            spoiled = image(width, height, 2)
            spoiled.pixels[64:80, 64:80, :3] *= 1.5
            new = spoiled.write(home / "new.exr")
            report = home / "report.html"
            before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            command = [sys.executable, "-m", "ajar_tools", "compare", new, reference, "--html", report]
            done = subprocess.run(command, capture_output=True, text=True)
            wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
            assert done.returncode == 1, done.stdout + done.stderr
            cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            print(f"{size}: {wall:.2f} s, {cpu:.2f} s of CPU, report {report.stat().st_size / 1e6:.1f} MB")


def flip(width: int, height: int) -> None:
    """Prints how long FLIP takes, ours and its authors'."""
    new, reference = (np.ascontiguousarray(image(width, height, seed).pixels[..., :3], np.float32) for seed in (1, 2))
    stops = exposures_for(Settings().max_luminance, MEDIAN_LUMINANCE)
    parameters = {"startExposure": stops[0], "stopExposure": stops[-1], "numExposures": len(stops)}
    start = time.monotonic()
    hdr_flip(reference, new, stops, PIXELS_PER_DEGREE)
    between = time.monotonic()
    flip_evaluator.evaluate(reference, new, "HDR", applyMagma=False, parameters=parameters | {"ppd": PIXELS_PER_DEGREE})
    ours, theirs = between - start, time.monotonic() - between
    print(f"FLIP of {width}x{height}: {ours:.2f} s, flip-evaluator {theirs:.2f} s")


if __name__ == "__main__":
    main(sys.argv[1:] or ["1920x1080", "3840x2160"])
    flip(640, 360)
