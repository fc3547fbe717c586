"""Makes a scene of the project comparable: the same geometry, textures and lights with materials that every renderer
has.

Opaque dielectrics become Lambert's surfaces, metals mirror all colours alike by the GGX model, glass stays; normal
and roughness maps are left out. The folder that is written holds

* `scene.glb` and `scene.toml` for Ajar,
* `scene.json`, an OBJ file a mesh and textures as linear EXR for others: `camera` (origin, target, up, fov: the
  vertical one in degrees, width, height), `max_depth`, `materials` (of type diffuse, emitter, dielectric or
  conductor), `meshes` (name, obj, material, smooth) and, where there is one, `environment` (a latitude-longitude EXR,
  pole +Y, its centre towards +Z, +X left of it).
"""

import io
import json
import math
import struct
import tomllib
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from PIL import Image

ROOT = Path(__file__).resolve().parents[3]
SKY = (2048, 1024)  # pixels of an environment with a sun in it


class Glb:
    """A binary glTF file as this project's generators write them."""

    def __init__(self, path):
        data = path.read_bytes()
        size = struct.unpack("<I", data[12:16])[0]
        self.json = json.loads(data[20 : 20 + size])
        self.binary = data[28 + size :]

    def view(self, index):
        view = self.json["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self.binary[start : start + view["byteLength"]]

    def accessor(self, index):
        accessor = self.json["accessors"][index]
        kind = {5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
        columns = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        values = np.frombuffer(self.view(accessor["bufferView"]), kind)[: accessor["count"] * columns]
        return values.reshape(accessor["count"], columns)

    def write(self, path):
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        size = 28 + len(text) + len(self.binary)
        head = struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON")
        path.write_bytes(head + text + struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary)


def write_exr(path, pixels, kind=oiio.HALF):
    """Writes RGB pixels."""
    height, width, _ = pixels.shape
    spec = oiio.ImageSpec(width, height, 3, kind)
    spec.attribute("compression", "zip")
    output = oiio.ImageOutput.create(str(path))
    output.open(str(path), spec)
    output.write_image(np.ascontiguousarray(pixels, np.float32))
    output.close()


def read_rgb(path):
    """Pixels of an image as they are stored."""
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))[..., :3]


def linear(display):
    return np.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)


def simplify(material):
    """Changes a glTF material in place into one of the four kinds; returns the kind and what others need of it."""
    extensions = material.setdefault("extensions", {})
    pbr = material.setdefault("pbrMetallicRoughness", {})
    for key in ("normalTexture", "occlusionTexture"):
        material.pop(key, None)
    color = pbr.get("baseColorFactor", [1.0] * 4)[:3]
    if "KHR_materials_transmission" in extensions:
        ior = extensions.get("KHR_materials_ior", {}).get("ior", 1.5)
        return {"type": "dielectric", "ior": ior}
    if any(material.get("emissiveFactor", [0.0])):
        strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
        pbr["baseColorFactor"] = [0.0, 0.0, 0.0, 1.0]
        extensions["KHR_materials_specular"] = {"specularFactor": 0.0}
        return {"type": "emitter", "radiance": [strength * c for c in material["emissiveFactor"]]}
    if pbr.get("metallicFactor", 1.0) > 0.5:
        pbr.pop("metallicRoughnessTexture", None)
        pbr["baseColorFactor"] = [1.0] * 4
        return {"type": "conductor", "reflectance": [1.0] * 3, "alpha": pbr.get("roughnessFactor", 1.0) ** 2}
    pbr.pop("metallicRoughnessTexture", None)
    pbr["roughnessFactor"], pbr["metallicFactor"], material["doubleSided"] = 1.0, 0.0, True
    extensions["KHR_materials_specular"] = {"specularFactor": 0.0}
    return {"type": "diffuse", "reflectance": color}


def texture_of(glb, material, folder, name):
    """Writes the base colour texture as linear EXR; returns the file's name."""
    index = material.get("pbrMetallicRoughness", {}).get("baseColorTexture", {}).get("index")
    if index is None:
        return None
    image = glb.json["images"][glb.json["textures"][index]["source"]]
    pixels = np.asarray(Image.open(io.BytesIO(glb.view(image["bufferView"]))).convert("RGB"), np.float64) / 255.0
    write_exr(folder / f"{name}.exr", linear(pixels))
    return f"{name}.exr"


def matrix(node):
    """The node's transform; this project's generators write translation, rotation about +Y, and scale."""
    x, y, z, w = node.get("rotation", [0.0, 0.0, 0.0, 1.0])
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return turn * np.array(node.get("scale", [1.0] * 3)), np.array(node.get("translation", [0.0] * 3))


def write_obj(path, positions, normals, uvs, triangles):
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in positions]
    lines += [f"vt {u:.9g} {1 - v:.9g}" for u, v in uvs]
    lines += [f"vn {x:.9g} {y:.9g} {z:.9g}" for x, y, z in normals]
    lines += ["f " + " ".join(f"{i + 1}/{i + 1}/{i + 1}" for i in triangle) for triangle in triangles]
    path.write_text("\n".join(lines) + "\n")


def meshes(glb, materials, folder):
    """Writes every primitive of every node as an OBJ file in world space."""
    written = []
    for node in glb.json["nodes"]:
        linear_part, offset = matrix(node)
        for part in glb.json["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            attributes = part["attributes"]
            positions = glb.accessor(attributes["POSITION"]) @ linear_part.T + offset
            normals = glb.accessor(attributes["NORMAL"]) @ np.linalg.inv(linear_part)
            lengths = np.linalg.norm(normals, axis=1, keepdims=True)
            normals = np.where(lengths > 0, normals / np.maximum(lengths, 1e-12), [0.0, 1.0, 0.0])
            uv = attributes.get("TEXCOORD_0")
            uvs = glb.accessor(uv) if uv is not None else np.zeros((len(positions), 2))
            triangles = glb.accessor(part["indices"]).reshape(-1, 3)
            name = f"mesh{len(written)}"
            write_obj(folder / f"{name}.obj", positions, normals, uvs, triangles)
            written.append(
                {"name": name, "obj": f"{name}.obj", "material": materials[part["material"]], "smooth": True}
            )
    return written


def sun_and_sky(lights, source, folder):
    """One latitude-longitude image of the environment and the sun."""
    width, height = SKY
    sky = next(light for light in lights if light["type"] == "environment")
    small = read_rgb(source / sky["texture"]) * np.array(sky.get("color", [1.0] * 3)) * sky.get("radiance", 1.0)
    rows = np.minimum((np.arange(height) + 0.5) / height * small.shape[0], small.shape[0] - 1).astype(int)
    columns = np.minimum((np.arange(width) + 0.5) / width * small.shape[1], small.shape[1] - 1).astype(int)
    pixels = small[rows][:, columns].astype(np.float64)
    for sun in (light for light in lights if light["type"] == "directional"):
        towards = -np.array(sun["direction"]) / np.linalg.norm(sun["direction"])
        polar = math.acos(towards[1]) / math.pi * height
        azimuth = (0.5 - math.atan2(towards[0], towards[2]) / (2 * math.pi)) % 1.0 * width
        radius = math.radians(sun["angle"]) / 2 / math.pi * height
        y, x = np.mgrid[0:height, 0:width] + 0.5
        sine = np.sin(np.pi * y / height)
        disc = np.hypot((x - azimuth) * sine, y - polar) < max(radius, 1.0)
        solid = (sine * (np.pi / height) * (2 * np.pi / width))[disc].sum()
        pixels[disc] += np.array(sun["color"]) * sun["illuminance"] / solid
    # Half floats cannot hold the sun.
    write_exr(folder / "environment.exr", pixels, oiio.FLOAT)
    return "environment.exr"


TOML = """[[import]]
file = "scene.glb"
[[camera]]
position = {origin}
target = {target}
yfov = {fov}
[render]
size = [{width}, {height}]
max_depth = {max_depth}
"""


def make(name, folder, size=256, max_depth=32):
    """Writes the comparable form of `scenes/NAME` into `folder`."""
    source = ROOT / "scenes" / name
    described = tomllib.loads((source / "scene.toml").read_text())
    folder.mkdir(parents=True, exist_ok=True)
    glb = Glb(source / described["import"][0]["file"])
    scene, names = {"name": name, "max_depth": max_depth, "materials": {}}, []
    for index, material in enumerate(glb.json["materials"]):
        kind = simplify(material)
        if kind["type"] == "diffuse" and (texture := texture_of(glb, material, folder, f"texture{index}")):
            kind["texture"] = texture
        names.append(f"material{index}")
        scene["materials"][names[-1]] = kind
    extensions = {key for material in glb.json["materials"] for key in material["extensions"]}
    glb.json["extensionsUsed"] = sorted(extensions)
    glb.write(folder / "scene.glb")
    scene["meshes"] = meshes(glb, names, folder)
    camera = described["camera"][0]
    scene["camera"] = {
        "origin": camera["position"],
        "target": camera["target"],
        "up": [0, 1, 0],
        "fov": camera["yfov"],
        "width": size,
        "height": size,
    }
    toml = TOML.format(**scene["camera"], max_depth=max_depth)
    if "light" in described:
        scene["environment"] = sun_and_sky(described["light"], source, folder)
        toml += '[[light]]\ntype = "environment"\ntexture = "environment.exr"\nradiance = 1\n'
    (folder / "scene.toml").write_text(toml)
    (folder / "scene.json").write_text(json.dumps(scene, indent=1))
