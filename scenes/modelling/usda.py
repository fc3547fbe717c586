"""Writes USD as text: prims, attributes, meshes, materials of UsdPreviewSurface."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from textwrap import indent
from typing import Any

import numpy as np

from .cage import Cage
from .mesh import Array, Mesh

HEADER = '#usda 1.0\n(\n    defaultPrim = "{root}"\n    metersPerUnit = 1\n    upAxis = "Y"\n)\n\n'


def write(path: Path, root: str, *prims: str) -> None:
    """Saves a layer in metres, +Y up, whose default prim is `root`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(HEADER.format(root=root) + "\n\n".join(prims) + "\n", "utf-8")


def prim(kind: str, name: str, *body: str, meta: Sequence[str] = (), specifier: str = "def") -> str:
    """A prim with metadata and what is in it."""
    head = f'{specifier} {kind} "{name}"'.replace("  ", " ")
    about = f" (\n{indent(chr(10).join(meta), '    ')}\n)" if meta else ""
    return f"{head}{about}\n{{\n{indent(chr(10).join(body), '    ')}\n}}"


def text(value: Any) -> str:
    """A value as USD writes it; arrays of pairs and triples become tuples."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, np.ndarray):
        rows = value.tolist() if value.ndim == 1 else [tuple(row) for row in value.tolist()]
        return "[" + ", ".join(text(row) for row in rows) + "]"
    if isinstance(value, (tuple, list)):
        return "(" + ", ".join(text(item) for item in value) + ")"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def attribute(kind: str, name: str, value: Any, *meta: str) -> str:
    """`float radius = 2`."""
    about = f" (\n{indent(chr(10).join(meta), '    ')}\n)" if meta else ""
    return f"{kind} {name} = {text(value)}{about}"


def placed(
    move: Sequence[float] = (0.0, 0.0, 0.0), turn: Sequence[float] = (0.0, 0.0, 0.0), scale: float = 1.0
) -> Iterable[str]:
    """Transform of a prim: scaled, turned about X, Y, Z (degrees), moved."""
    order = []
    if any(move):
        order.append('"xformOp:translate"')
        yield attribute("double3", "xformOp:translate", tuple(float(x) for x in move))
    if any(turn):
        order.append('"xformOp:rotateXYZ"')
        yield attribute("float3", "xformOp:rotateXYZ", tuple(float(x) for x in turn))
    if scale != 1.0:
        order.append('"xformOp:scale"')
        yield attribute("float3", "xformOp:scale", (float(scale),) * 3)
    if order:
        yield f"uniform token[] xformOpOrder = [{', '.join(order)}]"


BOUND = 'prepend apiSchemas = ["MaterialBindingAPI"]'


def bound(material: str) -> str:
    """Binds a material; the prim needs the metadata `BOUND`."""
    return f"rel material:binding = <{material}>"


def smooth(name: str, cage: Cage, material: str, repeat: float = 0.0) -> str:
    """A subdivision surface; `repeat` is how often a texture repeats around it, 0 for none."""
    body = [
        attribute("int[]", "faceVertexCounts", cage.counts),
        attribute("int[]", "faceVertexIndices", cage.corners),
        attribute("point3f[]", "points", np.round(cage.points, 5)),
        'uniform token subdivisionScheme = "catmullClark"',
    ]
    if repeat:
        body.append(coordinates(cage.uvs * repeat, "faceVarying"))
    if len(cage.creases):
        body += [
            attribute("int[]", "creaseIndices", cage.creases.reshape(-1)),
            attribute("int[]", "creaseLengths", np.full(len(cage.creases), 2)),
            attribute("float[]", "creaseSharpnesses", np.full(len(cage.creases), cage.sharpness)),
        ]
    # What a variant set binds must not be bound here: this would be stronger.
    return prim("Mesh", name, *body, *([bound(material)] if material else []), meta=[BOUND])


def faceted(name: str, mesh: Mesh, material: str, subdivide: bool = False) -> str:
    """A mesh of triangles with its normals and texture coordinates, or one that is refined."""
    body = [
        attribute("int[]", "faceVertexCounts", np.full(len(mesh.triangles), 3)),
        attribute("int[]", "faceVertexIndices", mesh.triangles.reshape(-1)),
        attribute("point3f[]", "points", np.round(mesh.positions, 5)),
    ]
    if subdivide:
        body.append('uniform token subdivisionScheme = "catmullClark"')
    else:
        body += [
            'uniform token subdivisionScheme = "none"',
            attribute("normal3f[]", "normals", np.round(mesh.normals, 4), 'interpolation = "vertex"'),
            coordinates(mesh.uvs),
        ]
    return prim("Mesh", name, *body, bound(material), meta=[BOUND])


def coordinates(uvs: Array, interpolation: str = "vertex") -> str:
    """Texture coordinates of the models, whose origin is at the top left, as USD has them."""
    flipped = np.round(np.column_stack([uvs[:, 0], 1 - uvs[:, 1]]), 5)
    return attribute("texCoord2f[]", "primvars:st", flipped, f'interpolation = "{interpolation}"')


def preview_surface(name: str, path: str, maps: dict[str, str] | None = None, **inputs: Any) -> str:
    """A material of UsdPreviewSurface at `path`; `maps` names image files of inputs, `normal` a normal map."""
    shader, textures = [], []
    for key, value in inputs.items():
        kind = "color3f" if isinstance(value, tuple) else "float"
        shader.append(attribute(kind, f"inputs:{key}", value))
    for key, file in (maps or {}).items():
        kind, channel = {"diffuseColor": ("color3f", "rgb"), "normal": ("normal3f", "rgb")}.get(key, ("float", "r"))
        shader.append(f"{kind} inputs:{key}.connect = <{path}/{key}.outputs:{channel}>")
        body = [
            'uniform token info:id = "UsdUVTexture"',
            f"asset inputs:file = @{file}@",
            f'token inputs:sourceColorSpace = "{"sRGB" if key == "diffuseColor" else "raw"}"',
            'token inputs:wrapS = "repeat"',
            'token inputs:wrapT = "repeat"',
            f"float2 inputs:st.connect = <{path}/st.outputs:result>",
            f"float{3 if channel == 'rgb' else ''} outputs:{channel}",
        ]
        if key == "normal":
            body += ["float4 inputs:scale = (2, 2, 2, 1)", "float4 inputs:bias = (-1, -1, -1, 0)"]
        textures.append(prim("Shader", key, *body))
    if textures:
        reader = ['uniform token info:id = "UsdPrimvarReader_float2"', 'string inputs:varname = "st"']
        textures.append(prim("Shader", "st", *reader, "float2 outputs:result"))
    surface = prim("Shader", "surface", 'uniform token info:id = "UsdPreviewSurface"', *shader, "token outputs:surface")
    connection = f"token outputs:surface.connect = <{path}/surface.outputs:surface>"
    return prim("Material", name, connection, surface, *textures)
