"""MaterialX files: usd-core cannot read them, so what prims reference in them is written into the session layer."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import MaterialX as mx
from pxr import Sdf, Usd, UsdShade

from .layers import Jail
from .report import Report

TYPES = {
    "float": Sdf.ValueTypeNames.Float,
    "integer": Sdf.ValueTypeNames.Int,
    "boolean": Sdf.ValueTypeNames.Bool,
    "color3": Sdf.ValueTypeNames.Color3f,
    "color4": Sdf.ValueTypeNames.Color4f,
    "vector2": Sdf.ValueTypeNames.Float2,
    "vector3": Sdf.ValueTypeNames.Vector3f,
    "vector4": Sdf.ValueTypeNames.Float4,
    "string": Sdf.ValueTypeNames.String,
    "filename": Sdf.ValueTypeNames.Asset,
    "surfaceshader": Sdf.ValueTypeNames.Token,
    "displacementshader": Sdf.ValueTypeNames.Token,
}


def resolve(stage: Usd.Stage, jail: Jail, report: Report) -> None:
    """Writes materials below every prim that references a `.mtlx` file, at UsdMtlx's paths: /MaterialX/Materials."""
    documents: dict[str, Any] = {}
    for prim in list(Usd.PrimRange.Stage(stage, Usd.PrimAllPrimsPredicate)):
        for path, target in references(prim):
            jail.check(path, str(prim.GetPath()))
            if path not in documents:
                documents[path] = read(path, prim, report)
            if documents[path]:
                Writer(stage, Path(path), documents[path]).write(prim.GetPath(), str(target or "/MaterialX"))


def references(prim: Usd.Prim) -> Iterator[tuple[str, Any]]:
    """The MaterialX files that a prim references, and the path of what it wants of each."""
    for spec in prim.GetPrimStack():
        for items in (spec.referenceList, spec.payloadList):
            for item in [*items.explicitItems, *items.prependedItems, *items.appendedItems, *items.addedItems]:
                if item.assetPath.lower().endswith(".mtlx"):
                    yield str(Sdf.ComputeAssetPathRelativeToLayer(spec.layer, item.assetPath)), item.primPath


def read(path: str, prim: Usd.Prim, report: Report) -> Any:
    """The document, or None with a warning. What it includes is not read."""
    report.file(path)
    document = mx.createDocument()
    try:
        mx.readFromXmlString(document, Path(path).read_text("utf-8"))
    except (OSError, UnicodeDecodeError, mx.Exception) as error:
        report.warn(prim.GetPath(), f"the MaterialX file cannot be read: {error}")
        return None
    if "<xi:include" in Path(path).read_text("utf-8"):
        report.warn(prim.GetPath(), "files that a MaterialX file includes are not read")
    return document


class Writer:
    """Writes the materials of a document as shaders of UsdShade."""

    def __init__(self, stage: Usd.Stage, path: Path, document: Any) -> None:
        self.stage, self.folder, self.document = stage, path.parent, document

    def write(self, at: Sdf.Path, target: str) -> None:
        """Writes what `target` names: all, the folder of materials, or one of them."""
        name = target.removeprefix("/MaterialX").removeprefix("/Materials").strip("/")
        for material in self.document.getMaterialNodes():
            if name and material.getName() != name:
                continue
            below = at
            if not name:
                below = at if target.endswith("/Materials") else at.AppendChild("Materials")
                below = below.AppendChild(material.getName())
            self.material(material, below)

    def material(self, material: Any, path: Sdf.Path) -> None:
        """A material and all nodes of the document that it reads."""
        made = UsdShade.Material.Define(self.stage, path)
        written: dict[str, UsdShade.Shader] = {}
        for given in material.getInputs():
            node = given.getConnectedNode()
            if node is None:
                continue
            shader = self.node(node, path, written)
            kind = "surface" if given.getType() == "surfaceshader" else "displacement"
            output = made.CreateOutput(f"mtlx:{kind}", Sdf.ValueTypeNames.Token)
            output.ConnectToSource(shader.ConnectableAPI(), "out")

    def node(self, node: Any, below: Sdf.Path, written: dict[str, UsdShade.Shader]) -> UsdShade.Shader:
        """A node, its inputs and what feeds them."""
        key = node.getNamePath()
        if key in written:
            return written[key]
        path = below.AppendChild(key.replace("/", "_"))
        shader = written[key] = UsdShade.Shader.Define(self.stage, path)
        shader.CreateIdAttr(f"ND_{node.getCategory()}_{node.getType()}")
        for given in node.getInputs():
            kind = TYPES.get(given.getType(), Sdf.ValueTypeNames.String)
            made = shader.CreateInput(given.getName(), kind)
            given = given.getInterfaceInput() or given
            source = given.getConnectedNode()
            if source is not None:
                feeding = self.node(source, below, written)
                name = given.getOutputString() if not given.getNodeGraphString() else ""
                output = self.output_of(given)
                feeding.CreateOutput(name or output, kind)
                made.ConnectToSource(feeding.ConnectableAPI(), name or output)
            elif given.getValueString():
                self.value(made, given, kind)
        return shader

    def output_of(self, given: Any) -> str:
        """The output of the node that feeds an input, through the outputs of a node graph."""
        output = given.getConnectedOutput()
        return str(output.getOutputString() or "out") if output is not None else "out"

    def value(self, made: UsdShade.Input, given: Any, kind: Any) -> None:
        """A constant, a name or a file."""
        attribute = made.GetAttr()
        if given.getType() == "filename":
            file = self.folder / given.getResolvedValueString()
            attribute.Set(Sdf.AssetPath(str(file)))
        elif given.getType() in ("string", "boolean", "integer", "float"):
            attribute.Set(kind.type.pythonClass(given.getValue()) if kind.type.pythonClass else given.getValue())
        else:
            attribute.Set(tuple(given.getValue()))
        space = given.getActiveColorSpace()
        if space:
            attribute.SetColorSpace(space)
