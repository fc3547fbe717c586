"""Ray casting speed of Ajar beside Embree's.

    cargo build --release -p ajar-render --example rays
    pip install embreex numpy
    python tools/bench/rays.py target/release/examples/rays

runs the example, which writes a furnished room and incoherent rays, and casts the same rays with Embree's
robust single-ray query, one thread each. The two take turns and the fastest time of each batch counts, so that other
work on the machine does not decide. Also tells how many hits differ.
"""

import re
import subprocess
import sys
import tempfile
import time

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

BATCH = 500
PASSES = 8


def read(path):
    with open(path, "rb") as file:
        triangles, rays = np.fromfile(file, "<u8", 2)
        corners = np.fromfile(file, "<f4", triangles * 9).reshape(-1, 3, 3)
        origins = np.fromfile(file, "<f4", rays * 3).reshape(-1, 3)
        directions = np.fromfile(file, "<f4", rays * 3).reshape(-1, 3)
        distances = np.fromfile(file, "<f4", rays)
    return corners, origins, directions, distances


def passes(scene, origins, directions, fastest):
    """Updates the fastest time of each batch."""
    for batch in range(len(fastest)):
        span = slice(batch * BATCH, (batch + 1) * BATCH)
        start = time.perf_counter()
        scene.run(origins[span], directions[span])
        fastest[batch] = min(fastest[batch], time.perf_counter() - start)


def differing(scene, origins, directions, distances):
    embree = scene.run(origins, directions, query="DISTANCE")
    embree = np.where(embree >= 1e30, np.inf, embree)
    with np.errstate(invalid="ignore"):
        same = (embree == distances) | (np.abs(embree - distances) <= 1e-4 * (1 + distances))
    return np.count_nonzero(~same)


def main(example, turns=3):
    ours, fastest = 0.0, None
    with tempfile.NamedTemporaryFile() as file:
        for _ in range(turns):
            text = subprocess.run([example, file.name], check=True, capture_output=True, text=True).stdout
            ours = max(ours, float(re.search(r"nearest ([\d.]+)", text)[1]))
            corners, origins, directions, distances = read(file.name)
            if fastest is None:
                fastest = np.full(len(origins) // BATCH, np.inf)
                scene = EmbreeScene(robust=True)
                _mesh = TriangleMesh(scene, corners)
                scene.run(origins[:1], directions[:1])  # builds the tree
            for _ in range(PASSES):
                passes(scene, origins, directions, fastest)
    theirs = len(origins) / fastest.sum() / 1e6
    print(text.strip())
    print(f"hits that differ {differing(scene, origins, directions, distances)} of {len(distances)}")
    print(f"Mrays/s ajar {ours:.3f} embree (robust) {theirs:.3f} ratio {ours / theirs:.3f}")


if __name__ == "__main__":
    main(sys.argv[1])
