"""Two files through all gates, in order."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from ajar_tools.gates import exact, finite, flip, numbers, statistical, structure, variance
from ajar_tools.picture import CannotCompareError, Picture, read
from ajar_tools.settings import Settings
from ajar_tools.verdict import GateResult, Outcome, Status, Verdict

# Beyond these, other gates have nothing to say: differing windows, or pixels that are no numbers.
ENDING = ("structure", "finite")
# A change of all light beyond which a comparison that could not see it is worth a warning.
VAGUE = 0.2
# One beyond which it has not judged.
BLIND = 1.0


def compare(new: str | Path, reference: str | Path, settings: Settings | None = None) -> Verdict:
    """Whether the image `new` shows what `reference` shows. Never raises for what files hold."""
    try:
        with ThreadPoolExecutor() as pool:
            ours, theirs = pool.map(read, (new, reference))
        return compare_pictures(ours, theirs, settings or Settings())
    except CannotCompareError as error:
        return Verdict(Outcome.CANNOT, str(new), str(reference), problem=str(error))


def compare_pictures(new: Picture, reference: Picture, settings: Settings) -> Verdict:
    """As `compare`, for images already read.

    Raises:
        CannotCompareError: their windows differ, or one has no colours.
    """
    verdict = Verdict(Outcome.PASS, str(new.path), str(reference.path), pictures=(new, reference))
    for gate in (structure.check, finite.check, exact.check):
        result = gate(new, reference, settings)
        verdict.gates.append(result)
        if result.gate == "exact" and result.status is Status.PASS:
            return judge(verdict, settings)
        if result.gate in ENDING and result.status is Status.FAIL and not goes_on(result.gate, verdict, settings):
            # What ends the comparison cannot be excused: nothing else was looked at.
            return judge(verdict, replace(settings, excused=()))
    # numpy works without the interpreter's lock.
    with ThreadPoolExecutor() as pool:
        seen = pool.submit(flip.flip_map, new, reference, settings)
        checks = [pool.submit(gate.check, new, reference, settings) for gate in (statistical, variance, numbers)]
    verdict.flip = seen.result()
    statistics, noise, measures = (check.result() for check in checks)
    verdict.gates += [statistics, noise, flip.check(verdict.flip, settings, unjudged(statistics, settings)), measures]
    change = statistics.numbers.get("smallest_change", 0.0)
    if statistics.status is Status.PASS and change > VAGUE:
        verdict.warnings.append(
            f"so much noise is declared that only {change:.0%} more or less light would have been seen"
        )
    return judge(verdict, settings)


def unjudged(statistics: GateResult, settings: Settings) -> str:
    """Why gate 4 leaves the judgement to FLIP; empty if it does not."""
    if statistics.status is Status.SKIP:
        return statistics.message
    if statistics.status is Status.PASS and statistics.numbers.get("smallest_change", 0.0) > BLIND:
        return "so much noise is declared that twice the light would not have been seen"
    excused = statistics.gate in {entry.gate for entry in settings.excused}
    return "its failure is excused" if excused and statistics.status is Status.FAIL else ""


def goes_on(gate: str, verdict: Verdict, settings: Settings) -> bool:
    """Whether other gates can judge though one failed: its failure is excused, and pixels lie over each other."""
    assert verdict.pictures
    new, reference = verdict.pictures
    excused = gate in {entry.gate for entry in settings.excused}
    return excused and new.data_window == reference.data_window and new.color.shape == reference.color.shape


def judge(verdict: Verdict, settings: Settings) -> Verdict:
    """Sets the outcome; failures that the settings excuse are reported as such. Nobody's objection is no pass."""
    excused = {entry.gate: entry for entry in settings.excused}
    for gate in verdict.failures:
        if entry := excused.get(gate.gate):
            gate.status = Status.REPORT
            verdict.exceptions.append(f"{gate.gate}, until {entry.until}: {entry.reason}")
    verdict.outcome = Outcome.PASS if verdict.deciding and not verdict.failures else Outcome.FAIL
    return verdict
