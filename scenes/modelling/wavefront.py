"""Writes Wavefront OBJ with MTL, the PBR extension included."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .mesh import Array, Mesh


@dataclass
class Wavefront:
    """A model in the making; `write` saves `name.obj` and `name.mtl`."""

    lines: list[str] = field(default_factory=list)
    materials: list[str] = field(default_factory=list)
    counts: tuple[int, int, int] = (0, 0, 0)
    triangles: int = 0

    def material(self, name: str, **statements: object) -> str:
        """A material of MTL statements, `Kd=(1, 0, 0)`, `map_Kd="wood.jpg"`; returns its name."""
        self.materials.append(f"newmtl {name}")
        for key, value in statements.items():
            words = value if isinstance(value, tuple) else (value,)
            self.materials.append(" ".join([key, *map(str, words)]))
        self.materials.append("")
        return name

    def add(self, name: str, *parts: tuple[Mesh, str]) -> None:
        """An object of (geometry, material) parts; equal positions, normals and coordinates are written once."""
        self.lines.append(f"o {name}")
        for mesh, material in parts:
            uvs = np.column_stack([mesh.uvs[:, 0], 1 - mesh.uvs[:, 1]])
            columns = [
                self._values("v", mesh.positions, 5),
                self._values("vt", uvs, 4),
                self._values("vn", mesh.normals, 4),
            ]
            self.lines.append(f"usemtl {material}")
            for corners in mesh.triangles:
                self.lines.append("f " + " ".join("/".join(str(column[i]) for column in columns) for i in corners))
            self.triangles += len(mesh.triangles)

    def _values(self, statement: str, values: Array, digits: int) -> Array:
        """Writes distinct rows and returns the number of each."""
        rows, indices = np.unique(np.round(values, digits) + 0.0, axis=0, return_inverse=True)
        self.lines += [f"{statement} {' '.join(f'{x:.{digits}g}' for x in row)}" for row in rows]
        kind = ("v", "vt", "vn").index(statement)
        first = self.counts[kind] + 1
        self.counts = tuple(c + len(rows) * (k == kind) for k, c in enumerate(self.counts))  # type: ignore[assignment]
        return indices.reshape(-1) + first

    def write(self, path: Path) -> None:
        """Saves the model beside its material library."""
        path.parent.mkdir(parents=True, exist_ok=True)
        library = path.with_suffix(".mtl")
        head = ["# Ajar example scenes, CC0-1.0", f"mtllib {library.name}"]
        path.write_text("\n".join([*head, *self.lines]) + "\n", "utf-8")
        library.write_text("\n".join([head[0], "", *self.materials]), "utf-8")
