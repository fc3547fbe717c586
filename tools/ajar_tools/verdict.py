"""The result of a comparison, as data and in words."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from enum import Enum
from typing import Any


class Outcome(Enum):
    """Of a gate or a comparison; the value of a comparison's is its exit code."""

    PASS = 0
    FAIL = 1
    CANNOT = 2


class Status(Enum):
    """What a gate says."""

    PASS = "pass"
    FAIL = "FAIL"
    REPORT = "report"
    """It has numbers, and nobody asked it to judge."""
    SKIP = "skip"


@dataclass
class GateResult:
    """One gate's finding: a sentence for people, numbers for programs."""

    gate: str
    status: Status
    message: str
    numbers: dict[str, Any] = field(default_factory=dict)


@dataclass
class Verdict:
    """What came out of comparing two files."""

    outcome: Outcome
    new: str
    reference: str
    gates: list[GateResult] = field(default_factory=list)
    problem: str = ""
    """Why there is nothing to compare."""
    exceptions: list[str] = field(default_factory=list)
    """Failures that the settings excuse, in words."""

    @property
    def failures(self) -> list[GateResult]:
        """The gates that failed."""
        return [gate for gate in self.gates if gate.status is Status.FAIL]

    def headline(self) -> str:
        """One sentence."""
        if self.outcome is Outcome.CANNOT:
            return f"CANNOT COMPARE: {self.problem}"
        if self.outcome is Outcome.PASS:
            return f"SAME PICTURE: {self.new} agrees with {self.reference}"
        return f"DIFFERENT PICTURE: {self.new} is not {self.reference}: {self.failures[0].message}"

    def text(self) -> str:
        """The headline and a line a gate."""
        lines = [self.headline()]
        lines += [f"  {i}. {g.gate:<10} {g.status.value:<6}  {g.message}" for i, g in enumerate(self.gates, 1)]
        lines += [f"  excused: {line}" for line in self.exceptions]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        data = asdict(self)
        data["outcome"] = self.outcome.name.lower()
        data["exit_code"] = self.outcome.value
        data["headline"] = self.headline()
        for gate in data["gates"]:
            gate["status"] = gate["status"].value.lower()
        return data
