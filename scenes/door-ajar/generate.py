#!/usr/bin/env python3
"""The door ajar, after figure 6 of Veach and Guibas, "Metropolis Light Transport" (1997).

A room that gets its light only through the gap of a door, from an emitter
in the next room; three teapots (china, metal, glass) stand on a table. All
models are our own. Both rooms are sealed: thick slabs that overlap at their
corners, a door that sits in a rebate, stops behind its edges.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from modelling import furniture, pictures, textures
from modelling.finish import glass, save, textured
from modelling.glb import Glb
from modelling.mesh import Mesh, merge
from modelling.solids import box, quad, wall
from modelling.teapot import hollow_teapot, teapot

# The camera's room reaches from z = WALL to FRONT, the bright one from BACK to WALL - THICK.
LEFT, RIGHT, FRONT, WALL, BACK = -2.2, 1.9, 2.3, -2.2, -4.7
HEIGHT, THICK, SLAB = 2.6, 0.15, 0.2
DOOR_LEFT, DOOR_WIDTH, DOOR_HEIGHT = 0.45, 0.86, 2.05
OPENING = 5.0  # degrees


def shell(glb: Glb) -> None:
    """Floor, ceiling, outer walls, and the wall between the rooms."""
    boards = textures.planks(1024, 20, 8, (0.70, 0.50, 0.32), (0.44, 0.27, 0.15))
    floor = textured(glb, "Floor", boards, relief=3.0)
    paint = textured(glb, "Plaster", textures.plaster(512, 21, (0.87, 0.84, 0.77)), relief=2.0, roughness=1.0)
    white = glb.material("Ceiling", (0.80, 0.79, 0.76))
    out = SLAB
    glb.add(
        "Floor",
        (
            box((LEFT - out, -out, BACK - out), (RIGHT + out, 0.0, FRONT + out)).with_uv_swapped().with_uv_scale(0.8),
            floor,
        ),
    )
    glb.add("Ceiling", (box((LEFT - out, HEIGHT, BACK - out), (RIGHT + out, HEIGHT + out, FRONT + out)), white))
    low, high = -0.1, HEIGHT + 0.1
    sides = [
        box((LEFT - out, low, BACK - out), (LEFT, high, FRONT + out)),
        box((RIGHT, low, BACK - out), (RIGHT + out, high, FRONT + out)),
        box((LEFT - out, low, FRONT), (RIGHT + out, high, FRONT + out)),
        box((LEFT - out, low, BACK - out), (RIGHT + out, high, BACK)),
    ]
    start = LEFT - 0.1
    hole = (DOOR_LEFT - start, 0.1, DOOR_LEFT + DOOR_WIDTH - start, DOOR_HEIGHT + 0.1)
    divider = wall(RIGHT + 0.1 - start, HEIGHT + 0.2, THICK, [hole]).moved(start, -0.1, WALL)
    glb.add("Walls", (merge([*sides, divider]).with_uv_scale(0.5), paint))


def frame() -> Mesh:
    """Casings on both sides of the wall, and stops that the door closes against."""
    left, right, top, middle = DOOR_LEFT, DOOR_LEFT + DOOR_WIDTH, DOOR_HEIGHT, WALL - THICK / 2
    parts = []
    for z in (WALL + 0.002, WALL - THICK - 0.002):
        for x in (left - 0.045, right + 0.045):
            parts.append(furniture.board((0.09, top + 0.09, 0.04), (x, (top + 0.09) / 2, z), 0.006, "y"))
        parts.append(furniture.board((right - left, 0.089, 0.039), ((left + right) / 2, top + 0.0445, z), 0.006))
    for x in (left, right):
        parts.append(box((x - 0.02, 0.0, WALL - 0.09), (x + 0.02, top, WALL - 0.044)))
    parts.append(box((left, top - 0.02, WALL - 0.09), (right, top + 0.01, WALL - 0.044)))
    parts.append(box((left, -0.01, middle - 0.06), (right, 0.004, middle + 0.06)))
    return merge(parts)


def door(glb: Glb) -> None:
    """The leaf hangs on the right and opens towards the camera."""
    paint = glb.material("Painted wood", (0.62, 0.63, 0.58), roughness=0.4)
    brass = glb.material("Brass", (0.80, 0.60, 0.30), metallic=1.0, roughness=0.22)
    leaf = furniture.panelled_door(DOOR_WIDTH - 0.006, DOOR_HEIGHT - 0.008)
    # Hinge line at the right: the leaf is modelled to the right of its hinge, so it is moved first.
    hung = leaf.moved(x=-(DOOR_WIDTH - 0.006)).rotated("y", OPENING)
    handle = furniture.lever_handle().transformed([[-1, 0, 0], [0, 1, 0], [0, 0, 1]])
    handle = handle.moved(x=-(DOOR_WIDTH - 0.075), y=1.0).rotated("y", OPENING)
    hinge = (DOOR_LEFT + DOOR_WIDTH - 0.003, 0.005, WALL)
    glb.add("Door", (hung.moved(*hinge), paint))
    glb.add("Handle", (handle.moved(*hinge), brass))
    glb.add("Door frame", (frame(), paint))
    run = [
        furniture.skirting(DOOR_LEFT - 0.09 - LEFT).moved((LEFT + DOOR_LEFT - 0.09) / 2, 0, WALL),
        furniture.skirting(RIGHT - DOOR_LEFT - DOOR_WIDTH - 0.09).moved(
            (RIGHT + DOOR_LEFT + DOOR_WIDTH + 0.09) / 2, 0, WALL
        ),
        furniture.skirting(FRONT - WALL).rotated("y", 90.0).moved(LEFT, 0, (FRONT + WALL) / 2),
        furniture.skirting(FRONT - WALL).rotated("y", -90.0).moved(RIGHT, 0, (FRONT + WALL) / 2),
    ]
    glb.add("Skirting", (merge(run), paint))


def furnish(glb: Glb) -> None:
    """The table with its three pots, and two pictures."""
    oak = textured(glb, "Oak", textures.wood(512, 22, (0.62, 0.40, 0.23), (0.36, 0.20, 0.10)), relief=1.0)
    glb.add("Table", (furniture.table(1.25, 0.66, 0.74).rotated("y", 4.0).moved(-0.45, 0.0, -0.35), oak))
    china = glb.material("China", (0.70, 0.30, 0.20), roughness=1.0)
    metal = glb.material("Steel", (0.80, 0.79, 0.77), metallic=1.0, roughness=0.13)
    solid = teapot()
    glb.place(glb.mesh("China teapot", (solid, china)), "China teapot", (-0.84, 0.74, -0.36), 155.0, 1.4)
    glb.place(glb.mesh("Steel teapot", (solid, metal)), "Steel teapot", (-0.44, 0.74, -0.50), 25.0, 1.4)
    clear = glb.mesh("Glass teapot", (hollow_teapot(), glass(glb, "Glass")))
    glb.place(clear, "Glass teapot", (-0.06, 0.7405, -0.24), -20.0, 1.4)
    dark = glb.material("Dark wood", (0.10, 0.06, 0.035), roughness=0.35)
    hills = pictures.landscape(
        512, 384, 24, [(0.93, 0.72, 0.48), (0.98, 0.90, 0.74)],
        [(0.55, 0.58, 0.60), (0.38, 0.46, 0.46), (0.22, 0.34, 0.30), (0.12, 0.20, 0.17)], (0.97, 0.55, 0.30),
    )  # fmt: skip
    painting = glb.material("Painting", color_map=glb.texture(hills, "Painting"), roughness=0.6)
    canvas = quad((-0.36, 0.27, 0.008), (0.72, 0, 0), (0, -0.54, 0)).with_uv_scale(1 / 0.72, 1 / 0.54)
    x, y = -0.85, 1.52
    glb.add(
        "Painting", (canvas.moved(x, y, WALL), painting), (furniture.picture_frame(0.72, 0.54).moved(x, y, WALL), dark)
    )


def build() -> Glb:
    """The whole scene."""
    glb = Glb()
    shell(glb)
    door(glb)
    furnish(glb)
    lamp = glb.material("Lamp", (0.0, 0.0, 0.0), emission=(1000.0, 860.0, 650.0))
    glb.add("Lamp", (quad((-1.5, 2.2, BACK + 0.02), (2.1, 0, 0), (0, -1.6, 0)), lamp))
    return glb


if __name__ == "__main__":
    save(build(), __file__)
