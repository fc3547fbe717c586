#!/usr/bin/env python3
"""Glass on a table under a small bright lamp: caustics of a goblet and of a ball.

The goblet is one closed lathe with real walls, of amber glass; the ball is
solid and clear. A small tumbler is left empty beside them.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from modelling import textures
from modelling.curved import lathe, smooth_profile, sphere, surface
from modelling.finish import glass, save, textured
from modelling.glb import Glb
from modelling.mesh import Array, Mesh
from modelling.solids import rounded_box

# The ball and the glasses float this far above the table, so that no faces coincide.
LIFT = 0.0004


def goblet() -> Mesh:
    """A wine goblet 0.17 m high: foot, stem, bowl with walls of 2 mm."""
    outside = [
        (0.030, 0.0), (0.0335, 0.0012), (0.0325, 0.003), (0.020, 0.0060), (0.0078, 0.0125), (0.0050, 0.026),
        (0.0048, 0.045), (0.0075, 0.052), (0.0050, 0.059), (0.0062, 0.070), (0.0180, 0.079), (0.0330, 0.095),
        (0.0395, 0.115), (0.0390, 0.140), (0.0345, 0.1690),
    ]  # fmt: skip
    inside = [
        (0.0335, 0.1700), (0.0326, 0.1690), (0.0370, 0.140), (0.0374, 0.115), (0.0312, 0.0970), (0.0165, 0.0830),
        (0.0, 0.0785),
    ]  # fmt: skip
    curve = smooth_profile(outside + inside, 6)
    return lathe(np.vstack([[(0.0, 0.0)], _inside_axis(curve)]), 128, 60.0)


def tumbler() -> Mesh:
    """A straight glass with a thick bottom."""
    outside = [(0.0255, 0.0), (0.0275, 0.0020), (0.0285, 0.010), (0.0320, 0.0795)]
    inside = [(0.0312, 0.0806), (0.0303, 0.0795), (0.0272, 0.0160), (0.0235, 0.0112), (0.0, 0.0105)]
    curve = smooth_profile(outside + inside, 6)
    return lathe(np.vstack([[(0.0, 0.0)], _inside_axis(curve)]), 128, 60.0)


def _inside_axis(curve: Array) -> Array:
    """A profile whose smoothing may have crossed the axis, clipped to it."""
    return np.column_stack([np.maximum(curve[:, 0], 0.0), curve[:, 1]])


def backdrop() -> Mesh:
    """A wall that sweeps up behind the table."""
    t = np.linspace(0.0, 1.0, 25)
    bend = np.column_stack([-0.75 - 0.35 * np.sin(t * np.pi / 2), 0.35 - 0.35 * np.cos(t * np.pi / 2)])
    line = np.vstack([[(3.0, 0.0)], bend, [(-1.1, 2.5)]])[::-1]
    x = np.array([-3.0, 3.0])
    grid = np.stack(np.broadcast_arrays(x[None, :], line[:, 1:], line[:, :1]), axis=-1)
    return surface(grid)


def build() -> Glb:
    """Table, glasses and lamp."""
    glb = Glb()
    stone = textures.marble(1024, 31, (0.90, 0.87, 0.82), (0.52, 0.47, 0.42))
    marble = textured(glb, "Marble", stone, roughness=0.35)
    wall = glb.material("Backdrop", (0.28, 0.30, 0.33), double_sided=True)
    top = rounded_box((1.3, 0.03, 0.8), 0.006, 3).moved(0.0, -0.015, -0.05)
    glb.add("Table top", (top.with_uv_offset(0.13, 0.4), marble))
    glb.add("Backdrop", (backdrop().moved(0.0, -0.75, -0.2), wall))
    amber = glass(glb, "Amber glass", tint=(0.93, 0.50, 0.14), depth=0.008)
    clear = glass(glb, "Clear glass")
    sea = glass(glb, "Sea glass", tint=(0.45, 0.88, 0.80), depth=0.012)
    glb.add("Goblet", (goblet().moved(-0.055, LIFT, -0.02), amber))
    glb.add("Tumbler", (tumbler().moved(0.035, LIFT, -0.10), sea))
    glb.add("Ball", (sphere(0.032, 128, 64).moved(0.055, 0.032 + LIFT, 0.025), clear))
    return glb


if __name__ == "__main__":
    save(build(), __file__)
