"""One self-contained HTML page that a person can judge in ten seconds."""

from __future__ import annotations

import html
import json
import math
import pkgutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from ajar_tools.gates.flip import factor_for, flip_map, shrunk
from ajar_tools.gates.statistical import Level
from ajar_tools.picture import COLORS, Picture
from ajar_tools.report.encode import data_uri, shared_exponent
from ajar_tools.report.strip import strip
from ajar_tools.settings import Settings
from ajar_tools.verdict import Verdict, printable

# Larger images are averaged for the page, which says so.
MOST_PIXELS = 2_100_000
# Standard errors that are shown as dark, for noise reaches them, and as the brightest.
SIGNIFICANT = (2, 8)
# Characters of an attribute that are shown; hashes are cut.
LONGEST = 40
# What the page tells of both files, by attribute.
ABOUT = {
    "ajar:integrator": "integrator",
    "ajar:rounds": "rounds",
    "samplesPerPixel": "samples a pixel",
    "ajar:seed": "seed",
    "ajar:noise": "noise of the typical pixel",
    "ajar:sceneHash": "scene",
    "renderTime": "render time",
    "DateTime": "finished",
    "software": "program",
}


def write_report(path: Path, verdict: Verdict, settings: Settings, command: str) -> None:
    """Writes the page; without pictures where they cannot be shown side by side."""
    data: dict[str, Any] = {"verdict": verdict.as_dict(), "command": command}
    if can_be_shown(verdict):
        data |= images(verdict, settings)
    page = resource("page.html")
    # A tag inside a text must not end the script.
    text = json.dumps(printable(data)).replace("<", "\\u003c")
    parts = {"{{title}}": html.escape(verdict.headline()), "{{css}}": resource("page.css")}
    parts |= {"{{planes}}": resource("planes.js"), "{{js}}": resource("page.js"), "{{data}}": text}
    for place, part in parts.items():
        page = page.replace(place, part)
    path.write_text(page, "utf-8")


def write_strip(path: Path, verdict: Verdict) -> bool:
    """Writes a small picture of both images and their difference for a list; false where there is nothing to show."""
    if not can_be_shown(verdict):
        return False
    assert verdict.pictures
    new, reference = verdict.pictures
    path.write_bytes(strip(new, None if verdict.problem else reference, exposure(reference.color)))
    return True


def can_be_shown(verdict: Verdict) -> bool:
    """Whether there are images, of colours that are numbers."""
    pictures = verdict.pictures or ()
    return bool(pictures) and all(any(map(p.has, COLORS)) and np.isfinite(p.color).all() for p in pictures)


def resource(name: str) -> str:
    """A file of this folder."""
    data = pkgutil.get_data(__name__, name)
    assert data is not None
    return data.decode("utf-8")


def images(verdict: Verdict, settings: Settings) -> dict[str, Any]:
    """Everything that the viewer draws."""
    assert verdict.pictures
    new, reference = verdict.pictures
    factor = factor_for(reference, MOST_PIXELS)
    # numpy and zlib work without the interpreter's lock.
    with ThreadPoolExecutor() as pool:
        colors = list(pool.map(lambda picture: shrunk(picture.color, factor), (new, reference)))
        ours, theirs = pool.map(encoded, colors)
    flip = verdict.flip or flip_map(new, reference, settings)
    data: dict[str, Any] = {
        "width": colors[0].shape[1],
        "height": colors[0].shape[0],
        "factor": factor,
        "origin": [reference.data_window.x, reference.data_window.y],
        "exposure": exposure(colors[1]),
        "new": ours,
        "reference": theirs,
        "flip": data_uri(np.rint(np.clip(flip.errors, 0, 1) * 255)),
        "flip_factor": flip.factor,
        "significance": significance(new, reference),
        "significant": SIGNIFICANT,
        "about": about(new, reference),
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
    dark, bright = SIGNIFICANT
    return data_uri(np.rint(np.clip((t - dark) / (bright - dark), 0, 1) * 255))


def about(new: Picture, reference: Picture) -> list[list[str]]:
    """Lines of a table: what, of the new image, of the reference."""
    pictures = (new, reference)
    lines = [["mean brightness", *(f"{picture.color.mean(dtype=np.float64):.5g}" for picture in pictures)]]
    lines += [["pixels", *(f"{p.data_window.width} × {p.data_window.height}" for p in pictures)]]
    for name, label in ABOUT.items():
        values = [picture.attributes.get(name) for picture in pictures]
        if values != [None, None]:
            lines.append([label, *(shown(value) for value in values)])
    return lines


def shown(value: Any) -> str:
    """An attribute for people."""
    if value is None:
        return "–"
    text = f"{value:.3g}" if isinstance(value, float) else str(value)
    return text if len(text) <= LONGEST else f"{text[:12]}…"


def exposure(color: np.ndarray) -> float:
    """Stops that bring the bright parts of an image just below white."""
    bright = float(np.percentile(color[::2, ::2].mean(axis=2), 95))
    return round(math.log2(0.8 / bright), 1) if bright > 0 else 0.0
