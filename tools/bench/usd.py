"""How long a large USD stage takes to come through the importer, beside usd-core alone.

    cargo build --release -p ajar-importers --example import
    .venv/bin/python tools/bench/usd.py target/release/examples/import

makes binary stages of two million triangles with normals, texture coordinates and a textured material: in four meshes
with an attribute a point, then with one a corner, as many exporters write, and that in one mesh. It times a Python
program that opens it and reads the same arrays, from its start to its end, and the import up to the scene graph, in
which a Python starts too. Both take turns; the fastest of each counts.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Sdf, Usd, UsdGeom, UsdShade, Vt

TRIANGLES, TURNS = 2_000_000, 7

READER = """
import sys
import numpy as np
from pxr import Usd, UsdGeom
total, stage = 0, Usd.Stage.Open(sys.argv[1])
for prim in stage.Traverse():
    if prim.IsA(UsdGeom.Mesh):
        mesh = UsdGeom.Mesh(prim)
        attributes = [mesh.GetPointsAttr(), mesh.GetNormalsAttr(), mesh.GetFaceVertexCountsAttr(),
                      mesh.GetFaceVertexIndicesAttr(), UsdGeom.PrimvarsAPI(prim).GetPrimvar("st").GetAttr()]
        total += sum(np.array(attribute.Get()).nbytes for attribute in attributes)
print(total)
"""


def grid(side):
    """Points, normals and coordinates of a wavy sheet, and its triangles."""
    x, z = np.meshgrid(np.linspace(0, 1, side + 1), np.linspace(0, 1, side + 1))
    points = np.stack([x, 0.05 * np.sin(20 * x) * np.cos(17 * z), z], axis=-1).reshape(-1, 3)
    slopes = np.stack([-np.cos(20 * x) * np.cos(17 * z), np.ones_like(x), 0.85 * np.sin(20 * x) * np.sin(17 * z)], -1)
    normals = (slopes / np.linalg.norm(slopes, axis=-1, keepdims=True)).reshape(-1, 3)
    a = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).reshape(-1)
    b, c, d = a + 1, a + side + 1, a + side + 2
    triangles = np.concatenate([np.stack([a, c, b], -1), np.stack([b, c, d], -1)])
    return points, normals, np.stack([x, z], -1).reshape(-1, 2), triangles


def textured(stage):
    """A material that reads the texture coordinates."""
    material = UsdShade.Material.Define(stage, "/World/Paint")
    shaders = {}
    for name, kind in [("Surface", "UsdPreviewSurface"), ("Image", "UsdUVTexture"), ("St", "UsdPrimvarReader_float2")]:
        shaders[name] = UsdShade.Shader.Define(stage, f"/World/Paint/{name}")
        shaders[name].CreateIdAttr(kind)
    surface, image, st = shaders.values()
    st.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    image.CreateInput("file", Sdf.ValueTypeNames.Asset).Set("./paint.png")
    image.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(st.ConnectableAPI(), "result")
    color = surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
    color.ConnectToSource(image.ConnectableAPI(), "rgb")
    material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    return material


def write(path, meshes, interpolation):
    """The stage, and its image."""
    side = int((TRIANGLES / meshes / 2) ** 0.5)
    points, normals, uvs, triangles = (array.astype(kind) for array, kind in zip(grid(side), "fffi"))
    if interpolation == "faceVarying":
        normals, uvs = normals[triangles.reshape(-1)], uvs[triangles.reshape(-1)]
    Image.new("RGB", (2, 2)).save(path.with_name("paint.png"))
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1)
    material = textured(stage)
    for index in range(meshes):
        mesh = UsdGeom.Mesh.Define(stage, f"/World/Sheet{index}")
        mesh.AddTranslateOp().Set((index, 0, 0))
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points + np.float32(index) * 1e-6))
        mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals))
        mesh.SetNormalsInterpolation(interpolation)
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(triangles), 3, np.int32)))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(triangles.reshape(-1)))
        mesh.CreateSubdivisionSchemeAttr("none")
        primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, interpolation)
        primvar.Set(Vt.Vec2fArray.FromNumpy(uvs))
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    stage.Save()


def run(command):
    """What a program prints, and how long it takes."""
    started = time.perf_counter()
    environment = os.environ | {"AJAR_USD_PYTHON": sys.executable}
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    return done.stdout, time.perf_counter() - started


def main(importer):
    with tempfile.TemporaryDirectory() as folder:
        for meshes, interpolation in [(4, "vertex"), (4, "faceVarying"), (1, "faceVarying")]:
            stage = Path(folder) / f"{interpolation}-{meshes}.usdc"
            write(stage, meshes, interpolation)
            times = []
            for _ in range(TURNS):
                _, alone = run([sys.executable, "-c", READER, stage])
                printed, _ = run([importer, stage])
                times.append((alone, float(printed)))
            alone, through = np.min(times, axis=0)
            print(
                f"{stage.stem}: {stage.stat().st_size / 1e6:.0f} MB, usd-core alone {alone:.2f} s, "
                f"through the importer {through:.2f} s, {through / alone:.2f} times"
            )


if __name__ == "__main__":
    main(sys.argv[1])
