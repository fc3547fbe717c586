"""Writes binary glTF 2.0 (Khronos, section "GLB File Format").

Only what the scenes use: triangle meshes, embedded images, metallic-roughness
materials with a handful of Khronos extensions, and nodes with a transform.
"""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from .mesh import Array, Mesh

_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_FLOAT, _U16, _U32 = 5126, 5123, 5125


class Glb:
    """A glTF document in the making; `write` saves it."""

    def __init__(self) -> None:
        self._binary = bytearray()
        self._extensions: set[str] = set()
        self._known: dict[tuple[str, str | bytes], int] = {}
        self._lists: dict[str, list[Any]] = {
            key: []
            for key in ("accessors", "bufferViews", "images", "materials", "meshes", "nodes", "samplers", "textures")
        }
        self.triangles = 0

    def texture(self, pixels: Array, name: str, *, jpeg: bool = True, quality: int = 90) -> int:
        """Embeds an image given as display values in [0, 1], shape (h, w, 1, 3 or 4); returns its index."""
        values = np.clip(np.round(pixels * 255.0), 0, 255).astype(np.uint8)
        image = Image.fromarray(values[..., 0] if values.shape[-1] == 1 else values)
        encoded = io.BytesIO()
        if jpeg:
            image.save(encoded, "JPEG", quality=quality, subsampling=0)
        else:
            image.save(encoded, "PNG", optimize=True)
        view = self._view(encoded.getvalue())
        source = self._add(
            "images", {"bufferView": view, "mimeType": "image/jpeg" if jpeg else "image/png", "name": name}
        )
        if not self._lists["samplers"]:
            self._add("samplers", {"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497})
        return self._add("textures", {"source": source, "sampler": 0, "name": name})

    def material(
        self,
        name: str,
        color: Sequence[float] = (1.0, 1.0, 1.0),
        *,
        roughness: float = 1.0,
        metallic: float = 0.0,
        color_map: int | None = None,
        rough_map: int | None = None,
        normal_map: int | None = None,
        normal_scale: float = 1.0,
        emission: Sequence[float] | None = None,
        emission_map: int | None = None,
        alpha: str = "OPAQUE",
        double_sided: bool = False,
        **extensions: dict[str, Any],
    ) -> int:
        """Adds a material; colours are linear, `emission` is radiance, `extensions` are KHR_materials_ blocks."""
        pbr: dict[str, Any] = {
            "baseColorFactor": [*color, 1.0],
            "metallicFactor": metallic,
            "roughnessFactor": roughness,
        }
        entry: dict[str, Any] = {"name": name, "pbrMetallicRoughness": pbr, "doubleSided": double_sided}
        if color_map is not None:
            pbr["baseColorTexture"] = {"index": color_map}
        if rough_map is not None:
            pbr["metallicRoughnessTexture"] = {"index": rough_map}
        if normal_map is not None:
            entry["normalTexture"] = {"index": normal_map, "scale": normal_scale}
        if emission is not None:
            strength = max(*emission, 1.0)
            entry["emissiveFactor"] = [channel / strength for channel in emission]
            if strength > 1.0:
                extensions["emissive_strength"] = {"emissiveStrength": strength}
        if emission_map is not None:
            entry["emissiveTexture"] = {"index": emission_map}
        if alpha != "OPAQUE":
            entry["alphaMode"] = alpha
        if extensions:
            entry["extensions"] = {f"KHR_materials_{key}": value for key, value in extensions.items()}
            self._extensions.update(entry["extensions"])
        return self._add("materials", entry)

    def mesh(self, name: str, *parts: tuple[Mesh, int]) -> int:
        """Adds a mesh of (geometry, material) parts without placing it; returns its index."""
        primitives = [self._primitive(*part) for part in parts]
        return self._add("meshes", {"name": name, "primitives": primitives})

    def place(
        self,
        mesh: int,
        name: str,
        translation: Sequence[float] = (0.0, 0.0, 0.0),
        turn: float = 0.0,
        scale: float = 1.0,
    ) -> None:
        """Adds a node that shows a mesh, turned by `turn` degrees about +Y."""
        node: dict[str, Any] = {"mesh": mesh, "name": name}
        if any(translation):
            node["translation"] = [round(float(x), 5) for x in translation]
        if turn:
            half = np.radians(turn) / 2
            node["rotation"] = [0.0, round(float(np.sin(half)), 7), 0.0, round(float(np.cos(half)), 7)]
        if scale != 1.0:
            node["scale"] = [scale] * 3
        self._add("nodes", node)
        primitives = self._lists["meshes"][mesh]["primitives"]
        self.triangles += sum(self._lists["accessors"][part["indices"]]["count"] // 3 for part in primitives)

    def add(self, name: str, *parts: tuple[Mesh, int]) -> None:
        """Adds a mesh and shows it where it was modelled."""
        self.place(self.mesh(name, *parts), name)

    def write(self, path: Path) -> None:
        """Saves the document."""
        document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "Ajar example scenes", "copyright": "CC0-1.0"},
            "scene": 0,
            "scenes": [{"nodes": list(range(len(self._lists["nodes"])))}],
            "buffers": [{"byteLength": len(self._binary)}],
        }
        document |= {key: entries for key, entries in self._lists.items() if entries}
        if self._extensions:
            document["extensionsUsed"] = sorted(self._extensions)
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(self._binary)))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", len(self._binary), b"BIN\0") + self._binary)

    def _primitive(self, mesh: Mesh, material: int) -> dict[str, Any]:
        """The accessors of one part of a mesh; vertices without use for texture coordinates carry none."""
        attributes = {
            "POSITION": self._vertices(mesh.positions, "VEC3", bounds=True),
            "NORMAL": self._vertices(mesh.normals, "VEC3"),
        }
        if np.ptp(mesh.uvs, axis=0).any():
            attributes["TEXCOORD_0"] = self._vertices(mesh.uvs, "VEC2")
        if mesh.tangents is not None and "anisotropy" in str(self._lists["materials"][material]):
            attributes["TANGENT"] = self._vertices(mesh.tangents, "VEC4")
        kind, component = (np.uint16, _U16) if len(mesh.positions) < 65535 else (np.uint32, _U32)
        view = self._view(np.ascontiguousarray(mesh.triangles, dtype=kind).tobytes(), _ELEMENT_BUFFER)
        indices = self._accessor(
            {"bufferView": view, "componentType": component, "count": mesh.triangles.size, "type": "SCALAR"}
        )
        return {"attributes": attributes, "indices": indices, "material": material}

    def _vertices(self, values: Array, kind: str, bounds: bool = False) -> int:
        """Stores one vertex attribute as 32-bit floats."""
        data = np.ascontiguousarray(values, dtype=np.float32)
        view = self._view(data.tobytes(), _ARRAY_BUFFER)
        accessor: dict[str, Any] = {"bufferView": view, "componentType": _FLOAT, "count": len(data), "type": kind}
        if bounds:
            accessor |= {"min": data.min(axis=0).tolist(), "max": data.max(axis=0).tolist()}
        return self._accessor(accessor)

    def _accessor(self, entry: dict[str, Any]) -> int:
        """The accessor that says this: an existing one where there is one."""
        key = ("accessor", json.dumps(entry))
        if key not in self._known:
            self._known[key] = self._add("accessors", entry)
        return self._known[key]

    def _view(self, data: bytes, target: int | None = None) -> int:
        """Appends bytes to the buffer, aligned to four; the same bytes are stored once."""
        if (str(target), data) in self._known:
            return self._known[str(target), data]
        self._binary += b"\0" * (-len(self._binary) % 4)
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self._binary += data
        self._binary += b"\0" * (-len(self._binary) % 4)
        self._known[str(target), data] = self._add("bufferViews", view)
        return self._known[str(target), data]

    def _add(self, kind: str, entry: dict[str, Any]) -> int:
        """Appends to one of the document's lists."""
        self._lists[kind].append(entry)
        return len(self._lists[kind]) - 1
