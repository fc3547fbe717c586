"""How long `ajar watch` takes from a save to the first pixels that show it.

    cargo build --release
    pip install numpy
    python tools/bench/watch.py target/release/ajar

writes a scene around an asset of a million triangles with a texture, opens the page's WebSocket as a browser does, and
saves material, camera, texture and geometry again and again: `--saves` times each. First it tells how long the first
pixels take from the start of the program. The clock of a save runs from the moment that
the file has its new name until the first part of a changed frame has arrived. It also changes a material from the
page, into a render at work, at moments spread over its first seconds; there the clock runs until the old render has
stopped, and until the first changed part.
"""

import argparse
import base64
import json
import os
import socket
import statistics
import struct
import subprocess
import tempfile
import threading
import time
import zlib
from collections import deque
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
from large import sheet

# The fractional parts of its multiples spread evenly.
GOLDEN = 0.618034
# Columns of the image.
WIDTH = 1280
SCENE = """
[[import]]
file = "sheet.glb"

[[camera]]
name = "main"
position = [{x}, 2, 3]
target = [0, 0, 0]

[[light]]
type = "environment"
radiance = 0.5

[[light]]
type = "directional"
direction = [-1, -2, -1]
illuminance = 3

[material.sheet]
base_color_texture = "wood.png"
roughness = {roughness}

[render]
size = [1280, 720]
noise = 0.001
"""


def write(path, content):
    """As editors do: a new file takes the name. Returns when it did."""
    other = path.with_suffix(".new")
    other.write_bytes(content)
    os.replace(other, path)
    return time.perf_counter()


def glb(positions, normals, triangles):
    """The sheet with texture coordinates and a material."""
    uvs = (positions[:, [0, 2]] / 4 + 0.5).astype("<f4")
    arrays = [positions, normals, uvs, triangles]
    starts = np.cumsum([0] + [array.nbytes for array in arrays]).tolist()
    view = [{"buffer": 0, "byteOffset": start, "byteLength": array.nbytes} for start, array in zip(starts, arrays)]
    floats = {"componentType": 5126, "count": len(positions)}
    limits = {"min": positions.min(0).tolist(), "max": positions.max(0).tolist()}
    attributes = {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "materials": [{"name": "sheet"}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 3, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "type": "VEC3", **floats, **limits},
            {"bufferView": 1, "type": "VEC3", **floats},
            {"bufferView": 2, "type": "VEC2", **floats},
            {"bufferView": 3, "componentType": 5125, "count": triangles.size, "type": "SCALAR"},
        ],
        "bufferViews": view,
        "buffers": [{"byteLength": starts[-1]}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = b"".join(array.tobytes() for array in arrays)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(body), b"BIN\0") + body


def png(number, side=1024):
    """A picture of noise, each number another."""
    noise = np.random.default_rng(number).integers(90, 200, (side, side, 3), "u1")
    rows = np.concatenate([np.zeros((side, 1), "u1"), noise.reshape(side, -1)], axis=1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1))
        + chunk(b"IEND", b"")
    )


class Page:
    """The WebSocket of a page (RFC 6455), as far as listening goes."""

    def __init__(self, url):
        parts = urlsplit(url)
        self.socket = socket.create_connection((parts.hostname, parts.port), timeout=120)
        key = base64.b64encode(os.urandom(16)).decode()
        headers = {
            "Host": parts.netloc,
            "Origin": f"http://{parts.netloc}",
            "Connection": "Upgrade",
            "Upgrade": "websocket",
            "Sec-WebSocket-Version": "13",
            "Sec-WebSocket-Key": key,
        }
        lines = [f"GET {parts.path}socket HTTP/1.1", *(f"{name}: {value}" for name, value in headers.items())]
        self.socket.sendall("".join(line + "\r\n" for line in [*lines, ""]).encode())
        self.stream = self.socket.makefile("rb")
        while self.stream.readline() != b"\r\n":
            pass

    def ask(self, request):
        """Sends a request; returns when it did."""
        text = json.dumps(request).encode()
        # The mask is all zeros, which leaves the text as it is.
        self.socket.sendall(b"\x81" + struct.pack("B", 0x80 | len(text)) + bytes(4) + text)
        return time.perf_counter()

    def stopped(self):
        """Waits until a render is at work no more; returns when that was."""
        while True:
            it = self.message()
            if is_state(it) and it["phase"] != "rendering":
                return time.perf_counter()

    def message(self):
        """A document, or the columns of the frame that a part is of."""
        first, length = self.stream.read(2)
        if length == 126:
            (length,) = struct.unpack(">H", self.stream.read(2))
        elif length == 127:
            (length,) = struct.unpack(">Q", self.stream.read(8))
        payload = self.stream.read(length)
        return json.loads(payload) if first & 15 == 1 else struct.unpack_from("<I", payload)[0]

    def until_quiet(self, seconds):
        """Takes all that comes for so long, so that what comes later is new."""
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            self.message()

    def image(self):
        """Waits for the first frame, a coarse one, of an image that is newer than any before; returns when that was."""
        newest = getattr(self, "newest", 0)
        found = 0
        while True:
            it = self.message()
            # What is left of the image before has all columns.
            if found > newest and isinstance(it, int) and it < WIDTH:
                self.newest = found
                return time.perf_counter()
            if is_state(it) and it["phase"] == "rendering":
                found = it["image"]


def is_state(it):
    """Whether a message tells what is going on."""
    return isinstance(it, dict) and it["type"] == "state"


def report(name, times):
    high = statistics.quantiles(times, n=20)[-1] if len(times) > 1 else times[0]
    print(f"{name:9} {statistics.median(times):6.2f} s {high:6.2f} s", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ajar")
    parser.add_argument("--saves", type=int, default=20)
    parser.add_argument("--triangles", type=int, default=1_000_000)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    positions, normals, triangles = sheet(options.triangles)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)

        def scene(number):
            text = SCENE.format(x=2 + number[0] * 0.01, roughness=0.2 + number[1] * 0.01)
            return write(folder / "scene.toml", text.encode())

        def shape(number):
            positions[: len(positions) // 10, 1] += 0.01
            return glb(positions, normals, triangles)

        write(folder / "sheet.glb", shape(0))
        write(folder / "wood.png", png(0))
        scene([0, 0])
        edits = {
            "material": lambda i: scene([0, i]),
            "camera": lambda i: scene([i, 0]),
            "texture": lambda i: write(folder / "wood.png", textures[i]),
            "geometry": lambda i: write(folder / "sheet.glb", shape(i)),
        }
        textures = [png(i) for i in range(options.saves + 1)]
        command = [options.ajar, "watch", folder / "scene.toml", "--port", "0", "--log-format", "json"]
        began = time.perf_counter()
        process = subprocess.Popen([*command, "--threads", str(options.threads)], stderr=subprocess.PIPE, text=True)
        try:
            said = (json.loads(line) for line in process.stderr)
            page = Page(next(it["page"] for it in said if "page" in it))
            # Who is not listened to waits when the pipe is full.
            threading.Thread(target=deque, args=[process.stderr, 0], daemon=True).start()
            first = page.image() - began
            print(f"{len(triangles):,} triangles, {options.threads} threads, {options.saves} saves each")
            print(f"from the start to the first pixels {first:.2f} s")
            print("edit       median     95 %")
            for name, save in edits.items():
                times = []
                for i in range(1, options.saves + 1):
                    # Into the render, so that it has to be stopped, while the page reads along as browsers do.
                    page.until_quiet(1.5)
                    saved = save(i)
                    times.append(page.image() - saved)
                report(name, times)
            stops, images = [], []
            for i in range(1, options.saves + 1):
                page.until_quiet(0.2 + 3.8 * (i * GOLDEN % 1))
                setting = {"do": "set", "table": "material", "name": "sheet", "key": "metallic", "value": i / 100}
                asked = page.ask(setting)
                stops.append(page.stopped() - asked)
                images.append(page.image() - asked)
            report("page", images)
            report("its stop", stops)
        finally:
            process.terminate()
            process.wait()


if __name__ == "__main__":
    main()
