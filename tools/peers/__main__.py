"""Compares glTF assets with Blender's importer and Cycles: python tools/peers --ajar AJAR --bpy PYTHON ASSET.glb…

Both get one camera, a uniform sky and a sun. Prints the table of docs/peers.md, a row per asset. Colours are means over
the pixels in which either renderer sees more than sky. In these, on a screen, `alike` is the correlation of the images
and `off` their mean difference once Ajar's has the mean of Cycles'. FLIP is that of the whole images.
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import flip_evaluator
import numpy as np
import OpenImageIO as oiio

SKY, SUN, ANGLE, DIRECTION = 0.5, 3.0, 5.0, [-0.4, -1.0, -0.6]
SCENE = """
[[import]]
file = "{file}"
time = 0

[[camera]]
name = "peers"
position = {position}
target = {target}
yfov = 35

[[light]]
type = "environment"
radiance = {sky}

[[light]]
type = "directional"
illuminance = {sun}
angle = {angle}
direction = {direction}
"""


def pixels(path: Path) -> np.ndarray:
    """Linear RGB of an EXR."""
    return np.ascontiguousarray(np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))[:, :, :3])


def theirs(arguments: argparse.Namespace, file: Path, out: Path) -> dict[str, Any]:
    """Renders by Cycles; its version, and the camera that frames the asset."""
    asked = json.dumps({"sky": SKY, "sun": SUN, "angle": ANGLE, "direction": DIRECTION})
    command = [arguments.bpy, str(Path(__file__).with_name("cycles_peer.py")), str(file), str(out)]
    command += [str(arguments.size), str(arguments.spp), asked]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    made = next(line for line in said.splitlines() if line.startswith("made "))
    found: dict[str, Any] = json.loads(made.removeprefix("made "))
    return found


def ours(arguments: argparse.Namespace, file: Path, camera: dict[str, list[float]], out: Path) -> None:
    """Renders by Ajar."""
    scene = out.with_suffix(".toml")
    scene.write_text(SCENE.format(file=file, sky=SKY, sun=SUN, angle=ANGLE, direction=DIRECTION, **camera))
    size = f"{arguments.size}x{arguments.size}"
    command = [arguments.ajar, "render", str(scene), "-o", str(out), "--size", size, "--spp", str(arguments.spp)]
    command += ["--float", "--quiet", "--integrator", "path", "--camera", "peers", "--allow", str(file.parent)]
    subprocess.run(command, check=True)


def shown(linear: np.ndarray) -> np.ndarray:
    """Values as a screen gets them, sRGB."""
    held = linear.clip(0, 1)
    return np.where(held < 0.0031308, 12.92 * held, 1.055 * held ** (1 / 2.4) - 0.055)


def row(name: str, a: np.ndarray, b: np.ndarray) -> str:
    """A row of the table: Ajar's image a, Cycles' image b."""
    seen = (abs(np.stack([a, b]) - SKY) > 0.01 * SKY).any(axis=(0, 3))
    means = [image[seen].mean(axis=0) for image in (a, b)]
    ratio = means[0].mean() / means[1].mean()
    screens = [shown(image[seen]).ravel() for image in (a, b)]
    alike = np.corrcoef(screens)[0, 1]
    off = abs(shown(a[seen] / ratio).ravel() - screens[1]).mean()
    _, flip, _ = flip_evaluator.evaluate(b, a, "HDR")
    colours = [" ".join(f"{c:.3f}" for c in mean) for mean in means]
    return f"| {name} | {colours[0]} | {colours[1]} | {ratio:.3f} | {alike:.3f} | {off:.3f} | {flip:.3f} |"


def write_sheet(path: Path, pairs: list[tuple[np.ndarray, np.ndarray]]) -> None:
    """All pairs as one picture of sRGB, Ajar above Cycles."""
    coded = shown(np.concatenate([np.concatenate(pair) for pair in pairs], axis=1))
    height, width, _ = coded.shape
    image = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, oiio.UINT8))
    image.set_pixels(oiio.ROI(), coded.astype(np.float32))
    image.specmod().attribute("Compression", "jpeg:88")
    image.write(str(path))


def main() -> None:
    """Renders and compares."""
    parser = argparse.ArgumentParser(prog="peers", description=__doc__.split("\n")[0])
    parser.add_argument("--ajar", default="target/release/ajar", help="the program [target/release/ajar]")
    parser.add_argument("--bpy", required=True, metavar="PYTHON", help="a Python that has bpy")
    parser.add_argument("--size", type=int, default=256, help="pixels on each side [256]")
    parser.add_argument("--spp", type=int, default=256, help="samples a pixel [256]")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="where the images stay")
    parser.add_argument("--sheet", type=Path, metavar="OUT.jpg", help="all pairs as one picture, Ajar above Cycles")
    parser.add_argument("assets", nargs="+", type=Path)
    arguments = parser.parse_args()
    print("| asset | Ajar | Cycles | ratio | alike | off | FLIP |\n|---|---|---|---|---|---|---|", flush=True)
    pairs = []
    with tempfile.TemporaryDirectory() as folder:
        kept = arguments.keep or Path(folder)
        kept.mkdir(parents=True, exist_ok=True)
        for asset in arguments.assets:
            file = asset.resolve()
            out = [kept / f"{file.stem}.{who}.exr" for who in ("ajar", "cycles")]
            made = theirs(arguments, file, out[1])
            ours(arguments, file, made["camera"], out[0])
            pairs.append((pixels(out[0]), pixels(out[1])))
            print(row(file.stem, *pairs[-1]), flush=True)
    if arguments.sheet:
        write_sheet(arguments.sheet, pairs)
    print(f"\nBlender {made['blender']}, {arguments.size}×{arguments.size} pixels, {arguments.spp} samples a pixel.")


if __name__ == "__main__":
    main()
