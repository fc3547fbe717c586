"""Makes tools/tests/peers: the Cornell box by Mitsuba and by Cycles, small, for tests of comparison across renderers.

.venv/bin/python tools/peers/stored.py --mitsuba PYTHON --bpy PYTHON       Pythons that have mitsuba and bpy
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "bench" / "peers"))

from make import make

HERE = Path(__file__).parent
FOLDER = HERE.parent / "tests" / "peers"
SIZE, DEPTH = 48, 16
SPP, PASSES = 256, 16


def mitsuba(python: str, scene: Path, home: Path) -> None:
    """One image as Mitsuba writes it, and its passes as an image that declares its noise."""
    prefix = home / "pass"
    command = [python, HERE / "mitsuba_passes.py", scene, str(SPP), str(PASSES), FOLDER / "cornell-mitsuba.exr", prefix]
    subprocess.run(command, check=True)
    passes = [f"{prefix}-{seed}.exr" for seed in range(PASSES)]
    average = [sys.executable, "-m", "ajar_tools", "average", *passes, "-o", FOLDER / "cornell-mitsuba-passes.exr"]
    subprocess.run(average, check=True)


def cycles(python: str, scene: Path) -> None:
    """One image as Blender writes it; the lamp is the only light."""
    camera = json.loads((scene / "scene.json").read_text())["camera"]
    placed = {"position": camera["origin"], "target": camera["target"], "yfov": camera["fov"]}
    asked = json.dumps({"sky": 0, "sun": 0, "angle": 0, "direction": [0, -1, 0], "camera": placed})
    command = [python, HERE / "cycles_peer.py", scene / "scene.glb", FOLDER / "cornell-cycles.exr", str(SIZE)]
    subprocess.run([*command, str(SPP * PASSES), asked], check=True)


def main() -> None:
    """Makes the images of the renderers that are named."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--mitsuba", metavar="PYTHON")
    parser.add_argument("--bpy", metavar="PYTHON")
    arguments = parser.parse_args()
    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        make("cornell", home / "scene", SIZE, DEPTH)
        if arguments.mitsuba:
            mitsuba(arguments.mitsuba, home / "scene", home)
        if arguments.bpy:
            cycles(arguments.bpy, home / "scene")


if __name__ == "__main__":
    main()
