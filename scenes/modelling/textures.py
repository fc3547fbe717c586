"""Procedural surface textures: wood, plaster, tiles, stone, cloth.

Each function returns display (sRGB) colours in [0, 1], or a `Surface` that
adds a height and a roughness image. All repeat without seams.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .mesh import Array
from .noise import coloured, mix, smooth_step, warp

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Surface:
    """What a textured surface looks like: colour, and relief and roughness in [0, 1]."""

    color: Array
    height: Array
    roughness: Array


def wood(size: int, seed: int, light: Colour, dark: Colour, rings: float = 7.0) -> Surface:
    """A board sawn along the grain, which runs along u."""
    shape = (size, size)
    y = np.linspace(0.0, 1.0, size, endpoint=False)[:, None]
    bend = coloured(shape, seed, 1.6, 6.0) * 0.07 + coloured(shape, seed + 1, 1.2, 14.0) * 0.010
    ring = (y + bend) * rings
    saw = ring - np.floor(ring)
    late = smooth_step(0.35, 0.95, saw) * (1.0 - smooth_step(0.95, 1.0, saw))
    fibre = coloured(shape, seed + 2, 0.35, 40.0)
    pores = smooth_step(1.5, 2.6, coloured(shape, seed + 3, 0.2, 26.0))
    tone = coloured(shape, seed + 4, 1.5, 4.0)
    weight = np.clip(0.25 + 0.5 * late + 0.10 * fibre + 0.09 * tone, 0.0, 1.0)
    color = mix(light, dark, weight) * (1.0 - 0.35 * pores[..., None])
    height = np.clip(0.6 - 0.15 * late + 0.05 * fibre - 0.4 * pores, 0.0, 1.0)
    return Surface(np.clip(color, 0.0, 1.0), height, np.clip(0.42 + 0.12 * late + 0.04 * fibre + 0.2 * pores, 0.0, 1.0))


def planks(size: int, seed: int, rows: int, light: Colour, dark: Colour, spread: float = 0.22) -> Surface:
    """Floor boards along u: staggered joints, each board cut from another place of the wood."""
    rng = np.random.default_rng(seed)
    board = wood(size, seed + 10, light, dark, rings=9.0)
    width = size // rows
    images = [np.empty_like(board.color), np.empty_like(board.height), np.empty_like(board.roughness)]
    gap = max(1, size // 512)
    for row in range(rows):
        joint = int((row * 0.382 + 0.1 * rng.random()) % 1.0 * size)
        for part in range(2):
            columns = (np.arange(size // 2) + joint + part * size // 2) % size
            lines = np.arange(row * width, (row + 1) * width)
            shift = rng.integers(0, size, 2)
            source = np.ix_((lines + shift[0]) % size, (columns + shift[1]) % size)
            tone = 1.0 + spread * (rng.random() - 0.5)
            warmth = 1.0 + 0.05 * (rng.random(3) - 0.5)
            target = np.ix_(lines, columns)
            images[0][target] = np.clip(board.color[source] * tone * warmth, 0.0, 1.0)
            images[1][target] = board.height[source] * 0.4 + 0.6
            images[2][target] = board.roughness[source]
            for edge in (np.ix_(lines, columns[:gap]), np.ix_(lines[:gap], columns)):
                images[0][edge] *= 0.35
                images[1][edge] = 0.0
                images[2][edge] = 0.9
    return Surface(*images)


def plaster(size: int, seed: int, color: Colour, variation: float = 0.035) -> Surface:
    """A trowelled wall: faint clouds of tone, fine relief."""
    shape = (size, size)
    clouds, grain = coloured(shape, seed, 1.4), coloured(shape, seed + 1, 0.5, 1.0, 8.0)
    strokes = warp(coloured(shape, seed + 2, 1.0, 3.0, 3.0), clouds * 20, np.roll(clouds, size // 3, 0) * 20)
    tone = 1.0 + variation * (0.7 * clouds + 0.35 * strokes + 0.12 * grain)
    height = np.clip(0.5 + 0.13 * strokes + 0.04 * grain, 0.0, 1.0)
    return Surface(np.clip(np.asarray(color) * tone[..., None], 0, 1), height, np.full(shape, 0.9))


def tiles(size: int, seed: int, count: int, colors: Sequence[Colour], joint: Colour = (0.55, 0.53, 0.5)) -> Surface:
    """Square tiles in a chequered order of colours, with worn edges and grout."""
    rng = np.random.default_rng(seed)
    y, x = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    step = size / count
    column, row = (x / step).astype(int), (y / step).astype(int)
    edge = np.minimum(np.minimum(x % step, step - x % step), np.minimum(y % step, step - y % step)) / step
    base = np.asarray(colors)[(column + row) % len(colors)]
    tone = 1.0 + 0.10 * (rng.random((count, count))[row, column] - 0.5) + 0.025 * coloured((size, size), seed, 0.9)
    body = smooth_step(0.012, 0.03, edge + 0.003 * coloured((size, size), seed + 1, 0.8))
    color = mix(np.broadcast_to(joint, base.shape), np.clip(base * tone[..., None], 0, 1), body)
    rough = 0.22 + 0.05 * coloured((size, size), seed + 2, 1.1) + 0.6 * (1 - body)
    relief = smooth_step(0.0, 0.06, edge) * 0.8 + 0.02 * coloured((size, size), seed + 3, 1.2)
    return Surface(np.clip(color, 0, 1), np.clip(relief, 0, 1), np.clip(rough, 0.05, 1))


def marble(size: int, seed: int, base: Colour, vein: Colour) -> Surface:
    """Polished stone with sharp veins in soft clouds."""
    shape = (size, size)
    a, b, c = (coloured(shape, seed + i, 2.3) for i in range(3))
    grain = coloured(shape, seed + 3, 1.2) * size / 160
    field = warp(c, a * size / 22 + grain, b * size / 22 - grain)
    lines = np.exp(-np.abs(field) * 22.0) * smooth_step(-1.0, 1.2, a)
    hair = np.exp(-np.abs(warp(b, c * size / 30 + grain, a * size / 30)) * 45.0) * smooth_step(-0.5, 1.0, c)
    weight = np.clip(0.8 * lines + 0.5 * hair + 0.06 * a + 0.015 * grain, 0.0, 1.0)
    return Surface(np.clip(mix(base, vein, weight), 0, 1), np.full(shape, 0.5), np.full(shape, 0.15))


def linen(size: int, seed: int, color: Colour, threads: int = 64) -> Surface:
    """Plain weave, a little uneven."""
    y, x = np.meshgrid(np.arange(size) / size, np.arange(size) / size, indexing="ij")
    wobble = coloured((size, size), seed, 1.5) * 0.12
    warp_thread = np.abs(np.sin(np.pi * (x * threads + wobble)))
    weft_thread = np.abs(np.sin(np.pi * (y * threads + wobble)))
    over = ((np.floor(x * threads + wobble) + np.floor(y * threads + wobble)) % 2) > 0.5
    height = np.where(over, 0.35 + 0.65 * warp_thread, 0.35 + 0.65 * weft_thread)
    tone = (0.72 + 0.28 * height) * (1.0 + 0.04 * coloured((size, size), seed + 1, 0.8, 1.0))
    return Surface(np.clip(np.asarray(color) * tone[..., None], 0, 1), height, np.full((size, size), 0.95))


def rug(size: int, seed: int, field: Colour, border: Colour, accent: Colour) -> Surface:
    """A woven rug with a border and rows of diamonds; not meant to repeat."""
    y, x = np.meshgrid(np.linspace(-1, 1, size), np.linspace(-1, 1, size), indexing="ij")
    y, x = np.round(y * 72) / 72, np.round(x * 72) / 72
    edge = np.maximum(np.abs(x), np.abs(y))
    diamonds = np.abs((x * 4) % 1.0 - 0.5) + np.abs((y * 4) % 1.0 - 0.5)
    color = np.broadcast_to(field, (size, size, 3)).copy()
    color[diamonds < 0.30] = accent
    color[diamonds < 0.16] = border
    color[(diamonds > 0.46) & (diamonds < 0.54)] = np.asarray(field) * 0.72
    teeth = (np.abs(((x + y) * 9) % 1.0 - 0.5) < 0.25) & (edge > 0.84) & (edge < 0.92)
    color[edge > 0.80] = border
    color[teeth] = accent
    color[(edge > 0.78) & (edge < 0.80)] = accent
    weave = linen(size, seed, (1.0, 1.0, 1.0), 144)
    wear = 1.0 + 0.06 * coloured((size, size), seed + 1, 1.1)
    return Surface(np.clip(color * weave.color * wear[..., None], 0, 1), weave.height, np.full((size, size), 1.0))


def checker(size: int, count: int, a: Colour, b: Colour) -> Array:
    """A plain checkerboard with `count` fields along each side."""
    index = (np.arange(size) * count) // size
    return np.where(((index[:, None] + index[None, :]) % 2)[..., None] == 0, np.asarray(a), np.asarray(b))


def studs(size: int, count: int) -> Array:
    """Heights of a triangular pattern of round studs, for a normal map."""
    y, x = np.meshgrid(np.arange(size) / size * count, np.arange(size) / size * count, indexing="ij")
    heights = []
    for offset in (0.0, 0.5):
        dx, dy = (x + offset) % 1.0 - 0.5, (y + offset) % 1.0 - 0.5
        heights.append(smooth_step(0.0, 1.0, np.clip(1.0 - np.hypot(dx, dy) / 0.34, 0.0, 1.0)))
    return np.maximum(*heights)


def lattice(size: int, count: int, hole: float = 0.36) -> Array:
    """RGBA of a white sheet with staggered round holes, for a cut-out."""
    y, x = np.meshgrid(np.arange(size) / size * count, np.arange(size) / size * count, indexing="ij")
    distance = np.full((size, size), np.inf)
    for offset in (0.0, 0.5):
        dx, dy = (x + offset) % 1.0 - 0.5, (y + offset) % 1.0 - 0.5
        distance = np.minimum(distance, np.hypot(dx, dy))
    alpha = smooth_step(-2.0, 2.0, (distance - hole * 0.9) * size / count)
    return np.dstack([np.ones((size, size, 3)), alpha])
