"""Steps every scene ends with: textured materials, glass, and the report line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from .glb import Glb
from .noise import normal_map, roughness_map
from .textures import Surface


def textured(
    glb: Glb,
    name: str,
    surface: Surface,
    *,
    relief: float = 0.0,
    roughness: float | None = None,
    **material: object,
) -> int:
    """A material from a procedural surface.

    `relief` is its depth in pixels (0: no normal map). `roughness` replaces
    the roughness map by a number.
    """
    maps: dict[str, int] = {"color_map": glb.texture(surface.color, f"{name} colour")}
    if roughness is None:
        maps["rough_map"] = glb.texture(roughness_map(surface.roughness), f"{name} roughness", quality=75)
    if relief > 0.0:
        maps["normal_map"] = glb.texture(normal_map(surface.height, relief), f"{name} normal", quality=85)
    return glb.material(name, roughness=1.0 if roughness is None else roughness, **maps, **material)  # type: ignore[arg-type]


def glass(
    glb: Glb,
    name: str,
    *,
    roughness: float = 0.0,
    ior: float = 1.5,
    tint: Sequence[float] | None = None,
    depth: float = 0.05,
) -> int:
    """Solid glass for closed meshes; `tint` is what white light becomes over `depth` metres."""
    volume: dict[str, object] = {"thicknessFactor": depth}
    if tint is not None:
        volume |= {"attenuationColor": list(tint), "attenuationDistance": depth}
    return glb.material(
        name,
        roughness=roughness,
        double_sided=True,
        transmission={"transmissionFactor": 1.0},
        ior={"ior": ior},
        volume=volume,
    )


def save(glb: Glb, scene: str, name: str = "scene.glb") -> None:
    """Writes the model into the `assets` folder beside the script `scene`, and says how large it is."""
    path = Path(scene).resolve().parent / "assets" / name
    glb.write(path)
    print(f"{path.parent.parent.name}/assets/{name}: {glb.triangles} triangles, {path.stat().st_size / 1e6:.2f} MB")
