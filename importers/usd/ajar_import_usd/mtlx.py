"""MaterialX files: usd-core cannot read them, so prims reference layers that are made of them."""

from __future__ import annotations

import posixpath
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from pxr import Ar, Sdf, Usd, UsdShade

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


def resolve(layers: Iterable[Any], report: Report) -> list[Any]:
    """Lets prims reference layers of the same content in place of `.mtlx` files; only in memory, nothing is saved.

    Returns those layers: they are there as long as somebody holds them.
    """
    made: dict[str, Any] = {}

    def visit(layer: Any, path: Any) -> None:
        spec = layer.GetObjectAtPath(path)
        spec = spec.primSpec if isinstance(spec, Sdf.VariantSpec) else spec
        if not isinstance(spec, Sdf.PrimSpec):
            return
        for key in ("references", "payload"):
            items = spec.GetInfo(key) if spec.HasInfo(key) else None
            if items and any(is_materialx(item) for item in items.GetAddedOrExplicitItems()):
                added = ["prependedItems", "appendedItems", "addedItems"]
                for field in ["explicitItems"] if items.isExplicit else added:
                    setattr(items, field, [replaced(layer, item, path) for item in getattr(items, field)])
                spec.SetInfo(key, items)

    def replaced(layer: Any, item: Any, place: Any) -> Any:
        if not is_materialx(item):
            return item
        path = str(Sdf.ComputeAssetPathRelativeToLayer(layer, item.assetPath))
        if path not in made:
            made[path] = converted(path, place, report)
        return type(item)(made[path].identifier, item.primPath, item.layerOffset)

    for layer in layers:
        layer.Traverse(Sdf.Path.absoluteRootPath, partial(visit, layer))
    return list(made.values())


def is_materialx(item: Any) -> bool:
    """Whether a reference or payload is of a MaterialX file."""
    return bool(item.assetPath.lower().endswith(".mtlx"))


def converted(path: str, place: Any, report: Report) -> Any:
    """A layer with the materials of a file at UsdMtlx's paths, /MaterialX/Materials; none if it cannot be read."""
    layer = Sdf.Layer.CreateAnonymous(f"{Path(path).name}.usda")
    stage = Usd.Stage.Open(layer)
    stage.SetDefaultPrim(stage.DefinePrim("/MaterialX"))
    document = read(path, place, report)
    if document:
        writer = Writer(stage, path, document)
        for material in document.getMaterialNodes():
            writer.material(material, Sdf.Path("/MaterialX/Materials").AppendChild(material.getName()))
    return layer


def read(path: str, place: Any, report: Report) -> Any:
    """The document, or None with a warning. What it includes is not read."""
    # Read by few stages, and slow to load.
    import MaterialX as mx

    document = mx.createDocument()
    try:
        text = contents(path)
        mx.readFromXmlString(document, text)
    except (OSError, UnicodeDecodeError, mx.Exception) as error:
        report.warn(place, f"the MaterialX file cannot be read: {error}")
        return None
    if "<xi:include" in text:
        report.warn(place, "files that a MaterialX file includes are not read")
    return document


def contents(path: str) -> str:
    """The text of a file, which may lie in a package."""
    if not Ar.IsPackageRelativePath(path):
        return Path(path).read_text("utf-8")
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    if not asset:
        raise OSError("it is not in the package")
    return bytes(asset.GetBuffer()).decode("utf-8")


class Writer:
    """Writes the materials of a document as shaders of UsdShade."""

    def __init__(self, stage: Usd.Stage, path: str, document: Any) -> None:
        self.stage, self.path, self.document = stage, path, document

    def beside(self, name: str) -> str:
        """Where a file lies that is named relative to the document."""
        if not Ar.IsPackageRelativePath(self.path):
            return str(Path(self.path).parent / name)
        package, inner = Ar.SplitPackageRelativePathInner(self.path)
        return str(
            Ar.JoinPackageRelativePath(package, posixpath.normpath(posixpath.join(posixpath.dirname(inner), name)))
        )

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
            attribute.Set(Sdf.AssetPath(self.beside(given.getResolvedValueString())))
        elif given.getType() in ("string", "boolean", "integer", "float"):
            attribute.Set(kind.type.pythonClass(given.getValue()) if kind.type.pythonClass else given.getValue())
        else:
            attribute.Set(tuple(given.getValue()))
        space = given.getActiveColorSpace()
        if space:
            attribute.SetColorSpace(space)
