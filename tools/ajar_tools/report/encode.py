"""Images as text inside a page: PNG files in data URIs.

High dynamic range goes as Ward's shared exponents ("Real Pixels", Graphics Gems II): one PNG of mantissas and a grey
one of exponents, for browsers multiply colours by alpha and would spoil a fourth channel.
"""

from __future__ import annotations

import base64
import struct
import zlib

import numpy as np

from ajar_tools.statistics import over_channels

BIAS = 128


def png(pixels: np.ndarray) -> bytes:
    """An 8-bit PNG of rows × columns (grey) or rows × columns × 3."""
    height, width = pixels.shape[:2]
    color_type = 2 if pixels.ndim == 3 else 0
    rows = np.ascontiguousarray(pixels, np.uint8).reshape(height, -1)
    # Every row starts with the number of its filter: none.
    raw = np.concatenate([np.zeros((height, 1), np.uint8), rows], axis=1).tobytes()
    header = struct.pack(">IIBBBBB", width, height, 8, color_type, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(raw, 1)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(map(chunk, chunks))


def chunk(named: tuple[bytes, bytes]) -> bytes:
    """Length, name, data and check sum."""
    name, data = named
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def data_uri(pixels: np.ndarray) -> str:
    """The PNG as text."""
    return "data:image/png;base64," + base64.b64encode(png(pixels)).decode("ascii")


def shared_exponent(color: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mantissas and exponents: a value is (mantissa + 0.5) / 256 · 2^(exponent − 128), 0 for exponent 0."""
    brightest = over_channels(np.maximum, color)
    _, exponent = np.frexp(brightest)
    stored = np.where(brightest > 0, np.clip(exponent + BIAS, 0, 255), 0).astype(np.uint8)
    scale = np.where(stored > 0, np.ldexp(np.float32(256), BIAS - np.maximum(stored, 9).astype(np.int32)), 0)
    # Repeated, for numpy is slow where it goes along three values at a time.
    mantissa = np.maximum(color, 0) * np.repeat(scale, color.shape[2], axis=1).reshape(color.shape)
    return np.minimum(mantissa, 255, out=mantissa).astype(np.uint8), stored
