#!/usr/bin/env python3
"""A corner to read in at night: chair, books and a plant under a standing lamp, as Wavefront OBJ."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from modelling import furniture, pictures, textures
from modelling.curved import lathe
from modelling.mesh import Mesh, merge
from modelling.noise import normal_map
from modelling.solids import box, floor, quad, rounded_box
from modelling.wavefront import Wavefront
from PIL import Image

ASSETS = Path(__file__).resolve().parent / "assets"


def save_image(name: str, pixels: np.ndarray, quality: int = 88) -> str:
    """Writes a JPEG of display values in [0, 1]; returns its name."""
    values = np.clip(np.round(pixels * 255), 0, 255).astype(np.uint8)
    (ASSETS / "textures").mkdir(parents=True, exist_ok=True)
    Image.fromarray(values).save(ASSETS / "textures" / name, quality=quality, subsampling=0)
    return f"textures/{name}"


def surfaced(obj: Wavefront, name: str, made: textures.Surface, relief: float = 0.0) -> str:
    """A material with maps of colour and roughness, and of normals where there is relief."""
    maps = {
        "map_Kd": save_image(f"{name.lower()}.jpg", made.color),
        "map_Pr": save_image(f"{name.lower()}_roughness.jpg", made.roughness, 78),
    }
    if relief:
        maps["norm"] = save_image(f"{name.lower()}_normal.jpg", normal_map(made.height, relief))
    return obj.material(name, Kd=(1, 1, 1), Pr=1, Ni=1.5, **maps)


def shell(obj: Wavefront) -> None:
    """Floor, walls, skirting, rug."""
    boards = surfaced(obj, "Boards", textures.planks(1024, 21, 6, (0.50, 0.34, 0.20), (0.31, 0.19, 0.11)), 2.0)
    wall = surfaced(obj, "Wall", textures.plaster(512, 22, (0.36, 0.47, 0.45)), 1.2)
    white = obj.material("Paint", Kd=(0.74, 0.72, 0.68), Pr=0.4, Ni=1.5)
    woven = textures.rug(768, 23, (0.47, 0.13, 0.10), (0.16, 0.15, 0.22), (0.80, 0.66, 0.42))
    rug = obj.material(
        "Rug", Kd=(1, 1, 1), Pr=1,
        map_Kd=save_image("rug.jpg", woven.color),
    )  # fmt: skip
    obj.add("Floor", (floor(5.0, 5.0).moved(z=1.0).with_uv_scale(0.6), boards))
    back = quad((-2.5, 2.7, -1.3), (5.0, 0, 0), (0, -2.7, 0)).with_uv_scale(0.7)
    left = quad((-1.7, 2.7, 3.5), (0, 0, -5.0), (0, -2.7, 0)).with_uv_scale(0.7)
    obj.add("Walls", (merge([back, left]), wall))
    side = furniture.skirting(5.0).rotated("y", 90.0).moved(-1.7, 0, 1.0)
    obj.add("Skirting", (merge([furniture.skirting(5.0).moved(0, 0, -1.3), side]), white))
    carpet = rounded_box((1.9, 0.012, 1.35), 0.005, 1).moved(0.1, 0.006, 0.1)
    flat = np.column_stack([carpet.positions[:, 0] / 1.9 + 0.447, carpet.positions[:, 2] / 1.35 + 0.426])
    obj.add("Rug", (Mesh(carpet.positions, carpet.normals, flat, carpet.triangles), rug))


def seat(obj: Wavefront) -> None:
    """The chair with a cushion, and a low table with books and a cup."""
    oak = surfaced(obj, "Oak", textures.wood(512, 24, (0.55, 0.38, 0.22), (0.37, 0.23, 0.12)), 1.5)
    cloth = obj.material(
        "Cushion",
        Kd=(1, 1, 1),
        Pr=1,
        map_Kd=save_image("cushion.jpg", textures.linen(512, 25, (0.71, 0.52, 0.20)).color),
    )
    chair = furniture.chair().rotated("y", 28.0).moved(0.12, 0.012, -0.32)
    pad = rounded_box((0.38, 0.055, 0.38), 0.026, 3).with_uv_scale(6.0).rotated("y", 28.0).moved(0.12, 0.487, -0.32)
    obj.add("Chair", (chair, oak), (pad, cloth))
    obj.add("Table", (furniture.table(0.52, 0.42, 0.46, 0.035, 0.024).moved(0.80, 0.012, -0.48), oak))
    glaze = obj.material("Glaze", Kd=(0.07, 0.16, 0.26), Pr=0.12, Ni=1.5, Pc=1, Pcr=0.05)
    wall = [
        (0, 0),
        (0.026, 0),
        (0.036, 0.012),
        (0.041, 0.05),
        (0.042, 0.082),
        (0.038, 0.082),
        (0.036, 0.05),
        (0.03, 0.014),
        (0, 0.01),
    ]
    obj.add("Cup", (lathe(wall, 48, 50.0).moved(0.95, 0.472, -0.37), glaze))
    books(obj)


def books(obj: Wavefront) -> None:
    """A pile on the table and one that lies open on nothing but its cover, on the chair."""
    paper = obj.material("Pages", Kd=(0.80, 0.75, 0.64), Pr=0.9)
    level = 0.472
    covers = [
        ("Umber", (0.20, 0.07, 0.035)),
        ("Sea", (0.025, 0.13, 0.15)),
        ("Mustard", (0.52, 0.32, 0.05)),
        ("Wine", (0.23, 0.02, 0.04)),
    ]
    sizes = [(0.042, 0.245, 0.175), (0.031, 0.225, 0.16), (0.036, 0.21, 0.15), (0.024, 0.19, 0.135)]
    for (name, color), size, turn in zip(covers, sizes, (12, -9, 24, -28), strict=True):
        material = obj.material(f"Cover {name}".replace(" ", "_"), Kd=color, Pr=0.45, Ni=1.5)
        lying = [part.rotated("z", 90.0).moved(size[1] / 2, size[0] / 2, size[2] / 2) for part in furniture.book(*size)]
        cover, pages = (part.rotated("y", turn).moved(0.74, level, -0.50) for part in lying)
        obj.add(f"Book_{name}", (cover, material), (pages, paper))
        level += size[0] + 0.0005


def lamp(obj: Wavefront) -> None:
    """A standing lamp, with a bulb and a shade that glow."""
    stand, shade, bulb = (part.moved(-0.62, 0.0, -0.62) for part in furniture.floor_lamp(1.58))
    brass = obj.material("Brass", Kd=(0.86, 0.62, 0.27), Pm=1, Pr=0.24)
    # MTL cannot say that cloth lets light pass, so the shade glows itself.
    cloth = obj.material("Shade", Kd=(0.83, 0.72, 0.52), Pr=0.9, Ke=(2.0, 1.1, 0.42))
    glow = obj.material("Bulb", Kd=(0, 0, 0), Ke=(430, 265, 120))
    obj.add("Lamp", (stand, brass), (shade, cloth), (bulb, glow))


def plant(obj: Wavefront) -> None:
    """A plant beside the lamp, and a print on the wall."""
    clay = obj.material("Clay", Kd=(0.47, 0.19, 0.10), Pr=0.75)
    soil = obj.material("Soil", Kd=(0.045, 0.03, 0.02), Pr=1)
    green = obj.material("Leaves", Kd=(0.055, 0.17, 0.035), Pr=0.38, Ni=1.45)
    pot, earth = (part.moved(-1.18, 0, -0.78) for part in furniture.flower_pot(0.17, 0.3))
    blades, stems = (part.moved(-1.18, 0.26, -0.78) for part in furniture.plant(15, 0.34, 26))
    obj.add("Plant", (pot, clay), (earth, soil), (merge([blades, stems]), green))
    inks = [(0.86, 0.42, 0.25), (0.32, 0.52, 0.58), (0.90, 0.72, 0.35)]
    sheet = save_image("print.jpg", pictures.discs(512, 27, (0.93, 0.90, 0.83), inks), 92)
    ink = obj.material("Print", Kd=(1, 1, 1), Pr=0.6, map_Kd=sheet)
    frame = furniture.picture_frame(0.5, 0.5, 0.025).moved(0.30, 1.42, -1.3)
    picture = quad((0.05, 1.67, -1.29), (0.5, 0, 0), (0, -0.5, 0)).with_uv_scale(2.0)
    obj.add("Picture", (frame, "Oak"), (picture, ink))
    obj.add("Backing", (box((0.05, 1.17, -1.299), (0.55, 1.67, -1.2905)), "Paint"))


if __name__ == "__main__":
    model = Wavefront()
    for part in (shell, seat, lamp, plant):
        part(model)
    model.write(ASSETS / "corner.obj")
    size = sum(file.stat().st_size for file in ASSETS.rglob("*") if file.is_file())
    print(f"reading-corner/assets/corner.obj: {model.triangles} triangles; all assets {size / 1e6:.2f} MB")
