"""Materials: which one a prim has, and its surface as Ajar's principled material."""

from __future__ import annotations

import os
from typing import Any

from pxr import Ar, Sdf, Usd, UsdShade

from . import primvars, surfaces
from .document import Document
from .layers import Jail
from .network import Network, category, located
from .report import Report
from .surface import Surface
from .terms import Coordinates, Image, UnsupportedError

# Where outputs of several render contexts are there, the first that can be read wins.
CONTEXTS = ["mtlx", "", "arnold"]
# What USD shows where nothing says a colour.
GREY = 0.18


class Materials:
    """Converts materials when they are first met. Meshes name them by the paths of their prims."""

    def __init__(
        self, stage: Usd.Stage, time: Usd.TimeCode, unit: float, document: Document, jail: Jail, report: Report
    ) -> None:
        self.stage, self.time, self.unit = stage, time, unit
        self.document, self.jail, self.report = document, jail, report
        self.network = Network(time, jail, report)
        # Sets of texture coordinates in the order of every mesh's `uvs`.
        self.uv_names: list[str] = []
        self.known: dict[str, tuple[int, Surface]] = {}
        self.shown: dict[float | None, int] = {}
        self.images: dict[str, int] = {}
        self.textures: dict[Any, int] = {}

    def bound(self, prim: Usd.Prim) -> str | None:
        """The path of the material that is bound for the final picture."""
        api = UsdShade.MaterialBindingAPI(prim)
        for purpose in (UsdShade.Tokens.full, UsdShade.Tokens.preview):
            material = api.ComputeBoundMaterial(purpose)[0]
            if material:
                return str(material.GetPath())
        self.name_what_is_missing(prim)
        return None

    def name_what_is_missing(self, prim: Usd.Prim) -> None:
        """Names a material that is bound to the prim or above it, and that is none."""
        while prim:
            path = UsdShade.MaterialBindingAPI(prim).GetDirectBinding().GetMaterialPath()
            if path and not UsdShade.Material(self.stage.GetPrimAtPath(path)):
                self.report.warn(prim.GetPath(), f"the bound material {path} is not there")
                return
            prim = prim.GetParent()

    def index(self, path: str) -> int:
        """The index of a material in the document."""
        return self.surface(path)[0]

    def coordinates(self, path: str) -> set[int]:
        """The sets of texture coordinates that a material reads."""
        return {self.uv_set(name) for name in self.surface(path)[1].uv_names}

    def color_primvar(self, path: str) -> str | None:
        """The colours of the mesh that a material reads."""
        return self.surface(path)[1].color_primvar

    def uv_set(self, name: str) -> int:
        """The place of a set in `uvs`."""
        if name not in self.uv_names:
            self.uv_names.append(name)
        return self.uv_names.index(name)

    def surface(self, path: str) -> tuple[int, Surface]:
        """A material, converted once."""
        if path not in self.known:
            material = UsdShade.Material(self.stage.GetPrimAtPath(path))
            surface = Surface(self, path)
            self.fill(material, surface)
            surface.item |= {"name": Sdf.Path(path).name, "path": path}
            self.known[path] = self.document.add("materials", surface.item), surface
        return self.known[path]

    def fill(self, material: UsdShade.Material, surface: Surface) -> None:
        """Reads the first surface shader that is known."""
        unknown = []
        for context in CONTEXTS:
            shader = material.ComputeSurfaceSource(context)[0]
            if not shader:
                continue
            read = surfaces.SURFACES.get(category(shader))
            if read:
                surface.shader = shader
                read(surface)
                self.name_what_is_ignored(material)
                return
            unknown.append(category(shader) or str(shader.GetPath()))
        what = (
            f"surface shaders {', '.join(dict.fromkeys(unknown))} are not read"
            if unknown
            else "it has no surface shader"
        )
        self.report.approximate(material.GetPath(), f"the material is grey: {what}")
        surface.item["base_color"] = [GREY] * 3

    def name_what_is_ignored(self, material: UsdShade.Material) -> None:
        """Displacement and volumes."""
        for context in CONTEXTS:
            for output, what in (
                (material.GetDisplacementOutput(context), "displacement"),
                (material.GetVolumeOutput(context), "the volume shader"),
            ):
                if output and output.HasConnectedSource():
                    self.report.warn(material.GetPath(), f"{what} is ignored")

    def display(self, prim: Usd.Prim, time: Usd.TimeCode) -> int:
        """The material of a prim without one: its displayColor and displayOpacity."""
        color, opacity = primvars.find(prim, "displayColor"), primvars.find(prim, "displayOpacity")
        values = list(opacity.Get(time) or []) if opacity else []
        if len(set(values)) > 1:
            self.report.warn(prim.GetPath(), "displayOpacity that varies is ignored")
        share = min(max(float(values[0]), 0.0), 1.0) if len(set(values)) == 1 else 1.0
        key = share if color else share - 2
        if key not in self.shown:
            item: dict[str, Any] = {"name": "displayColor", "base_color": [1.0 if color else GREY] * 3}
            if share < 1:
                item |= {"opacity": share, "alpha_mode": "blend"}
            self.shown[key] = self.document.add("materials", item)
        return self.shown[key]

    def light_texture(self, prim: Usd.Prim, asset: Sdf.AssetPath) -> int | None:
        """The texture of a light, or None with a warning."""
        attribute = prim.GetAttribute("inputs:texture:file")
        try:
            path = located(attribute, asset, self.jail, self.report)
        except UnsupportedError as unsupported:
            self.report.warn(prim.GetPath(), f"the light has no texture: {unsupported}")
            return None
        return self.texture(Image(path, Coordinates(), "auto", "clamp", "clamp"), None, None)

    def texture(self, image: Image, scale: list[float] | None, bias: list[float] | None) -> int:
        """The index of a texture."""
        key = (image, tuple(scale or ()), tuple(bias or ()))
        if key not in self.textures:
            item: dict[str, Any] = {
                "image": self.image(image.path),
                "color_space": image.color_space,
                "wrap_u": image.wrap_u,
                "wrap_v": image.wrap_v,
                "filter": image.filter,
                "uv_set": self.uv_set(image.coordinates.primvar) if scale is not None else 0,
                "transform": image.coordinates.top_left(),
            }
            if scale is not None and (scale != [1.0] * 4 or bias != [0.0] * 4):
                item |= {"scale": scale, "bias": bias}
            self.textures[key] = self.document.add("textures", item)
        return self.textures[key]

    def image(self, path: str) -> int:
        """The index of an image; those in packages are copied."""
        if path not in self.images:
            name = os.path.basename(Ar.SplitPackageRelativePathInner(path)[1] or path)
            if Ar.IsPackageRelativePath(path):
                asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
                if not asset:
                    raise UnsupportedError(f"the file {path} cannot be read")
                item: dict[str, Any] = {"name": name, "bytes": self.document.bytes(bytes(asset.GetBuffer()))}
            else:
                item = {"name": name, "file": path}
            self.images[path] = self.document.add("images", item)
        return self.images[path]
