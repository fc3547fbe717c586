"""Surface shaders that are read: UsdPreviewSurface, Autodesk's Standard Surface, OpenPBR."""

from __future__ import annotations

import math
from collections.abc import Callable

from . import lobes
from .lobes import WHITE
from .surface import Surface
from .terms import Term, UnsupportedError, computed, constant, is_constant, is_zero, numbers, product

# Ajar's dispersion times the Abbe number.
ABBE = 20.0


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
    s.set_normal("normal")
    s.ignored(displacement=0.0, occlusion=1.0)
    preview_opacity(s)


def specular_workflow(s: Surface) -> None:
    """A reflectance at normal incidence in place of metalness and ior: an index for the brightest, and a tint.

    The index is one for all texels, so that reflection towards grazing is Schlick's where an image is dark.
    """
    color = s.term("specularColor", (0.0,) * 3)
    values = [c.bias if c.source is None else c.scale + c.bias for c in (color * 3)[:3]]
    strongest = max(values)
    if strongest <= 0:
        s.item["specular"] = 0.0
        return
    root = math.sqrt(min(strongest, 0.99))
    s.item["ior"] = (1 + root) / (1 - root)
    s.set_color("specular_color", product(color, constant(1 / strongest)))


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
    base = lobes.scattered(s, base, s.number("subsurface", 0.0), s.term("subsurface_color", WHITE))
    s.set_number("diffuse_roughness", s.term("diffuse_roughness", 0.0))
    lobes.specular(s, "specular", "metalness", "specular_IOR")
    anisotropy = s.term("specular_anisotropy", 0.0)
    lobes.stretched(s, s.term("specular_roughness", 0.2), anisotropy, standard_widths)
    s.item["anisotropy_rotation"] = 2 * math.pi * s.number("specular_rotation", 0.0)
    if lobes.transmitted(s, base, "transmission", "transmission_color", "transmission_depth"):
        abbe = s.number("transmission_dispersion", 0.0)
        s.item["dispersion"] = ABBE / abbe if abbe > 0 else 0.0
        s.ignored(transmission_scatter=0.0, transmission_extra_roughness=0.0)
    s.item["thin_walled"] = bool(s.number("thin_walled", 0))
    lobes.fibres(s, "sheen", "sheen_color", s.term("sheen_roughness", 0.3), math.sqrt)
    thickness = s.term("thin_film_thickness", 0.0)
    if not is_zero(thickness):
        lobes.filmed(s, constant(1.0), thickness, s.number("thin_film_IOR", 1.5))
    if lobes.coated(s, "coat", s.term("coat_roughness", 0.1), s.number("coat_IOR", 1.5), "coat_normal"):
        s.ignored(coat_anisotropy=0.0, coat_affect_color=0.0, coat_affect_roughness=0.0)
    emission = s.term("emission_color", WHITE)
    s.set_color("emission", s.product("emission_color", "emission", emission, s.term("emission", 0.0)), math.inf)
    lobes.covered(s, s.term("opacity", WHITE))
    s.set_normal("normal")
    lobes.untwisted(s, "tangent", anisotropy)


def standard_widths(roughness: float, anisotropy: float) -> tuple[float, float]:
    """The GGX widths along and across the tangent of Standard Surface."""
    aspect = math.sqrt(1 - min(anisotropy, 0.98))
    return roughness**2 / aspect, roughness**2 * aspect


def open_pbr(s: Surface) -> None:
    """OpenPBR 1.1."""
    base = s.product("base_color", "base_weight", s.term("base_color", (0.8,) * 3), s.term("base_weight", 1.0))
    base = lobes.scattered(s, base, s.number("subsurface_weight", 0.0), s.term("subsurface_color", (0.8,) * 3))
    s.set_number("diffuse_roughness", s.term("base_diffuse_roughness", 0.0))
    lobes.specular(s, "specular_weight", "base_metalness", "specular_ior")
    coat_roughness = s.term("coat_roughness", 0.0)
    roughness = roughened(s, s.term("specular_roughness", 0.3), s.term("coat_weight", 0.0), coat_roughness)
    anisotropy = s.term("specular_roughness_anisotropy", 0.0)
    lobes.stretched(s, roughness, anisotropy, open_pbr_widths)
    if lobes.transmitted(s, base, "transmission_weight", "transmission_color", "transmission_depth"):
        abbe, scale = (
            s.number("transmission_dispersion_abbe_number", 20.0),
            s.number("transmission_dispersion_scale", 0.0),
        )
        s.item["dispersion"] = scale * ABBE / abbe if abbe > 0 and scale > 0 else 0.0
        s.ignored(transmission_scatter=0.0)
    s.item["thin_walled"] = bool(s.number("geometry_thin_walled", 0))
    if lobes.fibres(s, "fuzz_weight", "fuzz_color", s.term("fuzz_roughness", 0.5), sheen_of_fuzz):
        s.approximate("fuzz is approximated by sheen, under the coat")
    weight = s.term("thin_film_weight", 0.0)
    if not is_zero(weight):
        micrometres = s.term("thin_film_thickness", 0.5)
        lobes.filmed(s, weight, product(micrometres, constant(1000.0)), s.number("thin_film_ior", 1.4))
    if lobes.coated(s, "coat_weight", coat_roughness, s.number("coat_ior", 1.6), "geometry_coat_normal"):
        s.ignored(coat_roughness_anisotropy=0.0)
        if not is_zero(s.term("coat_darkening", 1.0)):
            s.approximate("'coat_darkening' is ignored: a coat does not darken what is below")
    emission = s.term("emission_color", WHITE)
    luminance = s.term("emission_luminance", 0.0)
    s.set_color("emission", s.product("emission_color", "emission_luminance", emission, luminance), math.inf)
    lobes.covered(s, s.term("geometry_opacity", 1.0))
    s.set_normal("geometry_normal")
    lobes.untwisted(s, "geometry_tangent", anisotropy)


def open_pbr_widths(roughness: float, anisotropy: float) -> tuple[float, float]:
    """The GGX widths along and across the tangent of OpenPBR."""
    along = roughness**2 * math.sqrt(2 / (1 + (1 - anisotropy) ** 2))
    return along, along * (1 - anisotropy)


def roughened(s: Surface, roughness: Term, coat: Term, coat_roughness: Term) -> Term:
    """What lies below a rough coat looks rougher: its lobe is widened by that of the coat, on both ways."""
    if is_zero(coat) or is_zero(coat_roughness):
        return roughness
    try:
        return computed(
            lambda r, c, above: (1 - c) * r + c * min(r**4 + 2 * above**4, 1.0) ** 0.25, roughness, coat, coat_roughness
        )
    except UnsupportedError:
        s.approximate("with images of roughness, a rough coat does not blur what is below")
        return roughness


def sheen_of_fuzz(roughness: float) -> float:
    """The roughness with which sheen reflects as much as fuzz from each direction, within 0.02 from 0.3 to 0.8."""
    return min((roughness / 0.8) ** 1.75, 1.0)


SURFACES: dict[str, Callable[[Surface], None]] = {
    "UsdPreviewSurface": preview_surface,
    "standard_surface": standard_surface,
    "open_pbr_surface": open_pbr,
}
"""Who reads which surface shader."""
