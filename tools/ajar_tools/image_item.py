"""The test of one case: render, compare, keep what is worth looking at."""

from __future__ import annotations

import os
import shlex
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn

import pytest

from ajar_tools.artifacts import Artifacts, shown
from ajar_tools.cases import CONFIG, Case, RenderError, read_case
from ajar_tools.comparison import compare
from ajar_tools.junit import title
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

    @property
    def new(self) -> Path:
        """The image that is rendered."""
        return self.artifacts.case(self.case.name) / "new.exr"

    def prepare(self, artifacts: Artifacts, alpha: float) -> None:
        """Learns where to write and how many false alarms are this case's; its own alpha, if it sets one, stays."""
        self.artifacts = artifacts
        self.case = read_case(self.case.folder, Settings(alpha=alpha))

    def runtest(self) -> None:
        """Renders and compares, or makes the reference."""
        try:
            self.case.render(self.new, self.config.getoption("--ajar-binary"))
        except RenderError as error:
            self.refuse(f"{self.case.name} cannot be rendered: {error}", "image cannot be rendered")
        if self.config.getoption("--ajar-update"):
            self.update()
        elif self.case.reference.is_file():
            self.judge()
        else:
            how = f"Make one, look at it, and commit it:\n    {self.update_command()}"
            self.refuse(f"{self.case.name} has no reference image. {how}", "no reference image")

    def judge(self) -> None:
        """Fails unless the new image shows what the reference shows."""
        verdict = compare(shown(self.new), shown(self.case.reference), self.case.settings)
        if self.config.getoption("--ajar-exact"):
            require_exact(verdict)
        folder = self.keep(verdict, self.command(self.case.reference))
        for warning in verdict.warnings:
            self.warn(pytest.PytestWarning(f"{self.case.name}: {warning}"))
        if verdict.outcome is Outcome.PASS:
            return
        report = folder / "report.html"
        lines = [verdict.text(), f"new image: {shown(self.new)}"]
        lines += [f"report:    {shown(report)}"] if report.exists() else []
        lines += ["if the change is meant, review and commit the new reference:", f"    {self.update_command()}"]
        self.fail("\n".join(lines), verdict.headline(), title(verdict))

    def update(self) -> None:
        """Replaces the reference unless it is the same in all; keeps the old one beside the report."""
        check = compare(shown(self.new), shown(self.new), self.case.settings)
        if check.outcome is not Outcome.PASS:
            self.refuse(f"this image cannot be a reference: {check.headline()}", "image cannot be a reference")
        if not self.case.reference.exists():
            first = replace(check, gates=[], review="new reference", problem="nothing to compare with")
            self.keep(first, self.update_command(), always=True)
            self.replace_reference()
            return
        old = self.artifacts.case(self.case.name) / "old.exr"
        shutil.copyfile(self.case.reference, old)
        verdict = compare(shown(self.new), shown(old), self.case.settings)
        kept = bool(verdict.gates) and {verdict.gates[0].status, verdict.gates[-1].status} == {Status.PASS}
        kept = kept and verdict.gates[-1].gate == "exact"
        verdict.review = "kept reference" if kept else "changed reference"
        self.keep(verdict, self.command(old), always=not kept)
        if not kept:
            self.replace_reference()

    def replace_reference(self) -> None:
        """Never leaves half a file."""
        reference = self.case.reference
        beside = reference.with_name(f".{reference.name}.{os.getpid()}")
        shutil.copyfile(self.new, beside)
        beside.replace(reference)

    def keep(self, verdict: Verdict, command: str, always: bool = False) -> Path:
        """Stores a verdict among the artifacts."""
        return self.artifacts.keep(self.case.name, verdict, self.case.settings, command, always)

    def refuse(self, problem: str, topic: str) -> NoReturn:
        """Ends the test where there is nothing to compare; the list of cases says so too."""
        verdict = Verdict(Outcome.CANNOT, shown(self.new), shown(self.case.reference), problem=problem)
        self.keep(verdict, self.command(self.case.reference))
        self.fail(problem, " ".join(problem.split()), topic)

    def fail(self, message: str, headline: str, topic: str) -> NoReturn:
        """Ends the test; headline and topic go to annotations and JUnit."""
        self.user_properties += [("ajar", headline), ("ajar-title", topic)]
        raise CaseFailedError(message)

    def command(self, reference: Path) -> str:
        """What a person types to see the same verdict."""
        command = ["ajar-compare", shown(self.new), shown(reference)]
        if (self.case.folder / CONFIG).exists():
            command += ["--config", shown(self.case.folder / CONFIG)]
        return shlex.join([*command, "--alpha", f"{self.case.settings.alpha:.3g}"])

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


def require_exact(verdict: Verdict) -> None:
    """Turns a picture that is only statistically the same into a failure."""
    if verdict.outcome is Outcome.PASS and verdict.gates[-1].gate != "exact":
        verdict.outcome = Outcome.FAIL
        exact: GateResult = next(gate for gate in verdict.gates if gate.gate == "exact")
        exact.status = Status.FAIL
