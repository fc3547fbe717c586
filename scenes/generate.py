#!/usr/bin/env python3
"""Makes the assets of the example scenes again: `python3 scenes/generate.py [name…]`.

Needs numpy and Pillow. Without names it makes all scenes. The files come out
byte for byte the same each time.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def main(names: list[str]) -> int:
    """Runs the generators of the named scenes, then prints what the folder weighs."""
    known = sorted(script.parent.name for script in HERE.glob("*/generate.py"))
    unknown = [name for name in names if name not in known]
    if unknown:
        print(f"error: no scene called {', '.join(unknown)}; there are {', '.join(known)}", file=sys.stderr)
        return 2
    for name in names or known:
        if subprocess.run([sys.executable, HERE / name / "generate.py"], check=False).returncode != 0:
            return 1
    size = sum(path.stat().st_size for name in known for path in (HERE / name).rglob("*") if path.is_file())
    print(f"all scenes: {size / 1e6:.2f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
