"""What the layered surface shaders have in common, lobe by lobe."""

from __future__ import annotations

import math
from collections.abc import Callable

from .surface import Surface
from .terms import Term, UnsupportedError, computed, constant, is_constant, is_zero, mixed, numbers

WHITE = (1.0, 1.0, 1.0)


def scattered(s: Surface, base: Term, share: float, color: Term) -> Term:
    """Subsurface scattering as diffuse reflection."""
    if share <= 0:
        return base
    s.approximate("subsurface scattering is approximated by diffuse reflection")
    try:
        return mixed(base, color, constant(share))
    except UnsupportedError:
        return color if share > 0.5 else base


def specular(s: Surface, weight: str, metalness: str, ior: str) -> None:
    """The interface; metal reflects by its base colour alone."""
    share, metal, tint = s.term(weight, 1.0), s.term(metalness, 0.0), s.term("specular_color", WHITE)
    s.set_number("metallic", metal)
    s.set_number("specular", share)
    s.set_color("specular_color", tint)
    s.item["ior"] = max(s.number(ior, 1.5), 1.0)
    if not is_zero(metal) and not (is_white(share) and is_white(tint)):
        s.approximate(f"{weight!r} and 'specular_color' do not change metal")


def is_white(term: Term) -> bool:
    """Whether a term is 1 everywhere."""
    return is_constant(term) and all(v == 1 for v in numbers(term))


def stretched(
    s: Surface, roughness: Term, anisotropy: Term, widths: Callable[[float, float], tuple[float, float]]
) -> None:
    """Roughness and anisotropy, by the `widths` of the highlight that the shader makes of them."""
    s.set_number("roughness", roughness)
    if is_zero(anisotropy):
        return
    # Where no normal map says otherwise, tangents are those of the first coordinates.
    s.uv_names.add("st")
    if s.materials.uv_set("st") != 0:
        s.approximate("highlights are stretched along other texture coordinates than 'st'")
    if not is_constant(roughness) or not is_constant(anisotropy):
        s.approximate("images of roughness or anisotropy stretch highlights by another law")
        s.set_number("anisotropy", anisotropy)
        return
    unit = [s.limited(key, numbers(t)[0], 1.0) for key, t in (("roughness", roughness), ("anisotropy", anisotropy))]
    along, across = (min(width, 1.0) for width in widths(*unit))
    s.item["roughness"] = math.sqrt(across)
    s.item["anisotropy"] = math.sqrt((along - across) / (1 - across)) if across < 1 else 0.0


def untwisted(s: Surface, tangent: str, anisotropy: Term) -> None:
    """Names a tangent that is not that of the texture coordinates."""
    if s.says(tangent) and not is_zero(anisotropy):
        s.warn(f"{tangent!r} is ignored: highlights are stretched along the texture coordinates")


def transmitted(s: Surface, base: Term, weight: str, color: str, depth: str) -> bool:
    """Transmission, if any. Ajar tints it by the base colour, or, with a depth, by what is absorbed on the way."""
    share, tint, distance = s.term(weight, 0.0), s.term(color, WHITE), s.number(depth, 0.0)
    s.set_color("base_color", base)
    if is_zero(share):
        return False
    s.set_number("transmission", share)
    if not is_constant(share) or numbers(share)[0] < 1:
        s.approximate(f"{color!r} is ignored: light that is scattered and light that passes have one colour")
    elif distance > 0:
        s.item["attenuation_color"] = [min(max(v, 1e-4), 1.0) for v in (s.numbers(color, WHITE) * 3)[:3]]
        s.item["attenuation_distance"] = distance * s.materials.unit
        s.item["base_color"] = list(WHITE)
    else:
        s.set_color("base_color", tint)
    return True


def fibres(s: Surface, weight: str, color: str, roughness: Term, perceptual: Callable[[float], float]) -> bool:
    """Sheen, if any; `perceptual` makes its roughness of that of the shader."""
    share = s.term(weight, 0.0)
    if is_zero(share):
        return False
    s.set_color("sheen_color", s.product(color, weight, s.term(color, WHITE), share))
    try:
        roughness = computed(lambda r: perceptual(max(r, 0.0)), roughness)
    except UnsupportedError:
        s.approximate("an image of the roughness of sheen is taken as perceptual roughness")
    s.set_number("sheen_roughness", roughness)
    return True


def filmed(s: Surface, weight: Term, nanometres: Term, ior: float) -> None:
    """A thin film."""
    s.set_number("film", weight)
    s.set_number("film_thickness", nanometres, math.inf)
    s.item["film_ior"] = max(ior, 1.0)


def coated(s: Surface, weight: str, roughness: Term, ior: float, normal: str) -> bool:
    """A clear coat, if any; a tint of it is named."""
    share = s.term(weight, 0.0)
    s.set_number("coat", share)
    if is_zero(share):
        return False
    s.set_number("coat_roughness", roughness)
    s.item["coat_ior"] = max(ior, 1.0)
    if not is_white(s.term("coat_color", WHITE)):
        s.warn("'coat_color' is ignored: the coat is clear")
    s.set_normal(normal, "coat_normal_map")
    return True


def covered(s: Surface, opacity: Term) -> None:
    """Opacity as coverage; of a colour, its green."""
    if is_constant(opacity) and min(numbers(opacity)) >= 1:
        return
    if is_constant(opacity) and len(set(numbers(opacity))) > 1:
        s.approximate("an opacity with a colour is approximated by its green")
    s.item["alpha_mode"] = "blend"
    s.set_number("opacity", opacity[1:2] or opacity)
