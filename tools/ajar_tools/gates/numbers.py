"""Gate 7: layers without noise, and the classic measures of error: always reported, judged where the case asks for it.

OpenImageIO's own verdict is not used: its comparisons pass images of NaN. Gate 2 stands before this one.
"""

from __future__ import annotations

import math

import numpy as np

from ajar_tools.gates.layers import layer_problems
from ajar_tools.picture import Picture
from ajar_tools.settings import Settings
from ajar_tools.statistics import over_channels
from ajar_tools.verdict import GateResult, Status

# What idiff counts: a per cent of pixels beyond each of these.
THRESHOLDS = (0.001, 0.01, 0.1)


def check(new: Picture, reference: Picture, settings: Settings) -> GateResult:
    """Computes all measures and holds them against the limits that are set."""
    numbers = measures(new.color, reference.color, settings)
    problems = [] if settings.other_renderer else layer_problems(new, reference, settings)
    for name, limit in (("mean_error", settings.mean_error), ("rms_error", settings.rms_error)):
        if limit is not None and numbers[name] > limit:
            problems.append(f"the {name.replace('_', ' ')} is {numbers[name]:.4g}, more than {limit:g}")
    if settings.max_error is not None and numbers["max_error"] > settings.max_error:
        x, y = max_pixel(new, reference)
        largest = f"{numbers['max_error']:.4g}, more than {settings.max_error:g}"
        problems.append(f"the error at pixel ({x}, {y}) is {largest}")
    if settings.psnr is not None and numbers["psnr"] < settings.psnr:
        problems.append(f"PSNR is {numbers['psnr']:.2f} dB, less than {settings.psnr:g}")
    if settings.fail is not None and numbers["fail_percent"] > settings.fail_percent:
        problems.append(
            f"{numbers['fail_percent']:.3g} % of the pixels differ by more than {settings.fail:g}, "
            f"{settings.fail_percent:g} % may"
        )
    text = "mean error {mean_error:.3g}, rms {rms_error:.3g}, max {max_error:.3g}, PSNR {psnr:.1f} dB".format(**numbers)
    return GateResult("numbers", Status.FAIL if problems else Status.PASS, "; ".join(problems) or text, numbers)


def measures(a: np.ndarray, b: np.ndarray, settings: Settings) -> dict[str, float]:
    """Mean, root mean square and largest error, PSNR, and percentages of pixels beyond thresholds."""
    error = np.abs(a - b)
    worst = over_channels(np.maximum, error)
    # In doubles: the square of a large float is none any more.
    mean_square = float(np.square(error, dtype=np.float64).mean())
    peak = float(b.max())
    psnr = math.inf if mean_square == 0 else 10 * math.log10(max(peak * peak, 1e-300) / mean_square)
    numbers = {
        "mean_error": float(error.mean(dtype=np.float64)),
        "rms_error": math.sqrt(mean_square),
        "max_error": float(worst.max()),
        "psnr": psnr,
        "mean_new": float(a.mean(dtype=np.float64)),
        "mean_reference": float(b.mean(dtype=np.float64)),
    }
    for threshold in THRESHOLDS:
        numbers[f"percent_beyond_{threshold:g}"] = 100 * float((worst > threshold).mean())
    if settings.fail is not None:
        numbers["fail_percent"] = 100 * float((worst > settings.fail).mean())
    return numbers


def max_pixel(new: Picture, reference: Picture) -> tuple[int, int]:
    """Column and row of the largest error in the full frame."""
    worst = over_channels(np.maximum, np.abs(new.color - reference.color))
    row, column = np.unravel_index(int(worst.argmax()), worst.shape)
    return new.data_window.x + int(column), new.data_window.y + int(row)
