"""Runs the package that comes on standard input: a JSON object from the names of its modules to their texts."""

import importlib.abc
import importlib.util
import json
import sys

PACKAGE = "ajar_import_usd"
TEXTS = json.load(sys.stdin)


class Finder(importlib.abc.MetaPathFinder, importlib.abc.InspectLoader):
    """Finds the modules in `TEXTS`."""

    def find_spec(self, fullname, path=None, target=None):
        package, _, name = fullname.partition(".")
        if package != PACKAGE or (name or "__init__") not in TEXTS:
            return None
        return importlib.util.spec_from_loader(fullname, self, is_package=not name)

    def get_source(self, fullname):
        return TEXTS[fullname.partition(".")[2] or "__init__"]

    def is_package(self, fullname):
        return fullname == PACKAGE


sys.meta_path.insert(0, Finder())
importlib.import_module(f"{PACKAGE}.main").main()
