"""What `ajar watch` shows on a terminal: a few lines that are kept up to date, and messages above them."""

import os
import re
import select
import signal
import subprocess
import time
from pathlib import Path

import pytest
from watching import studio

pty = pytest.importorskip("pty")
# How long anything may take on a machine that is busy.
PATIENCE = 120


class Terminal:
    """The program on a terminal of its own."""

    def __init__(self, *arguments: str | Path, state: Path) -> None:
        self.here, there = pty.openpty()
        command = [os.environ["AJAR_BIN"], "watch", *map(str, arguments), "--port", "0"]
        environment = {**os.environ, "TERM": "xterm", "XDG_STATE_HOME": str(state)}
        self.process = subprocess.Popen(command, stdin=there, stdout=there, stderr=there, env=environment)
        os.close(there)
        self.text = ""

    def read(self) -> bool:
        """Takes what there is within a moment; returns whether more may come."""
        if not select.select([self.here], [], [], 1)[0]:
            return True
        try:
            more = os.read(self.here, 65536)
        except OSError:  # It is closed.
            return False
        self.text += re.sub("\x1b\\[[0-9;?]*[A-Za-z]", "", more.decode(errors="replace"))
        return bool(more)

    def wait_for(self, pattern: str) -> re.Match[str]:
        """Waits until this is there, and forgets what was before it."""
        end = time.monotonic() + PATIENCE
        while not (found := re.search(pattern, self.text)):
            assert self.read(), self.text
            assert time.monotonic() < end, self.text
        self.text = self.text[found.end() :]
        return found

    def end(self) -> int:
        self.process.send_signal(signal.SIGINT)
        while self.read():
            pass
        os.close(self.here)
        return self.process.wait()


@pytest.mark.skipif("AJAR_BIN" not in os.environ, reason="AJAR_BIN names no program")
def test_the_lines_say_what_the_page_does(tmp_path: Path) -> None:
    scene = studio(tmp_path)
    terminal = Terminal(scene, state=tmp_path)
    terminal.wait_for(r"scene   \S*scene\.toml")
    terminal.wait_for(r"page    http://127\.0\.0\.1:\d+/[0-9a-f]{32}/")
    terminal.wait_for(r"image   1: done 320x200, 8 samples a pixel")
    good = scene.read_text()
    scene.write_text(good.replace("size =", "sise ="))
    terminal.wait_for(r"scene\.toml:\d+:\d+: error: render\.sise: unknown key")
    terminal.wait_for(r"hint: did you mean")
    terminal.wait_for(r"error   \S*scene\.toml:\d+:\d+")
    scene.write_text(good.replace("illuminance = 10", "illuminance = 20"))
    terminal.wait_for(r"change  scene\.toml")
    terminal.wait_for(r"image   2: done")
    assert terminal.end() == 0
