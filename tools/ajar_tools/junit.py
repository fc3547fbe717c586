"""What continuous integration reads: JUnit XML and GitHub's annotations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from ajar_tools.verdict import Outcome, Verdict

# Titles of annotations.
DIFFERS, CANNOT = "image differs", "images cannot be compared"


def junit(cases: Sequence[tuple[str, Verdict]]) -> str:
    """A test suite with one test a case. A failure is a different picture, an error none that can be compared."""
    failures = sum(v.outcome is Outcome.FAIL for _, v in cases)
    errors = sum(v.outcome is Outcome.CANNOT for _, v in cases)
    counts = {"tests": str(len(cases)), "failures": str(failures), "errors": str(errors)}
    suite = ElementTree.Element("testsuite", {"name": "ajar", **counts})
    for name, verdict in cases:
        case = ElementTree.SubElement(suite, "testcase", {"classname": "ajar", "name": printable(name)})
        if verdict.outcome is not Outcome.PASS:
            tag = "failure" if verdict.outcome is Outcome.FAIL else "error"
            element = ElementTree.SubElement(case, tag, {"message": printable(verdict.headline())})
            element.text = printable(verdict.text())
    return ElementTree.tostring(suite, "unicode", xml_declaration=True) + "\n"


def printable(text: str) -> str:
    """Without the control characters that XML forbids."""
    return "".join(c if c in "\n\t" or c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def title(verdict: Verdict) -> str:
    """The annotation's of a verdict that is no pass."""
    return DIFFERS if verdict.outcome is Outcome.FAIL else CANNOT


def annotation(file: Path, message: str, title: str) -> str:
    """A line that GitHub Actions shows at a file; its "Workflow commands" say what to escape."""

    def escaped(text: str) -> str:
        return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")

    path = escaped(file.as_posix()).replace(":", "%3A").replace(",", "%2C")
    return f"::error file={path},title={escaped(title)}::{escaped(message)}"
