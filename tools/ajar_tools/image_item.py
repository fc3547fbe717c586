"""The test of one case: render, compare, keep what is worth looking at."""

from __future__ import annotations

import os
import shlex
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from ajar_tools.artifacts import Artifacts
from ajar_tools.cases import CONFIG, Case, RenderError
from ajar_tools.comparison import compare
from ajar_tools.settings import Settings
from ajar_tools.verdict import GateResult, Outcome, Status, Verdict


class CaseFailedError(Exception):
    """A case that differs, or cannot be rendered or compared; the message is all that a person needs."""


class ImageItem(pytest.Item):
    """A case as a test."""

    def __init__(self, *, case: Case, **keywords: Any) -> None:
        super().__init__(**keywords)
        self.case = case
        self.artifacts = Artifacts(Path())
        self.settings = case.settings

    def prepare(self, artifacts: Artifacts, alpha: float) -> None:
        """Learns where to write and how many false alarms are this case's; its own alpha, if it sets one, stays."""
        self.artifacts = artifacts
        if self.settings.alpha == Settings().alpha:
            self.settings = replace(self.settings, alpha=alpha)

    def runtest(self) -> None:
        """Renders and compares, or makes the reference."""
        new = self.artifacts.case(self.case.name) / "new.exr"
        try:
            self.case.render(new, self.config.getoption("--ajar-binary"))
        except RenderError as error:
            self.fail(f"{self.case.name} cannot be rendered: {error}")
        if self.config.getoption("--ajar-update"):
            self.update(new)
        else:
            self.judge(new)

    def judge(self, new: Path) -> None:
        """Fails unless the new image shows what the reference shows."""
        if not self.case.reference.is_file():
            self.fail(
                f"{self.case.name} has no reference image. Make one, look at it, and commit it:\n"
                f"    {self.update_command()}"
            )
        verdict = compare(shown(new), shown(self.case.reference), self.settings)
        if self.config.getoption("--ajar-exact"):
            require_exact(verdict)
        folder = self.artifacts.keep(self.case.name, verdict, self.settings, self.command(new))
        if verdict.outcome is Outcome.PASS:
            return
        report = folder / "report.html"
        lines = [verdict.text(), f"new image: {shown(new)}"]
        lines += [f"report:    {shown(report)}"] if report.exists() else []
        lines += ["if the change is meant, review and commit the new reference:", f"    {self.update_command()}"]
        self.fail("\n".join(lines), verdict.headline())

    def update(self, new: Path) -> None:
        """Replaces the reference unless it holds the same pixels; keeps the old one beside the report."""
        reference, folder = self.case.reference, self.artifacts.case(self.case.name)
        check = compare(new, new, self.settings)
        if check.outcome is not Outcome.PASS:
            self.fail(f"this image cannot be a reference: {check.headline()}")
        old = folder / "old.exr"
        if reference.exists():
            shutil.copyfile(reference, old)
            verdict = compare(shown(new), shown(old), self.settings)
            if verdict.gates and verdict.gates[-1].gate == "exact":
                verdict.gates[-1].message += "; the reference was kept"
                self.artifacts.keep(self.case.name, verdict, self.settings, self.command(new))
                return
        else:
            verdict = check
        self.artifacts.keep(self.case.name, verdict, self.settings, self.command(new), always=True)
        beside = reference.with_name(f".{reference.name}.{os.getpid()}")
        shutil.copyfile(new, beside)
        beside.replace(reference)

    def fail(self, message: str, headline: str = "") -> None:
        """Ends the test; the headline goes to annotations and JUnit."""
        self.user_properties.append(("ajar", headline or message.splitlines()[0]))
        raise CaseFailedError(message)

    def command(self, new: Path) -> str:
        """What a person types to see the same verdict."""
        command = ["ajar-compare", shown(new), shown(self.case.reference)]
        if (self.case.folder / CONFIG).exists():
            command += ["--config", shown(self.case.folder / CONFIG)]
        return shlex.join([*command, "--alpha", f"{self.settings.alpha:.3g}"])

    def update_command(self) -> str:
        """What a person types to make the reference."""
        return shlex.join(["pytest", shown(self.case.folder), "--ajar-update"])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The message alone: no trace helps to understand a picture."""
        if isinstance(excinfo.value, CaseFailedError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Where the case is, for pytest and its reports."""
        return self.path, 0, self.case.name


def shown(path: Path) -> str:
    """A path relative to the current folder where that is shorter."""
    relative = os.path.relpath(path)
    return str(path) if relative.startswith("..") else relative


def require_exact(verdict: Verdict) -> None:
    """Turns a picture that is only statistically the same into a failure."""
    if verdict.outcome is Outcome.PASS and verdict.gates[-1].gate != "exact":
        verdict.outcome = Outcome.FAIL
        exact: GateResult = next(gate for gate in verdict.gates if gate.gate == "exact")
        exact.status = Status.FAIL
