"""The folder for everything that a person may want to look at after a run: uploaded as one artifact by CI."""

from __future__ import annotations

import html
import json
import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from ajar_tools.settings import Settings
from ajar_tools.verdict import Outcome, Verdict

if TYPE_CHECKING:
    import pytest

MARKER = ".ajar-artifacts"
PAGE = """<!doctype html><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Ajar: {title}</title>
<style>
body {{ font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 60rem; padding: 0 1rem; color: #222 }}
table {{ border-collapse: collapse; width: 100% }}
td, th {{ padding: .4rem .6rem; text-align: left; vertical-align: top; border-bottom: 1px solid #ddd }}
img {{ max-width: 100%; min-height: 5rem; margin-top: .4rem; image-rendering: pixelated }}
.pass {{ color: #176b2c }} .fail, .cannot {{ color: #b3261e; font-weight: 600 }} .review {{ color: #1f4e79 }}
</style>
<h1>{title}</h1><p>{lead}</p>
<table><tr><th>case<th>result<th>what was found</tr>{rows}</table>
"""


@dataclass(frozen=True)
class Artifacts:
    """A folder with a subfolder a case; cases may write at the same time."""

    folder: Path

    def clear(self) -> None:
        """Removes what an earlier run left.

        Raises:
            FileExistsError: the folder holds somebody else's files.
        """
        if not self.folder.exists():
            return
        if any(self.folder.iterdir()) and not (self.folder / MARKER).exists():
            raise FileExistsError(f"{self.folder} is not a folder of artifacts; choose another one")
        shutil.rmtree(self.folder)

    def case(self, name: str) -> Path:
        """The folder of a case."""
        folder = self.folder / name
        folder.mkdir(parents=True, exist_ok=True)
        (self.folder / MARKER).touch()
        return folder

    def keep(self, name: str, verdict: Verdict, settings: Settings, command: str, always: bool = False) -> Path:
        """Stores a verdict; where images differ, or always, a report too. Returns the case's folder."""
        folder = self.case(name)
        report = strip = ""
        if verdict.outcome is Outcome.FAIL or (always and verdict.outcome is not Outcome.CANNOT):
            from ajar_tools.report import write_report, write_strip

            report = "report.html"
            write_report(folder / report, verdict, settings, command)
            strip = "strip.png" if write_strip(folder / "strip.png", verdict) else ""
        data = verdict.as_dict() | {"case": name, "report": report, "strip": strip, "command": command}
        (folder / "verdict.json").write_text(json.dumps(data, indent=1), "utf-8")
        return folder

    def write_index(self, title: str, lead: str) -> Path | None:
        """A page that lists all cases, those that differ first; `None` when no case left anything."""
        verdicts = [json.loads(path.read_text("utf-8")) for path in sorted(self.folder.glob("*/verdict.json"))]
        if not verdicts:
            return None
        verdicts.sort(key=lambda v: (v["outcome"] == "pass", v["case"]))
        rows = "".join(map(row, verdicts))
        page = self.folder / "index.html"
        page.write_text(PAGE.format(title=html.escape(title), lead=html.escape(lead), rows=rows), "utf-8")
        return page


def row(verdict: dict[str, Any]) -> str:
    """A case in the table."""
    name, folder = html.escape(verdict["case"]), quote(verdict["case"])
    picture = ""
    if verdict["strip"]:
        picture = f'<br><img src="{folder}/{verdict["strip"]}" alt="reference, new image and difference">'
    if verdict["report"]:
        name, picture = (f'<a href="{folder}/{verdict["report"]}">{text}</a>' for text in (name, picture))
    kind, word = ("review", verdict["review"]) if verdict["review"] else (verdict["outcome"],) * 2
    return f'<tr><td>{name}<td class="{kind}">{word}<td>{html.escape(verdict["headline"])}{picture}</tr>'


def artifacts_of(config: pytest.Config) -> Artifacts:
    """The folder of a run."""
    return Artifacts((config.invocation_params.dir / config.getoption("--ajar-artifacts")).resolve())


def shown(path: Path) -> str:
    """A path relative to the current folder where that is shorter."""
    relative = os.path.relpath(path)
    return str(path) if relative.startswith("..") else relative
