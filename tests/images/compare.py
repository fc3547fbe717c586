"""Renders of a scene and their comparison with a stored reference, as far as chance allows."""

import os
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

ROOT = Path(__file__).parents[2]
SIZE = (48, 36)
BLOCK = 6

# Path tracing alone would need hours for a door ajar and for caustics.
CASES = [
    ("caustic-glass", "bdpt"),
    ("cornell", "bdpt"),
    ("cornell", "path"),
    ("door-ajar", "bdpt"),
    ("many-lights", "path"),
    ("materials", "path"),
    ("window-room", "path"),
]


def reference(scene: str) -> Path:
    return Path(__file__).parent / scene / "reference.exr"


def render(scene: str, integrator: str, target: Path, rounds: int, seed: int) -> None:
    """Renders full floats with the variance of every pixel."""
    source = ROOT / "scenes" / scene / "scene.toml"
    command = [os.environ["AJAR_BIN"], "render", source, "--integrator", integrator, "-o", target]
    command += ["--size", f"{SIZE[0]}x{SIZE[1]}", "--rounds", str(rounds), "--seed", str(seed)]
    subprocess.run([*command, "--aov", "variance", "--float", "--quiet"], check=True, timeout=1200)


def load(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Means and variances of the means, rows × columns × RGB."""
    image = oiio.ImageBuf(str(path))
    pixels = image.get_pixels(oiio.FLOAT).astype(np.float64)
    names = list(image.spec().channelnames)
    pick = [[names.index(prefix + c) for c in "RGB"] for prefix in ("", "variance.")]
    return pixels[..., pick[0]], pixels[..., pick[1]]


def blocks(values: np.ndarray) -> np.ndarray:
    """Means of square blocks."""
    rows, columns, channels = values.shape
    return values.reshape(rows // BLOCK, BLOCK, columns // BLOCK, BLOCK, channels).mean((1, 3))


def z_scores(a: Path, b: Path) -> tuple[float, float]:
    """The largest |z| of all blocks, and that of the whole image."""
    (mean_a, variance_a), (mean_b, variance_b) = load(a), load(b)
    difference, variance = mean_a - mean_b, variance_a + variance_b
    # Float rounding is not noise.
    floor = (1e-4 * np.maximum(mean_a, mean_b)) ** 2 + 1e-24
    z = np.abs(blocks(difference)) / np.sqrt(blocks(variance + floor) / BLOCK**2)
    count = difference.shape[0] * difference.shape[1]
    total = np.abs(difference.mean((0, 1))) / np.sqrt((variance + floor).mean((0, 1)) / count)
    return float(z.max()), float(total.max())
