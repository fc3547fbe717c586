"""`ajar-compare NEW REFERENCE`: a verdict in words, as JSON, JUnit or HTML, and an exit code."""

from __future__ import annotations

import argparse
import io
import json
import shlex
import sys
import traceback
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ajar_tools import __version__
from ajar_tools.comparison import compare
from ajar_tools.junit import annotation, junit, title
from ajar_tools.picture import CannotCompareError
from ajar_tools.settings import Settings, SettingsError, checked, load
from ajar_tools.verdict import Outcome, Verdict

DESCRIPTION = "Say whether two OpenEXR files show the same picture, but for noise."
EPILOG = """Exit codes: 0 the same picture, 1 a different one, 2 they cannot be compared (missing, damaged or unsuitable
files, wrong usage). The gates and their limits: docs/compare.md."""


def program() -> str:
    """What the user called."""
    name = Path(sys.argv[0]).name
    return name if name in ("ajar-compare", "ajar diff") else "ajar-compare"


def parser() -> argparse.ArgumentParser:
    """The command line."""
    p = argparse.ArgumentParser(prog=program(), description=DESCRIPTION, epilog=EPILOG)
    p.add_argument("new", metavar="NEW", help="the image to judge, OpenEXR")
    p.add_argument("reference", metavar="REFERENCE", help="the image that is right")
    p.add_argument("--config", type=Path, metavar="compare.toml", help="other limits than the default ones")
    p.add_argument("--alpha", type=float, metavar="P", help="probability of a false alarm [default: 0.001]")
    p.add_argument("--other-renderer", action="store_true", help="compare colours only, whatever else the files hold")
    p.add_argument("--json", type=Path, metavar="FILE", help="write the verdict as JSON; - is standard output")
    p.add_argument("--junit", type=Path, metavar="FILE", help="write the verdict as JUnit XML")
    p.add_argument("--html", type=Path, metavar="FILE", help="write a self-contained report")
    p.add_argument("--github", action="store_true", help="print failures as annotations of GitHub Actions")
    p.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    p.add_argument("-q", "--quiet", action="store_true", help="print nothing but failures")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns the exit code. Wrong usage exits with 2, as argparse does."""
    for stream in (sys.stdout, sys.stderr):
        # What a terminal cannot show must not turn a verdict into a crash.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        return run(sys.argv[1:] if arguments is None else list(arguments))
    except Exception:  # Python would end with 1, which is a verdict here.
        traceback.print_exc()
        return Outcome.CANNOT.value


def run(arguments: list[str]) -> int:
    """Compares as the arguments say."""
    options = parser().parse_args(arguments)
    try:
        settings = with_flags(load(options.config), options)
        verdict = compare(options.new, options.reference, settings)
        tell(options, verdict)
        write(options, settings, verdict, f"{program()} {shlex.join(arguments)}")
    except (SettingsError, CannotCompareError) as error:
        return refuse(str(error))
    except MemoryError:
        return refuse("there is not enough memory")
    except OSError as error:
        return refuse(f"{error.filename or 'standard output'} cannot be written: {error.strerror}")
    return verdict.outcome.value


def refuse(problem: str) -> int:
    """Says why there is no verdict."""
    print(f"CANNOT COMPARE: {problem}", file=sys.stderr)
    return Outcome.CANNOT.value


def tell(options: argparse.Namespace, verdict: Verdict) -> None:
    """Prints the verdict."""
    if verdict.outcome is Outcome.CANNOT:
        print(verdict.headline(), file=sys.stderr)
    elif not (options.quiet and verdict.outcome is Outcome.PASS) and str(options.json) != "-":
        print(verdict.text())
    if options.github and verdict.outcome is not Outcome.PASS:
        # GitHub reads both streams.
        stream = sys.stderr if str(options.json) == "-" else sys.stdout
        print(annotation(Path(options.reference), verdict.headline(), title(verdict)), file=stream)


def with_flags(settings: Settings, options: argparse.Namespace) -> Settings:
    """Flags beat the file."""
    if options.alpha is not None:
        settings = replace(settings, alpha=checked("alpha", options.alpha, settings.alpha, "the command line"))
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
