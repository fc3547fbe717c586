"""How much faster two cores render than one, and what many emitters cost.

    cargo build --release
    python tools/bench/scaling.py target/release/ajar

renders scenes of the repository by each integrator on one thread and on `--threads`, in turn, and prints the ratio of
the fastest times of whole programs, preparation and writing included. Then path traces a hall under one lamp, and under
a hundred thousand emissive triangles that give the same light.
"""

import argparse
import math
import subprocess
import tempfile
import time
from pathlib import Path

SCENES = Path(__file__).parents[2] / "scenes"
ROUNDS = {"path": 2, "bdpt": 1, "mlt": 8, "ajar": 8}


def seconds(ajar, *arguments):
    """Time on the clock of one render."""
    start = time.perf_counter()
    subprocess.run([ajar, "render", *map(str, arguments), "--quiet"], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def scaling(ajar, threads, turns, folder):
    print(f"{'':24} 1 thread  {threads} threads  ratio")
    for scene in ["cornell", "door-ajar"]:
        for integrator, rounds in ROUNDS.items():
            image = [SCENES / scene / "scene.toml", "--integrator", integrator, "--size", "256x256"]
            image += ["--rounds", rounds, "-o", folder / "image.exr"]
            fastest = {}
            for _ in range(turns):
                for n in (1, threads):
                    taken = seconds(ajar, *image, "--threads", n)
                    fastest[n] = min(taken, fastest.get(n, math.inf))
            one, many = fastest[1], fastest[threads]
            print(f"{scene + ', ' + integrator:24} {one:6.2f} s   {many:6.2f} s     {one / many:.2f}")


def hall(folder, triangles, lamp):
    """A floor below a ceiling of small triangles that shine, or below one `lamp` of the same light under dark ones."""
    side = round(math.sqrt(triangles / 2))
    size = 10 / side
    corners, faces = [], []
    for i in range(side * side):
        x, z = (i % side) * size - 5, (i // side) * size - 5
        corners += [(x, 4, z), (x + size, 4, z), (x + size, 4, z + size), (x, 4, z + size)]
        faces.append([4 * i + 1, 4 * i + 2, 4 * i + 3, 4 * i + 4])
    corners += [(-8, 0, -8), (-8, 0, 8), (8, 0, 8), (8, 0, -8)]
    lines = ["mtllib hall.mtl", *("v {:.6f} {:.6f} {:.6f}".format(*corner) for corner in corners), "usemtl ceiling"]
    lines += ["f " + " ".join(map(str, face)) for face in faces]
    last = len(corners)
    lines += ["usemtl floor", f"f {last - 3} {last - 2} {last - 1} {last}"]
    (folder / "hall.obj").write_text("\n".join(lines))
    emission = 0 if lamp else 4
    ceiling = f"newmtl ceiling\nKd 0 0 0\nKe {emission} {emission} {emission}\n"
    (folder / "hall.mtl").write_text(ceiling + "newmtl floor\nKd 0.5 0.5 0.5\n")
    text = '[[import]]\nfile = "hall.obj"\n[[camera]]\nposition = [0, 1.5, 7]\ntarget = [0, 1, 0]\nyfov = 60\n'
    if lamp:
        text += '[[light]]\ntype = "rect"\nposition = [0, 3.999, 0]\ntarget = [0, 0, 0]\n'
        text += "width = 10\nheight = 10\nradiance = 4\n"
    (folder / "scene.toml").write_text(text)


def emitters(ajar, triangles, turns, folder):
    fastest = {True: math.inf, False: math.inf}
    image = [folder / "scene.toml", "--integrator", "path", "--size", "256x256", "-o", folder / "image.exr"]
    for _ in range(turns):
        for lamp in fastest:
            hall(folder, triangles, lamp)
            # One of both is longer by 256 samples a pixel: reading and building drop out of the difference.
            short, long = (seconds(ajar, *image, "--spp", spp) for spp in (16, 272))
            fastest[lamp] = min(long - short, fastest[lamp])
    print(f"256 samples a pixel under one lamp: {fastest[True]:.2f} s")
    print(f"under {triangles} emissive triangles: {fastest[False]:.2f} s, ratio {fastest[False] / fastest[True]:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ajar")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--turns", type=int, default=3)
    arguments = parser.parse_args()
    ajar = str(Path(arguments.ajar).resolve())
    with tempfile.TemporaryDirectory() as folder:
        scaling(ajar, arguments.threads, arguments.turns, Path(folder))
        emitters(ajar, 100_000, arguments.turns, Path(folder))


if __name__ == "__main__":
    main()
