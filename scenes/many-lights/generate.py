#!/usr/bin/env python3
"""A market street at night, lit by hundreds of paper lanterns, lit windows and signs.

Each lantern is a small closed mesh that emits, placed as a node of its own:
the scene holds tens of thousands of emitting triangles.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from modelling import furniture, pictures, textures
from modelling.curved import cylinder, lathe, sphere, surface, tube
from modelling.finish import save, textured
from modelling.glb import Glb
from modelling.mesh import Array, Mesh, merge
from modelling.solids import box, floor, quad

HALF, FAR, NEAR = 3.4, -26.0, 7.0
GLOW = [
    (4.2, 1.10, 0.18), (4.2, 2.00, 0.50), (4.0, 0.34, 0.14), (1.1, 2.2, 0.30),
    (0.25, 1.5, 2.4), (3.0, 0.40, 1.4), (4.0, 2.8, 1.3), (4.4, 1.50, 0.22),
]  # fmt: skip


def lantern() -> tuple[Mesh, Mesh]:
    """The paper globe, ribbed, and its dark caps with a hook; the top of the cap is the origin."""
    angles = np.linspace(-1.15, 1.15, 13)
    ribs = 0.100 + 0.0045 * np.cos(np.arange(13) * np.pi)
    globe = lathe(np.column_stack([ribs * np.cos(angles), 0.095 * np.sin(angles) - 0.14]), 20, 180.0)
    caps = [cylinder(0.046, 0.012, 14).moved(y=y) for y in (-0.057, -0.235)]
    return globe, merge([*caps, cylinder(0.004, 0.05, 6).moved(y=-0.05)])


def catenary(start: Array, end: Array, sag: float, count: int) -> Array:
    """Points along a hanging wire (its parabola)."""
    t = np.linspace(0.0, 1.0, count)[:, None]
    return start + (end - start) * t - np.array([0.0, 1.0, 0.0]) * sag * 4 * t * (1 - t)


def strings(glb: Glb) -> None:
    """Wires across the street and along it, with a lantern every so often."""
    rng = np.random.default_rng(70)
    globe, caps = lantern()
    iron = glb.material("Iron", (0.03, 0.03, 0.03), metallic=0.6, roughness=0.5)
    kinds = [
        glb.mesh(f"Lantern {i}", (globe, glb.material(f"Lantern {i}", (0.6, 0.6, 0.6), emission=glow)), (caps, iron))
        for i, glow in enumerate(GLOW)
    ]
    wires: list[Mesh] = []

    def hang(start: tuple[float, ...], end: tuple[float, ...], sag: float, count: int) -> None:
        path = catenary(np.array(start), np.array(end), sag, 4 * count + 1)
        wires.append(tube(path, 0.006, 5))
        for index, at in enumerate(path[2::4]):
            kind = kinds[int(rng.integers(len(kinds)))]
            size = round(float(rng.uniform(0.9, 1.45)), 3)
            glb.place(kind, f"Lantern {len(wires)}.{index}", tuple(at), float(rng.uniform(0, 360)), size)

    for index, z in enumerate(np.arange(3.6, FAR + 1, -1.35)):
        slant = rng.uniform(-0.7, 0.7)
        hang(
            (-HALF, 3.9 + rng.uniform(-0.3, 0.5), z - slant),
            (HALF, 3.9 + rng.uniform(-0.3, 0.5), z + slant),
            0.45 + 0.2 * (index % 3),
            9,
        )
    for side in (-1, 1):
        for z in np.arange(4.0, FAR + 4, -4.0):
            hang((side * (HALF - 0.9), 2.75, z), (side * (HALF - 0.9), 2.75, z - 4.0), 0.22, 6)
    glb.add("Wires", (merge(wires), iron))


def facades(glb: Glb) -> None:
    """Houses on both sides and at the far end, with windows lit and unlit, and signs."""
    rng = np.random.default_rng(71)
    plaster = textures.plaster(512, 72, (0.84, 0.78, 0.70), 0.06)
    color = glb.texture(plaster.color, "House colour")
    tints = [(1.0, 0.85, 0.72), (0.70, 0.75, 0.80), (0.95, 0.95, 0.80), (0.80, 0.55, 0.45)]
    paints = [glb.material(f"House {i}", tint, color_map=color) for i, tint in enumerate(tints)]
    trim = glb.material("Trim", (0.16, 0.13, 0.10), roughness=0.5)
    dark = glb.material("Dark pane", (0.02, 0.025, 0.03), roughness=0.05)
    lit = [
        glb.material(f"Lit pane {i}", (0.2, 0.2, 0.2), emission=e)
        for i, e in enumerate([(2.6, 1.7, 0.75), (1.6, 1.2, 0.7), (0.8, 1.0, 1.3)])
    ]
    panes: dict[int, list[Mesh]] = {}
    frames: list[Mesh] = []
    houses: dict[int, list[Mesh]] = {}
    for side in (-1, 1):
        z = NEAR
        while z > FAR:
            width, tall = rng.uniform(4.0, 6.0), rng.uniform(6.5, 9.5)
            paint = paints[int(rng.integers(len(paints)))]
            x = HALF + rng.uniform(0.0, 0.12)
            block = box((x, -0.1, z - width), (x + 4.0, tall, z))
            cornice = box((x - 0.12, tall - 0.25, z - width + 0.01), (x + 0.1, tall + 0.1, z - 0.01))
            ledge = box((x - 0.06, 3.15, z - width + 0.01), (x + 0.1, 3.3, z - 0.01))
            mirror = np.diag([float(side), 1.0, 1.0])
            houses.setdefault(paint, []).append(block.with_uv_scale(0.4).transformed(mirror))
            frames += [part.transformed(mirror) for part in (cornice, ledge)]
            for y in np.arange(3.75, tall - 1.7, 1.9):
                for at in np.arange(z - width + 0.9, z - 0.7, 1.35):
                    pane = quad((x - 0.012, y + 1.2, at - 0.38), (0, 0, 0.76), (0, -1.2, 0))
                    material = lit[int(rng.integers(len(lit)))] if rng.random() < 0.42 else dark
                    panes.setdefault(material, []).append(pane.transformed(mirror))
                    bars = [
                        box((x - 0.05, y - 0.06, at + o - 0.03), (x + 0.02, y + 1.26, at + o + 0.03))
                        for o in (-0.4, 0.0, 0.4)
                    ]
                    bars += [
                        box((x - 0.049, y + o - 0.03, at - 0.4), (x + 0.02, y + o + 0.03, at + 0.4))
                        for o in (0.0, 0.75, 1.2)
                    ]
                    frames += [bar.transformed(mirror) for bar in bars]
            z -= width
    end = box((-9.0, -0.1, FAR - 4.0), (9.0, 8.0, FAR - 0.5))
    houses.setdefault(paints[1], []).append(end.with_uv_scale(0.4))
    for paint, blocks in houses.items():
        glb.add(f"Houses {paint}", (merge(blocks), paint))
    for material, quads in panes.items():
        glb.add(f"Panes {material}", (merge(quads), material))
    glb.add("Frames", (merge(frames), trim))


def signs(glb: Glb) -> None:
    """Lit boxes that stand out from the houses, each with a printed face."""
    inks = [(0.95, 0.25, 0.20), (0.20, 0.55, 0.85), (0.98, 0.80, 0.25), (0.30, 0.80, 0.45)]
    case = glb.material("Sign case", (0.05, 0.05, 0.05), roughness=0.4)
    for index, (side, y, z) in enumerate(
        ((-1, 3.0, 0.9), (1, 3.2, -1.2), (-1, 3.1, -4.6), (1, 2.9, -6.8), (-1, 3.2, -9.5), (1, 3.1, -13.0))
    ):
        face = pictures.discs(256, 80 + index, (0.99, 0.95, 0.86), inks[index % 4 :] + inks[: index % 4])
        lit = glb.material(
            f"Sign {index}", (0.1, 0.1, 0.1), emission=(1.3, 1.3, 1.3), emission_map=glb.texture(face, f"Sign {index}")
        )
        x = side * (HALF - 0.46)
        front = quad((-0.36, 0.36, 0.062), (0.72, 0, 0), (0, -0.72, 0)).with_uv_scale(1 / 0.72)
        body = merge([box((-0.4, -0.4, -0.06), (0.4, 0.4, 0.06)), box((-0.5, 0.28, -0.02), (0.5, 0.32, 0.02))])
        glb.add(f"Sign {index}", (front.moved(x, y, z), lit), (body.moved(x, y, z), case))


def stalls(glb: Glb) -> None:
    """Market stalls along both kerbs: posts, a striped awning, crates of fruit."""
    rng = np.random.default_rng(73)
    oak = textured(glb, "Oak", textures.wood(512, 74, (0.70, 0.50, 0.32), (0.46, 0.29, 0.17)), roughness=0.6)
    cloths = []
    for index, ink in enumerate([(0.62, 0.08, 0.06), (0.06, 0.25, 0.42), (0.10, 0.38, 0.20), (0.78, 0.45, 0.08)]):
        stripe = np.where((np.arange(128) // 16 % 2)[None, :, None] == 0, np.asarray(ink) ** (1 / 2.2), 0.9)
        image = np.broadcast_to(stripe, (16, 128, 3)).copy()
        cloths.append(
            glb.material(
                f"Awning {index}", color_map=glb.texture(image, f"Awning {index}", jpeg=False), double_sided=True
            )
        )
    colors = [(0.80, 0.30, 0.03), (0.50, 0.05, 0.04), (0.30, 0.48, 0.06), (0.85, 0.65, 0.08), (0.25, 0.05, 0.18)]
    fruits = [
        glb.mesh(f"Fruit {i}", (sphere(0.05, 14, 8), glb.material(f"Fruit {i}", c, roughness=0.35)))
        for i, c in enumerate(colors)
    ]
    t = np.linspace(0, 1, 9)[:, None]
    s = np.linspace(0, 1, 13)[None, :]
    droop = 2.35 - 0.5 * t - 0.03 * np.cos(s * 6 * np.pi) * t
    slope = surface(np.stack(np.broadcast_arrays(-1.1 + 2.2 * s, droop, -0.55 + 1.25 * t), -1))
    bench = [
        furniture.board((2.0, 0.04, 0.75), (0, 0.85, 0), 0.006),
        furniture.board((1.96, 0.75, 0.03), (0, 0.45, 0.34), 0.006),
    ]
    bench += [
        furniture.board((0.05, 2.35 if z < 0 else 1.9, 0.05), (x, 1.17 if z < 0 else 0.95, z), 0.004, "y")
        for x in (-1.0, 1.0)
        for z in (-0.5, 0.36)
    ]
    crates = [
        furniture.board((0.58, 0.10, 0.02), (x, 0.93, z), 0.003) for x in (-0.64, 0.0, 0.64) for z in (-0.28, 0.28)
    ]
    crates += [
        furniture.board((0.02, 0.10, 0.56), (x + o, 0.93, 0), 0.003, "z")
        for x in (-0.64, 0.0, 0.64)
        for o in (-0.28, 0.28)
    ]
    stand = glb.mesh("Stall", (merge([*bench, *crates]), oak))
    roofs = [glb.mesh(f"Awning {i}", (slope, cloth)) for i, cloth in enumerate(cloths)]
    glow = glb.material("Stall lamp", (0.6, 0.6, 0.6), emission=(5.0, 2.9, 1.1))
    bulb = glb.mesh("Stall lamp", (lantern()[0], glow))
    spots = [(side, z + 0.8 * (side > 0)) for side in (-1, 1) for z in (0.6, -2.4, -5.4, -8.6, -11.8, -15.0)]
    for index, (side, z) in enumerate(spots):
        place = (side * 2.55, 0.0, z)
        turn = -90.0 * side
        glb.place(stand, f"Stall {index}", place, turn)
        glb.place(roofs[index % 4], f"Awning {index}", place, turn)
        for u in (-0.55, 0.55):
            glb.place(bulb, f"Stall lamp {index}", (side * 2.5, 2.10, z + u), 0.0, 0.7)
        for crate in (-0.64, 0.0, 0.64):
            kind = fruits[int(rng.integers(len(fruits)))]
            for layer, side_count in ((0, 4), (1, 3)):
                for i in range(side_count):
                    for j in range(side_count):
                        u = crate + (i - (side_count - 1) / 2) * 0.125 + rng.uniform(-0.01, 0.01)
                        v = (j - (side_count - 1) / 2) * 0.125 + rng.uniform(-0.01, 0.01)
                        # The stall is turned so that its front looks at the street.
                        glb.place(kind, "Fruit", (place[0] - side * v, 0.945 + layer * 0.075, z + side * u))


def build() -> Glb:
    """The whole street."""
    glb = Glb()
    stone = textures.tiles(
        1024, 75, 8, [(0.47, 0.46, 0.44), (0.53, 0.50, 0.47), (0.43, 0.43, 0.44)], (0.22, 0.21, 0.20)
    )
    paving = textured(glb, "Paving", stone, relief=7.0)
    glb.add(
        "Street", (floor(2 * HALF + 8.0, NEAR - FAR + 8.0).moved(0, 0, (NEAR + FAR) / 2).with_uv_scale(0.55), paving)
    )
    facades(glb)
    strings(glb)
    signs(glb)
    stalls(glb)
    return glb


if __name__ == "__main__":
    save(build(), __file__)
