"""A browser for the tests of pages: one that is installed, or Playwright's own.

As a program: exit code 0 if one starts.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome")


class NoBrowserError(Exception):
    """No browser starts: the message says how to get one."""


@contextmanager
def started(*flags: str) -> Iterator[Any]:
    """A headless Chromium, with flags of its command line.

    Raises:
        NoBrowserError: there is none, or it does not start.
    """
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError as error:
        raise NoBrowserError("there is no playwright (tools/requirements.txt)") from error
    installed = next(filter(None, map(shutil.which, NAMES)), None)
    with sync_playwright() as playwright:
        try:
            browser = playwright.chromium.launch(executable_path=installed, args=["--no-sandbox", *flags])
        except Error as error:
            lines = [line for line in str(error).splitlines() if line.strip(" ╔║╚═")]
            advice = "Debian: apt-get install chromium; elsewhere: python -m playwright install --with-deps chromium"
            raise NoBrowserError(f"no browser starts ({advice}): {lines[0]}") from error
        try:
            yield browser
        finally:
            browser.close()


if __name__ == "__main__":
    try:
        with started():
            pass
    except NoBrowserError as error:
        sys.exit(str(error))
