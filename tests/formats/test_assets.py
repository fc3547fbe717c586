"""Real files: each imports, says what it loses with place and reason, and loses what `losses.toml` lists."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from ajar_tools.cases import ajar

sys.path.insert(0, str(Path(__file__).parents[2] / "tools/gallery"))

import assets

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
SHARED = Path(os.environ.get("AJAR_SHARED", ROOT.parent / "shared")) / "assets"
LOSSES = tomllib.loads((HERE / "losses.toml").read_text("utf-8"))
FOUND = [asset for asset in assets.find(SHARED)] if SHARED.is_dir() else []
WHOLE = [asset for asset in FOUND if not asset.name.startswith("malformed/")]


def validate(asset: assets.Asset) -> tuple[int, list[dict[str, str]]]:
    """Exit code of a strict look at an asset, and what was said."""
    command = [ajar(), "--log-format", "json", "validate", str(asset.file), "--allow", str(asset.folder), "--strict"]
    done = subprocess.run(command, capture_output=True, text=True, env={"AJAR_USD_PYTHON": sys.executable} | os.environ)
    return done.returncode, [json.loads(line) for line in done.stderr.splitlines()]


@pytest.mark.skipif(not FOUND, reason="no shared assets")
@pytest.mark.parametrize("asset", WHOLE, ids=lambda asset: asset.name)
def test_an_asset_loses_what_is_listed(asset: assets.Asset) -> None:
    code, said = validate(asset)
    errors = {f"error: {it['message']}" for it in said if it["severity"] == "error"}
    assert not errors - set(LOSSES.get(asset.name, [])), errors
    if errors:
        return
    lost = [it for it in said if it["loss"]]
    assert code == (3 if any(it["severity"] == "warning" for it in said) else 0), "strict makes losses errors"
    for loss in lost:
        assert loss["file"], loss
        assert loss["message"], loss
    told = {f"{it['loss']}: {it['message'].split(' (and at')[0]}" for it in lost}
    listed = set(LOSSES.get(asset.name, []))
    assert told == listed, {"more": told - listed, "less": listed - told}
    kept = [it["message"] for it in said if it["message"].startswith("kept ")]
    assert len(kept) == 1, said


@pytest.mark.skipif(not FOUND, reason="no shared assets")
def test_every_loss_of_the_list_is_of_an_asset() -> None:
    assert not set(LOSSES) - {asset.name for asset in WHOLE}
