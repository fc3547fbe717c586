"""One self-contained HTML page that a person can judge in ten seconds."""

from __future__ import annotations

import html
import json
import math
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from ajar_tools.gates.flip import flip_map, shrunk
from ajar_tools.gates.statistical import Level
from ajar_tools.picture import Picture
from ajar_tools.report.encode import data_uri, shared_exponent
from ajar_tools.settings import Settings
from ajar_tools.verdict import Verdict

# Larger images are averaged for the page, which says so.
MOST_PIXELS = 2_100_000
# Standard errors that are shown as the brightest.
MOST_SIGNIFICANT = 8.0


def write_report(path: Path, verdict: Verdict, settings: Settings, command: str) -> None:
    """Writes the page; without pictures where they cannot be shown side by side."""
    data: dict[str, Any] = {"verdict": verdict.as_dict(), "command": command}
    if verdict.pictures and all(np.isfinite(p.color).all() for p in verdict.pictures):
        data |= images(verdict, settings)
    page = resource("page.html")
    # A tag inside a text must not end the script.
    text = json.dumps(printable(data)).replace("<", "\\u003c")
    parts = {"{{title}}": html.escape(verdict.headline()), "{{css}}": resource("page.css")}
    parts |= {"{{js}}": resource("page.js"), "{{data}}": text}
    for place, part in parts.items():
        page = page.replace(place, part)
    path.write_text(page, "utf-8")


def resource(name: str) -> str:
    """A file of this folder."""
    return (files(__package__) / name).read_text("utf-8")


def printable(value: Any) -> Any:
    """JSON has no infinity: such numbers become texts."""
    if isinstance(value, dict):
        return {key: printable(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [printable(item) for item in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def images(verdict: Verdict, settings: Settings) -> dict[str, Any]:
    """Everything that the viewer draws."""
    assert verdict.pictures
    new, reference = verdict.pictures
    height, width = reference.pixels.shape[:2]
    factor = 1
    while (width // factor) * (height // factor) > MOST_PIXELS:
        factor += 1
    colors = [shrunk(picture.color, factor) for picture in (new, reference)]
    flip = verdict.flip or flip_map(new, reference, settings)
    data: dict[str, Any] = {
        "width": colors[0].shape[1],
        "height": colors[0].shape[0],
        "factor": factor,
        "origin": [reference.data_window.x, reference.data_window.y],
        "exposure": exposure(colors[1]),
        "new": encoded(colors[0]),
        "reference": encoded(colors[1]),
        "flip": data_uri(np.rint(np.clip(flip.errors, 0, 1) * 255)),
        "flip_factor": flip.factor,
        "significance": significance(new, reference),
        "most_significant": MOST_SIGNIFICANT,
        "block": next((g.numbers["block"] for g in verdict.gates if "block" in g.numbers), None),
    }
    return data


def encoded(color: np.ndarray) -> dict[str, str]:
    """An image of high dynamic range."""
    mantissa, exponent = shared_exponent(color)
    return {"mantissa": data_uri(mantissa), "exponent": data_uri(exponent)}


def significance(new: Picture, reference: Picture) -> str | None:
    """Differences of 8×8 blocks in standard errors; `None` where an image does not declare its noise."""
    ours, theirs = new.statistics, reference.statistics
    if ours is None or theirs is None:
        return None
    t = np.abs(Level(new, reference, ours, theirs, 8).t).max(axis=2)
    return data_uri(np.rint(np.minimum(t / MOST_SIGNIFICANT, 1) * 255))


def exposure(color: np.ndarray) -> float:
    """Stops that bring the bright parts of an image just below white."""
    bright = float(np.percentile(color[::2, ::2].mean(axis=2), 95))
    return round(math.log2(0.8 / bright), 1) if bright > 0 else 0.0
