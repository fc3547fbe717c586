"""The stage from its root down: which prims are seen, where they are, and who makes what of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdShade

from . import camera, curves, instancer, mesh, points, settings, shapes
from .document import Document, Matrix, Node
from .layers import Jail
from .material import Materials
from .report import Report, StageError
from .stage import Opened

DEEPEST = 1000
# Prims between two signs of life.
STEP = 1000

SHAPES = {
    "Mesh": mesh.mesh,
    "Cube": shapes.shape,
    "Sphere": shapes.shape,
    "Cylinder": shapes.shape,
    "Cylinder_1": shapes.shape,
    "Cone": shapes.shape,
    "Capsule": shapes.shape,
    "Capsule_1": shapes.shape,
    "Plane": shapes.shape,
    "BasisCurves": curves.curves,
    "HermiteCurves": curves.curves,
    "NurbsCurves": curves.curves,
    "Points": points.points,
}
"""Who makes a mesh of which geometry."""


class Walk:
    """Turns a stage into a document."""

    def __init__(self, opened: Opened, document: Document, jail: Jail, report: Report) -> None:
        self.stage, self.time, self.unit, self.z_up = opened.stage, opened.time, opened.unit, opened.z_up
        self.upright = opened.upright
        self.document, self.report = document, report
        self.materials = Materials(self.stage, opened.time, opened.unit, document, jail, report)
        self.meshes: dict[Any, list[int]] = {}
        self.prototypes: dict[Any, Node] = {}
        self.instancing: list[Sdf.Path] = []
        self.top: list[Node] = []
        # Names of cameras by path.
        self.cameras: dict[Sdf.Path, str] = {}
        self.seen = 0
        # The prim that was met last.
        self.place = Sdf.Path.absoluteRootPath
        self.settings = settings.chosen(self)
        self.purposes = settings.purposes(self, self.settings)

    def run(self) -> None:
        """Fills the document."""
        try:
            self.fill_document()
        except (TypeError, ValueError) as error:
            # usd-core hands on values whose type is not that of the schema.
            raise StageError(f"holds a value that cannot be used: {error}", str(self.place)) from error

    def fill_document(self) -> None:
        """All nodes from the root down, then what the settings say."""
        root = Node(self.stage.GetRootLayer().GetDisplayName(), self.upright)
        children = [self.node(child, 0) for child in self.children(self.stage.GetPseudoRoot())]
        root.children = [child for child in [*children, *self.top] if child]
        self.document.place(root)
        for prim in self.settings:
            self.place = prim.GetPath()
            settings.take(self, prim)

    def children(self, prim: Usd.Prim) -> Any:
        """Prims below that are active, loaded, defined and no classes, those of instances too."""
        return prim.GetFilteredChildren(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate))

    def node(self, prim: Usd.Prim, depth: int) -> Node | None:
        """The tree below a prim, if there is something to be seen of it."""
        if depth > DEEPEST:
            raise StageError(f"prims are nested more than {DEEPEST} deep", str(prim.GetPath()))
        self.seen += 1
        self.place = prim.GetPath()
        if self.seen % STEP == 0:
            self.report.progress(f"{self.seen} prims")
        if self.is_hidden(prim) or prim.IsA(UsdShade.Material):
            return None
        node = Node(prim.GetName())
        is_detached = self.set_transform(prim, node)
        if prim.IsInstance():
            shown = self.prototype(prim, depth)
            node.meshes, node.light, node.camera, node.children = (
                shown.meshes,
                shown.light,
                shown.camera,
                shown.children,
            )
        else:
            self.fill(prim, node, depth)
        if node.is_empty:
            return None
        if is_detached:
            self.top.append(node)
            return None
        return node

    def is_hidden(self, prim: Usd.Prim) -> bool:
        """Whether the prim and all below is invisible."""
        imageable = UsdGeom.Imageable(prim)
        return bool(imageable and imageable.GetVisibilityAttr().Get(self.time) == UsdGeom.Tokens.invisible)

    def is_drawn(self, prim: Usd.Prim) -> bool:
        """Whether the prim itself has a purpose that is drawn."""
        purpose = UsdGeom.Imageable(prim).ComputePurpose() if prim.IsA(UsdGeom.Imageable) else "default"
        return purpose in self.purposes

    def set_transform(self, prim: Usd.Prim, node: Node) -> bool:
        """Gives the node the prim's transform; whether it does not follow its parent."""
        xformable = UsdGeom.Xformable(prim)
        if not xformable:
            return False
        matrix = np.array(xformable.GetLocalTransformation(self.time))
        if not np.all(np.isfinite(matrix)):
            self.report.approximate(prim.GetPath(), "the transform is not finite, taken as identity")
        elif not np.array_equal(matrix, np.eye(4)):
            node.transform = matrix
        return bool(xformable.GetResetXformStack())

    def prototype(self, prim: Usd.Prim, depth: int) -> Node:
        """What an instance shows; those that share prototype and bound material share the tree."""
        bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        key = (prim.GetPrototype().GetPath(), bound.GetPath() if bound else None)
        if key not in self.prototypes:
            top, self.top = self.top, []
            holder = Node(prim.GetName())
            self.fill(prim, holder, depth)
            # Transforms that do not follow their parents differ between instances.
            if not self.top:
                self.prototypes[key] = holder
            self.top = top + self.top
            return holder
        return self.prototypes[key]

    def fill(self, prim: Usd.Prim, node: Node, depth: int) -> None:
        """Adds what the prim is, and all below."""
        kind = prim.GetTypeName()
        if prim.IsA(UsdGeom.PointInstancer):
            if self.is_drawn(prim):
                instancer.fill(self, prim, node, depth)
            # Prototypes below an instancer are not drawn by themselves.
            return
        if self.is_drawn(prim):
            if kind in SHAPES:
                node.meshes = self.geometry(prim)
            elif prim.IsA(UsdGeom.Camera):
                node.camera = camera.camera(self, prim)
            elif prim.IsA(UsdGeom.Gprim):
                self.report.warn(prim.GetPath(), f"{kind} geometry is dropped")
            if prim.HasAPI("LightAPI"):
                # Loaded where it is needed, with its part of usd-core: that takes as long as a million corners.
                from . import lights

                lights.light(self, prim, node)
        children = [self.node(child, depth + 1) for child in self.children(prim)]
        node.children += [child for child in children if child]

    def geometry(self, prim: Usd.Prim) -> list[int]:
        """Meshes of a prim; instances share those of their prototype."""
        bound = self.materials.bound(prim)
        source = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
        key = (source.GetPath(), bound)
        if key not in self.meshes:
            self.meshes[key] = SHAPES[prim.GetTypeName()](self, prim, bound)
        return self.meshes[key]

    def camera_name(self, prim: Usd.Prim) -> str:
        """A name that no other camera has: that of the prim, else its path."""
        path, name = prim.GetPath(), prim.GetName()
        self.cameras[path] = str(path) if name in self.cameras.values() else name
        return self.cameras[path]

    def world(self, prim: Usd.Prim) -> Matrix:
        """From the prim to the stage, in units of the stage."""
        return np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(self.time))
