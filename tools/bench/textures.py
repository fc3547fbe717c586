"""How fast textures are decoded on one thread and on several, and how much memory that takes.

    cargo build --release
    pip install numpy OpenImageIO
    python tools/bench/textures.py target/release/ajar

writes a wall of tiles with a picture each, half of them PNG and half JPEG, prepares it on one thread and on
`--threads`, in turn, and renders it. Tells the ratio of the fastest times, and the most memory of the render beside
what it holds while pixels are made (needs Linux).
"""

import argparse
import math
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from large import measure

TILE = "v {x} 0 0\nv {right} 0 0\nv {right} 1 0\nv {x} 1 0\nusemtl m{i}\nf -4/1 -3/2 -2/3 -1/4\n"


def picture(size, seed):
    """Soft colours with grain, which neither format shrinks to nothing."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:size, 0:size] / size * 2 * math.pi
    waves = [np.sin(a * x + b * y + c) for a, b, c in rng.uniform(1, 9, (3, 3))]
    grain = rng.normal(0, 4, (size, size, 1))
    return np.clip(128 + 90 * np.stack(waves, -1) + grain, 0, 255).astype(np.uint8)


def write(folder, count, size):
    """An OBJ file with its library and pictures."""
    corners = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    tiles = "".join(TILE.format(i=i, x=1.1 * i, right=1.1 * i + 1) for i in range(count))
    (folder / "wall.obj").write_text("mtllib wall.mtl\n" + corners + tiles)
    names = [f"{i}.{'png' if i % 2 else 'jpg'}" for i in range(count)]
    (folder / "wall.mtl").write_text("".join(f"newmtl m{i}\nmap_Kd {name}\n" for i, name in enumerate(names)))
    for i, name in enumerate(names):
        image = oiio.ImageBuf(oiio.ImageSpec(size, size, 3, oiio.UINT8))
        image.set_pixels(oiio.ROI(), picture(size, i))
        image.write(str(folder / name))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ajar")
    parser.add_argument("--count", type=int, default=16)
    parser.add_argument("--size", type=int, default=4096)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--turns", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write(folder, arguments.count, arguments.size)
        texels = arguments.count * arguments.size**2
        print(f"{arguments.count} pictures of {arguments.size}², {texels / 1e6:.0f} million texels")
        command = [str(Path(arguments.ajar).resolve()), "render", str(folder / "wall.obj")]
        command += ["-o", str(folder / "wall.exr"), "--memory-limit", "16G"]
        fastest = {}
        for _ in range(arguments.turns):
            for threads in (1, arguments.threads):
                clock, *_ = measure([*command, "--threads", str(threads), "--dry-run"])
                fastest[threads] = min(clock, fastest.get(threads, math.inf))
        one, many = fastest[1], fastest[arguments.threads]
        print(f"prepared in {one:.2f} s by one thread, {many:.2f} s by {arguments.threads}: {one / many:.2f} times")
        _, _, most, late = measure([*command, "--spp", "16", "--integrator", "path"])
        print(f"at most {most / 2**30:.2f} GiB, {most / late:.2f} times the {late / 2**30:.2f} GiB of the render")


if __name__ == "__main__":
    main()
