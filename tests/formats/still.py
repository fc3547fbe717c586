"""One still in all formats that Ajar reads: three balls on a printed floor under a glowing box."""

from __future__ import annotations

import json
import struct
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scenes"))

from modelling import usda
from modelling.curved import sphere
from modelling.glb import Glb
from modelling.mesh import Mesh
from modelling.solids import box, floor
from modelling.wavefront import Wavefront


@dataclass(frozen=True)
class Look:
    """A material in the words of all formats."""

    name: str
    color: tuple[float, float, float] = (0.0, 0.0, 0.0)
    roughness: float = 0.5
    metallic: float = 0.0
    emission: tuple[float, float, float] | None = None
    image: str | None = None


LOOKS = [
    Look("Clay", (0.55, 0.20, 0.12), 0.9),
    Look("Plastic", (0.05, 0.25, 0.45), 0.2),
    Look("Brass", (0.85, 0.60, 0.25), 0.3, 1.0),
    Look("Glow", emission=(9.0, 8.0, 6.0)),
    Look("Print", (1.0, 1.0, 1.0), 0.6, image="print.png"),
]


def parts() -> list[tuple[str, Mesh, Look]]:
    """What is seen. Nothing has a back that could be seen: formats disagree about those."""
    ball = sphere(0.5, 32, 16)
    clay, plastic, brass, glow, printed = LOOKS
    return [
        ("Left", ball.moved(-1.1, 0.5, 0.0), clay),
        ("Middle", ball.moved(0.0, 0.5, 0.2), plastic),
        ("Right", ball.moved(1.1, 0.5, -0.1), brass),
        ("Lamp", box((-0.7, 2.2, -0.5), (0.7, 2.3, 0.5)), glow),
        ("Floor", floor(5.0, 4.0).with_uv_scale(0.2, 0.25), printed),
    ]


def picture() -> np.ndarray:
    """An image that no turn or mirror leaves alike."""
    y, x = np.mgrid[0:64, 0:80]
    red, green = 40 + 2 * x, 200 - 2 * y
    blue = np.where((x // 16 + y // 16) % 2 == 0, 60, 180)
    return np.stack([red, green, blue], axis=-1).astype(np.uint8)


def save_picture(folder: Path) -> None:
    """Writes it beside the scenes."""
    Image.fromarray(picture()).save(folder / "print.png")


def glb(path: Path, brighter: float = 1.0) -> None:
    """Binary glTF; light can be made brighter to see whether anybody notices."""
    made = Glb()
    image = made.texture(picture() / 255.0, "print", jpeg=False)
    for name, mesh, look in parts():
        emission = [brighter * value for value in look.emission] if look.emission else None
        material = made.material(
            look.name, look.color, roughness=look.roughness, metallic=look.metallic, emission=emission,
            color_map=image if look.image else None,
        )  # fmt: skip
        made.add(name, (mesh, material))
    made.write(path)


def gltf(path: Path) -> None:
    """The same as JSON beside its buffer."""
    whole = path.with_suffix(".whole.glb")
    glb(whole)
    data = whole.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20 : 20 + length])
    path.with_suffix(".bin").write_bytes(data[28 + length :])
    document["buffers"][0]["uri"] = path.with_suffix(".bin").name
    path.write_text(json.dumps(document), "utf-8")
    whole.unlink()


def obj(path: Path) -> None:
    """OBJ and MTL with the PBR extension."""
    made = Wavefront()
    for name, mesh, look in parts():
        extra = {"map_Kd": look.image} if look.image else {}
        extra |= {"Ke": look.emission} if look.emission else {}
        made.material(look.name, Kd=look.color, Pr=look.roughness, Pm=look.metallic, Ni=1.5, **extra)
        made.add(name, (mesh, look.name))
    made.write(path)


def preview(look: Look) -> str:
    """UsdPreviewSurface."""
    inputs = {"roughness": look.roughness, "metallic": look.metallic, "ior": 1.5}
    inputs |= {"emissiveColor": look.emission} if look.emission else {}
    if not look.image:
        inputs["diffuseColor"] = look.color
    maps = {"diffuseColor": look.image} if look.image else None
    return usda.preview_surface(look.name, f"/Still/Looks/{look.name}", maps, **inputs)


def stage(path: Path, looks: str | None = None) -> None:
    """USD as text, with UsdPreviewSurface or the materials that the prim `looks` holds."""
    shapes = [usda.faceted(name, mesh, f"/Still/Looks/{look.name}") for name, mesh, look in parts()]
    looks = looks or usda.prim("Scope", "Looks", *map(preview, LOOKS))
    usda.write(path, "Still", usda.prim("Xform", "Still", *shapes, looks))


def materialx(path: Path, kind: str) -> None:
    """USD with surfaces of `kind`, standard_surface or open_pbr_surface, from a MaterialX file."""
    words = {
        "standard_surface": ("base", "metalness", "emission"),
        "open_pbr_surface": ("base_weight", "base_metalness", "emission_luminance"),
    }
    weight, metalness, emission = words[kind]
    lines = ['<?xml version="1.0"?>', '<materialx version="1.38" colorspace="lin_rec709">']
    for look in LOOKS:
        values = [
            ("float", weight, 1.0),
            ("float", metalness, look.metallic),
            ("float", "specular_roughness", look.roughness),
        ]
        values += [("color3", "base_color", look.color)] if not look.image else []
        values += [("color3", "emission_color", look.emission), ("float", emission, 1.0)] if look.emission else []
        if look.image:
            lines.append(
                f'<image name="{look.name}I" type="color3"><input name="file" type="filename" value="{look.image}" '
                'colorspace="srgb_texture"/></image>'
            )
        lines.append(f'<{kind} name="{look.name}S" type="surfaceshader">')
        for form, name, value in values:
            shown = ", ".join(map(str, value)) if isinstance(value, tuple) else value
            lines.append(f'<input name="{name}" type="{form}" value="{shown}"/>')
        if look.image:
            lines.append(f'<input name="base_color" type="color3" nodename="{look.name}I"/>')
        lines += [f"</{kind}>", f'<surfacematerial name="{look.name}" type="material">']
        lines += [f'<input name="surfaceshader" type="surfaceshader" nodename="{look.name}S"/>', "</surfacematerial>"]
    file = path.with_suffix(".mtlx")
    file.write_text("\n".join([*lines, "</materialx>"]), "utf-8")
    stage(path, usda.prim("", "Looks", meta=[f"references = @{file.name}@</MaterialX/Materials>"]))
