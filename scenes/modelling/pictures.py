"""Pictures for walls, and lettering for signs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .mesh import Array
from .noise import coloured, mix, smooth_step
from .textures import Colour


def landscape(width: int, height: int, seed: int, sky: Sequence[Colour], hills: Sequence[Colour], sun: Colour) -> Array:
    """Layered hills under a graded sky with a low sun, with the grain of a print."""
    y, x = np.meshgrid(np.linspace(0, 1, height), np.linspace(0, 1, width), indexing="ij")
    image = mix(sky[0], sky[1], np.clip(y * 1.6, 0, 1))
    rng = np.random.default_rng(seed)
    centre = rng.uniform(0.25, 0.75), rng.uniform(0.3, 0.42)
    distance = np.hypot((x - centre[0]) * width / height, y - centre[1])
    image = mix(image, sun, 1 - smooth_step(0.10, 0.106, distance))
    for index, colour in enumerate(hills):
        ridge = coloured((1, width), seed + index, 1.5, 1.0)[0] * (0.035 + 0.008 * index)
        line = 0.46 + 0.5 * index / len(hills) + ridge
        depth = y - line[None, :]
        shade = np.asarray(colour) * (0.85 + 0.3 * np.clip(depth * 2.2, 0, 1))[..., None]
        image = np.where((depth > 0)[..., None], shade, image)
    grain = 1.0 + 0.03 * coloured((height, width), seed + 99, 0.4)
    return np.clip(image * grain[..., None], 0, 1)


def discs(size: int, seed: int, paper: Colour, inks: Sequence[Colour]) -> Array:
    """An abstract print: overlapping discs and bars of transparent ink."""
    rng = np.random.default_rng(seed)
    y, x = np.meshgrid(np.linspace(0, 1, size), np.linspace(0, 1, size), indexing="ij")
    image = np.broadcast_to(paper, (size, size, 3)).copy()
    for index in range(9):
        ink = np.asarray(inks[index % len(inks)])
        centre, radius = rng.uniform(0.2, 0.8, 2), rng.uniform(0.06, 0.24)
        if index % 3 == 2:
            cover = (np.abs(x - centre[0]) < radius * 0.18) & (np.abs(y - centre[1]) < radius * 2.2)
        else:
            cover = np.hypot(x - centre[0], y - centre[1]) < radius
        image = np.where(cover[..., None], image * ink, image)
    grain = 1.0 + 0.025 * coloured((size, size), seed + 50, 0.5)
    return np.clip(image * grain[..., None], 0, 1)
