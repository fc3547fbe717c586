"""Furniture and fittings, each a mesh of one material standing on the origin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .curved import cylinder, lathe, smooth_profile, sphere, surface, tube
from .mesh import Array, Mesh, merge
from .solids import box, rounded_box


def board(size: Sequence[float], centre: Sequence[float], radius: float = 0.004, grain: str = "x") -> Mesh:
    """A piece of timber with eased edges; its grain (texture u) runs along `grain`."""
    piece = rounded_box(size, radius, 1)
    if grain == "y":
        piece = piece.with_uv_swapped()
    elif grain == "z":
        turned = rounded_box((size[2], size[1], size[0]), radius, 1)
        piece = turned.rotated("y", 90.0)
    offset = np.asarray(centre) @ np.array([0.37, 1.73, 0.59])
    return piece.moved(*centre).with_uv_offset(float(offset), float(offset * 1.61))


def table(length: float, depth: float, height: float, leg: float = 0.06, top: float = 0.035) -> Mesh:
    """A four-legged table with an apron; length along x."""
    parts = [board((length, top, depth), (0, height - top / 2, 0), 0.008)]
    x, z, under = length / 2 - leg, depth / 2 - leg, height - top
    for sx in (-1, 1):
        parts += [board((leg, under, leg), (sx * x, under / 2, sz * z), 0.006, "y") for sz in (-1, 1)]
        parts += [board((0.02, 0.08, 2 * z), (sx * x, under - 0.04, 0), 0.002, "z")]
    parts += [board((2 * x, 0.08, 0.02), (0, under - 0.04, sz * z), 0.002) for sz in (-1, 1)]
    return merge(parts)


def chair(seat: float = 0.45, width: float = 0.42, depth: float = 0.42, back: float = 0.9) -> Mesh:
    """A plain wooden chair that faces +Z."""
    leg, x, z = 0.036, width / 2 - 0.022, depth / 2 - 0.022
    parts = [board((width, 0.025, depth), (0, seat - 0.0125, 0), 0.01)]
    for sx in (-1, 1):
        parts += [board((leg, seat - 0.02, leg), (sx * x, (seat - 0.02) / 2, z), 0.006, "y")]
        lean = board((leg, back, leg), (0, 0, 0), 0.006, "y").rotated("x", -4.0)
        parts += [lean.moved(sx * x, back / 2, -z - 0.02)]
        parts += [board((0.02, 0.03, 2 * z), (sx * x, 0.2, 0), 0.004, "z")]
        parts += [board((0.02, 0.05, 2 * z), (sx * x, seat - 0.045, 0), 0.004, "z")]
    parts += [board((2 * x, 0.05, 0.02), (0, seat - 0.045, s * z), 0.004) for s in (-1, 1)]
    for height, tall in ((back - 0.06, 0.08), (back - 0.19, 0.05), (back - 0.30, 0.05)):
        lean_z = -z - 0.02 - np.tan(np.radians(4.0)) * (height - back / 2)
        parts += [board((2 * x, tall, 0.018), (0, height, lean_z), 0.006)]
    return merge(parts)


def panelled_door(width: float, height: float, thickness: float = 0.04) -> Mesh:
    """A door of four panels: hinge line at x = 0, body between z = 0 and z = -thickness."""
    stile, rails = 0.11, ((0.0, 0.22), (height * 0.44, 0.16), (height - 0.12, 0.12))
    core = box((0.002, 0.002, -thickness + 0.011), (width - 0.002, height - 0.002, -0.011))
    parts = [core]
    middle = -thickness / 2
    for x in (stile / 2, width / 2, width - stile / 2):
        wide = stile if x != width / 2 else stile * 0.8
        parts += [board((wide, height, thickness), (x, height / 2, middle), 0.004, "y")]
    for bottom, tall in rails:
        parts += [board((width - 0.02, tall, thickness - 0.0006), (width / 2, bottom + tall / 2, middle), 0.004)]
    inner = (width - 2.8 * stile) / 2
    for low, high in ((0.22, height * 0.44), (height * 0.44 + 0.16, height - 0.12)):
        for x in (stile + inner / 2, width - stile - inner / 2):
            size = (inner - 0.07, high - low - 0.07, thickness - 0.010)
            raised = rounded_box(size, 0.0055, 2).with_uv_swapped()
            parts += [raised.moved(x, (low + high) / 2, middle)]
    return merge(parts)


def lever_handle(thickness: float = 0.04) -> Mesh:
    """Roses, levers and lock plates on both faces of a door; the spindle is at the origin, levers point to -X."""
    bend = [
        (0, 0, 0.0),
        (0, 0, 0.03),
        (-0.004, 0, 0.045),
        (-0.02, 0, 0.052),
        (-0.07, -0.001, 0.053),
        (-0.12, -0.004, 0.05),
    ]
    lever = tube(smooth_curve(bend, 6), 0.0085, 16)
    rose = lathe([(0, 0), (0.026, 0), (0.026, 0.005), (0.022, 0.009), (0, 0.009)], 32).rotated("x", 90.0)
    lock = rounded_box((0.022, 0.05, 0.006), 0.003).moved(0, -0.09, 0.003)
    front = merge([lever, sphere(0.0095, 16, 8).moved(-0.12, -0.004, 0.05), rose, lock])
    return merge([front, front.transformed(np.diag([1.0, 1.0, -1.0])).moved(z=-thickness)])


def smooth_curve(points: Sequence[Sequence[float]], steps: int = 8) -> Array:
    """A smooth path through points in space."""
    return smooth_profile(np.asarray(points, dtype=float), steps)


def picture_frame(width: float, height: float, border: float = 0.04, depth: float = 0.025) -> Mesh:
    """A moulded frame around a picture of the given size, against the plane z = 0, facing +Z."""
    x, y = width / 2 + border / 2 - 0.006, height / 2 + border / 2 - 0.006
    parts = [board((border, height + 2 * border - 0.013, depth), (sx * x, 0, depth / 2), 0.008, "y") for sx in (-1, 1)]
    parts += [board((width, border, depth - 0.001), (0, sy * y, depth / 2 - 0.0005), 0.008) for sy in (-1, 1)]
    return merge(parts)


def skirting(length: float, height: float = 0.1, depth: float = 0.016) -> Mesh:
    """A skirting board along x against the plane z = 0, in front of it."""
    return board((length, height, depth * 2), (0, height / 2 - 0.001, 0), 0.005)


def book(thickness: float, height: float, depth: float) -> tuple[Mesh, Mesh]:
    """A book standing upright, spine at +Z, thickness along x: its cover and its pages."""
    cover = 0.0025
    x = thickness / 2 - cover / 2
    covers = [box((s * x - cover / 2, 0, -depth), (s * x + cover / 2, height, 0)) for s in (-1, 1)]
    spine = rounded_box((thickness, height, 0.008), 0.0035, 1).moved(0, height / 2, -0.002)
    pages = box(
        (-thickness / 2 + cover * 0.8, 0.003, -depth + 0.005), (thickness / 2 - cover * 0.8, height - 0.003, -0.003)
    )
    return merge([*covers, spine]), pages


def flower_pot(radius: float, height: float) -> tuple[Mesh, Mesh]:
    """A clay pot and the soil in it."""
    r, h = radius, height
    profile = [
        (0, 0), (0.68 * r, 0), (0.72 * r, 0.02 * h), (0.92 * r, 0.78 * h), (1.0 * r, 0.78 * h), (1.02 * r, 0.98 * h),
        (1.0 * r, h), (0.9 * r, h), (0.86 * r, 0.8 * h), (0.8 * r, 0.3 * h), (0, 0.3 * h),
    ]  # fmt: skip
    soil = surface(_disk_grid(0.87 * r, 0.86 * h, 0.02 * h))
    return lathe(profile, 48, 30.0), soil


def _disk_grid(radius: float, level: float, bumps: float) -> Array:
    """A bumpy round sheet as a polar grid, seen from above."""
    rows, columns = np.linspace(0.0, radius, 10)[:, None], np.linspace(0.0, 2 * np.pi, 33)[None, :]
    ripple = np.cos(columns * 7 + rows * 90) * np.cos(columns * 4) * bumps * (rows < radius * 0.99)
    return np.stack(np.broadcast_arrays(rows * np.cos(columns), level + ripple, -rows * np.sin(columns)), -1)


def leaf(length: float, width: float, bend: float) -> Mesh:
    """A pointed leaf from the origin along +Z, drooping by `bend` metres; a single sheet."""
    t, s = np.linspace(0, 1, 11)[:, None], np.linspace(-1, 1, 5)[None, :]
    half = width / 2 * np.sin(np.pi * np.clip(t, 0.02, 0.995) ** 0.75)
    z = np.broadcast_to(length * t, (11, 5))
    y = 0.35 * length * t - bend * t**2 * 2.2 + 0.35 * half * np.abs(s)
    return surface(np.stack([-half * s, np.broadcast_to(y, (11, 5)), z], axis=-1)).reversed()


def plant(leaves: int, length: float, seed: int) -> tuple[Mesh, Mesh]:
    """Leaves on thin stems around the origin: the leaves and the stems."""
    rng = np.random.default_rng(seed)
    blades, stems = [], []
    for index in range(leaves):
        turn = index * 137.5 + rng.uniform(-12, 12)
        size = length * rng.uniform(0.7, 1.1)
        rise = 0.25 + 0.75 * index / leaves
        tip = np.array([0.0, length * 1.5 * rise, length * (0.55 - 0.35 * rise)])
        path = smooth_curve([(0, -0.02, 0.01), (0, tip[1] * 0.6, tip[2] * 0.25), tuple(tip)], 5)
        blade = leaf(size, size * 0.42, size * rng.uniform(0.2, 0.4)).moved(*tip)
        blades.append(blade.rotated("y", turn))
        stems.append(tube(path, 0.003, 6).rotated("y", turn))
    return merge(blades), merge(stems)


def curtain(width: float, height: float, folds: int, depth: float, seed: int) -> Mesh:
    """A hanging cloth in folds, x from 0 to `width`, y from 0 to `height`; a single sheet that faces +Z."""
    rng = np.random.default_rng(seed)
    x, y = np.linspace(0, 1, folds * 12 + 1)[None, :], np.linspace(1, 0, 13)[:, None]
    phase = x + 0.02 * np.interp(x, np.linspace(0, 1, 7), rng.uniform(-1, 1, 7))
    wave = np.sin(2 * np.pi * folds * phase) * (1.0 + 0.35 * (1 - y) * np.sin(5 * x + 1))
    sway = 0.3 * depth * (1 - y) * np.sin(9 * x)
    grid = np.broadcast_arrays(x * width, y * height, depth * 0.5 * wave + sway)
    return surface(np.stack(grid, axis=-1)).with_uv_scale(width * 1.6, height)


def floor_lamp(height: float) -> tuple[Mesh, Mesh, Mesh]:
    """A standing lamp: metal stand, cloth shade (a single sheet), bulb."""
    foot = lathe(smooth_profile([(0.0, 0.03), (0.03, 0.028), (0.13, 0.012), (0.14, 0.0)], 6)[::-1], 48)
    pole = cylinder(0.011, height - 0.12, 20).moved(y=0.02)
    shade = lathe([(0.20, height - 0.28), (0.14, height)], 48)
    ring = cylinder(0.03, 0.05, 20).moved(y=height - 0.2)
    bulb = sphere(0.035, 24, 12).moved(y=height - 0.12)
    return merge([foot, pole, ring]), shade, bulb
