"""Renders a comparable scene with Mitsuba 3: `mitsuba_peer.py FOLDER VARIANT INTEGRATOR SECONDS[,SECONDS…] PREFIX`.

After each number of CPU seconds, scene loading and compiling included, the image so far is written to PREFIX-
SECONDS.npy and a line of JSON says how many CPU seconds it took. LLVM variants want a recent LLVM (environment
variable DRJIT_LIBLLVM_PATH).
"""

import json
import sys
import time
from pathlib import Path

import drjit
import mitsuba as mi
import numpy as np

PASS = 16  # samples a pixel at a time
ROULETTE = 5  # where roulette begins, as in Ajar


def bsdf(material, folder):
    kind, color = material["type"], {"type": "rgb", "value": material.get("reflectance", 0.0)}
    if kind == "dielectric":
        return {"type": "dielectric", "int_ior": material["ior"], "ext_ior": 1.0}
    if kind == "emitter":
        return {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
    if kind == "diffuse":
        if "texture" in material:
            color = {"type": "bitmap", "filename": str(folder / material["texture"]), "raw": True}
        surface = {"type": "diffuse", "reflectance": color}
    else:
        surface = {"type": "roughconductor", "material": "none", "distribution": "ggx"}
        surface |= {"alpha": material["alpha"], "specular_reflectance": color}
    return {"type": "twosided", "surface": surface}


def load(folder, scene):
    camera = scene["camera"]
    place = mi.ScalarTransform4f().look_at(camera["origin"], camera["target"], camera["up"])
    film = {"type": "hdrfilm", "width": camera["width"], "height": camera["height"], "rfilter": {"type": "box"}}
    sensor = {"type": "perspective", "fov": camera["fov"], "fov_axis": "y", "near_clip": 1e-3, "far_clip": 1e3}
    sensor |= {"to_world": place, "film": film, "sampler": {"type": "independent"}}
    parts = {"type": "scene", "sensor": sensor}
    for mesh in scene["meshes"]:
        material, flat = scene["materials"][mesh["material"]], not mesh.get("smooth", False)
        shape = {"type": "obj", "filename": str(folder / mesh["obj"]), "face_normals": flat}
        shape["bsdf"] = bsdf(material, folder)
        if material["type"] == "emitter":
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": material["radiance"]}}
        parts[mesh["name"]] = shape
    if "environment" in scene:
        parts["environment"] = {"type": "envmap", "filename": str(folder / scene["environment"])}
    return mi.load_dict(parts)


def main():
    folder, variant, kind, seconds, prefix = Path(sys.argv[1]), *sys.argv[2:]
    mi.set_variant(variant)
    scene = json.loads((folder / "scene.json").read_text())
    began, total, passes = time.process_time(), 0.0, 0
    loaded = load(folder, scene)
    drjit.set_thread_count(1)  # not before: it reads images by a pool of threads, and waits for ever for the only one
    integrator = mi.load_dict({"type": kind, "max_depth": scene["max_depth"], "rr_depth": ROULETTE})
    for limit in (float(s) for s in seconds.split(",")):
        while time.process_time() - began < limit:
            image = mi.render(loaded, integrator=integrator, spp=PASS, seed=passes)
            total, passes = total + np.array(image, np.float64), passes + 1
        np.save(f"{prefix}-{limit:g}.npy", total[..., :3] / passes)
        print(json.dumps({"seconds": limit, "cpu": time.process_time() - began}), flush=True)


if __name__ == "__main__":
    main()
