"""A comparable scene by Mitsuba 3, from a Python that has it: mitsuba_passes.py FOLDER SPP PASSES OUT.exr PREFIX

FOLDER is what tools/bench/peers/make.py wrote. OUT gets the mean of all passes, PREFIX-0.exr … one pass each.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "bench" / "peers"))

import mitsuba as mi
from mitsuba_peer import ROULETTE, load


def main() -> None:
    """Renders passes with seeds of their own."""
    folder, (spp, passes), (out, prefix) = Path(sys.argv[1]), map(int, sys.argv[2:4]), sys.argv[4:6]
    mi.set_variant("scalar_rgb")
    scene = json.loads((folder / "scene.json").read_text())
    loaded = load(folder, scene)
    integrator = mi.load_dict({"type": "path", "max_depth": scene["max_depth"], "rr_depth": ROULETTE})
    total = 0
    for seed in range(passes):
        image = mi.render(loaded, integrator=integrator, spp=spp, seed=seed)
        mi.Bitmap(image).convert(mi.Bitmap.PixelFormat.RGB).write(f"{prefix}-{seed}.exr")
        total = total + image
    mi.Bitmap(total / passes).convert(mi.Bitmap.PixelFormat.RGB).write(out)


if __name__ == "__main__":
    main()
