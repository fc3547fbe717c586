"""What showing costs: processor time of `ajar watch` with pages that read along, beside that of `ajar render`.

cargo build --release
pip install numpy
python tools/bench/watch_cpu.py target/release/ajar scenes/window-room/scene.toml --spp 64 --pages 2
"""

import argparse
import json
import os
import signal
import subprocess
import tempfile
import threading
from pathlib import Path

from watch import Page


def seconds(process):
    """Processor time of a process that has ended, in its own code and for it in the kernel."""
    _, code, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(code)
    return usage.ru_utime + usage.ru_stime


def read(page, received):
    """Reads all that comes."""
    try:
        while True:
            received[0] += page.message() is None
    except (ValueError, OSError):
        return


def watch(command, pages):
    """Processor time until the image is done, and the parts of frames that pages got."""
    process = subprocess.Popen([*command, "--port", "0", "--log-format", "json"], stderr=subprocess.PIPE, text=True)
    received = [0]
    for line in process.stderr:
        it = json.loads(line)
        if "page" in it:
            for _ in range(pages):
                threading.Thread(target=read, args=(Page(it["page"]), received), daemon=True).start()
        if it.get("phase") == "done":
            break
    process.send_signal(signal.SIGINT)
    return seconds(process), received[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ajar")
    parser.add_argument("scene")
    parser.add_argument("--spp", default="64")
    parser.add_argument("--pages", type=int, default=2)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.exr"
        asked = [options.scene, "--spp", options.spp]
        for _ in range(options.runs):
            alone = seconds(subprocess.Popen([options.ajar, "render", *asked, "-o", out, "--quiet"]))
            for pages in (0, options.pages):
                shown, parts = watch([options.ajar, "watch", *asked], pages)
                more = shown / alone - 1
                print(f"render {alone:6.1f} s, watch with {pages} pages {shown:6.1f} s ({more:+.1%}), {parts} parts")


if __name__ == "__main__":
    main()
