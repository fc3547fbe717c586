"""UsdLux: strengths in cd/m², and the kinds of light that Ajar has."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Gf, Usd, UsdLux

from . import mesh
from .document import Node

if TYPE_CHECKING:
    from .walk import Walk

# Shaping cones at least so wide shape nothing.
WIDE = 90.0
# Lights that a cone makes a spot.
SHAPED = ("SphereLight", "RectLight", "DiskLight", "CylinderLight")
TEXTURED = ("RectLight", "DomeLight", "DomeLight_1")


def light(walk: Walk, prim: Usd.Prim, node: Node) -> None:
    """Puts the light of a prim on its node, or names what cannot be."""
    lamp = Lamp(walk, prim)
    lamp.name_what_is_ignored()
    kind = prim.GetTypeName()
    make = MAKERS.get(kind)
    if make:
        make(lamp, node)
    elif prim.HasAPI(UsdLux.MeshLightAPI) and node.meshes:
        lamp.glowing_mesh(node)
    else:
        walk.report.warn(prim.GetPath(), f"the {kind} is dropped")


class Lamp:
    """A light and what all lights say."""

    def __init__(self, walk: Walk, prim: Usd.Prim) -> None:
        self.walk, self.prim = walk, prim
        self.api = UsdLux.LightAPI(prim)

    def get(self, name: str, default: float = 0.0) -> float:
        """A number of the light, `default` where it is missing or not finite."""
        value = self.prim.GetAttribute(f"inputs:{name}").Get(self.walk.time) if self.has(name) else None
        return float(value) if value is not None and math.isfinite(value) else default

    def has(self, name: str) -> bool:
        """Whether the light knows such an input."""
        return bool(self.prim.HasAttribute(f"inputs:{name}"))

    @property
    def color(self) -> list[float]:
        """Colour, with that of its temperature."""
        given = self.prim.GetAttribute("inputs:color").Get(self.walk.time)
        color = np.array(given if given is not None else (1, 1, 1), dtype=float)
        if self.prim.GetAttribute("inputs:enableColorTemperature").Get(self.walk.time):
            color *= np.array(UsdLux.BlackbodyTemperatureAsRgb(self.get("colorTemperature", 6500.0)))
        if not np.all(np.isfinite(color)) or color.min() < 0:
            self.approximate("a negative colour is cut at 0")
        return [max(float(c), 0.0) if math.isfinite(c) else 0.0 for c in color]

    @property
    def strength(self) -> float:
        """Luminance before normalization."""
        strength = self.get("intensity", 1.0) * 2.0 ** min(self.get("exposure"), 1000.0)
        if strength < 0:
            self.approximate("a negative intensity is taken as 0")
        return max(strength, 0.0)

    @property
    def normalizes(self) -> bool:
        """Whether the area divides the strength."""
        return bool(self.prim.GetAttribute("inputs:normalize").Get(self.walk.time))

    def approximate(self, message: str) -> None:
        """The light does not shine as it says."""
        self.walk.report.approximate(self.prim.GetPath(), message)

    def warn(self, message: str) -> None:
        """Something of the light is dropped."""
        self.walk.report.warn(self.prim.GetPath(), message)

    def stretch(self) -> np.ndarray:
        """Images of X, Y and Z in the stage: how transforms change sizes."""
        return self.walk.world(self.prim)[:3, :3]

    def divided(self, area: float) -> float:
        """Luminance, of a light with this area in the stage's units."""
        return self.strength / area if self.normalizes and area > 0 else self.strength

    def put(self, node: Node, kind: str, **values: Any) -> None:
        """Makes it the node's light."""
        item = {"name": self.prim.GetName(), "color": self.color, "kind": {kind: values}}
        node.light = self.walk.document.add("lights", item)

    def texture(self) -> int | None:
        """The light's texture."""
        attribute = self.prim.GetAttribute("inputs:texture:file")
        path = attribute.Get(self.walk.time) if attribute else None
        return self.walk.materials.light_texture(self.prim, path) if path and path.path else None

    def name_what_is_ignored(self) -> None:
        """Names what Ajar cannot do."""
        for name in ("diffuse", "specular"):
            if self.get(name, 1.0) != 1.0:
                self.warn(f"the multiplier {name!r} is ignored: light is physical")
        for name, api in (
            ("light", self.api.GetLightLinkCollectionAPI()),
            ("shadow", self.api.GetShadowLinkCollectionAPI()),
        ):
            if not api.GetIncludesRel().HasAuthoredTargets() and not api.GetExcludesRel().HasAuthoredTargets():
                continue
            self.warn(f"{name} linking is ignored: the light shines on everything")
        if self.api.GetFiltersRel().GetTargets():
            self.warn("light filters are ignored")
        if self.prim.HasAPI(UsdLux.ShapingAPI):
            shaping = UsdLux.ShapingAPI(self.prim)
            if self.get("shaping:focus") > 0:
                self.warn("shaping:focus is ignored")
            ies = shaping.GetShapingIesFileAttr().Get(self.walk.time)
            if ies and ies.path:
                self.warn("the IES profile is ignored")
        shadow = self.prim.GetAttribute("inputs:shadow:enable")
        if shadow and shadow.Get(self.walk.time) is False:
            self.warn("shadow:enable is ignored: lights cast shadows")
        for name in ("color", "distance"):
            tint = self.prim.GetAttribute(f"inputs:shadow:{name}")
            if tint and tint.HasAuthoredValue() and np.max(tint.Get(self.walk.time)) > 0:
                self.warn(f"shadow:{name} is ignored: shadows are where light does not come")
        self.name_what_the_kind_lacks()

    def name_what_the_kind_lacks(self) -> None:
        """Names a cone or a texture that other kinds of lights have."""
        kind, file = self.prim.GetTypeName(), self.prim.GetAttribute("inputs:texture:file")
        if self.cone() and kind not in SHAPED:
            self.warn("the shaping cone is ignored: only lights with a place become spots")
        if file and file.Get(self.walk.time) and (kind not in TEXTURED or (self.cone() and kind in SHAPED)):
            self.warn("the texture is ignored: only domes, and rectangles without a cone, have one")

    def cone(self) -> tuple[float, float] | None:
        """Half angles of the shaping cone in which the light is full, and which it does not leave."""
        if not self.prim.HasAPI(UsdLux.ShapingAPI):
            return None
        angle = self.get("shaping:cone:angle", WIDE)
        if not 0 < angle < WIDE:
            return None
        outer = math.radians(angle)
        return outer * (1 - min(max(self.get("shaping:cone:softness"), 0.0), 1.0)), outer

    def small(self, node: Node, candela: float) -> bool:
        """Makes it a spot where a cone shapes it; `candela` is its intensity along the axis."""
        cone = self.cone()
        if not cone:
            return False
        if not self.prim.GetAttribute("treatAsPoint") or not self.prim.GetAttribute("treatAsPoint").Get(self.walk.time):
            self.approximate("a light with a shaping cone is approximated by a spot without extent: shadows get sharp")
        self.put(node, "spot", intensity=candela * self.walk.unit**2, inner=cone[0], outer=cone[1])
        return True

    def sphere(self, node: Node) -> None:
        """SphereLight. As a point it has the intensity of the ball."""
        radius = self.get("radius", 0.5)
        size = radius * np.linalg.norm(self.stretch(), axis=1).mean()
        radiance = self.divided(4 * math.pi * size**2)
        is_point = self.prim.GetAttribute("treatAsPoint").Get(self.walk.time)
        candela = radiance * math.pi * size**2
        if self.small(node, candela):
            return
        if is_point or radius <= 0:
            if radius <= 0:
                # Nothing can be divided by: the intensity of a normalized light as its radius goes to 0.
                candela = self.strength / 4 if self.normalizes else 0.0
            self.put(node, "point", intensity=candela * self.walk.unit**2)
        else:
            self.put(node, "sphere", radiance=radiance, radius=radius)

    def rect(self, node: Node) -> None:
        """RectLight."""
        width, height = self.get("width", 1.0), self.get("height", 1.0)
        x, y, _ = self.stretch()
        area = width * height * float(np.linalg.norm(np.cross(x, y)))
        radiance = self.divided(area)
        if not self.small(node, radiance * area):
            self.put(node, "rect", radiance=radiance, width=width, height=height, texture=self.texture())

    def disk(self, node: Node) -> None:
        """DiskLight."""
        radius = self.get("radius", 0.5)
        x, y, _ = self.stretch()
        area = math.pi * radius**2 * float(np.linalg.norm(np.cross(x, y)))
        radiance = self.divided(area)
        if not self.small(node, radiance * area):
            self.put(node, "disk", radiance=radiance, radius=radius)

    def cylinder(self, node: Node) -> None:
        """CylinderLight, along X."""
        radius, length = self.get("radius", 0.5), self.get("length", 1.0)
        x, y, z = np.linalg.norm(self.stretch(), axis=1)
        around = 2 * math.pi * radius * math.sqrt((y * y + z * z) / 2)
        radiance = self.divided(around * length * x)
        if self.prim.GetAttribute("treatAsLine").Get(self.walk.time):
            self.approximate("treatAsLine is approximated: the light keeps its radius")
        if not self.small(node, radiance * 2 * radius * length * x * (y + z) / 2):
            self.put(node, "cylinder", radiance=radiance, radius=radius, length=length)

    def distant(self, node: Node) -> None:
        """DistantLight. Its luminance is that of a disc in the sky, or its illuminance if normalized."""
        angle = math.radians(min(max(self.get("angle", 0.53), 0.0), 360.0))
        half = min(angle / 2, math.pi / 2)
        size = math.pi * math.sin(half) ** 2
        illuminance = self.strength if self.normalizes or size == 0 else self.strength * size
        self.put(node, "directional", illuminance=illuminance, angle=2 * half)

    def dome(self, node: Node) -> None:
        """DomeLight and DomeLight_1: the pole is +Y, or what the stage calls up."""
        layout = self.prim.GetAttribute("inputs:texture:format").Get(self.walk.time)
        if layout not in ("automatic", "latlong", None):
            self.approximate(f"a texture of format {layout!r} is read as latlong")
        pole = self.prim.GetAttribute("poleAxis").Get(self.walk.time) if self.prim.HasAttribute("poleAxis") else "Y"
        if pole == "Z" or (pole == "scene" and self.walk.z_up):
            # Turns +Y to +Z, as Hydra does.
            turn = np.array(Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(1, 0, 0), 90)))
            node.transform = turn if node.transform is None else turn @ node.transform
        self.put(node, "environment", radiance=self.strength, texture=self.texture())

    def glowing_mesh(self, node: Node) -> None:
        """A mesh with MeshLightAPI glows instead of reflecting."""
        area = mesh.area(self.walk, self.prim, self.stretch()) if self.normalizes else 1.0
        color = [c * self.divided(area) for c in self.color]
        mode = UsdLux.LightAPI(self.prim).GetMaterialSyncModeAttr().Get()
        if mode != UsdLux.Tokens.noMaterialResponse:
            self.approximate(f"a mesh light with materialSyncMode {mode!r} glows alike everywhere and reflects nothing")
        black = {"name": self.prim.GetName(), "base_color": [0, 0, 0], "specular": 0, "emission": color}
        material = self.walk.document.add("materials", black)
        for index in node.meshes:
            self.walk.document.item("meshes", index)["material"] = material


MAKERS = {
    "SphereLight": Lamp.sphere,
    "RectLight": Lamp.rect,
    "DiskLight": Lamp.disk,
    "CylinderLight": Lamp.cylinder,
    "DistantLight": Lamp.distant,
    "DomeLight": Lamp.dome,
    "DomeLight_1": Lamp.dome,
}
"""Who makes which light."""
