"""Fixtures for tests written in Python: `ajar_render` makes an image, `ajar_compare` holds one against another."""

from __future__ import annotations

import datetime
import json
import shlex
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from ajar_tools.artifacts import artifacts_of, shown
from ajar_tools.cases import CONFIG, RenderError, ajar, run
from ajar_tools.comparison import compare
from ajar_tools.settings import Settings, SettingsError, from_dict
from ajar_tools.verdict import Outcome, Verdict


@pytest.fixture
def ajar_render(request: pytest.FixtureRequest, tmp_path: Path) -> Callable[..., Path]:
    """`ajar_render(scene, *arguments)` renders an image and returns its path."""

    def render(scene: str | Path, *arguments: str, name: str = "new.exr") -> Path:
        output = tmp_path / name
        command = [ajar(request.config.getoption("--ajar-binary")), "render", str(scene), "-o", str(output)]
        try:
            run([*command, "--quiet", *arguments], timeout=1200)
        except RenderError as error:
            pytest.fail(str(error), pytrace=False)
        return output

    return render


@pytest.fixture
def ajar_compare(request: pytest.FixtureRequest) -> Callable[..., Verdict]:
    """`ajar_compare(new, reference, **limits)` fails the test unless the images show the same.

    Limits are keys of `compare.toml`, but for exceptions, which belong to cases.
    """

    def check(new: str | Path, reference: str | Path, **limits: object) -> Verdict:
        settings = limited(limits)
        verdict = compare(new, reference, settings)
        if verdict.outcome is not Outcome.PASS:
            folder = keep(request, verdict, settings, limits)
            request.node.user_properties.append(("ajar", verdict.headline()))
            pytest.fail(f"{verdict.text()}\nmore in {shown(folder)}", pytrace=False)
        return verdict

    return check


def limited(limits: dict[str, object]) -> Settings:
    """The limits of a test; a wrong one fails it with a sentence."""
    try:
        if "excused" in limits:
            raise SettingsError("ajar_compare: exceptions belong into the compare.toml of a case")
        return from_dict(limits, Settings(), "ajar_compare", datetime.date.today())
    except SettingsError as error:
        pytest.fail(str(error), pytrace=False)


def keep(request: pytest.FixtureRequest, verdict: Verdict, settings: Settings, limits: dict[str, object]) -> Path:
    """Stores the image, the limits and the verdict with a command that gives it again; returns the folder."""
    test = f"{request.path.stem}-{request.node.name}"
    name = "".join(c if c.isalnum() or c in "-_" else "-" for c in test)
    artifacts = artifacts_of(request.config)
    new, config = artifacts.case(name) / "new.exr", artifacts.case(name) / CONFIG
    if Path(verdict.new).is_file():
        shutil.copyfile(verdict.new, new)
    command = ["ajar-compare", shown(new), shown(Path(verdict.reference))]
    if limits:
        # Numbers, truth values and lists of names are written alike in JSON and TOML.
        config.write_text("".join(f"{key} = {json.dumps(value)}\n" for key, value in limits.items()), "utf-8")
        command += ["--config", shown(config)]
    return artifacts.keep(name, verdict, settings, shlex.join(command))
