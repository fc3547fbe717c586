"""Runs a package that comes on standard input, as a JSON object:

`package`  its name,
`files`    from paths inside it to their texts: modules, and what they read by `pkgutil.get_data`,
`start`    the module whose `main()` is called,
`program`  what the program is called,
`codes`    what is added to its exit codes.
"""

import importlib.abc
import importlib.util
import json
import sys

CARRIED = json.load(sys.stdin)
PACKAGE, FILES = CARRIED["package"], CARRIED["files"]


class Finder(importlib.abc.MetaPathFinder, importlib.abc.InspectLoader):
    """Finds the modules in `FILES`."""

    def find_spec(self, fullname, path=None, target=None):
        if self.file_of(fullname) not in FILES:
            return None
        return importlib.util.spec_from_loader(fullname, self, origin=self.file_of(fullname))

    def file_of(self, fullname):
        """The file of a module; of no module where another package is asked for."""
        package, *names = fullname.split(".")
        if package != PACKAGE:
            return None
        folder = "/".join([*names, "__init__.py"])
        return folder if folder in FILES else "/".join(names) + ".py"

    def get_source(self, fullname):
        return FILES[self.file_of(fullname)]

    def is_package(self, fullname):
        return self.file_of(fullname).endswith("__init__.py")

    def exec_module(self, module):
        # What `pkgutil.get_data` starts from.
        module.__file__ = module.__spec__.origin
        super().exec_module(module)

    def get_data(self, path):
        return FILES[path.replace("\\", "/")].encode("utf-8")


sys.meta_path.insert(0, Finder())
sys.argv[0] = CARRIED["program"]
try:
    start = importlib.import_module(f"{PACKAGE}.{CARRIED['start']}")
except ModuleNotFoundError as error:
    print(f"error: {sys.argv[0]} needs {error.name}, which {sys.executable} does not have", file=sys.stderr)
    sys.exit(2)
except ImportError as error:
    print(f"error: {sys.argv[0]} does not work with {sys.executable}: {error}", file=sys.stderr)
    sys.exit(2)


def run():
    """The exit code of the program."""
    try:
        return start.main() or 0
    except SystemExit as end:
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
            return 1
        return end.code or 0


sys.exit(CARRIED["codes"] + run())
