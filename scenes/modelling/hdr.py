"""Environment maps: a Radiance .hdr writer, and a sky and a studio to fill it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .mesh import Array, normalize
from .noise import smooth_step


def directions(width: int, height: int) -> Array:
    """The direction each pixel of a latitude-longitude map shows: row 0 is up, the centre is +Z.

    Seen from inside; the left edge and the right edge are -Z, and a quarter
    of the width is +X (UsdLux DomeLight).
    """
    latitude = np.pi * (0.5 - (np.arange(height) + 0.5) / height)[:, None]
    longitude = np.pi * (1.0 - 2.0 * (np.arange(width) + 0.5) / width)[None, :]
    x, z = np.cos(latitude) * np.sin(longitude), np.cos(latitude) * np.cos(longitude)
    return np.stack([x, np.broadcast_to(np.sin(latitude), x.shape), z], axis=-1)


def clear_sky(width: int, height: int, sun: Sequence[float], zenith: float, ground: Sequence[float]) -> Array:
    """Linear radiance of a clear sky without the sun's disk, above plain ground.

    The luminance follows the CIE clear sky (CIE S 011, type 12), with
    radiance `zenith` overhead; the colour goes from deep blue to a pale horizon.
    """
    view = directions(width, height)
    toward = normalize(np.asarray(sun, dtype=float))
    up = np.maximum(view[..., 1], 0.01)
    angle, sun_zenith = np.arccos(np.clip(view @ toward, -1, 1)), np.arccos(toward[1])

    def scatter(gamma: Array | float) -> Array:
        return 0.91 + 10.0 * np.exp(-3.0 * gamma) + 0.45 * np.cos(gamma) ** 2

    luminance = scatter(angle) * (1 - np.exp(-0.32 / up)) / (scatter(sun_zenith) * (1 - np.exp(-0.32)))
    haze = np.exp(-up * 5.0)[..., None]
    tint = np.array([0.45, 0.72, 1.35]) * (1 - haze) + np.array([0.92, 1.0, 1.10]) * haze
    glow = np.exp(-3.5 * angle)[..., None]
    tint = tint * (1 - 0.6 * glow) + np.array([1.15, 1.0, 0.85]) * 0.6 * glow
    above = smooth_step(-0.01, 0.01, view[..., 1])[..., None]
    sky = zenith * luminance[..., None] * tint
    return sky * above + np.asarray(ground) * (1 - above)


def soft_box(
    image: Array, toward: Sequence[float], size: tuple[float, float], radiance: Sequence[float], edge: float = 0.03
) -> None:
    """Paints a soft-edged rectangular lamp onto a map; `size` is half width and height at distance 1."""
    view = directions(image.shape[1], image.shape[0])
    forward = normalize(np.asarray(toward, dtype=float))
    right = normalize(np.cross(forward, [0.0, 1.0, 0.0] if abs(forward[1]) < 0.99 else [0.0, 0.0, -1.0]))
    up = np.cross(right, forward)
    depth = view @ forward
    scale = 1.0 / np.where(depth > 1e-3, depth, 1.0)
    x, y = np.abs(view @ right) * scale, np.abs(view @ up) * scale
    inside = smooth_step(0.0, edge, size[0] - x) * smooth_step(0.0, edge, size[1] - y)
    image += np.where(depth > 1e-3, inside, 0.0)[..., None] * np.asarray(radiance)


def write_hdr(path: Path, image: Array) -> None:
    """Saves linear RGB as Radiance RGBE (Ward, "Real Pixels", 1991), run-length coded."""
    height, width = image.shape[:2]
    largest = image.max(axis=-1)
    mantissa, exponent = np.frexp(largest)
    scale = np.where(largest > 1e-32, mantissa * 256.0 / np.maximum(largest, 1e-32), 0.0)
    rgbe = np.zeros((height, width, 4), dtype=np.uint8)
    rgbe[..., :3] = np.clip(image * scale[..., None], 0, 255).astype(np.uint8)
    rgbe[..., 3] = np.where(largest > 1e-32, exponent + 128, 0).astype(np.uint8)
    data = bytearray(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode())
    for row in rgbe:
        data += bytes((2, 2, width >> 8, width & 255))
        for channel in row.T:
            data += _run_length(channel.tobytes())
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def _run_length(line: bytes) -> bytes:
    """One channel of one line: runs of four and more are coded, the rest is copied."""
    coded = bytearray()
    literal = bytearray()
    at = 0
    while at < len(line):
        end = at
        while end < len(line) and end - at < 127 and line[end] == line[at]:
            end += 1
        if end - at >= 4:
            coded += _literals(literal)
            literal.clear()
            coded += bytes((128 + end - at, line[at]))
        else:
            literal += line[at:end]
        at = end
    return bytes(coded + _literals(literal))


def _literals(data: bytearray) -> bytes:
    """Bytes copied in pieces of at most 128."""
    return b"".join(bytes((len(data[i : i + 128]),)) + data[i : i + 128] for i in range(0, len(data), 128))
