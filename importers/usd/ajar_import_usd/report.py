"""Lines for the user and for Ajar, on standard error."""

from __future__ import annotations

import json
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TextIO

# What usd-core adds to a message: an address in memory.
NOISE = re.compile(r" \([a-z ]+ on stage @[^@]*@ <0x[0-9a-f]+>\)")
# "Warning: in Function at line 3 of /some/file.cpp -- the message", as usd-core prints it.
USD_LINE = re.compile(r"^(?:Warning|Error|Coding Error|Runtime Error)[^:]*: in \S+ at line \d+ of \S+ -- (.*)$")


class StageError(Exception):
    """The import cannot go on. `cause` is what has to change: asset, usage, resource or system."""

    def __init__(self, message: str, place: str | None = None, hint: str | None = None, cause: str = "asset") -> None:
        super().__init__(message)
        self.message, self.place, self.hint, self.cause = message, place, hint, cause


def commentary(error: Exception) -> str:
    """What an exception of usd-core says first, with the line of the file."""
    first = error.args[0] if error.args else error
    return " ".join(str(getattr(first, "commentary", first)).split())


class Report:
    """What the importer has to say. Ajar shows equal messages once and counts their places."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self.stream = stream or sys.stderr
        self.files: set[str] = set()

    def say(self, **line: Any) -> None:
        """Prints the entries that are not None."""
        print(
            json.dumps({key: value for key, value in line.items() if value is not None}), file=self.stream, flush=True
        )

    def approximate(self, place: object, message: str) -> None:
        """What is at `place`, mostly the path of a prim, is not shown as the stage says."""
        self.say(level="warning", message=message, place=str(place) if place else None, loss="approximated")

    def warn(self, place: object, message: str) -> None:
        """Something at `place` is dropped, or its effect is."""
        self.say(level="warning", message=message, place=str(place) if place else None, loss="dropped")

    def note(self, place: object, message: str) -> None:
        """Something worth knowing."""
        self.say(level="note", message=message, place=str(place) if place else None)

    def fail(self, failure: StageError) -> None:
        """The import failed."""
        self.say(
            level="error",
            message=failure.message,
            place=failure.place,
            hint=failure.hint,
            cause=None if failure.cause == "asset" else failure.cause,
        )

    def file(self, path: str) -> None:
        """A file was read, or looked for."""
        if path not in self.files:
            self.files.add(path)
            self.say(file=path)

    def progress(self, text: str) -> None:
        """Still alive."""
        self.say(progress=text)

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Turns what usd-core prints to standard error meanwhile into warnings."""
        sys.stderr.flush()
        kept = os.dup(2)
        outer, self.stream = self.stream, os.fdopen(kept, "w", closefd=False)
        with tempfile.TemporaryFile("w+", errors="replace") as said:
            os.dup2(said.fileno(), 2)
            try:
                yield
            finally:
                self.stream.flush()
                os.dup2(kept, 2)
                self.stream = outer
                os.close(kept)
                said.seek(0)
                for line in said:
                    self.repeat(line.strip())

    def repeat(self, line: str) -> None:
        """One line of usd-core."""
        if "format for @" in line and ".mtlx" in line:
            # MaterialX files are read here, usd-core cannot.
            return
        line = NOISE.sub("", line)
        match = USD_LINE.match(line)
        if match:
            self.warn(None, f"usd-core: {match[1]}")
        elif line:
            self.note(None, f"usd-core: {line}")
