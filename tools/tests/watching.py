"""`ajar watch` at work, for tests: a studio of a few files, the program, and what it says."""

import base64
import json
import os
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

SCENE = """
[[import]]
file = "box.obj"

[[camera]]
name = "main"
position = [3, 2, 4]
target = [0, 0, 0]

[[light]]
name = "sun"
type = "directional"
direction = [-1, -2, -1]
illuminance = 10

[[light]]
name = "sky"
type = "environment"
radiance = 0.3

[render]
size = [320, 200]
spp = 8
"""
BOX = """mtllib box.mtl
usemtl clay
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""


def material(color: str) -> str:
    return f"newmtl clay\nKd {color}\n"


def studio(folder: Path) -> Path:
    """Writes a scene; returns its file."""
    for name, text in {"box.obj": BOX, "box.mtl": material("0.6 0.6 0.6"), "scene.toml": SCENE}.items():
        (folder / name).write_text(text)
    # What is written just before the program reads it may have changed meanwhile, and is rendered twice.
    time.sleep(0.1)
    return folder / "scene.toml"


def swatch(folder: Path) -> Path:
    """Writes a glTF triangle in two variants before the camera of the studio; returns its file."""
    corners = struct.pack("<9f", 2.55, -0.1, 0.9, 0.15, -0.1, 2.7, 1.35, 2.9, 1.8)
    data = "data:application/octet-stream;base64," + base64.b64encode(corners).decode()
    variants = "KHR_materials_variants"
    mappings = [{"material": i, "variants": [i]} for i in range(2)]
    colors = [[0.8, 0.05, 0.05, 1], [0.05, 0.8, 0.05, 1]]
    primitive = {"attributes": {"POSITION": 0}, "material": 0, "extensions": {variants: {"mappings": mappings}}}
    limits = {"min": [0, -1, 0], "max": [3, 3, 3]}
    document = {
        "asset": {"version": "2.0"},
        "extensionsUsed": [variants],
        "extensions": {variants: {"variants": [{"name": "Red"}, {"name": "Green"}]}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "swatch", "mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {"baseColorFactor": it}} for it in colors],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"} | limits],
        "bufferViews": [{"buffer": 0, "byteLength": len(corners)}],
        "buffers": [{"byteLength": len(corners), "uri": data}],
    }
    (folder / "swatch.gltf").write_text(json.dumps(document))
    return folder / "swatch.gltf"


PAINTED = """#usda 1.0
(
    defaultPrim = "Box"
    metersPerUnit = 1
    upAxis = "Y"
)
def Xform "Box" (
    prepend variantSets = "paint"
    variants = {
        string paint = "Red"
    }
)
{
    def Cube "Cube"
    {
    }
    variantSet "paint" = {
        "Green" {
            over "Cube"
            {
                color3f[] primvars:displayColor = [(0.05, 0.8, 0.05)]
            }
        }
        "Red" {
            over "Cube"
            {
                color3f[] primvars:displayColor = [(0.8, 0.05, 0.05)]
            }
        }
    }
}
"""


def painted(folder: Path) -> Path:
    """Writes a USD box in two variants; returns its file."""
    (folder / "painted.usda").write_text(PAINTED)
    return folder / "painted.usda"


class Watch:
    """The program at work."""

    def __init__(self, *arguments: str | Path, state: Path) -> None:
        command = [os.environ.get("AJAR_BIN", "target/release/ajar"), "watch", *map(str, arguments)]
        environment = {"AJAR_USD_PYTHON": sys.executable, **os.environ, "XDG_STATE_HOME": str(state)}
        # The page's link and what happens come as JSON; nobody reads it to the end, so it goes to a file.
        self.log = state / "watch.log"
        with self.log.open("w") as log:
            self.process = subprocess.Popen([*command, "--log-format", "json"], stderr=log, env=environment)

    def said(self) -> list[dict[str, Any]]:
        lines = self.log.read_text().splitlines(keepends=True)
        return [json.loads(line) for line in lines if line.endswith("\n")]

    def url(self) -> str:
        """Link of the page; waits for it."""
        while self.process.poll() is None:
            for it in self.said():
                if "page" in it:
                    return str(it["page"])
        raise AssertionError(self.log.read_text())

    def end(self) -> int:
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        return self.process.wait()
