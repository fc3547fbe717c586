"""The page."""

import subprocess
from html import escape
from pathlib import Path

from trial import Result

CSS = (Path(__file__).parent / "page.css").read_text("utf-8")


def page(folder: Path, results: list[Result]) -> str:
    """All results as HTML."""
    rendered = sum(result.picture is not None for result in results)
    lost = [sum(bool(result.said(loss=loss)) for result in results) for loss in ("approximated", "dropped")]
    summary = (
        f"{len(results)} assets, {rendered} rendered, "
        f"{lost[0]} with something approximated, {lost[1]} with something dropped"
    )
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(folder.name)}</title>'
        f"<style>{CSS}</style></head>\n<body><h1>{escape(str(folder.name))}</h1><p>{summary}</p>\n"
        + "\n".join(map(row, results))
        + "\n</body></html>\n"
    )


def row(result: Result) -> str:
    """One asset."""
    asset = result.asset
    counts = ", ".join(f"{count} {what.replace('_', ' ')}" for what, count in result.counts.items() if count)
    parts = [
        f"<h2>{escape(asset.name)}</h2>",
        f"<p>{escape(asset.exercises)}{f' (expected: {escape(asset.expect)})' if asset.expect else ''}</p>",
        section("kept", [counts] if counts else []),
        section("approximated", result.said(loss="approximated")),
        section("dropped", result.said(loss="dropped")),
        section("warnings", result.said(loss=None, severity="warning")),
        section("errors", result.said(severity="error")),
        f"<p class=time>import {result.import_time:.2f} s, render {result.render_time:.2f} s</p>",
    ]
    return f"<article>{pictures(result)}<div>{''.join(parts)}</div></article>"


def section(title: str, lines: list[str]) -> str:
    """A title and its lines, if there are any."""
    items = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f'<h3 class="{title}">{title}</h3><ul>{items}</ul>' if lines else ""


def pictures(result: Result) -> str:
    """Ajar's picture, and that of another renderer where there is one."""
    if result.picture is None:
        return f"<figure class=none>exit code {result.code}</figure>"
    shown = figure(result.picture, "Ajar")
    reference = result.asset.reference
    copy = result.picture.with_suffix(".reference.png")
    if reference and converted(reference, copy):
        shown += figure(copy, "reference")
    return shown


def figure(picture: Path, caption: str) -> str:
    """A picture with its name."""
    return f'<figure><img src="{escape(picture.name)}" alt=""><figcaption>{caption}</figcaption></figure>'


def converted(source: Path, target: Path) -> bool:
    """Writes a PNG with OpenImageIO's tool, if it is there."""
    try:
        end = subprocess.run(["oiiotool", source, "--ch", "R,G,B", "-d", "uint8", "-o", target], capture_output=True)
    except FileNotFoundError:
        return False
    return end.returncode == 0
