"""ꟻLIP for high dynamic range (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images"; 2021,
"Visualizing Errors in Rendered High Dynamic Range Images"), with separable filters.

The authors' program and OpenImageIO's filter in two dimensions and need seconds a megapixel and exposure. All kernels
are products, or sums of products, of one-dimensional ones, which makes it affordable here. Tests compare with theirs.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np

TO_XYZ = np.array(
    [
        [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
        [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
        [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
    ]
)
WHITE = TO_XYZ.sum(axis=1)
# XYZ over white to the opponent colours Y, Cx, Cz.
OPPONENT = np.array([[0, 116, 0], [500, -500, 0], [0, 200, -200]]) / WHITE
TO_OPPONENT = (OPPONENT @ TO_XYZ).astype(np.float32)
FROM_OPPONENT = np.linalg.inv(OPPONENT @ TO_XYZ).astype(np.float32)
TO_XYZ_OVER_WHITE = (TO_XYZ / WHITE[:, None]).astype(np.float32)
# Contrast sensitivity as sums of Gaussians (weight, width) for Y, Cx, Cz: table 1 of the paper.
SENSITIVITY = (((1.0, 0.0047),), ((1.0, 0.0053),), ((34.1, 0.04), (13.5, 0.025)))
FEATURE_WIDTH = 0.082
COLOR_EXPONENT, FEATURE_EXPONENT = 0.7, 0.5
# Where differences of colours begin to be compressed, and what they count there.
KNEE, KNEE_VALUE = 0.4, 0.95
# The tone curve (a x² + b x) / (c x² + d x + e), Narkowicz's fit of ACES.
ACES = (0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14)


def hdr_flip(reference: np.ndarray, test: np.ndarray, exposures: list[float], ppd: float) -> np.ndarray:
    """The largest error of any exposure (stops), a value in [0, 1] for every pixel of two linear Rec.709 images."""

    def error(exposure: float) -> np.ndarray:
        gain = np.float32(2.0**exposure)
        return ldr_flip(tone_mapped(reference * gain), tone_mapped(test * gain), ppd)

    # numpy works without the interpreter's lock.
    with ThreadPoolExecutor() as pool:
        return np.maximum.reduce(list(pool.map(error, exposures)))


def exposures_for(brightest: float, median: float) -> list[float]:
    """The exposures from which `brightest` maps to 0.85 up to that from which `median` does, about a stop apart."""
    a, b, c, d, e = ACES
    p, q, r = a - 0.85 * c, b - 0.85 * d, -0.85 * e
    x = (-q + math.sqrt(q * q - 4 * p * r)) / (2 * p)
    start, stop = math.log2(x / brightest), math.log2(x / median)
    count = max(2, math.ceil(stop - start))
    return [start + (stop - start) * i / (count - 1) for i in range(count)]


def tone_mapped(x: np.ndarray) -> np.ndarray:
    """Display-linear values in [0, 1]."""
    a, b, c, d, e = (np.float32(k) for k in ACES)
    # White long before; the square is still a float.
    x = np.minimum(x, np.float32(1e6))
    return np.clip((a * x * x + b * x) / (c * x * x + d * x + e), 0, 1)


def ldr_flip(reference: np.ndarray, test: np.ndarray, ppd: float) -> np.ndarray:
    """Errors of two linear images in [0, 1] seen at `ppd` pixels a degree."""
    ours, theirs = (reference @ TO_OPPONENT.T, test @ TO_OPPONENT.T)
    color = color_difference(perceived(ours, ppd), perceived(theirs, ppd))
    edges, points = (np.abs(a - b) for a, b in zip(features(ours[..., 0], ppd), features(theirs[..., 0], ppd)))
    feature = np.power(np.maximum(edges, points) * np.float32(math.sqrt(0.5)), np.float32(FEATURE_EXPONENT))
    return np.power(color, 1 - np.minimum(feature, 1))


def perceived(opponent: np.ndarray, ppd: float) -> np.ndarray:
    """What the eye resolves, in Hunt-adjusted CIELAB."""
    filtered = np.stack([sensitivity(opponent[..., c], SENSITIVITY[c], ppd) for c in range(3)], axis=-1)
    return hunt_lab(np.clip(filtered @ FROM_OPPONENT.T, 0, 1))


def sensitivity(plane: np.ndarray, gaussians: tuple[tuple[float, float], ...], ppd: float) -> np.ndarray:
    """Convolution with a sum of Gaussians of total weight one."""
    radius = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi**2)) * ppd)
    x = np.arange(-radius, radius + 1) / ppd
    kernels = [np.exp(-(math.pi**2) * x * x / width) for _, width in gaussians]
    weights = [a * math.sqrt(math.pi / b) * k.sum() ** 2 for (a, b), k in zip(gaussians, kernels)]
    terms = (
        np.float32(weight / sum(weights)) * across(down(plane, k / k.sum()), k / k.sum())
        for weight, k in zip(weights, kernels)
    )
    return np.asarray(sum(terms), np.float32)


def features(luminance: np.ndarray, ppd: float) -> tuple[np.ndarray, np.ndarray]:
    """Strength of edges and of points, from the first and second derivatives of a Gaussian."""
    sd = 0.5 * FEATURE_WIDTH * ppd
    x = np.arange(-math.ceil(3 * sd), math.ceil(3 * sd) + 1)
    gauss = np.exp(-x * x / (2 * sd * sd))
    first, second = balanced(-x * gauss), balanced((x * x / (sd * sd) - 1) * gauss)
    gauss /= gauss.sum()
    plane = (luminance + np.float32(16)) / np.float32(116)
    smooth_down, smooth_across = down(plane, gauss), across(plane, gauss)
    edges = np.hypot(across(smooth_down, first), down(smooth_across, first))
    points = np.hypot(across(smooth_down, second), down(smooth_across, second))
    return edges, points


def balanced(kernel: np.ndarray) -> np.ndarray:
    """Positive weights that sum to 1, negative ones to -1."""
    return np.where(kernel < 0, kernel / -kernel[kernel < 0].sum(), kernel / kernel[kernel > 0].sum())


def down(plane: np.ndarray, kernel: np.ndarray) -> np.ndarray:
    """Convolution along columns; beyond the border is what lies on it."""
    radius = len(kernel) // 2
    padded = np.pad(plane, ((radius, radius), (0, 0)), mode="edge")
    result = np.zeros_like(plane)
    term = np.empty_like(plane)
    for i, weight in enumerate(kernel[::-1]):
        np.multiply(padded[i : i + len(plane)], np.float32(weight), out=term)
        result += term
    return result


def across(plane: np.ndarray, kernel: np.ndarray) -> np.ndarray:
    """Convolution along rows."""
    return np.ascontiguousarray(down(np.ascontiguousarray(plane.T), kernel).T)


def hunt_lab(linear: np.ndarray) -> np.ndarray:
    """CIELAB whose chroma fades with lightness (the Hunt effect)."""
    xyz = linear @ TO_XYZ_OVER_WHITE.T
    delta = 6 / 29
    root = np.where(xyz > delta**3, np.cbrt(xyz), xyz / np.float32(3 * delta * delta) + np.float32(4 / 29))
    lightness = 116 * root[..., 1] - 16
    a, b = 500 * (root[..., 0] - root[..., 1]), 200 * (root[..., 1] - root[..., 2])
    return np.stack([lightness, 0.01 * lightness * a, 0.01 * lightness * b], axis=-1)


def hyab(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distance of colours that may lie far apart (Abasi et al. 2020)."""
    return np.asarray(np.abs(a[..., 0] - b[..., 0]) + np.hypot(a[..., 1] - b[..., 1], a[..., 2] - b[..., 2]))


def color_difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The distance in [0, 1]: 1 is that of green and blue; beyond the knee it is compressed."""
    primaries = hunt_lab(np.eye(3, dtype=np.float32)[1:])
    most = float(hyab(primaries[0], primaries[1])) ** COLOR_EXPONENT
    distance = np.power(hyab(a, b), np.float32(COLOR_EXPONENT))
    knee = KNEE * most
    low = distance * np.float32(KNEE_VALUE / knee)
    high = KNEE_VALUE + (distance - knee) * np.float32((1 - KNEE_VALUE) / (most - knee))
    return np.where(distance < knee, low, high).astype(np.float32)
