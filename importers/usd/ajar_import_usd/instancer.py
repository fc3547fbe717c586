"""UsdGeomPointInstancer: a node for each instance, over shared trees of prototypes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pxr import Tf, Usd, UsdGeom

from .document import NODE_SIZE, Node
from .report import StageError

if TYPE_CHECKING:
    from .walk import Walk


def fill(walk: Walk, prim: Usd.Prim, node: Node, depth: int) -> None:
    """Adds the instances to `node`."""
    schema = UsdGeom.PointInstancer(prim)
    targets = schema.GetPrototypesRel().GetForwardedTargets()
    chosen = np.array(schema.GetProtoIndicesAttr().Get(walk.time) or [], dtype=np.int64)
    if not len(chosen):
        return
    if len(chosen) * NODE_SIZE > walk.document.memory_limit:
        raise StageError(
            f"{len(chosen)} instances are more than the limit on memory allows", str(prim.GetPath()), cause="resource"
        )
    if chosen.min() < 0 or chosen.max() >= len(targets):
        walk.report.warn(prim.GetPath(), f"the instances are dropped: an index is beyond the {len(targets)} prototypes")
        return
    try:
        transforms = schema.ComputeInstanceTransformsAtTime(
            walk.time, walk.time, UsdGeom.PointInstancer.ExcludeProtoXform, UsdGeom.PointInstancer.IgnoreMask
        )
    except Tf.ErrorException:
        transforms = []
    if len(transforms) != len(chosen):
        walk.report.warn(prim.GetPath(), "the instances are dropped: positions, orientations or scales do not fit")
        return
    mask = schema.ComputeMaskAtTime(walk.time) or [True] * len(chosen)
    trees = [prototype(walk, path, depth) for path in targets]
    for index, (which, matrix, is_shown) in enumerate(zip(chosen, transforms, mask)):
        tree = trees[which]
        if is_shown and tree:
            node.children.append(Node(f"{tree.name}_{index}", np.array(matrix), children=[tree]))


def prototype(walk: Walk, path: object, depth: int) -> Node | None:
    """The tree of a prototype, or None with a warning."""
    prim = walk.stage.GetPrimAtPath(path)
    if not prim:
        walk.report.warn(path, "the prototype of an instancer is not there")
        return None
    if path in walk.instancing:
        walk.report.warn(path, "an instancer is its own prototype; dropped")
        return None
    walk.instancing.append(path)
    top, walk.top = walk.top, []
    tree = walk.node(prim, depth + 1)
    walk.top = top
    walk.instancing.pop()
    return tree
