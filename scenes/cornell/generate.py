#!/usr/bin/env python3
"""The Cornell box (Goral et al. 1984): red and green walls, two blocks, one light.

The room is a cube of 2 m that stands on the origin, open towards +Z. The
colours are our own choice, near the measured ones.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from modelling.finish import save
from modelling.glb import Glb
from modelling.mesh import merge
from modelling.solids import box, quad

HALF = 1.0
HEIGHT = 2.0


def build() -> Glb:
    """Walls, blocks, and a light that faces down and does not emit upwards."""
    glb = Glb()
    white = glb.material("White", (0.73, 0.72, 0.69), double_sided=True)
    red = glb.material("Red", (0.60, 0.055, 0.045), double_sided=True)
    green = glb.material("Green", (0.13, 0.44, 0.10), double_sided=True)
    lamp = glb.material("Lamp", (0.0, 0.0, 0.0), emission=(18.4, 15.6, 9.6))
    glb.add("Floor", (quad((-HALF, 0, -HALF), (2, 0, 0), (0, 0, 2)), white))
    glb.add("Ceiling", (quad((-HALF, HEIGHT, HALF), (2, 0, 0), (0, 0, -2)), white))
    glb.add("Back wall", (quad((-HALF, HEIGHT, -HALF), (2, 0, 0), (0, -HEIGHT, 0)), white))
    glb.add("Left wall", (quad((-HALF, HEIGHT, HALF), (0, 0, -2), (0, -HEIGHT, 0)), red))
    glb.add("Right wall", (quad((HALF, HEIGHT, -HALF), (0, 0, 2), (0, -HEIGHT, 0)), green))
    # The blocks sink a little into the floor, so that no light leaks in under them.
    tall = box((-0.3, -0.01, -0.3), (0.3, 1.2, 0.3)).rotated("y", 17.0).moved(-0.34, 0.0, -0.32)
    short = box((-0.3, -0.01, -0.3), (0.3, 0.6, 0.3)).rotated("y", -18.0).moved(0.34, 0.0, 0.30)
    glb.add("Blocks", (merge([tall, short]), white))
    glb.add("Light", (quad((-0.24, HEIGHT - 0.005, 0.2), (0.48, 0, 0), (0, 0, -0.4)), lamp))
    return glb


if __name__ == "__main__":
    save(build(), __file__)
