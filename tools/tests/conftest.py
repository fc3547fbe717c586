"""Lets tests import the modules beside them and those of tools/proof, however pytest is started."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from live_page import Bench

pytest_plugins = ["pytester"]
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "proof")]


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    """The page of `ajar watch`, one for the tests of a module."""
    from live_page import benched

    with benched(tmp_path_factory.mktemp("watch")) as bench:
        yield bench
