#!/usr/bin/env python3
"""A tea table by a window: cups and a pot of MaterialX glazes, a lacquered tray, mandarins scattered by an instancer.

`assets/` holds what `scene.usda` references: a cup with variants of its glaze and filling, a pot, a bowl of fruit, and
the room. The glazes are in `glazes.mtlx`.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from modelling import cage, textures, usda
from modelling.curved import lathe, surface
from modelling.furniture import leaf
from modelling.hdr import clear_sky, write_hdr
from modelling.mesh import Mesh, merge
from modelling.noise import coloured, normal_map, smooth_step
from modelling.solids import box, floor, quad, wall
from modelling.teapot import teapot
from PIL import Image

HERE = Path(__file__).resolve().parent
ASSETS = HERE / "assets"
GLAZES = {"celadon": "Celadon", "indigo": "Indigo", "shino": "Shino"}


def save_image(name: str, pixels: np.ndarray, quality: int = 88) -> None:
    """Writes a JPEG of display values in [0, 1]."""
    values = np.clip(np.round(pixels * 255), 0, 255).astype(np.uint8)
    (ASSETS / "textures").mkdir(parents=True, exist_ok=True)
    Image.fromarray(values).save(ASSETS / "textures" / name, quality=quality, subsampling=0)


def images() -> None:
    """Wood, plaster, the speckle of glazes, the skin of mandarins."""
    oak = textures.planks(1024, 5, 5, (0.47, 0.33, 0.21), (0.27, 0.17, 0.10), 0.2)
    save_image("oak.jpg", oak.color)
    save_image("oak_roughness.jpg", oak.roughness, 80)
    save_image("oak_normal.jpg", normal_map(oak.height, 2.0))
    save_image("plaster.jpg", textures.plaster(512, 9, (0.66, 0.60, 0.52)).color)
    specks = smooth_step(2.1, 2.8, coloured((512, 512), 3, 0.45, 1.0, 6.0))
    clouds = 0.93 + 0.05 * coloured((512, 512), 4, 1.6)
    tone = np.clip(clouds - 0.55 * specks, 0, 1)
    save_image("speckle.jpg", np.stack([tone, tone * 0.995, tone * 0.98], axis=-1))
    pores = smooth_step(0.6, 2.0, coloured((256, 256), 8, 0.2, 1.0, 16.0))
    save_image("peel_normal.jpg", normal_map(1 - pores, 1.4))
    save_image("linen.jpg", textures.linen(512, 12, (0.66, 0.60, 0.50)).color)


def cup() -> None:
    """A tea bowl; the variant sets `glaze` and `filling` choose what it is made of and what is in it."""
    wall = [
        (0.010, 0.004), (0.020, 0.0035), (0.0215, 0.0), (0.0255, 0.0), (0.0265, 0.006), (0.034, 0.014), (0.0405, 0.034),
        (0.0425, 0.058), (0.0432, 0.074), (0.0418, 0.0755), (0.0404, 0.074), (0.0394, 0.056), (0.0372, 0.034),
        (0.030, 0.018), (0.012, 0.0125),
    ]  # fmt: skip
    body = usda.smooth("Body", cage.turned(wall, 16, sharp=(2, 3)), "", 2.0)
    tea = usda.faceted("Tea", lathe([(0.0405, 0.058), (0.039, 0.0565), (0, 0.0565)], 48), "/Cup/Looks/Tea")
    glazes = usda.prim("", "Glazes", meta=["references = @glazes.mtlx@</MaterialX/Materials>"])
    looks = usda.prim(
        "Scope", "Looks", usda.preview_surface(
            "Tea", "/Cup/Looks/Tea", diffuseColor=(0.13, 0.042, 0.004), roughness=0.02, ior=1.33, opacity=1.0
        )
    )  # fmt: skip
    over = [
        f'"{variant}" {{\n    over "Body" {{\n        {usda.bound(f"/Cup/Glazes/{glaze}")}\n    }}\n}}'
        for variant, glaze in GLAZES.items()
    ]
    fillings = ['"tea" {\n}', '"empty" {\n    over "Tea" (\n        active = false\n    )\n    {\n    }\n}']
    variants = [
        f'variantSet "{name}" = {{\n{usda.indent(chr(10).join(choices), "    ")}\n}}'
        for name, choices in (("glaze", over), ("filling", fillings))
    ]
    meta = [
        'variants = {\n    string glaze = "celadon"\n    string filling = "tea"\n}',
        'prepend variantSets = ["glaze", "filling"]',
    ]
    usda.write(ASSETS / "cup.usda", "Cup", usda.prim("Xform", "Cup", body, tea, glazes, looks, *variants, meta=meta))


def pot() -> None:
    """The teapot, refined from a coarse net of triangles."""
    net = teapot(0.0062)
    body = usda.faceted("Body", net, "/Pot/Glazes/Ironstone", subdivide=True)
    glazes = usda.prim("", "Glazes", meta=["references = @glazes.mtlx@</MaterialX/Materials>"])
    usda.write(ASSETS / "pot.usda", "Pot", usda.prim("Xform", "Pot", body, glazes))


def fruit() -> None:
    """A bowl, and the prototypes that an instancer scatters in it: mandarins with and without a leaf."""
    bowl = [
        (0.015, 0.006), (0.038, 0.006), (0.040, 0.0), (0.046, 0.0), (0.048, 0.010), (0.080, 0.024), (0.112, 0.052),
        (0.120, 0.070), (0.1185, 0.0725), (0.116, 0.070), (0.107, 0.053), (0.076, 0.031), (0.030, 0.018),
    ]  # fmt: skip
    skin = cage.turned(
        [
            (0.004, -0.0255),
            (0.012, -0.0245),
            (0.027, -0.018),
            (0.034, 0.0),
            (0.026, 0.019),
            (0.012, 0.0235),
            (0.003, 0.021),
        ]
    )
    star = cage.turned([(0.0015, 0.020), (0.0045, 0.0215), (0.002, 0.0245), (0.0008, 0.0255)], 8)
    peel = usda.smooth("Peel", skin, "/Fruit/Looks/Peel", 2.0)
    stalk = usda.smooth("Stalk", star, "/Fruit/Looks/Leaf")
    blade = leaf(0.045, 0.021, 0.010).rotated("y", 40.0).moved(0.0, 0.0225, 0.0)
    prototypes = [
        usda.prim("Xform", "Plain", peel, stalk),
        usda.prim("Xform", "Leafy", peel, stalk, usda.faceted("Blade", blade, "/Fruit/Looks/Leaf")),
    ]
    ring = [(0.062 * np.cos(a), 0.048, 0.062 * np.sin(a)) for a in np.radians([8, 74, 149, 214, 287])]
    places = np.array([*ring, (0.0, 0.041, 0.0), (0.028, 0.086, 0.022), (-0.034, 0.084, 0.012), (0.004, 0.088, -0.036)])
    rng = np.random.default_rng(11)
    axes = rng.normal(size=(len(places), 3)) * [0.25, 1.0, 0.25]
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    half = rng.uniform(0.2, 2.4, len(places))
    orientations = np.column_stack([np.cos(half), np.sin(half)[:, None] * axes])
    size = rng.uniform(0.93, 1.06, len(places))
    instancer = usda.prim(
        "PointInstancer", "Mandarins",
        usda.attribute("int[]", "protoIndices", np.array([0, 1, 0, 0, 1, 0, 1, 0, 0])),
        usda.attribute("point3f[]", "positions", np.round(places, 4)),
        usda.attribute("quath[]", "orientations", np.round(orientations, 4)),
        usda.attribute("float3[]", "scales", np.round(np.repeat(size[:, None], 3, 1), 3)),
        "rel prototypes = [</Fruit/Mandarins/Prototypes/Plain>, </Fruit/Mandarins/Prototypes/Leafy>]",
        usda.prim("Scope", "Prototypes", *prototypes),
    )  # fmt: skip
    looks = usda.prim(
        "Scope", "Looks",
        usda.preview_surface(
            "Peel", "/Fruit/Looks/Peel", {"normal": "textures/peel_normal.jpg"}, diffuseColor=(0.87, 0.29, 0.02),
            roughness=0.38,
        ),
        usda.preview_surface("Leaf", "/Fruit/Looks/Leaf", diffuseColor=(0.045, 0.13, 0.02), roughness=0.42),
    )  # fmt: skip
    glazes = usda.prim("", "Glazes", meta=["references = @glazes.mtlx@</MaterialX/Materials>"])
    dish = usda.smooth("Bowl", cage.turned(bowl, 20, sharp=(2, 3)), "/Fruit/Glazes/Shino", 4.0)
    usda.write(ASSETS / "fruit.usda", "Fruit", usda.prim("Xform", "Fruit", dish, instancer, looks, glazes))


def cloth() -> Mesh:
    """A runner across the table, hanging over its front edge, with a few soft waves."""
    x, z = np.linspace(-0.17, 0.17, 25)[None, :], np.linspace(-0.5, 0.42, 67)[:, None]
    wave = 0.0012 * (np.sin(31 * x + 9 * z) + np.sin(17 * z - 11 * x) + 1.6)
    return surface(np.stack(np.broadcast_arrays(x, wave + 0.0006, z), axis=-1)).with_uv_scale(4.0, 11.0)


def window() -> Mesh:
    """The wall with the window that the sun shines through: two sashes with a bar across, about the origin."""
    sashes = [(1.18, 0.88, 1.57, 1.62), (1.63, 0.88, 2.02, 1.62)]
    bar = box((1.1, 1.225, -0.07), (2.1, 1.275, -0.02))
    return merge([wall(3.2, 2.6, 0.09, sashes), bar]).moved(-1.6, -1.25, 0.045)


def room() -> None:
    """Table, runner, tray, the wall behind and that with the window."""
    tray = [(0.02, 0.004), (0.17, 0.004), (0.176, 0.002), (0.186, 0.004), (0.198, 0.022), (0.196, 0.0235),
            (0.193, 0.022), (0.182, 0.009), (0.172, 0.0075), (0.03, 0.0075)]  # fmt: skip
    back = quad((-2.0, 1.6, -0.62), (4.0, 0.0, 0.0), (0.0, -2.2, 0.0))
    parts = [
        usda.faceted("Table", floor(2.4, 1.3).with_uv_scale(1.1), "/Room/Looks/Oak"),
        usda.faceted("Wall", back, "/Room/Looks/Plaster"),
        usda.faceted("Runner", cloth(), "/Room/Looks/Linen"),
        usda.smooth("Tray", cage.turned(tray, 24), "/Room/Looks/Lacquer"),
        usda.prim(
            "Xform",
            "Window",
            usda.faceted("Frame", window(), "/Room/Looks/Plaster"),
            *usda.placed((-0.8976, 0.64, 0.4879), (-30.0, -62.0, 0.0)),
        ),
    ]
    oak = {"diffuseColor": "oak.jpg", "roughness": "oak_roughness.jpg", "normal": "oak_normal.jpg"}
    looks = usda.prim(
        "Scope", "Looks",
        usda.preview_surface("Oak", "/Room/Looks/Oak", {key: f"textures/{file}" for key, file in oak.items()}),
        usda.preview_surface("Plaster", "/Room/Looks/Plaster", {"diffuseColor": "textures/plaster.jpg"}, roughness=0.9),
        usda.preview_surface("Linen", "/Room/Looks/Linen", {"diffuseColor": "textures/linen.jpg"}, roughness=0.95),
        usda.preview_surface(
            "Lacquer", "/Room/Looks/Lacquer", diffuseColor=(0.012, 0.010, 0.010), roughness=0.35, clearcoat=1.0,
            clearcoatRoughness=0.06,
        ),
    )  # fmt: skip
    usda.write(ASSETS / "room.usda", "Room", usda.prim("Xform", "Room", *parts, looks))


if __name__ == "__main__":
    images()
    for part in (cup, pot, fruit, room):
        part()
    write_hdr(ASSETS / "textures" / "sky.hdr", clear_sky(128, 64, (-0.8, 0.5, 0.3), 0.55, (0.16, 0.14, 0.12)))
    size = sum(file.stat().st_size for file in ASSETS.rglob("*") if file.is_file())
    print(f"tea-table/assets: {size / 1e6:.2f} MB")
