"""Surface shaders that are read: UsdPreviewSurface, Autodesk's Standard Surface, OpenPBR."""

from __future__ import annotations

import math
from collections.abc import Callable

from .surface import Surface
from .terms import Term, UnsupportedError, constant, is_constant, mixed, numbers

WHITE = (1.0, 1.0, 1.0)


def preview_surface(s: Surface) -> None:
    """UsdPreviewSurface 2.6."""
    s.set_color("base_color", s.term("diffuseColor", (0.18,) * 3))
    s.set_color("emission", s.term("emissiveColor", (0.0,) * 3), math.inf)
    s.set_number("roughness", s.term("roughness", 0.5))
    s.item["ior"] = max(s.number("ior", 1.5), 1.0)
    if s.number("useSpecularWorkflow", 0):
        specular_workflow(s)
    else:
        s.set_number("metallic", s.term("metallic", 0.0))
    s.set_number("coat", s.term("clearcoat", 0.0))
    s.set_number("coat_roughness", s.term("clearcoatRoughness", 0.01))
    if s.is_connected("normal"):
        s.set_normal(s.term("normal", (0.0, 0.0, 1.0)))
    s.ignored(displacement=0.0, occlusion=1.0)
    preview_opacity(s)


def specular_workflow(s: Surface) -> None:
    """A reflectance at normal incidence in place of metalness and ior."""
    color = s.term("specularColor", (0.0,) * 3)
    if not is_constant(color):
        s.warn("an image of 'specularColor' is ignored; reflections have that of the ior")
        return
    values = (numbers(color) * 3)[:3]
    strongest = min(max(values), 0.99)
    if strongest <= 0:
        s.item["specular"] = 0.0
        return
    root = math.sqrt(strongest)
    s.item["ior"] = (1 + root) / (1 - root)
    s.set_color("specular_color", constant([v / max(values) for v in values]))


def preview_opacity(s: Surface) -> None:
    """Cutouts, presence, and what is transparent."""
    opacity, threshold = s.term("opacity", 1.0), s.number("opacityThreshold", 0.0)
    if threshold > 0:
        s.item["alpha_mode"] = {"mask": threshold}
        s.set_number("opacity", opacity)
        return
    if is_constant(opacity) and numbers(opacity)[0] >= 1:
        return
    presence = s.materials.network.text(s.shader, "opacityMode", "transparent") == "presence"
    if not presence and is_constant(opacity) and numbers(opacity)[0] <= 0:
        # Nothing diffuse is left, only the reflections of a clear pane.
        s.item |= {"base_color": WHITE, "transmission": 1.0, "thin_walled": True}
        return
    if not presence:
        s.approximate("transparency is approximated by presence: highlights fade with opacity")
    s.item["alpha_mode"] = "blend"
    s.set_number("opacity", opacity)


def standard_surface(s: Surface) -> None:
    """Autodesk's Standard Surface 1.0.1, as MaterialX and Arnold have it."""
    base = s.product("base_color", "base", s.term("base_color", (0.8,) * 3), s.term("base", 1.0))
    base = scattered(s, base, s.number("subsurface", 0.0), s.term("subsurface_color", WHITE))
    s.set_number("diffuse_roughness", s.term("diffuse_roughness", 0.0))
    s.set_number("metallic", s.term("metalness", 0.0))
    s.set_number("specular", s.term("specular", 1.0))
    s.set_color("specular_color", s.term("specular_color", WHITE))
    s.set_number("roughness", s.term("specular_roughness", 0.2))
    s.item["ior"] = max(s.number("specular_IOR", 1.5), 1.0)
    s.set_number("anisotropy", s.term("specular_anisotropy", 0.0))
    s.item["anisotropy_rotation"] = 2 * math.pi * s.number("specular_rotation", 0.0)
    transmitted(s, base, "transmission", "transmission_color", "transmission_depth")
    s.item["thin_walled"] = bool(s.number("thin_walled", 0))
    coated(s, "coat", "coat_color", "coat_roughness", 0.1, "coat_IOR", 1.5)
    emission = s.term("emission_color", WHITE)
    s.set_color("emission", s.product("emission_color", "emission", emission, s.term("emission", 0.0)), math.inf)
    s.ignored(sheen=0.0, thin_film_thickness=0.0, transmission_scatter=0.0, transmission_dispersion=0.0)
    covered(s, s.term("opacity", WHITE))
    normals(s, "normal", "coat_normal", "tangent")


def open_pbr(s: Surface) -> None:
    """OpenPBR 1.1."""
    base = s.product("base_color", "base_weight", s.term("base_color", (0.8,) * 3), s.term("base_weight", 1.0))
    base = scattered(s, base, s.number("subsurface_weight", 0.0), s.term("subsurface_color", (0.8,) * 3))
    s.set_number("diffuse_roughness", s.term("base_diffuse_roughness", 0.0))
    s.set_number("metallic", s.term("base_metalness", 0.0))
    s.set_number("specular", s.term("specular_weight", 1.0))
    s.set_color("specular_color", s.term("specular_color", WHITE))
    s.set_number("roughness", s.term("specular_roughness", 0.3))
    s.item["ior"] = max(s.number("specular_ior", 1.5), 1.0)
    s.set_number("anisotropy", s.term("specular_roughness_anisotropy", 0.0))
    transmitted(s, base, "transmission_weight", "transmission_color", "transmission_depth")
    s.item["thin_walled"] = bool(s.number("geometry_thin_walled", 0))
    coated(s, "coat_weight", "coat_color", "coat_roughness", 0.0, "coat_ior", 1.6)
    emission = s.term("emission_color", WHITE)
    luminance = s.term("emission_luminance", 0.0)
    s.set_color("emission", s.product("emission_color", "emission_luminance", emission, luminance), math.inf)
    s.ignored(fuzz_weight=0.0, thin_film_weight=0.0, transmission_scatter=0.0, transmission_dispersion_scale=0.0)
    covered(s, s.term("geometry_opacity", 1.0))
    normals(s, "geometry_normal", "geometry_coat_normal", "geometry_tangent")


def scattered(s: Surface, base: Term, share: float, color: Term) -> Term:
    """Subsurface scattering as diffuse reflection."""
    if share <= 0:
        return base
    s.approximate("subsurface scattering is approximated by diffuse reflection")
    try:
        return mixed(base, color, constant(share))
    except UnsupportedError:
        return color if share > 0.5 else base


def transmitted(s: Surface, base: Term, weight: str, color: str, depth: str) -> None:
    """Transmission. Ajar tints it by the base colour, or, with a depth, by what is absorbed on the way."""
    share, tint, distance = s.term(weight, 0.0), s.term(color, WHITE), s.number(depth, 0.0)
    s.set_color("base_color", base)
    if is_constant(share) and numbers(share)[0] <= 0:
        return
    s.set_number("transmission", share)
    if not is_constant(share) or numbers(share)[0] < 1:
        s.approximate(f"{color!r} is ignored: light that is scattered and light that passes have one colour")
    elif distance > 0:
        s.item["attenuation_color"] = [min(max(v, 1e-4), 1.0) for v in (s.numbers(color, WHITE) * 3)[:3]]
        s.item["attenuation_distance"] = distance * s.materials.unit
        s.item["base_color"] = list(WHITE)
    else:
        s.set_color("base_color", tint)


def coated(s: Surface, weight: str, color: str, roughness: str, rough: float, ior: str, index: float) -> None:
    """A clear coat; a tint of it is named."""
    share = s.term(weight, 0.0)
    s.set_number("coat", share)
    if is_constant(share) and numbers(share)[0] <= 0:
        return
    s.set_number("coat_roughness", s.term(roughness, rough))
    s.item["coat_ior"] = max(s.number(ior, index), 1.0)
    tint = s.term(color, WHITE)
    if not is_constant(tint) or any(v != 1 for v in numbers(tint)):
        s.warn(f"{color!r} is ignored: the coat is clear")


def covered(s: Surface, opacity: Term) -> None:
    """Opacity as coverage; of a colour, its green."""
    if is_constant(opacity) and min(numbers(opacity)) >= 1:
        return
    s.item["alpha_mode"] = "blend"
    s.set_number("opacity", opacity[1:2] or opacity)


def normals(s: Surface, normal: str, coat: str, tangent: str) -> None:
    """The normal map; others are named."""
    if s.is_connected(normal):
        s.set_normal(s.term(normal, (0.0, 0.0, 1.0)))
    for name in (coat, tangent):
        if s.is_connected(name):
            s.warn(f"{name!r} is ignored")


SURFACES: dict[str, Callable[[Surface], None]] = {
    "UsdPreviewSurface": preview_surface,
    "standard_surface": standard_surface,
    "open_pbr_surface": open_pbr,
}
"""Who reads which surface shader."""
