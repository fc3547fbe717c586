"""Time and memory that a large asset takes until its first pixels are there.

    cargo build --release
    pip install numpy
    python tools/bench/large.py target/release/ajar

writes a GLB of five million triangles (a rough sheet with normals) and renders it at one sample a pixel, by path
tracing and by default: reading, building the hierarchy, learning, one round, writing. `--triangles` takes another size,
`--threads` another number of threads; `--keep FILE` leaves the GLB there, for `importers/examples/parse.rs`. The most
memory that the last run holds is told beside what it holds while pixels are made, which is the prepared world with its
film (needs Linux).
"""

import argparse
import json
import os
import struct
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np


def sheet(triangles):
    """Positions, normals and triangles of a square sheet."""
    n = int(np.sqrt(triangles / 2)) + 1
    y, x = np.mgrid[0:n, 0:n].astype(np.float32) / (n - 1)
    rough = 0.01 * np.random.default_rng(0).random((n, n))
    height = 0.05 * np.sin(x * 40) * np.cos(y * 33) + rough
    positions = np.stack([x * 4 - 2, height, y * 4 - 2], -1).reshape(-1, 3).astype("<f4")
    normals = np.tile(np.array([0, 1, 0], "<f4"), (n * n, 1))
    i = np.arange(n * n, dtype="<u4").reshape(n, n)
    a, b, c, d = i[:-1, :-1], i[:-1, 1:], i[1:, :-1], i[1:, 1:]
    upper, lower = np.stack([a, c, b], -1), np.stack([b, c, d], -1)
    return positions, normals, np.concatenate([upper.reshape(-1, 3), lower.reshape(-1, 3)])


def write_glb(path, positions, normals, triangles):
    arrays = [positions, normals, triangles]
    starts = np.cumsum([0] + [array.nbytes for array in arrays]).tolist()
    view = [{"buffer": 0, "byteOffset": start, "byteLength": array.nbytes} for start, array in zip(starts, arrays)]
    vector = {"componentType": 5126, "count": len(positions), "type": "VEC3"}
    limits = {"min": positions.min(0).tolist(), "max": positions.max(0).tolist()}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
        "accessors": [
            {"bufferView": 0, **vector, **limits},
            {"bufferView": 1, **vector},
            {"bufferView": 2, "componentType": 5125, "count": triangles.size, "type": "SCALAR"},
        ],
        "bufferViews": view,
        "buffers": [{"byteLength": starts[-1]}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + starts[-1]))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", starts[-1], b"BIN\0"))
        for array in arrays:
            file.write(array.tobytes())


def memory(pid):
    """Bytes that a process holds and the most that it held; none where it has ended."""
    status = Path(f"/proc/{pid}/status").read_text().splitlines()
    lines = {line.split()[0]: int(line.split()[1]) * 1024 for line in status if line.startswith(("VmRSS:", "VmHWM:"))}
    return (lines["VmRSS:"], lines["VmHWM:"]) if lines else None


def measure(command):
    """Seconds on the clock, seconds of processors, the most memory and that late in the run, in bytes."""
    start, samples, ended = time.perf_counter(), [], 0
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not ended:
        samples.append(memory(process.pid))
        time.sleep(0.002)
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
    seconds = time.perf_counter() - start
    if status != 0:
        raise SystemExit(f"{' '.join(command)} failed with status {status}")
    samples = [sample for sample in samples if sample]
    late = np.median([now for now, _ in samples[len(samples) * 3 // 4 :]])
    # Not `ru_maxrss`: it begins with what this program held when it started the other.
    return seconds, usage.ru_utime + usage.ru_stime, max(most for _, most in samples), late


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ajar")
    parser.add_argument("--triangles", type=int, default=5_000_000)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = arguments.keep or Path(folder) / "large.glb"
        positions, normals, triangles = sheet(arguments.triangles)
        write_glb(path, positions, normals, triangles)
        print(f"{len(triangles)} triangles, {path.stat().st_size / 2**20:.0f} MiB")
        program = str(Path(arguments.ajar).resolve())
        image = ["render", str(path), "--threads", str(arguments.threads), "-o", str(Path(folder) / "large.exr")]
        for name, command in [
            ("reading alone", ["inspect", str(path)]),
            ("reading and building", [*image, "--dry-run"]),
            ("first pixels by path", [*image, "--spp", "1", "--integrator", "path"]),
            ("first pixels by ajar", [*image, "--spp", "1", "--integrator", "ajar"]),
        ]:
            clock, processor, most, late = measure([program, *command])
            print(f"{name:24} {clock:6.2f} s, {processor:6.2f} s of processors, at most {most / 2**30:.2f} GiB")
        print(f"that is {most / late:.2f} times the {late / 2**30:.2f} GiB that the last run held late")


if __name__ == "__main__":
    main()
