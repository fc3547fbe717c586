"""The result of a comparison, as data and in words."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ajar_tools.gates.flip import FlipMap
    from ajar_tools.picture import Picture


# The gates whose pass says that the pictures are the same, the first that passes.
DECISIVE = ("exact", "statistics", "flip")
UNDECIDED = "no gate is left that could say that the pictures are the same"


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
    review: str = ""
    """What the new image becomes, where nobody judges it: "new reference" and the like."""
    exceptions: list[str] = field(default_factory=list)
    """Failures that the settings excuse, in words."""
    warnings: list[str] = field(default_factory=list)
    """Why a pass says little."""
    pictures: tuple[Picture, Picture] | None = None
    """What was compared, for reports: the new image and the reference."""
    flip: FlipMap | None = None
    """The map of gate 6, if it was reached."""

    @property
    def failures(self) -> list[GateResult]:
        """The gates that failed."""
        return [gate for gate in self.gates if gate.status is Status.FAIL]

    @property
    def deciding(self) -> list[GateResult]:
        """The gates that say that the pictures are the same."""
        return [gate for gate in self.gates if gate.status is Status.PASS and gate.gate in DECISIVE]

    @property
    def reason(self) -> str:
        """What decided, in words."""
        if self.problem:
            return self.problem
        if self.outcome is Outcome.FAIL:
            return "; ".join(gate.message for gate in self.failures) or UNDECIDED
        return self.deciding[0].message

    def title(self) -> str:
        """The verdict about which files."""
        if self.review:
            return f"{self.review.upper()}: {self.new}"
        if self.outcome is Outcome.CANNOT:
            return "CANNOT COMPARE"
        if self.outcome is Outcome.PASS:
            return f"SAME PICTURE: {self.new} agrees with {self.reference}"
        return f"DIFFERENT PICTURE: {self.new} is not {self.reference}"

    def headline(self) -> str:
        """One sentence with the reason of what is not a pass."""
        silent = self.outcome is Outcome.PASS and not self.review
        return self.title() if silent else f"{self.title()}: {self.reason}"

    def text(self) -> str:
        """The title and a line a gate."""
        lines = [self.title() if self.gates else self.headline()]
        lines += [f"  {i}. {g.gate:<10} {g.status.value:<6}  {g.message}" for i, g in enumerate(self.gates, 1)]
        lines += [f"  excused: {line}" for line in self.exceptions]
        lines += [f"  warning: {line}" for line in self.warnings]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """For JSON, which has no infinity: such numbers are texts."""
        gates = [
            {"gate": g.gate, "status": g.status.value.lower(), "message": g.message, "numbers": g.numbers}
            for g in self.gates
        ]
        return printable(
            {
                "outcome": self.outcome.name.lower(),
                "exit_code": self.outcome.value,
                "headline": self.headline(),
                "reason": self.reason,
                "new": self.new,
                "reference": self.reference,
                "problem": self.problem,
                "review": self.review,
                "gates": gates,
                "exceptions": self.exceptions,
                "warnings": self.warnings,
            }
        )


def printable(value: Any) -> Any:
    """JSON has no infinity: such numbers become texts."""
    if isinstance(value, dict):
        return {key: printable(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [printable(item) for item in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value
