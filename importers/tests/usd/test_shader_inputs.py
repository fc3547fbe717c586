"""No input of a surface shader is lost in silence: it changes the material, or it is named."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "usd"))

mx = pytest.importorskip("MaterialX")
pytest.importorskip("pxr")

from ajar_import_usd.document import Document  # noqa: E402
from ajar_import_usd.layers import Jail  # noqa: E402
from ajar_import_usd.material import Materials  # noqa: E402
from ajar_import_usd.report import Report  # noqa: E402
from pxr import Gf, Sdf, Usd, UsdShade  # noqa: E402

TYPES = {
    "float": (Sdf.ValueTypeNames.Float, 0.37),
    "color3": (Sdf.ValueTypeNames.Color3f, Gf.Vec3f(0.2, 0.4, 0.6)),
    "vector3": (Sdf.ValueTypeNames.Float3, Gf.Vec3f(0.6, 0.0, 0.8)),
    "boolean": (Sdf.ValueTypeNames.Bool, True),
}

# Lobes that must be there for an input to matter: all that lie over an opaque body, and glass.
STANDARD = [
    {"metalness": 0.5, "specular_anisotropy": 0.5, "subsurface": 0.5, "sheen": 0.5, "coat": 0.5, "emission": 1.0}
    | {"thin_film_thickness": 300.0},
    {"transmission": 1.0},
    {"transmission": 1.0, "transmission_depth": 1.0},
]
OPEN_PBR = [
    {"base_metalness": 0.5, "specular_roughness_anisotropy": 0.5, "subsurface_weight": 0.5, "fuzz_weight": 0.5}
    | {"coat_weight": 0.5, "coat_darkening": 0.0, "thin_film_weight": 0.5, "emission_luminance": 1.0},
    {"transmission_weight": 1.0, "transmission_dispersion_scale": 1.0},
    {"transmission_weight": 1.0, "transmission_depth": 1.0},
]

# Parts of lobes that are named as a whole: subsurface scattering, scattering inside, an anisotropic coat.
NAMED_WITH_THEIR_LOBE = {
    "subsurface_radius",
    "subsurface_radius_scale",
    "subsurface_scale",
    "subsurface_anisotropy",
    "subsurface_scatter_anisotropy",
    "transmission_scatter_anisotropy",
    "coat_rotation",
    "geometry_coat_tangent",
}


def inputs(definition: str, file: str) -> dict[str, str]:
    """The inputs of a MaterialX shader, with their types."""
    document = mx.createDocument()
    mx.readFromXmlFile(document, mx.FilePath(str(Path(mx.__file__).parent / "libraries" / "bxdf" / file)))
    return {one.getName(): one.getType() for one in document.getNodeDef(definition).getActiveInputs()}


def read(identifier: str, types: dict[str, str], values: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The material that a shader with these inputs becomes, and what is said about it."""
    stage = Usd.Stage.CreateInMemory()
    material = UsdShade.Material.Define(stage, "/M")
    shader = UsdShade.Shader.Define(stage, "/M/S")
    shader.CreateIdAttr(identifier)
    for name, value in values.items():
        shader.CreateInput(name, TYPES[types[name]][0]).Set(value)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "out")
    said = io.StringIO()
    jail = Jail(Path.cwd() / "main.usda", [])
    materials = Materials(stage, Usd.TimeCode.Default(), 1.0, Document(1 << 20), jail, Report(said))
    return materials.surface("/M")[1].item, said.getvalue()


@pytest.mark.parametrize(
    ("definition", "file", "bodies"),
    [
        ("ND_standard_surface_surfaceshader", "standard_surface.mtlx", STANDARD),
        ("ND_open_pbr_surface_surfaceshader", "open_pbr_surface.mtlx", OPEN_PBR),
    ],
)
def test_every_input_counts_or_is_named(definition: str, file: str, bodies: list[dict[str, float]]) -> None:
    types = inputs(definition, file)
    assert len(types) > 40

    def counts(name: str) -> bool:
        changed = TYPES[types[name]][1]
        return any(read(definition, types, body) != read(definition, types, body | {name: changed}) for body in bodies)

    lost = [name for name in types if name not in NAMED_WITH_THEIR_LOBE and not counts(name)]
    assert lost == []
