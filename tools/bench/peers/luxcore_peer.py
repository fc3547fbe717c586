"""Renders a comparable scene with LuxCore: `luxcore_peer.py FOLDER ENGINE SAMPLER SECONDS[,SECONDS…] PREFIX`.

After each number of CPU seconds, scene loading included, the image so far is written to PREFIX-SECONDS.npy and a line
of JSON says how many CPU seconds it took. One thread.
"""

import json
import os
import sys
import time
from pathlib import Path

import numpy as np
import pyluxcore as luxcore

CAMERA = "scene.camera."


def read_obj(path):
    """Positions, normals, texture coordinates and triangles of an OBJ file whose vertices carry one of each."""
    rows = {"v": [], "vn": [], "vt": [], "f": []}
    for line in path.read_text().splitlines():
        kind, *values = line.split()
        if kind in rows:
            rows[kind].append([int(v.split("/")[0]) - 1 if kind == "f" else float(v) for v in values])
    return [tuple(map(tuple, rows[key])) for key in ("v", "vn", "vt", "f")]


class Scene:
    def __init__(self, folder, described):
        self.scene, self.properties = luxcore.Scene(), luxcore.Properties()
        self.camera(described["camera"])
        for name, material in described["materials"].items():
            self.material(f"scene.materials.{name}.", name, material, folder)
        for mesh in described["meshes"]:
            positions, normals, uvs, triangles = read_obj(folder / mesh["obj"])
            smooth = mesh.get("smooth", False) and len(normals) == len(positions)
            mapped = list(uvs) if len(uvs) == len(positions) else None
            self.scene.DefineMesh(
                mesh["name"], list(positions), list(triangles), list(normals) if smooth else None, mapped, None, None
            )
            self.put(f"scene.objects.{mesh['name']}.shape", mesh["name"])
            self.put(f"scene.objects.{mesh['name']}.material", mesh["material"])
        if "environment" in described:
            self.put("scene.lights.environment.type", "infinite")
            self.put("scene.lights.environment.file", str(folder / described["environment"]))
            self.put("scene.lights.environment.gamma", 1.0)
            # LuxCore's up is Z: a turn that takes it to Y, then the image's middle to -Z.
            self.put("scene.lights.environment.transformation", ENVIRONMENT)
        self.scene.Parse(self.properties)

    def put(self, key, value):
        self.properties.Set(luxcore.Property(key, value))

    def camera(self, camera):
        row = 2.0 / camera["height"]
        self.put(CAMERA + "type", "perspective")
        self.put(CAMERA + "lookat.orig", camera["origin"])
        self.put(CAMERA + "lookat.target", camera["target"])
        self.put(CAMERA + "up", camera["up"])
        self.put(CAMERA + "fieldofview", float(camera["fov"]))
        self.put(CAMERA + "cliphither", 1e-3)
        self.put(CAMERA + "clipyon", 1e3)
        self.put(CAMERA + "autofocus.enable", False)
        self.put(CAMERA + "lensradius", 0.0)
        # LuxCore's film lies one row off those of the others.
        self.put(CAMERA + "screenwindow", [-1.0, 1.0, -1.0 - row, 1.0 - row])

    def material(self, key, name, material, folder):
        kind = material["type"]
        if kind == "diffuse":
            color = material["reflectance"]
            if "texture" in material:
                color = f"texture-{name}"
                self.put(f"scene.textures.{color}.type", "imagemap")
                self.put(f"scene.textures.{color}.file", str(folder / material["texture"]))
                self.put(f"scene.textures.{color}.gamma", 1.0)
            self.put(key + "type", "matte")
            self.put(key + "kd", color)
        elif kind == "emitter":
            self.put(key + "type", "matte")
            self.put(key + "kd", [0.0] * 3)
            self.put(key + "emission", material["radiance"])
            self.put(key + "emission.gain", [1.0] * 3)
            self.put(key + "emission.normalizebycolor", False)
            self.put(key + "emission.power", 0.0)
        elif kind == "dielectric":
            self.put(key + "type", "glass")
            self.put(key + "kr", [1.0] * 3)
            self.put(key + "kt", [1.0] * 3)
            self.put(key + "interiorior", material["ior"])
            self.put(key + "exteriorior", 1.0)
        else:
            self.put(f"scene.textures.fresnel-{name}.type", "fresnelcolor")
            self.put(f"scene.textures.fresnel-{name}.kr", material["reflectance"])
            self.put(key + "type", "metal2")
            self.put(key + "fresnel", f"fresnel-{name}")
            self.put(key + "uroughness", material["alpha"])
            self.put(key + "vroughness", material["alpha"])


ENVIRONMENT = [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def settings(engine, sampler, camera, depth):
    made = luxcore.Properties()
    for key, value in {
        "renderengine.type": engine,
        "sampler.type": sampler,
        "renderengine.seed": 1,
        "native.threads.count": 1,
        "film.width": camera["width"],
        "film.height": camera["height"],
        "film.filter.type": "NONE",
        "film.safesave": False,
        "film.imagepipelines.0.0.type": "NOP",
        "path.maxdepth": depth,
        "light.maxdepth": depth,
        "path.pathdepth.total": depth,
        "path.pathdepth.diffuse": depth,
        "path.pathdepth.glossy": depth,
        "path.pathdepth.specular": depth,
        # Its own default begins Russian roulette so early that the image gets too bright.
        "path.russianroulette.depth": depth,
        "light.russianroulette.depth": depth,
    }.items():
        made.Set(luxcore.Property(key, value))
    return made


def main():
    folder, engine, sampler, seconds, prefix = Path(sys.argv[1]), *sys.argv[2:]
    luxcore.Init()
    luxcore.SetLogHandler(lambda _: None)
    described = json.loads((folder / "scene.json").read_text())
    camera, began = described["camera"], time.process_time()
    scene = Scene(folder, described)
    config = luxcore.RenderConfig(settings(engine, sampler, camera, described["max_depth"]), scene.scene)
    session = luxcore.RenderSession(config)
    session.Start()
    for limit in (float(s) for s in seconds.split(",")):
        while time.process_time() - began < limit:
            time.sleep(0.02)
        session.UpdateStats()
        pixels = np.zeros(camera["width"] * camera["height"] * 3, np.float32)
        session.GetFilm().GetOutputFloat(luxcore.FilmOutputType.RGB, pixels, 0, True)
        np.save(f"{prefix}-{limit:g}.npy", pixels.reshape(camera["height"], camera["width"], 3)[::-1])
        print(json.dumps({"seconds": limit, "cpu": time.process_time() - began}), flush=True)
    session.Stop()
    # The library crashes when Python takes it down.
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
