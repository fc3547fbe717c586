"""Ajar's path tracer beside Mitsuba 3's at equal CPU time.

    cargo build --release
    pip install mitsuba numpy
    python tools/bench/peers.py FOLDER [--seconds 60] [--ajar target/release/ajar]

FOLDER holds one scene twice, as `scene.glb` for Ajar and as `scene.json` with OBJ files for Mitsuba, and a converged
image `reference.exr`. The JSON names `camera` (origin, target, up, fov: the vertical one in degrees, width, height),
`max_depth`, `materials` (of type diffuse, emitter, dielectric or conductor) and `meshes` (name, obj, material).

Each renderer gets the same CPU seconds, loading and compiling included; the relative mean squared error of its image is
printed: the mean of (x - r)^2 / (r^2 + 0.01) over pixels and channels. Mitsuba's LLVM variant wants a recent LLVM
(environment variable DRJIT_LIBLLVM_PATH).
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

VARIANTS = ("scalar_rgb", "llvm_ad_rgb")
PASS = 16  # samples a pixel that Mitsuba takes at a time
ROULETTE = 5  # both renderers begin roulette here

SCENE = """[[import]]
file = {file}
[[camera]]
position = {origin}
target = {target}
yfov = {fov}
[render]
size = [{width}, {height}]
max_depth = {depth}
integrator = "path"
"""


def read(path):
    return np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False), np.float64)


def relative_error(image, reference):
    return float(((image - reference) ** 2 / (reference**2 + 0.01)).mean())


def child_cpu():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def ajar(program, folder, scene, seconds):
    """The image after `seconds`, and the CPU time it took. One thread: then time is CPU time."""
    camera = scene["camera"]
    with tempfile.TemporaryDirectory() as out:
        file, exr = Path(out, "scene.toml"), Path(out, "image.exr")
        glb = json.dumps(str((folder / "scene.glb").resolve()))
        file.write_text(SCENE.format(file=glb, depth=scene["max_depth"], **camera))
        command = [program, "render", file, "-o", exr, "--time", f"{seconds}s", "--threads", "1", "--float", "-q"]
        before = child_cpu()
        subprocess.run(command, check=True)
        return read(exr), child_cpu() - before


def bsdf(material):
    kind, color = material["type"], {"type": "rgb", "value": material.get("reflectance", 0.0)}
    if kind == "dielectric":
        return {"type": "dielectric", "int_ior": material["ior"], "ext_ior": 1.0}
    if kind == "emitter":
        return {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
    if kind == "diffuse":
        surface = {"type": "diffuse", "reflectance": color}
    else:
        surface = {"type": "roughconductor", "material": "none", "distribution": "ggx"}
        surface |= {"alpha": material["alpha"], "specular_reflectance": color}
    return {"type": "twosided", "surface": surface}


def mitsuba_scene(folder, scene):
    camera = scene["camera"]
    place = mi.ScalarTransform4f().look_at(camera["origin"], camera["target"], camera["up"])
    film = {"type": "hdrfilm", "width": camera["width"], "height": camera["height"], "rfilter": {"type": "box"}}
    sensor = {"type": "perspective", "fov": camera["fov"], "fov_axis": "y", "near_clip": 1e-3, "far_clip": 1e3}
    sensor |= {"to_world": place, "film": film, "sampler": {"type": "independent"}}
    integrator = {"type": "path", "max_depth": scene["max_depth"], "rr_depth": ROULETTE}
    parts = {"type": "scene", "sensor": sensor, "integrator": integrator}
    for mesh in scene["meshes"]:
        material = scene["materials"][mesh["material"]]
        shape = {"type": "obj", "filename": str(folder / mesh["obj"]), "face_normals": True, "bsdf": bsdf(material)}
        if material["type"] == "emitter":
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": material["radiance"]}}
        parts[mesh["name"]] = shape
    return mi.load_dict(parts)


def mitsuba(folder, scene, seconds):
    """The mean of as many passes as begin within `seconds` of CPU time, and that time."""
    began, total, passes = time.process_time(), 0.0, 0
    loaded = mitsuba_scene(folder, scene)
    while time.process_time() - began < seconds:
        total = total + np.array(mi.render(loaded, spp=PASS, seed=passes), np.float64)
        passes += 1
    return total / passes, time.process_time() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--ajar", default="target/release/ajar")
    given = parser.parse_args()
    scene = json.loads((given.folder / "scene.json").read_text())
    mi.set_variant(VARIANTS[0])
    reference = read(given.folder / "reference.exr")

    def report(name, image, cpu):
        print(f"{name:22} {cpu:6.1f} CPU s  relMSE {relative_error(image, reference):.6f}", flush=True)

    report("ajar path", *ajar(given.ajar, given.folder, scene, given.seconds))
    for variant in VARIANTS:
        mi.set_variant(variant)
        report(f"mitsuba {variant}", *mitsuba(given.folder, scene, given.seconds))


if __name__ == "__main__":
    sys.exit(main())
