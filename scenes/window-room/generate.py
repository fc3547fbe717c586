#!/usr/bin/env python3
"""A study in the morning: sun and sky come in by one window.

The sky is our own clear-sky gradient; the sun itself is a light of the
scene file, with the same direction as `SUN`.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from modelling import furniture, pictures, textures
from modelling.curved import cylinder, lathe, smooth_profile, sphere
from modelling.finish import glass, save, textured
from modelling.glb import Glb
from modelling.hdr import clear_sky, write_hdr
from modelling.mesh import Mesh, merge
from modelling.solids import box, quad, rounded_box, wall

LEFT, RIGHT, BACK, FRONT, HEIGHT = -2.1, 2.1, -2.1, 2.4, 2.65
THICK = 0.28
# The window: from z = WINDOW[0] to z = WINDOW[1], heights SILL to LINTEL.
WINDOW, SILL, LINTEL = (-1.25, 0.55), 0.80, 2.20
# Towards the sun.
SUN = (-0.78, 0.62, 0.22)


def shell(glb: Glb) -> None:
    """Floor, walls, ceiling, skirting; every side is a thick slab."""
    boards = textures.planks(1024, 50, 8, (0.74, 0.56, 0.38), (0.52, 0.35, 0.21), 0.16)
    floor = textured(glb, "Floor", boards, relief=2.0)
    paint = textured(glb, "Walls", textures.plaster(512, 51, (0.80, 0.84, 0.82)), relief=1.5, roughness=1.0)
    white = glb.material("White paint", (0.82, 0.81, 0.78), roughness=0.45)
    chalk = glb.material("Ceiling", (0.84, 0.84, 0.82))
    t = THICK
    glb.add("Floor", (box((LEFT - t, -0.2, BACK - t), (RIGHT + t, 0, FRONT + t)).with_uv_scale(0.8), floor))
    glb.add("Ceiling", (box((LEFT - t, HEIGHT, BACK - t), (RIGHT + t, HEIGHT + 0.2, FRONT + t)), chalk))
    low, high = -0.1, HEIGHT + 0.1
    hole = (FRONT + 0.1 - WINDOW[1], SILL - low, FRONT + 0.1 - WINDOW[0], LINTEL - low)
    left = wall(FRONT - BACK + 0.2, high - low, t, [hole]).rotated("y", 90.0).moved(LEFT, low, FRONT + 0.1)
    sides = [
        left,
        box((RIGHT, low, BACK - t), (RIGHT + t, high, FRONT + t)),
        box((LEFT - t, low, BACK - t), (RIGHT + t, high, BACK)),
        box((LEFT - t, low, FRONT), (RIGHT + t, high, FRONT + t)),
    ]
    glb.add("Walls", (merge(sides).with_uv_scale(0.5), paint))
    run = [
        furniture.skirting(RIGHT - LEFT).moved(0, 0, BACK),
        furniture.skirting(FRONT - BACK).rotated("y", 90.0).moved(LEFT, 0, (FRONT + BACK) / 2),
        furniture.skirting(FRONT - BACK).rotated("y", -90.0).moved(RIGHT, 0, (FRONT + BACK) / 2),
    ]
    glb.add("Trim", (merge([*run, window_frame()]), white))


def window_frame() -> Mesh:
    """Frame, mullion, glazing bars and sill, in the middle of the wall; the panes are left out."""
    x, (start, end) = LEFT - THICK * 0.55, WINDOW
    middle, tall = (start + end) / 2, (SILL + LINTEL) / 2
    parts = [furniture.board((0.06, LINTEL - SILL, 0.07), (x, tall, z), 0.006, "y") for z in (start + 0.03, end - 0.03)]
    parts += [furniture.board((0.06, LINTEL - SILL, 0.08), (x, tall, middle), 0.006, "y")]
    parts += [
        furniture.board((0.06, 0.07, end - start), (x, y, middle), 0.006, "z") for y in (SILL + 0.03, LINTEL - 0.03)
    ]
    parts += [
        furniture.board((0.035, 0.03, end - start), (x, y, middle), 0.004, "z") for y in (SILL + 0.47, SILL + 0.94)
    ]
    parts += [furniture.board((0.34, 0.03, end - start + 0.16), (LEFT - 0.02, SILL - 0.012, middle), 0.008, "z")]
    return merge(parts)


def drapes(glb: Glb) -> None:
    """A rail and two curtains, drawn back."""
    cloth = textured(glb, "Curtain", textures.linen(512, 52, (0.86, 0.62, 0.36), 96), roughness=1.0, double_sided=True)
    iron = glb.material("Iron", (0.10, 0.10, 0.11), metallic=1.0, roughness=0.4)
    for index, (z, width) in enumerate(((WINDOW[1] + 0.36, 0.5), (WINDOW[0] + 0.10, 0.5))):
        sheet = furniture.curtain(width, LINTEL + 0.10, 7, 0.07, 53 + index)
        glb.add(f"Curtain {index}", (sheet.rotated("y", 90.0).moved(LEFT + 0.11, 0.04, z), cloth))
    rail = cylinder(0.012, WINDOW[1] - WINDOW[0] + 0.95, 16).rotated("x", 90.0)
    knobs = [sphere(0.024, 16, 8).moved(z=z) for z in (0.0, WINDOW[1] - WINDOW[0] + 0.95)]
    glb.add("Rail", (merge([rail, *knobs]).moved(LEFT + 0.11, LINTEL + 0.15, WINDOW[0] - 0.47), iron))


def bookcase(glb: Glb, wood: int) -> None:
    """Shelves against the back wall, filled with books of a few colours."""
    rng = np.random.default_rng(60)
    width, depth, tall, levels = 1.15, 0.28, 1.95, 5
    x, z = RIGHT - 0.12 - width / 2, BACK + depth / 2 + 0.02
    step = (tall - 0.08) / levels
    parts = [furniture.board((0.025, tall, depth), (s * width / 2, tall / 2, 0), 0.003, "y") for s in (-1, 1)]
    parts += [furniture.board((width, 0.025, depth), (0, 0.06 + i * step, 0), 0.003) for i in range(levels + 1)]
    parts += [furniture.board((width, tall - 0.05, 0.01), (0, tall / 2 + 0.02, -depth / 2 + 0.005), 0.002)]
    glb.add("Bookcase", (merge(parts).moved(x, 0, z), wood))
    inks = [
        (0.42, 0.06, 0.05),
        (0.05, 0.13, 0.28),
        (0.07, 0.22, 0.12),
        (0.55, 0.36, 0.12),
        (0.62, 0.56, 0.44),
        (0.10, 0.08, 0.08),
    ]
    covers: list[list[Mesh]] = [[] for _ in inks]
    pages: list[Mesh] = []
    for level in range(levels):
        at, end = -width / 2 + 0.03, width / 2 - 0.03 - rng.uniform(0.0, 0.35)
        while at < end:
            thick, height, deep = rng.uniform(0.018, 0.05), rng.uniform(0.2, 0.31), rng.uniform(0.15, 0.21)
            cover, block = furniture.book(thick, height, deep)
            lean = 0.0 if rng.random() < 0.9 else -5.0
            place = (x + at + thick / 2, 0.0735 + level * step, z + depth / 2 - 0.03 - rng.uniform(0, 0.02))
            covers[int(rng.integers(len(inks)))].append(cover.rotated("z", lean).moved(*place))
            pages.append(block.rotated("z", lean).moved(*place))
            at += thick + (0.03 if lean else 0.0015)
    paper = glb.material("Paper", (0.78, 0.72, 0.60))
    glb.add("Book pages", (merge(pages), paper))
    for index, (ink, group) in enumerate(zip(inks, covers, strict=True)):
        glb.add(f"Books {index}", (merge(group), glb.material(f"Cover {index}", ink, roughness=0.5)))


def furnish(glb: Glb) -> None:
    """Table and chairs on a rug, lamp, plant, pictures, and what lies about."""
    oak = textured(glb, "Oak", textures.wood(512, 54, (0.70, 0.48, 0.28), (0.46, 0.28, 0.15)), relief=0.8)
    walnut = textured(glb, "Walnut", textures.wood(512, 55, (0.42, 0.26, 0.16), (0.22, 0.12, 0.07)), roughness=0.4)
    weave = textures.rug(1024, 56, (0.52, 0.13, 0.11), (0.12, 0.15, 0.28), (0.84, 0.71, 0.50))
    wool = textured(glb, "Rug", weave, roughness=1.0)
    rug = rounded_box((2.5, 0.014, 1.9), 0.006).moved(0.0, 0.0075, -0.35)
    glb.add(
        "Rug",
        (Mesh(rug.positions, rug.normals, (rug.positions[:, [0, 2]] + (1.25, 1.3)) / (2.5, 1.9), rug.triangles), wool),
    )
    glb.add("Table", (furniture.table(1.35, 0.78, 0.75).moved(0.0, 0.015, -0.45), oak))
    chair = glb.mesh("Chair", (furniture.chair(), walnut))
    for index, (place, turn) in enumerate(
        (((-0.28, 0.015, 0.22), 172.0), ((0.95, 0.015, -0.40), -78.0), ((0.25, 0.015, -1.15), 8.0))
    ):
        glb.place(chair, f"Chair {index}", place, turn)
    bookcase(glb, walnut)
    metal = glb.material("Lamp metal", (0.80, 0.62, 0.35), metallic=1.0, roughness=0.25)
    cloth = glb.material("Shade", (0.82, 0.76, 0.64), double_sided=True)
    bulb = glb.material("Bulb", (0.8, 0.8, 0.8), emission=(14.0, 9.5, 5.0))
    for name, part, material in zip(
        ("Lamp stand", "Lamp shade", "Lamp bulb"), furniture.floor_lamp(1.55), (metal, cloth, bulb), strict=True
    ):
        glb.add(name, (part.moved(0.42, 0.0, -1.80), material))
    clay, soil = glb.material("Clay", (0.50, 0.22, 0.12)), glb.material("Soil", (0.06, 0.04, 0.03))
    green, stem = (
        glb.material("Leaf", (0.09, 0.26, 0.06), roughness=0.45, double_sided=True),
        glb.material("Stem", (0.16, 0.27, 0.08)),
    )
    pot, earth = furniture.flower_pot(0.17, 0.32)
    leaves, stems = furniture.plant(17, 0.30, 57)
    spot = (-1.62, 0.0, -1.66)
    for name, part, material in (("Pot", pot, clay), ("Soil", earth, soil)):
        glb.add(name, (part.moved(*spot), material))
    glb.add("Plant", (leaves.moved(spot[0], 0.28, spot[2]), green), (stems.moved(spot[0], 0.28, spot[2]), stem))
    still_life(glb)
    hang_pictures(glb)


def still_life(glb: Glb) -> None:
    """On the table: a vase, fruit in a bowl, two books."""
    china = glb.material("China", (0.78, 0.80, 0.82), roughness=0.12)
    vase = smooth_profile([(0.045, 0.0), (0.075, 0.06), (0.07, 0.14), (0.032, 0.22), (0.044, 0.27)], 8)
    vase = np.vstack([[(0, 0)], vase, [(0.038, 0.268), (0.026, 0.22), (0.03, 0.1), (0, 0.1)]])
    glb.add("Vase", (lathe(vase, 64, 50.0).moved(0.42, 0.765, -0.58), china))
    bowl = smooth_profile([(0.05, 0.0), (0.11, 0.03), (0.15, 0.085)], 8)
    inner = smooth_profile([(0.144, 0.085), (0.105, 0.036), (0.0, 0.014)], 8)
    glb.add(
        "Bowl",
        (lathe(np.vstack([[(0, 0)], bowl, inner]), 64, 60.0).moved(-0.05, 0.765, -0.42), glass(glb, "Bowl glass")),
    )
    fruit = sphere(0.042, 32, 16)
    orange, apple = (
        glb.material("Orange", (0.85, 0.33, 0.03), roughness=0.4),
        glb.material("Apple", (0.45, 0.07, 0.04), roughness=0.25),
    )
    heap = [(-0.05, 0.828, -0.47), (-0.10, 0.829, -0.40), (-0.005, 0.828, -0.385), (-0.05, 0.893, -0.415)]
    glb.add("Oranges", (merge([fruit.moved(*at) for at in heap[::2]]), orange))
    glb.add("Apples", (merge([fruit.moved(*at) for at in heap[1::2]]), apple))
    for index, (name, level, turn) in enumerate((("Red book", 0.7665, 12.0), ("Blue book", 0.7975, -9.0))):
        cover, block = (
            part.moved(-0.0155, 0, 0.0).rotated("z", 90.0).rotated("y", turn).moved(-0.45, level + 0.0155, -0.38)
            for part in furniture.book(0.03, 0.22, 0.16)
        )
        ink = ((0.42, 0.06, 0.05), (0.05, 0.13, 0.28))[index]
        glb.add(
            name,
            (cover, glb.material(name, ink, roughness=0.5)),
            (block, glb.material(f"{name} pages", (0.78, 0.72, 0.60))),
        )


def hang_pictures(glb: Glb) -> None:
    """Two prints on the back wall."""
    black = glb.material("Black frame", (0.03, 0.03, 0.03), roughness=0.3)
    hills = pictures.landscape(
        512, 512, 58, [(0.62, 0.76, 0.84), (0.93, 0.92, 0.84)],
        [(0.62, 0.68, 0.66), (0.40, 0.52, 0.46), (0.20, 0.34, 0.26)], (0.98, 0.86, 0.55),
    )  # fmt: skip
    inks = [(0.90, 0.36, 0.25), (0.25, 0.45, 0.60), (0.95, 0.75, 0.35)]
    prints = [
        ("Hills", hills, -0.98, 1.62, 0.66),
        ("Discs", pictures.discs(512, 59, (0.95, 0.93, 0.88), inks), -0.18, 1.72, 0.44),
    ]
    for name, image, x, y, size in prints:
        sheet = quad((-size / 2, size / 2, 0.008), (size, 0, 0), (0, -size, 0)).with_uv_scale(1 / size)
        material = glb.material(name, color_map=glb.texture(image, name), roughness=0.5)
        frame = furniture.picture_frame(size, size, 0.03)
        glb.add(name, (sheet.moved(x, y, BACK), material), (frame.moved(x, y, BACK), black))


def build() -> Glb:
    """The whole room."""
    glb = Glb()
    shell(glb)
    drapes(glb)
    furnish(glb)
    return glb


if __name__ == "__main__":
    save(build(), __file__)
    write_hdr(Path(__file__).resolve().parent / "assets" / "sky.hdr", clear_sky(512, 256, SUN, 2.2, (2.2, 2.3, 1.7)))
