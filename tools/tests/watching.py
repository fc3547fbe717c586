"""`ajar watch` at work, for tests: a studio of a few files, the program, and what it says."""

import json
import os
import signal
import subprocess
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
    (folder / "box.obj").write_text(BOX)
    (folder / "box.mtl").write_text(material("0.6 0.6 0.6"))
    (folder / "scene.toml").write_text(SCENE)
    return folder / "scene.toml"


class Watch:
    """The program at work."""

    def __init__(self, *arguments: str | Path, state: Path) -> None:
        command = [os.environ.get("AJAR_BIN", "target/release/ajar"), "watch", *map(str, arguments)]
        environment = {**os.environ, "XDG_STATE_HOME": str(state)}
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
