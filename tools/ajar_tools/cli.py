"""`ajar-compare NEW REFERENCE`: a verdict in words, as JSON, JUnit or HTML, and an exit code."""

from __future__ import annotations

import argparse
import json
import shlex
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ajar_tools.comparison import compare
from ajar_tools.junit import annotation, junit
from ajar_tools.settings import Settings, SettingsError, load
from ajar_tools.verdict import Outcome, Verdict

EPILOG = """Exit codes: 0 the same picture, 1 a different one, 2 they cannot be compared (missing, damaged or unsuitable
files, wrong usage). The gates and their limits: docs/compare.md."""


def parser() -> argparse.ArgumentParser:
    """The command line."""
    p = argparse.ArgumentParser(prog="ajar-compare", description=__doc__, epilog=EPILOG)
    p.add_argument("new", metavar="NEW", help="the image to judge, OpenEXR")
    p.add_argument("reference", metavar="REFERENCE", help="the image that is right")
    p.add_argument("--config", type=Path, metavar="compare.toml", help="other limits than the default ones")
    p.add_argument("--alpha", type=float, metavar="P", help="probability of a false alarm [default: 0.001]")
    p.add_argument("--other-renderer", action="store_true", help="compare colours only, whatever else the files hold")
    p.add_argument("--json", type=Path, metavar="FILE", help="write the verdict as JSON; - is standard output")
    p.add_argument("--junit", type=Path, metavar="FILE", help="write the verdict as JUnit XML")
    p.add_argument("--html", type=Path, metavar="FILE", help="write a self-contained report")
    p.add_argument("--github", action="store_true", help="print failures as annotations of GitHub Actions")
    p.add_argument("-q", "--quiet", action="store_true", help="print nothing but failures")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns the exit code. Wrong usage exits with 2, as argparse does."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    options = parser().parse_args(arguments)
    try:
        settings = load(options.config)
    except SettingsError as error:
        print(f"CANNOT COMPARE: {error}", file=sys.stderr)
        return Outcome.CANNOT.value
    settings = with_flags(settings, options)
    verdict = compare(options.new, options.reference, settings)
    if verdict.outcome is Outcome.CANNOT:
        print(verdict.headline(), file=sys.stderr)
    elif not (options.quiet and verdict.outcome is Outcome.PASS) and str(options.json) != "-":
        print(verdict.text())
    if options.github and verdict.outcome is not Outcome.PASS:
        print(annotation(Path(options.reference), verdict.headline()))
    try:
        write(options, settings, verdict, "ajar-compare " + shlex.join(arguments))
    except OSError as error:
        print(f"CANNOT COMPARE: {error.filename} cannot be written: {error.strerror}", file=sys.stderr)
        return Outcome.CANNOT.value
    return verdict.outcome.value


def with_flags(settings: Settings, options: argparse.Namespace) -> Settings:
    """Flags beat the file."""
    if options.alpha is not None:
        if not 0 < options.alpha < 1:
            parser().error("--alpha is a probability, between 0 and 1")
        settings = replace(settings, alpha=options.alpha)
    return replace(settings, other_renderer=settings.other_renderer or options.other_renderer)


def write(options: argparse.Namespace, settings: Settings, verdict: Verdict, command: str) -> None:
    """Writes the reports that were asked for."""
    if options.json:
        text = json.dumps(verdict.as_dict(), indent=1)
        if str(options.json) == "-":
            print(text)
        else:
            options.json.write_text(text, "utf-8")
    if options.junit:
        options.junit.write_text(junit([(Path(options.reference).stem, verdict)]), "utf-8")
    if options.html:
        from ajar_tools.report import write_report

        write_report(options.html, verdict, settings, command)


if __name__ == "__main__":
    sys.exit(main())
