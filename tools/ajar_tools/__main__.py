"""`python -m ajar_tools compare NEW REFERENCE`, which is `ajar-compare`, and `python -m ajar_tools average PASS…`."""

import sys

from ajar_tools import average, cli

COMMANDS = {"average": average.main, "compare": cli.main}
USAGE = f"usage: python -m ajar_tools {{{','.join(COMMANDS)}}} …; each says more with --help"

if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] not in COMMANDS:
        print(USAGE, file=sys.stderr)
        sys.exit(2)
    sys.exit(COMMANDS[sys.argv[1]](sys.argv[2:]))
