"""`python -m ajar_tools compare NEW REFERENCE`, the same as `ajar-compare NEW REFERENCE`."""

import sys

from ajar_tools.cli import main

COMMANDS = {"compare": main}
USAGE = "usage: python -m ajar_tools compare NEW REFERENCE [OPTIONS]; compare --help says more"

if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] not in COMMANDS:
        print(USAGE, file=sys.stderr)
        sys.exit(2)
    sys.exit(COMMANDS[sys.argv[1]](sys.argv[2:]))
