"""Tileable random fields, shaped in the frequency domain."""

from __future__ import annotations

import numpy as np

from .mesh import Array


def coloured(shape: tuple[int, int], seed: int, slope: float = 1.0, stretch: float = 1.0, low: float = 1.0) -> Array:
    """Noise whose amplitude falls with frequency to the power `slope`, zero mean, unit deviation.

    `stretch` > 1 draws the noise out along x; frequencies below `low` cycles
    per image are left out. The result repeats without seams.
    """
    rows, columns = shape
    v = np.fft.fftfreq(rows)[:, None] * rows
    u = np.fft.rfftfreq(columns)[None, :] * columns * stretch
    frequency = np.hypot(u, v)
    amplitude = np.where(frequency >= low, np.maximum(frequency, 1.0) ** -slope, 0.0)
    white = np.random.default_rng(seed).standard_normal(shape)
    field = np.fft.irfft2(np.fft.rfft2(white) * amplitude, s=shape)
    return (field - field.mean()) / field.std()


def smooth_step(low: float, high: float, x: Array) -> Array:
    """0 below `low`, 1 above `high`, smooth between."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def warp(image: Array, dx: Array, dy: Array) -> Array:
    """Samples an image (bilinear, repeating) at positions displaced by pixels."""
    rows, columns = image.shape[:2]
    y, x = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    x, y = x + dx, y + dy
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = x - x0, y - y0
    if image.ndim == 3:
        fx, fy = fx[..., None], fy[..., None]

    def pick(i: int, j: int) -> Array:
        return image[(y0 + j) % rows, (x0 + i) % columns]

    top = pick(0, 0) * (1 - fx) + pick(1, 0) * fx
    bottom = pick(0, 1) * (1 - fx) + pick(1, 1) * fx
    return top * (1 - fy) + bottom * fy


def mix(a: Array | tuple[float, ...], b: Array | tuple[float, ...], t: Array) -> Array:
    """Colours between `a` and `b`, with `t` an image of weights."""
    return np.asarray(a) * (1 - t[..., None]) + np.asarray(b) * t[..., None]


def normal_map(height: Array, strength: float) -> Array:
    """Tangent-space normals of a height image, green up; `strength` is the height of 1.0 in pixels."""
    right = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * 0.5 * strength
    down = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) * 0.5 * strength
    normals = np.stack([-right, down, np.ones_like(height)], axis=-1)
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True) * 0.5 + 0.5


def roughness_map(roughness: Array) -> Array:
    """Packs roughness the way glTF reads it: green; blue (metallic factor) stays 1."""
    return np.stack([np.ones_like(roughness), roughness, np.ones_like(roughness)], axis=-1)
