"""Limits of the gates, and `compare.toml`, where a case asks for others."""

from __future__ import annotations

import datetime
import difflib
import sys
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

try:
    import tomllib
except ImportError:  # Python 3.10
    import tomli as tomllib  # type: ignore[no-redef, import-not-found, unused-ignore]

GATES = ("structure", "finite", "exact", "statistics", "variance", "flip", "numbers")
# Least and largest value of numbers that may not be just any from zero up.
RANGES = {
    "alpha": (1e-100, 0.5),
    "min_rounds": (2, 1e9),
    "variance_ratio": (1, 1e9),
    "max_luminance": (0.01, 1e6),
    "flip_mean": (0, 1),
    "flip_p95": (0, 1),
    "layer_pixels": (0, 1),
    "fail_percent": (0, 100),
}


class SettingsError(Exception):
    """A mistake in `compare.toml`, in one sentence."""


@dataclass(frozen=True)
class ExcusedGate:
    """A gate that may fail, why, and until when."""

    gate: str
    reason: str
    until: datetime.date


@dataclass(frozen=True)
class Settings:
    """All limits. `None` means that the gate reports its number and does not judge."""

    alpha: float = 1e-3
    """Probability of a false alarm of one comparison of honest images; the plug-in divides a suite's by its cases."""
    min_rounds: int = 8
    """Fewest rounds from which an image's own variances are believed."""
    variance_ratio: float = 1.25
    """The noise of the typical block may differ by this factor, beyond what chance explains, before it counts."""
    dispersion: float = 1.15
    """Block differences may scatter by this factor more than the stored variances say, beyond chance."""
    max_luminance: float = 2.0
    """The luminance that fixes FLIP's range of exposures, for all images the same."""
    flip_mean: float | None = None
    """Largest mean FLIP; without statistics in both images the default is 0.05."""
    flip_p95: float | None = None
    """Largest 95th percentile of FLIP; without statistics in both images the default is 0.2."""
    layer_pixels: float = 0.002
    """Fraction of pixels of a layer without noise (albedo, normals, depth …) that may differ by more than 1 %."""
    mean_error: float | None = None
    """Largest mean absolute error."""
    rms_error: float | None = None
    """Largest root of the mean squared error."""
    max_error: float | None = None
    """Largest error of any channel of any pixel."""
    psnr: float | None = None
    """Smallest peak signal-to-noise ratio, decibels, the peak being that of the reference."""
    fail: float | None = None
    """idiff's -fail: pixels with a larger error are counted …"""
    fail_percent: float = 0.0
    """… and may be this many per cent."""
    other_renderer: bool = False
    """Compare only the colours, whatever else the files hold."""
    require: tuple[str, ...] = ()
    """Attributes that both images must have, with equal values."""
    excused: tuple[ExcusedGate, ...] = field(default=())
    """Gates whose failure is known."""


def load(path: Path | None, base: Settings | None = None, today: datetime.date | None = None) -> Settings:
    """`base` with what the file at `path` changes.

    Raises:
        SettingsError: unknown keys, wrong types, exceptions without reason or past their day.
    """
    base = base or Settings()
    if path is None:
        return base
    data = parse(path)
    # How a case is rendered is not the comparison's business: ajar_tools.cases reads it.
    data.pop("render", None)
    return from_dict(data, base, str(path), today or datetime.date.today())


def parse(path: Path) -> dict[str, Any]:
    """A TOML file.

    Raises:
        SettingsError: it cannot be read.
    """
    try:
        return tomllib.loads(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SettingsError(f"{path}: {error}") from error
    except RecursionError as error:
        raise SettingsError(f"{path}: lists or tables lie too deep in each other") from error


def from_dict(data: dict[str, Any], base: Settings, where: str, today: datetime.date) -> Settings:
    """As `load`, from parsed TOML."""
    data = dict(data)
    entries = data.pop("excused", [])
    if not isinstance(entries, list):
        raise SettingsError(f"{where}: exceptions are tables, [[excused]]")
    excused = tuple(excused_gate(entry, where, today) for entry in entries)
    defaults = Settings()
    known = {f.name for f in fields(Settings)} - {"excused"}
    changes: dict[str, Any] = {}
    for key, value in data.items():
        if key not in known:
            near = difflib.get_close_matches(key, known, 1)
            raise SettingsError(f'{where}: unknown key "{key}"' + (f'; did you mean "{near[0]}"?' if near else ""))
        changes[key] = checked(key, value, getattr(defaults, key), where)
    return replace(base, **changes, excused=excused)


def checked(key: str, value: Any, default: Any, where: str) -> Any:
    """A value of the type that its default has; a number in its range, or not negative.

    Raises:
        SettingsError: it is something else.
    """
    if isinstance(default, bool):
        if isinstance(value, bool):
            return value
        raise SettingsError(f"{where}: {key} must be true or false")
    if isinstance(default, tuple):
        if isinstance(value, list) and all(isinstance(item, str) for item in value):
            return tuple(value)
        raise SettingsError(f"{where}: {key} must be a list of names")
    least, largest = RANGES.get(key, (0, sys.float_info.max))
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not least <= value <= largest:
        bounds = f"from {least:g} to {largest:g}" if key in RANGES else "zero or more"
        raise SettingsError(f"{where}: {key} must be a number, {bounds}")
    return value


def excused_gate(entry: Any, where: str, today: datetime.date) -> ExcusedGate:
    """One `[[excused]]` table: a gate, a reason and the day on which somebody has to look again."""
    if not isinstance(entry, dict) or set(entry) != {"gate", "reason", "until"}:
        raise SettingsError(f"{where}: every [[excused]] needs gate, reason and until, and nothing else")
    gate, reason, until = entry["gate"], entry["reason"], entry["until"]
    if gate not in GATES or gate in ("finite", "exact"):
        raise SettingsError(f'{where}: the gate "{gate}" cannot be excused')
    if not isinstance(reason, str) or not reason.strip():
        raise SettingsError(f"{where}: the exception for {gate} gives no reason")
    if not isinstance(until, datetime.date) or isinstance(until, datetime.datetime):
        raise SettingsError(f"{where}: the exception for {gate} needs a date: until = 2030-01-31")
    if until < today:
        raise SettingsError(f"{where}: the exception for {gate} ended on {until} ({reason})")
    return ExcusedGate(gate, reason, until)
