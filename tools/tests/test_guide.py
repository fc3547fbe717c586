"""docs/guard-images.md runs as written: its shell blocks, in order, end in the promised red and green.

Only `pip` is a stand-in: the package of this checkout is there already, and what is tested needs no network.
"""

import datetime
import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml
from ajar_tools.cases import read_case
from ajar_tools.settings import Settings, from_dict

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "guard-images.md").read_text("utf-8")
WORKFLOW = yaml.safe_load((ROOT / "docs" / "github-actions.yml").read_text("utf-8"))
# The day on which the page's exception is good.
TODAY = datetime.date(2026, 12, 1)


def blocks(language: str) -> Iterator[tuple[str, str]]:
    """The blocks of the page, each with the text from it to the next one."""
    for match in re.finditer(rf"^```{language}\n(.*?)^```\n(.*?)(?=^```|\Z)", PAGE, re.MULTILINE | re.DOTALL):
        yield match[1], match[2].strip()


@dataclass(frozen=True)
class Shell:
    """A newcomer's: a folder, and programs on the search path."""

    folder: Path
    environment: dict[str, str]

    def run(self, commands: str, **variables: str) -> subprocess.CompletedProcess[str]:
        """Runs a block."""
        command = ["bash", "-e", "-c", commands]
        environment = self.environment | variables
        return subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True, timeout=600)

    def passes(self, commands: str) -> str:
        """What a block says that has to succeed."""
        done = self.run(commands)
        assert done.returncode == 0, f"{commands}\n{done.stdout}{done.stderr}"
        return done.stdout

    def fails(self, commands: str, **variables: str) -> str:
        """What a block says that has to fail."""
        done = self.run(commands, **variables)
        assert done.returncode != 0, f"{commands}\n{done.stdout}"
        return done.stdout + done.stderr


@pytest.fixture
def shell(tmp_path: Path) -> Shell:
    binary = os.environ.get("AJAR_BIN")
    if not binary:
        pytest.skip("AJAR_BIN does not name an ajar program")
    programs, folder = tmp_path / "bin", tmp_path / "project"
    programs.mkdir()
    folder.mkdir()
    (programs / "ajar").symlink_to(Path(binary).resolve())
    (programs / "pip").write_text('#!/bin/sh\ntest "$*" = "install ./tools"\n')
    (programs / "pip").chmod(0o755)
    unset = {"AJAR_BIN", "CI", "GITHUB_ACTIONS", "PYTEST_ADDOPTS", "PYTEST_DISABLE_PLUGIN_AUTOLOAD"}
    environment = {name: value for name, value in os.environ.items() if name not in unset}
    environment["PATH"] = os.pathsep.join([str(programs), str(Path(sys.executable).parent), environment["PATH"]])
    return Shell(folder, environment)


def test_the_page_runs_as_written(shell: Shell) -> None:
    """A block fails where the sentence after it says so, and passes everywhere else."""
    said = []
    for commands, sentence in blocks("sh"):
        said.append(shell.fails(commands) if sentence.startswith("fails") else shell.passes(commands))
    installed, made, missing, updated, green, red = said
    assert installed == made == ""
    assert "pytest tests/images/chair --ajar-update" in missing
    review = re.search(r"review the new references in (\S+index\.html)", updated)
    assert review
    assert (shell.folder / "tests/images/chair/reference.exr").is_file()
    assert "1 passed" in green
    assert re.search(r"DIFFERENT PICTURE.*pixel \(\d+, \d+\).* % (brighter|darker)", red, re.DOTALL)
    report = (shell.folder / "ajar-artifacts/chair/report.html").read_text("utf-8")
    for promised in ("swap", "wipe", "exposure", "difference"):
        assert promised in report.lower()
    assert "refused because CI is set" in shell.fails("pytest tests/images/chair --ajar-update", CI="true")
    shell.passes("pytest tests/images/chair --ajar-update")
    assert (shell.folder / "ajar-artifacts/chair/old.exr").is_file()
    (line,) = (step["run"] for step in steps() if step.get("run", "").startswith("pytest"))
    assert "1 passed" in shell.passes(line)
    assert (shell.folder / "junit.xml").is_file()
    (python,) = (text for text, _ in blocks("python"))
    (shell.folder / "tests/images/chair/test_exposure.py").write_text(python, "utf-8")
    assert "1 passed" in shell.passes("cd tests/images/chair && pytest test_exposure.py")


@pytest.mark.parametrize("text", [text for text, _ in blocks("toml")])
def test_limits_and_cases_of_the_page_are_understood(text: str, tmp_path: Path) -> None:
    table = tomllib.loads(text)
    render = table.pop("render")
    assert from_dict(table, Settings(), "page", TODAY) != Settings()
    lines = [f"{key} = {value!r}" for key, value in render.items()]
    (tmp_path / "compare.toml").write_text("\n".join(["[render]", *lines]), "utf-8")
    case = read_case(tmp_path)
    assert case.arguments or case.command
    assert case.scene.name.startswith("scene.")


def steps() -> list[dict[str, str]]:
    """Those of the workflow's one job."""
    (job,) = WORKFLOW["jobs"].values()
    return list(job["steps"])


def test_the_workflow_says_what_the_page_says() -> None:
    runs = [step["run"] for step in steps() if "run" in step]
    for line in runs:
        assert f"`{line}`" in PAGE
    version = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]["rust-version"]
    assert runs[0] == f"rustup default {version}"
    assert [shlex.split(line)[0] for line in runs] == ["rustup", "cargo", "pip", "pytest"]
    pinned = (ROOT / "tools" / "requirements.txt").read_text("utf-8").splitlines()
    assert set(shlex.split(runs[2])[3:]) <= set(pinned)


def test_the_workflow_takes_ajar_from_its_own_checkout() -> None:
    """The repository that is guarded is another one."""
    (ajar,) = (step["with"] for step in steps() if "checkout" in step.get("uses", "") and "with" in step)
    install, pip = (step["run"] for step in steps() if step.get("run", "").startswith(("cargo", "pip")))
    assert shlex.split(install)[-1] == ajar["path"]
    assert f"./{ajar['path']}/tools" in shlex.split(pip)
    assert (ROOT / "tools" / "pyproject.toml").is_file()
    (cache,) = (step for step in steps() if "cache" in step.get("uses", ""))
    assert cache["with"]["path"].endswith("/bin/ajar")
    skipped = [step["run"].split()[0] for step in steps() if "cache-hit" in step.get("if", "")]
    assert skipped == ["rustup", "cargo"]


def test_the_workflow_keeps_what_the_run_leaves() -> None:
    *_, last = steps()
    assert "upload-artifact" in last["uses"]
    assert last["with"]["path"].split() == ["ajar-artifacts", "junit.xml"]
    # YAML reads the key `on` as a truth value.
    assert set(WORKFLOW[True]) == {"push", "pull_request"}
