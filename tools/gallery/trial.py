"""One asset imported, rendered and timed."""

import json
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from assets import Asset

# Seconds; longer than any asset of a test corpus should take.
LIMIT = 600
# Exit codes that mean a defect of the program and not of the asset: it failed, or it was ended by a signal.
CRASHES = {1, 101}


@dataclass(frozen=True)
class How:
    """How pictures are made."""

    ajar: str
    output: Path
    size: int
    spp: int
    threads: int


@dataclass
class Result:
    """What became of an asset."""

    asset: Asset
    code: int
    diagnostics: list[dict[str, Any]] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)
    picture: Path | None = None
    import_time: float = 0.0
    render_time: float = 0.0

    @property
    def has_crashed(self) -> bool:
        """Whether the program is at fault."""
        return self.code < 0 or self.code in CRASHES

    def said(self, **wanted: Any) -> list[str]:
        """Messages with these entries: place and words."""
        return [
            ": ".join(filter(None, [d.get("element"), d["message"]]))
            for d in self.diagnostics
            if all(d.get(key) == value for key, value in wanted.items())
        ]

    def line(self) -> str:
        """For the terminal."""
        losses = len(self.said(loss="approximated")), len(self.said(loss="dropped"))
        how = f"exit code {self.code}" if self.code else f"{losses[0]} approximated, {losses[1]} dropped"
        return f"{self.asset.name}: {how}, import {self.import_time:.2f} s, render {self.render_time:.2f} s"


def run(asset: Asset, how: How) -> Result:
    """Inspects and renders an asset."""
    place = [str(asset.file), "--allow", str(asset.folder)]
    started = time.perf_counter()
    code, text = call([how.ajar, "inspect", *place, "--json"])
    contents = parsed(text)
    result = Result(asset, code, contents.get("diagnostics", []), contents.get("counts", {}))
    result.import_time = time.perf_counter() - started
    if code == 0:
        exr = how.output / (asset.name.replace("/", "_") + ".exr")
        size = ["--size", f"{how.size}x{how.size}", "--spp", str(how.spp), "--threads", str(how.threads)]
        result.code, _ = call([how.ajar, "render", *place, "-o", str(exr), "--quiet", *size])
        result.render_time = time.perf_counter() - started - result.import_time
        result.picture = exr.with_suffix(".png") if result.code == 0 else None
        exr.unlink(missing_ok=True)
    return result


def call(command: list[str]) -> tuple[int, str]:
    """Exit code and standard output."""
    try:
        end = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return 1, ""
    return end.returncode, end.stdout


def parsed(text: str) -> dict[str, Any]:
    """JSON, or nothing."""
    try:
        return dict(json.loads(text))
    except ValueError:
        return {}
