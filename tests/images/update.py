"""Renders the references anew: AJAR_BIN=target/release/ajar .venv/bin/python tests/images/update.py [SCENE…]"""

import sys

from compare import CASES, reference, render

# The integrator that is best at each scene makes its reference.
BEST = dict(sorted(CASES))

for scene in sys.argv[1:] or sorted(BEST):
    reference(scene).parent.mkdir(exist_ok=True)
    render(scene, BEST[scene], reference(scene), rounds=64, seed=1000)
    reference(scene).with_suffix(".png").unlink()
    print(reference(scene), reference(scene).stat().st_size, "bytes")
