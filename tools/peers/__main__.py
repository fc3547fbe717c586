"""Compares glTF assets with Blender's importer and Cycles: python tools/peers --ajar AJAR --bpy PYTHON ASSET.glb…

Both get one camera, a uniform sky and a sun. Prints a row per asset: mean colours, their ratio, FLIP.
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import flip_evaluator
import numpy as np
import OpenImageIO as oiio

SKY, SUN, DIRECTION = 0.5, 3.0, [-0.4, -1.0, -0.6]
SCENE = """
[[import]]
file = "{file}"

[[camera]]
position = {position}
target = {target}
yfov = 35

[[light]]
type = "environment"
radiance = {sky}

[[light]]
type = "directional"
illuminance = {sun}
angle = 0.53
direction = {direction}
"""


def pixels(path: Path) -> np.ndarray:
    """Linear RGB of an EXR."""
    return np.ascontiguousarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[:, :, :3])


def camera_of(bpy: str, file: Path) -> dict[str, list[float]]:
    """The camera that Blender would frame the asset with."""
    command = [bpy, str(Path(__file__).with_name("cycles_peer.py")), str(file), "-", "0", "0"]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    line = next(line for line in said.splitlines() if line.startswith("camera "))
    found: dict[str, list[float]] = json.loads(line.removeprefix("camera "))
    return found


def ours(arguments: argparse.Namespace, file: Path, camera: dict[str, list[float]], out: Path) -> None:
    """Renders by Ajar."""
    scene = out.with_suffix(".toml")
    scene.write_text(SCENE.format(file=file, sky=SKY, sun=SUN, direction=DIRECTION, **camera))
    size = f"{arguments.size}x{arguments.size}"
    command = [arguments.ajar, "render", str(scene), "-o", str(out), "--size", size, "--spp", str(arguments.spp)]
    command += ["--float", "--quiet", "--integrator", "path", "--allow", str(file.parent)]
    subprocess.run(command, check=True)


def theirs(arguments: argparse.Namespace, file: Path, camera: dict[str, list[float]], out: Path) -> None:
    """Renders by Cycles."""
    asked = json.dumps({"sky": SKY, "sun": SUN, "direction": DIRECTION, "camera": camera})
    command = [arguments.bpy, str(Path(__file__).with_name("cycles_peer.py")), str(file), str(out)]
    command += [str(arguments.size), str(arguments.spp), asked]
    subprocess.run(command, check=True, capture_output=True)


def row(name: str, a: np.ndarray, b: np.ndarray) -> str:
    """A row of the table."""
    means = [image.mean(axis=(0, 1)) for image in (a, b)]
    ratio = means[0].mean() / means[1].mean()
    _, flip, _ = flip_evaluator.evaluate(b, a, "HDR")
    shown = [" ".join(f"{c:.3f}" for c in mean) for mean in means]
    return f"| {name} | {shown[0]} | {shown[1]} | {ratio:.3f} | {flip:.3f} |"


def main() -> None:
    """Renders and compares."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--ajar", default="target/release/ajar")
    parser.add_argument("--bpy", required=True, help="a Python that has bpy")
    parser.add_argument("--size", type=int, default=192)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--keep", type=Path, help="folder for the images")
    parser.add_argument("assets", nargs="+", type=Path)
    arguments = parser.parse_args()
    print("| asset | Ajar | Cycles | ratio | FLIP |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        kept = arguments.keep or Path(folder)
        kept.mkdir(parents=True, exist_ok=True)
        for asset in arguments.assets:
            file = asset.resolve()
            camera = camera_of(arguments.bpy, file)
            out = [kept / f"{file.stem}.{who}.exr" for who in ("ajar", "cycles")]
            ours(arguments, file, camera, out[0])
            theirs(arguments, file, camera, out[1])
            print(row(file.stem, *map(pixels, out)), flush=True)


if __name__ == "__main__":
    main()
