"""Images with known noise and honest statistics, made without a renderer."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from ajar_tools import Picture
from ajar_tools.statistics import NAMES, as_attributes, block_means

Change = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Recipe:
    """A picture and its noise."""

    width: int = 96
    height: int = 72
    rounds: int = 16
    noise: float = 0.3
    """Standard deviation of a pixel in one round, relative to its value; the distribution is skewed like light."""
    shared: float = 0.0
    """The part of the noise that all pixels of a 4×4 square share, as a chain's."""
    seed: int = 1
    scale: float = 1.0
    equal_rounds: bool = False
    """Every round is the first one again: a seed that was used twice."""


def scene(width: int, height: int) -> np.ndarray:
    """A picture without noise: a gradient, discs, a dark corner."""
    y, x = np.mgrid[:height, :width] / np.array([height, width])[:, None, None]
    color = np.stack([0.2 + x, 0.3 + 0.5 * y, 0.4 + 0.3 * x * y], axis=-1)
    color[(x - 0.3) ** 2 + (y - 0.4) ** 2 < 0.04] = (0.9, 0.2, 0.1)
    color[(x - 0.7) ** 2 + (y - 0.6) ** 2 < 0.03] = (3.0, 2.5, 2.0)
    color[(x > 0.85) & (y > 0.85)] = 0.01
    return color


def render(recipe: Recipe) -> tuple[np.ndarray, dict[int, np.ndarray]]:
    """Mean and block variances over the rounds, which are never held all at once."""
    rng = np.random.default_rng(recipe.seed)
    truth = scene(recipe.width, recipe.height) * recipe.scale
    shape = 1 / recipe.noise**2
    total = np.zeros_like(truth)
    sums = {side: np.zeros_like(block_means(truth, side)) for side in NAMES}
    squares = {side: np.zeros_like(value) for side, value in sums.items()}
    for index in range(recipe.rounds):
        if index == 0 or not recipe.equal_rounds:
            image = truth * gamma_noise(rng, recipe, shape)
        total += image
        for side in NAMES:
            means = block_means(image, side)
            sums[side] += means
            squares[side] += means**2
    n = recipe.rounds
    variances = {s: np.maximum(squares[s] / n - (sums[s] / n) ** 2, 0) / (n - 1) for s in NAMES}
    return total / n, variances


def gamma_noise(rng: np.random.Generator, recipe: Recipe, shape: float) -> np.ndarray:
    """Factors of mean 1; a part is shared by neighbours."""
    size = (recipe.height, recipe.width, 1)
    own = rng.gamma(shape, 1 / shape, size)
    if not recipe.shared:
        return own
    small = (-(-recipe.height // 4), -(-recipe.width // 4), 1)
    common = rng.gamma(shape, 1 / shape, small).repeat(4, 0).repeat(4, 1)[: recipe.height, : recipe.width]
    return (1 - recipe.shared) * own + recipe.shared * common


@dataclass
class File:
    """What goes into an OpenEXR file; tests spoil it before it is written."""

    pixels: np.ndarray
    variances: dict[int, np.ndarray]
    recipe: Recipe
    channels: tuple[str, ...] = ("R", "G", "B", "A")
    kind: oiio.TypeDesc = oiio.FLOAT
    integrator: str = "path"

    def write(self, path: Path) -> Path:
        """Writes it as Ajar would."""
        height, width, count = self.pixels.shape
        spec = oiio.ImageSpec(width, height, count, self.kind)
        spec.channelnames = self.channels
        spec.attribute("ajar:rounds", self.recipe.rounds)
        spec.attribute("samplesPerPixel", self.recipe.rounds * 4)
        spec.attribute("ajar:integrator", self.integrator)
        spec.attribute("ajar:sceneHash", "synthetic")
        spec.attribute("ajar:seed", str(self.recipe.seed))
        spec.attribute("ajar:complete", 1)
        for side, values in self.variances.items():
            flat = values.astype(np.float32).reshape(-1)
            spec.attribute(NAMES[side], oiio.TypeDesc(f"float[{flat.size}]"), flat)
        image = oiio.ImageBuf(spec)
        image.set_pixels(spec.roi, np.ascontiguousarray(self.pixels, np.float32))
        assert image.write(str(path)), image.geterror()
        return path


def file(recipe: Recipe | None = None, change: Change | None = None, **changes: object) -> File:
    """A rendered file; `change` is applied to its colours."""
    recipe = replace(recipe or Recipe(), **changes)
    mean, variances = render(recipe)
    if change:
        mean = change(mean)
    alpha = np.ones((*mean.shape[:2], 1))
    return File(np.concatenate([mean, alpha], axis=2), variances, recipe)


def brighter(picture: Picture, factor: float) -> Picture:
    """With other energy: colours, and the noise that is declared of them, times `factor`."""
    statistics = picture.statistics
    assert statistics is not None
    pixels = picture.pixels.copy()
    pixels[..., [picture.channels.index(name) for name in picture.color_channels]] *= factor
    variances = {side: variance * factor**2 for side, variance in statistics.variances.items()}
    attributes = picture.attributes | as_attributes(replace(statistics, variances=variances))
    return replace(picture, pixels=pixels, attributes=attributes)
