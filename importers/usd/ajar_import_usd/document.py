"""The Ajar scene that is printed: lists of items and one binary chunk (docs/ajar-scene.md)."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any, BinaryIO

import numpy as np

from .blocks import blocks
from .report import StageError

# Bytes that a node takes, roughly, here and in its reader.
NODE_SIZE = 1024

Piece = bytes | memoryview
"""Bytes of the binary chunk."""

Matrix = np.ndarray
"""4 × 4, for row vectors as in USD: its rows are the images of X, Y, Z and the origin."""


@dataclass
class Node:
    """A node in the making. Trees share subtrees: each instance of a prototype is one more parent."""

    name: str
    transform: Matrix | None = None
    meshes: list[int] = field(default_factory=list)
    light: int | None = None
    camera: int | None = None
    children: list[Node] = field(default_factory=list)

    @property
    def is_empty(self) -> bool:
        """Whether it holds nothing that is seen or sees."""
        return not (self.meshes or self.children) and self.light is None and self.camera is None


class Document:
    """Collects items; each list gives out indices from 0."""

    def __init__(self, memory_limit: int) -> None:
        self.memory_limit = memory_limit
        self.lists: dict[str, list[dict[str, Any]]] = {}
        self.render: dict[str, Any] = {}
        self.variants: list[dict[str, Any]] = []
        # Arrays, each in pieces.
        self.chunk: list[Iterable[Piece]] = []
        self.size = 0

    def add(self, kind: str, item: dict[str, Any]) -> int:
        """Appends `item` to the list `kind` and returns its index."""
        items = self.lists.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def item(self, kind: str, index: int) -> dict[str, Any]:
        """What `add` was given."""
        return self.lists[kind][index]

    def array(self, values: np.ndarray | Sequence[Any], width: int = 1, dtype: str = "<f4") -> dict[str, int]:
        """Puts items of `width` numbers into the binary chunk."""
        data = np.ascontiguousarray(np.asarray(values, dtype=dtype).reshape(-1))
        return self.bytes(data.view(np.uint8).data, len(data) // width)

    def indices(self, values: np.ndarray | Sequence[Any], width: int = 1) -> dict[str, int]:
        """Puts integers that are not negative into the binary chunk."""
        values = np.asarray(values)
        # Signed ones of the same size have the same bits.
        return self.array(values.view(np.uint32) if values.dtype == np.int32 else values, width, "<u4")

    def coordinates(self, values: np.ndarray) -> dict[str, int]:
        """Puts texture coordinates into the binary chunk, with the origin moved from the bottom to the top left."""

        def moved() -> Iterator[memoryview]:
            for block in blocks(np.asarray(values, dtype="<f4")):
                block = block.copy()
                np.subtract(1, block[:, 1], out=block[:, 1])
                yield block.reshape(-1).view(np.uint8).data

        return self.pieces(moved(), len(values) * 8, len(values))

    def bytes(self, data: Piece, count: int | None = None) -> dict[str, int]:
        """Puts bytes into the binary chunk."""
        return self.pieces([data], len(data), len(data) if count is None else count)

    def pieces(self, pieces: Iterable[Piece], size: int, count: int) -> dict[str, int]:
        """Puts an array of `count` items into the binary chunk, in pieces that have `size` bytes together."""
        offset = self.size
        self.chunk += [pieces, [bytes(-size % 4)]]
        self.size += size + -size % 4
        self.check(self.size)
        return {"offset": offset, "count": count}

    def check(self, size: int) -> None:
        """Stops where the limit on memory is met."""
        if size > self.memory_limit:
            raise StageError(f"more than the limit of {self.memory_limit} bytes is needed", cause="resource")

    def place(self, root: Node) -> None:
        """Makes the tree below `root` nodes of the scene; shared subtrees become nodes of each parent."""
        most = self.memory_limit // NODE_SIZE
        if count(root) > most:
            raise StageError(f"instances make {count(root)} nodes, the limit on memory allows {most}", cause="resource")
        self.lists.setdefault("roots", []).append(self.emit(root))  # type: ignore[arg-type]

    def emit(self, node: Node) -> int:
        """Adds a node and all below it."""
        item: dict[str, Any] = {"name": node.name}
        index = self.add("nodes", item)
        if node.transform is not None:
            item["transform"] = [float(x) for x in node.transform[:4, :3].reshape(-1)]
        if node.meshes:
            item["meshes"] = node.meshes
        if node.light is not None:
            item["light"] = node.light
        if node.camera is not None:
            item["camera"] = node.camera
        if node.children:
            item["children"] = [self.emit(child) for child in node.children]
        return index

    def write(self, stream: BinaryIO) -> None:
        """Prints the container."""
        top = {"ajar": 1, **self.lists}
        if self.render:
            top["render"] = self.render
        if self.variants:
            top["variants"] = self.variants
        text = json.dumps(top, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        stream.write(struct.pack("<4sII", b"AJAR", 1, 28 + len(text) + self.size))
        stream.write(struct.pack("<I4s", len(text), b"JSON") + text)
        stream.write(struct.pack("<I4s", self.size, b"BIN\0"))
        stream.writelines(chain.from_iterable(self.chunk))


def count(root: Node) -> int:
    """Nodes that the tree becomes, without walking shared subtrees twice."""
    known: dict[int, int] = {}

    def below(node: Node) -> int:
        if id(node) not in known:
            known[id(node)] = 1 + sum(below(child) for child in node.children)
        return known[id(node)]

    return below(root)
