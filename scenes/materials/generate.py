#!/usr/bin/env python3
"""A tray of spheres, one for each thing the material model does, under a studio of soft boxes."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from modelling import textures
from modelling.curved import lathe, sphere, surface
from modelling.finish import glass, save
from modelling.glb import Glb
from modelling.hdr import soft_box, write_hdr
from modelling.mesh import Mesh
from modelling.noise import coloured, normal_map, roughness_map

RADIUS, STEP = 0.42, 1.0
COLUMNS = 6


def ground() -> Mesh:
    """A studio sweep: flat in front, rising smoothly behind; texture coordinates in metres along it."""
    t = np.linspace(0.0, np.pi / 2, 33)
    bend = np.column_stack([-4.2 - 2.2 * np.sin(t), 2.2 - 2.2 * np.cos(t)])
    line = np.vstack([[(9.0, 0.0)], bend, [(-6.4, 7.0)]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    x = np.linspace(-12.0, 12.0, 25)
    grid = np.stack(np.broadcast_arrays(x[None, :], line[::-1, 1:], line[::-1, :1]), axis=-1)
    sheet = surface(grid)
    v = np.repeat(length[::-1], len(x))
    return Mesh(sheet.positions, sheet.normals, np.column_stack([np.tile(x, len(line)), -v]), sheet.triangles)


def pedestal() -> Mesh:
    """The low foot of one ball."""
    return lathe([(0, 0), (0.30, 0), (0.30, 0.05), (0.28, 0.07), (0.2, 0.07), (0, 0.07)], 64)


def swatches(glb: Glb) -> list[tuple[str, int]]:
    """The materials in reading order: opaque ones behind, the others in front."""
    bumps = glb.texture(normal_map(textures.studs(512, 3), 26.0), "Studs", quality=92)
    clouds = np.clip(0.28 + 0.16 * coloured((512, 512), 41, 1.3), 0.05, 0.7)
    worn = glb.texture(roughness_map(clouds), "Worn roughness")
    holes = glb.texture(textures.lattice(512, 3), "Lattice", jpeg=False)
    gold, copper, steel = (1.0, 0.77, 0.34), (0.95, 0.64, 0.54), (0.62, 0.61, 0.60)
    return [
        ("Diffuse", glb.material("Diffuse", (0.75, 0.20, 0.12))),
        ("Plastic, gloss", glb.material("Plastic gloss", (0.03, 0.16, 0.50), roughness=0.03)),
        ("Plastic, satin", glb.material("Plastic satin", (0.03, 0.16, 0.50), roughness=0.30)),
        ("Plastic, matte", glb.material("Plastic matte", (0.03, 0.16, 0.50), roughness=0.65)),
        (
            "Coated",
            glb.material(
                "Coated", (0.45, 0.02, 0.03), metallic=0.75, roughness=0.45,
                clearcoat={"clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 0.02},
            ),
        ),
        ("Studs", glb.material("Studs", (0.10, 0.32, 0.16), roughness=0.28, normal_map=bumps)),
        ("Gold, polished", glb.material("Gold polished", gold, metallic=1.0, roughness=0.06)),
        ("Gold, worn", glb.material("Gold worn", gold, metallic=1.0, roughness=1.0, rough_map=worn)),
        (
            "Copper, brushed",
            glb.material(
                "Copper brushed", copper, metallic=1.0, roughness=0.38, anisotropy={"anisotropyStrength": 0.85}
            ),
        ),
        ("Chrome", glb.material("Chrome", steel, metallic=1.0, roughness=0.0)),
        (
            "Lattice",
            glb.material(
                "Lattice", (0.85, 0.62, 0.15), roughness=0.35, color_map=holes, alpha="MASK", double_sided=True
            ),
        ),
        ("Lamp", glb.material("Lamp", (0.0, 0.0, 0.0), emission=(2.2, 0.95, 0.28))),
        ("Glass", glass(glb, "Glass")),
        ("Frosted glass", glass(glb, "Frosted glass", roughness=0.32)),
        ("Tinted glass", glass(glb, "Tinted glass", tint=(0.20, 0.62, 0.48), depth=0.5)),
        (
            "Bubble",
            glb.material(
                "Bubble",
                roughness=0.0,
                double_sided=True,
                transmission={"transmissionFactor": 1.0},
                ior={"ior": 1.5},
            ),
        ),
        ("Wax", glb.material("Wax", (0.86, 0.80, 0.70), roughness=0.5)),
        ("Marble", glb.material("Marble", roughness=0.12, color_map=glb.texture(
            textures.marble(512, 42, (0.10, 0.13, 0.12), (0.75, 0.78, 0.72)).color, "Marble"))),
    ]  # fmt: skip


def studio() -> np.ndarray:
    """A dim room with a key, a fill, a rim strip and an overhead panel."""
    image = np.full((256, 512, 3), 0.06) * np.array([0.9, 0.95, 1.05])
    soft_box(image, (-1.0, 0.9, 0.9), (0.42, 0.42), (11.0, 10.4, 9.5))
    soft_box(image, (1.2, 0.5, 0.7), (0.22, 0.6), (4.2, 4.8, 5.6))
    soft_box(image, (0.5, 0.45, -1.0), (0.9, 0.10), (5.0, 5.0, 5.2))
    soft_box(image, (0.0, 1.0, 0.05), (0.5, 0.22), (6.0, 6.0, 6.0))
    return image


def build() -> Glb:
    """Sweep, pedestals and three rows of six."""
    glb = Glb()
    check = glb.texture(textures.checker(512, 2, (0.55, 0.55, 0.55), (0.40, 0.41, 0.42)), "Checker", jpeg=False)
    sweep = glb.material("Sweep", color_map=check, roughness=0.55, double_sided=True)
    slate = glb.material("Slate", (0.045, 0.047, 0.05), roughness=0.45)
    glb.add("Sweep", (ground().with_uv_scale(0.7), sweep))
    ball, foot = sphere(RADIUS, 96, 48), glb.mesh("Pedestal", (pedestal(), slate))
    plain = Mesh(ball.positions, ball.normals, ball.uvs * np.array([3.0, 1.5]), ball.triangles, ball.tangents)
    for index, (name, material) in enumerate(swatches(glb)):
        row, column = divmod(index, COLUMNS)
        x, z = (column - (COLUMNS - 1) / 2) * STEP, (row - 2) * 1.45
        glb.place(foot, f"Pedestal {name}", (x, 0.0, z))
        glb.place(glb.mesh(name, (plain, material)), name, (x, RADIUS + 0.072, z))
    return glb


if __name__ == "__main__":
    save(build(), __file__)
    write_hdr(Path(__file__).resolve().parent / "assets" / "studio.hdr", studio())
