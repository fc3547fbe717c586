"""Which files of a folder are tried."""

import re
from dataclasses import dataclass
from pathlib import Path

EXTENSIONS = {".gltf", ".glb", ".obj", ".usd", ".usda", ".usdc", ".usdz", ".ajar"}


@dataclass(frozen=True)
class Asset:
    """A file, and the folder below which it may read."""

    name: str
    file: Path
    folder: Path
    exercises: str = ""
    expect: str = ""

    @property
    def reference(self) -> Path | None:
        """The picture of another renderer that lies beside it."""
        return next(iter(sorted(self.folder.glob("ref/reference.*"))), None)


def find(folder: Path) -> list[Asset]:
    """All assets, in the order of the manifest or by name."""
    manifest = folder / "MANIFEST.md"
    if manifest.is_file():
        return [asset for row in rows(manifest.read_text("utf-8")) for asset in listed(folder, row)]
    files = sorted(file for file in folder.rglob("*") if file.suffix.lower() in EXTENSIONS)
    return [Asset(str(file.relative_to(folder)), file, folder) for file in files]


def rows(text: str) -> list[dict[str, str]]:
    """Rows of the Markdown tables that have a column `open this`."""
    found: list[dict[str, str]] = []
    columns: list[str] = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            columns = []
        elif not columns:
            columns = cells
        elif "open this" in columns and not re.fullmatch(r"-+", cells[0]):
            found.append(dict(zip(columns, cells)))
    return found


def listed(folder: Path, row: dict[str, str]) -> list[Asset]:
    """The file of a row; where a row names a folder, the stage that is not part of another one there."""
    own = folder / row["folder"]
    file = own / row["open this"]
    if file.is_dir():
        scenes = [one for one in sorted(file.iterdir()) if one.suffix.lower() in EXTENSIONS]
        named = [one for one in scenes if one.stem in ("scene", "test")]
        file = next(iter(named or scenes), file)
    return [Asset(row["folder"], file, own, row.get("exercises", ""), row.get("expect", ""))]
