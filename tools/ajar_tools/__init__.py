"""Comparison of renders with stored references, for continuous integration.

`compare` answers one question: is this the same picture, but for noise? It reads two OpenEXR files and runs seven gates
(`ajar_tools.gates`); the pytest plug-in (`ajar_tools.pytest_plugin`) does that for folders of cases.
"""

from ajar_tools.comparison import compare
from ajar_tools.picture import CannotCompareError, Picture, read
from ajar_tools.settings import Settings, SettingsError
from ajar_tools.verdict import Outcome, Verdict

__all__ = ["CannotCompareError", "Outcome", "Picture", "Settings", "SettingsError", "Verdict", "compare", "read"]
__version__ = "0.1.0"
