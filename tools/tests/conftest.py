"""Lets tests import the modules beside them and those of tools/proof, however pytest is started."""

import sys
from pathlib import Path

pytest_plugins = ["pytester"]
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "proof")]
