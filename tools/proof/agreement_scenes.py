"""Small scenes that integrators must agree on and that are no pictures for a README: made where they are asked for."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scenes"))

from modelling import textures
from modelling.curved import sphere, surface
from modelling.finish import glass, textured
from modelling.glb import Glb
from modelling.solids import box, quad

TOML = """[[import]]
file = "scene.glb"
[[camera]]
position = {position}
target = {target}
yfov = 40
{more}
"""


def room(glb: Glb, lamp: float, size: float = 0.5) -> None:
    """A box of two metres, open to the front, with a lamp of half a metre under its ceiling."""
    white = glb.material("White", (0.7, 0.7, 0.7), double_sided=True)
    red = glb.material("Red", (0.6, 0.1, 0.1), double_sided=True)
    glb.add("Floor", (quad((-1, 0, -1), (2, 0, 0), (0, 0, 2)), white))
    glb.add("Ceiling", (quad((-1, 2, 1), (2, 0, 0), (0, 0, -2)), white))
    glb.add("Back", (quad((-1, 2, -1), (2, 0, 0), (0, -2, 0)), white))
    glb.add("Left", (quad((-1, 2, 1), (0, 0, -2), (0, -2, 0)), red))
    light = glb.material("Lamp", (0.0, 0.0, 0.0), emission=(lamp, 0.9 * lamp, 0.7 * lamp))
    glb.add("Lamp", (quad((-size / 2, 1.98, size / 2), (size, 0, 0), (0, 0, -size)), light))


def lens(glb: Glb) -> str:
    """Depth of field."""
    room(glb, 17.0)
    clay = glb.material("Clay", (0.5, 0.3, 0.2), roughness=0.4)
    steel = glb.material("Steel", (0.9, 0.9, 0.9), metallic=1.0, roughness=0.3)
    glb.add("Near", (sphere(0.25, 32, 16).moved(0.3, 0.25, 0.7), clay))
    glb.add("Far", (sphere(0.3, 32, 16).moved(-0.3, 0.3, -0.5), steel))
    return TOML.format(
        position=[0, 1, 4], target=[0, 0.8, 0], more="lens_radius = 0.12\nfocus_distance = 4.5\nshift = [0.05, 0.1]"
    )


def lattice(glb: Glb) -> str:
    """Textures, normal maps, cut-outs and a half-transparent sheet."""
    room(glb, 17.0)
    tiles = textured(glb, "Tiles", textures.tiles(128, 1, 4, [(0.7, 0.6, 0.5), (0.3, 0.4, 0.5)]), relief=3.0)
    glb.add("Block", (box((-0.7, 0.0, -0.6), (0.0, 0.9, -0.1)), tiles))
    holes = np.ones((128, 128, 4))
    holes[..., 3:] = textures.lattice(128, 4)[..., -1:]
    screen = glb.material(
        "Screen", (0.2, 0.5, 0.5), color_map=glb.texture(holes, "Screen", jpeg=False), alpha="MASK", double_sided=True
    )
    glb.add("Screen", (quad((-0.2, 0.9, 0.5), (0.9, 0, 0), (0, -0.9, 0)), screen))
    sheet = np.full((4, 4, 4), 0.4)
    veil = glb.material(
        "Veil", (1.0, 0.8, 0.4), color_map=glb.texture(sheet, "Veil", jpeg=False), alpha="BLEND", double_sided=True
    )
    glb.add("Veil", (quad((-0.8, 1.5, -0.6), (1.6, 0, 0), (0, 0, 1.2)), veil))
    return TOML.format(position=[0, 1, 4], target=[0, 0.9, 0], more="")


def pool(glb: Glb) -> str:
    """Water over a floor under a small lamp: light reaches the camera through the waves, both ways (S D S)."""
    room(glb, 150.0, 0.2)
    u = np.linspace(-0.98, 0.98, 33)
    x, z = np.meshgrid(u, u, indexing="ij")
    waves = 0.5 + 0.02 * np.sin(7 * x + 2 * z) + 0.015 * np.sin(3 * x - 8 * z)
    water = glass(glb, "Water", ior=1.33)
    top = surface(np.stack([x, waves, z], axis=-1))
    if top.normals[:, 1].mean() < 0:
        top = top.reversed()
    sides = [
        quad((-0.98, 0.5, 0.98), (1.96, 0, 0), (0, -0.49, 0)),
        quad((0.98, 0.5, -0.98), (-1.96, 0, 0), (0, -0.49, 0)),
        quad((-0.98, 0.5, -0.98), (0, 0, 1.96), (0, -0.49, 0)),
        quad((0.98, 0.5, 0.98), (0, 0, -1.96), (0, -0.49, 0)),
        quad((-0.98, 0.01, 0.98), (1.96, 0, 0), (0, 0, -1.96)),
    ]
    glb.add("Water", (top, water), *((side, water) for side in sides))
    return TOML.format(position=[0, 1.9, 3.2], target=[0, 0.4, 0], more="")


SCENES: dict[str, Callable[[Glb], str]] = {"lens": lens, "lattice": lattice, "pool": pool}


def write(name: str, folder: Path) -> Path:
    """Makes the scene in `folder`; returns its scene file."""
    folder.mkdir(parents=True, exist_ok=True)
    glb = Glb()
    toml = SCENES[name](glb)
    glb.write(folder / "scene.glb")
    (folder / "scene.toml").write_text(toml)
    return folder / "scene.toml"
