"""What a file makes usd-core open, looked at before it does: where layers lie, and how many prims they make."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any
from urllib.parse import urlparse

from pxr import Ar, Sdf, Tf

from .report import Report, StageError, commentary

# Bytes that usd-core needs for a prim, roughly.
PRIM_SIZE = 2048
# And for text, as measured: for a byte, for a number of a list, for a line or statement.
TEXT_SIZE = 4
TEXT_SIZES = {b",": 140, b"\n": 400, b";": 400}
CHUNK = 1 << 20
DEEPEST = 400
MOST_LAYERS = 100_000


class Jail:
    """The folders below which files may be read."""

    def __init__(self, file: Path, allowed: list[Path]) -> None:
        self.folders = [folder.resolve() for folder in [file.parent, *allowed]]

    def check(self, path: str, place: str | None) -> str:
        """`path` if it may be read; of a path into a package, the package counts."""
        outer = Ar.SplitPackageRelativePathOuter(path)[0] if Ar.IsPackageRelativePath(path) else path
        if len(urlparse(outer).scheme) > 1:
            raise StageError(f"{path!r} is a URL; only files beside the scene are read", place)
        try:
            real = Path(outer).resolve()
        except (OSError, RuntimeError, ValueError) as error:
            raise StageError(f"{path!r} is no path: {error}", place) from error
        if not any(real.is_relative_to(folder) for folder in self.folders):
            hint = "move it there, or allow its folder with --allow"
            raise StageError(f"{path!r} lies outside the scene's folder", place, hint)
        return path


def check(file: Path, jail: Jail, memory_limit: int, report: Report) -> list[Any]:
    """Follows all layers from `file`, an absolute path, those of variants and payloads too, and returns them.

    Raises a failure where one lies outside the jail, is a package that cannot be trusted, or where references multiply
    beyond memory.
    """
    try:
        size = file.stat().st_size
    except OSError as error:
        raise StageError(f"cannot be read: {error.strerror}") from error
    if size > memory_limit:
        raise StageError(f"{size} bytes are more than the memory limit", cause="resource")
    visited = Visited(jail, memory_limit, report)
    visited.layer(str(file), None)
    visited.count()
    return [layer for layer in visited.layers.values() if layer]


class Visited:
    """The layers found."""

    def __init__(self, jail: Jail, memory_limit: int, report: Report) -> None:
        self.jail, self.memory_limit, self.report = jail, memory_limit, report
        self.most = memory_limit // PRIM_SIZE
        self.layers: dict[str, Any] = {}
        self.counts: dict[tuple[str, str], int] = {}

    def layer(self, path: str, place: str | None) -> None:
        """Opens the layer at `path` and all that it names."""
        todo = [(path, place)]
        while todo:
            path, place = todo.pop()
            if path in self.layers:
                continue
            if len(self.layers) > MOST_LAYERS:
                raise StageError(f"more than {MOST_LAYERS} layers", place, cause="resource")
            self.layers[path] = layer = self.open(self.jail.check(path, place), place)
            if layer:
                todo += [(located(layer, asset, place), place) for asset, place in self.arcs(layer) if asset]

    def open(self, path: str, place: str | None) -> Any:
        """The layer, or None where there is none: usd-core says so when it composes."""
        self.report.file(Ar.SplitPackageRelativePathOuter(path)[0])
        if not Path(Ar.SplitPackageRelativePathOuter(path)[0]).is_file() or path.lower().endswith(".mtlx"):
            return None
        if path.lower().endswith(".usdz"):
            check_package(Path(path), self.memory_limit, place)
        elif not Ar.IsPackageRelativePath(path):
            try:
                with Path(path).open("rb") as file:
                    check_text(file, self.memory_limit, place)
            except OSError as error:
                raise StageError(f"{path!r} cannot be read: {error.strerror}", place) from error
        try:
            return Sdf.Layer.FindOrOpen(path)
        except Tf.ErrorException as error:
            if place is None:
                raise StageError(f"is no USD that can be read: {commentary(error)}") from error
            return None

    def arcs(self, layer: Any) -> Iterator[tuple[str, str | None]]:
        """Every path that composition may open because of `layer`, with the prim that says so."""
        found: list[tuple[str, str | None]] = [(asset, None) for asset in layer.subLayerPaths]
        prims = 0
        too_deep = None

        # What it raises would be lost.
        def visit(path: Any) -> None:
            nonlocal prims, too_deep
            if path.pathElementCount > 2 * DEEPEST:
                # More than variants account for. Texts of all these paths would not fit into memory: one prim tells.
                too_deep = too_deep or str(path.GetPrefixes()[0])
            elif path.IsPrimPath() or path.IsPrimVariantSelectionPath():
                prims += 1
                if prims <= self.most:
                    spec, place = spec_at(layer, path), str(path)
                    files = clip_files(spec.GetInfo("clips") if spec.HasInfo("clips") else {})
                    found.extend((asset, place) for asset in [*(asset for asset, _ in targets(spec)), *files])

        layer.Traverse(Sdf.Path.absoluteRootPath, visit)
        if too_deep:
            raise StageError(f"prims are nested more than {DEEPEST} deep", too_deep)
        if prims > self.most:
            raise StageError(f"a layer has {prims} prims, the limit on memory allows {self.most}", cause="resource")
        yield from found

    def count(self) -> None:
        """Prims that composition makes at most, references counted as often as they are met."""
        for path, layer in self.layers.items():
            if layer:
                self.below(path, Sdf.Path.absoluteRootPath, 0)

    def below(self, path: str, prim: Any, depth: int) -> int:
        """Prims of the subtree at `prim` in the layer at `path`."""
        layer = self.layers.get(path)
        spec = spec_at(layer, prim)
        if not spec:
            return 0
        key = (path, str(prim))
        if key not in self.counts:
            if depth > DEEPEST:
                raise StageError(f"prims and references are nested more than {DEEPEST} deep", str(prim))
            # A cycle adds nothing; usd-core reports it.
            self.counts[key] = 0
            total = 1 + sum(self.below(path, child.path, depth + 1) for child in children(spec))
            for asset, target in targets(spec):
                other = located(layer, asset, None) if asset else path
                total += self.below(other, target or self.default(other), depth + 1)
            if total > self.most:
                raise StageError(f"references make {total} prims, the limit on memory allows {self.most}", str(prim))
            self.counts[key] = total
        return self.counts[key]

    def default(self, path: str) -> Any:
        """The prim that a reference without one means."""
        layer = self.layers.get(path)
        name = layer.defaultPrim if layer else ""
        return Sdf.Path.absoluteRootPath.AppendPath(name) if name else Sdf.Path("/_")


def spec_at(layer: Any, path: Any) -> Any:
    """What a layer says about a prim, or about one in a variant."""
    found = layer.GetObjectAtPath(path) if layer else None
    return found.primSpec if isinstance(found, Sdf.VariantSpec) else found


def located(layer: Any, asset: str, place: str | None) -> str:
    """Where `asset` lies, seen from `layer`."""
    if asset.startswith("`"):
        raise StageError(f"{asset!r} is computed; such paths are not read", place)
    asset = Sdf.Layer.SplitIdentifier(asset)[0]
    path = str(Sdf.ComputeAssetPathRelativeToLayer(layer, asset))
    if Path(path).is_absolute() or len(urlparse(path).scheme) > 1 or not layer.realPath:
        return path
    # What is not found beside its layer keeps its relative path.
    return str(Path(layer.realPath).parent / path)


def clip_files(clips: Any) -> Iterator[str]:
    """Files that value clips name. Of a template, its folder tells."""
    if isinstance(clips, Sdf.AssetPath):
        yield clips.path
    elif isinstance(clips, dict):
        for key, value in clips.items():
            if key == "templateAssetPath":
                yield str(value)
            yield from clip_files(value)
    elif isinstance(clips, (list, tuple, Sdf.AssetPathArray)):
        for value in clips:
            yield from clip_files(value)


def targets(spec: Any) -> list[tuple[str, Any]]:
    """References, payloads and, within the layer, inherited and specialized prims of a prim: file and prim."""
    found = []
    for key in ("references", "payload"):
        found += [(item.assetPath, item.primPath) for item in listed(spec, key)]
    for key in ("inheritPaths", "specializes"):
        found += [("", path) for path in listed(spec, key)]
    return found


def listed(spec: Any, key: str) -> list[Any]:
    """What an edited list can bring. The lists that a spec has as properties take a hundred times as long."""
    if not spec.HasInfo(key):
        return []
    items = spec.GetInfo(key)
    return [*items.explicitItems, *items.prependedItems, *items.appendedItems, *items.addedItems]


def children(spec: Any) -> list[Any]:
    """Prims below a prim, those of its variants too."""
    found = list(spec.nameChildren) if spec.HasInfo("primChildren") else []
    if spec.HasInfo("variantSetChildren"):
        for variants in spec.variantSets.values():
            found += [variant.primSpec for variant in variants.variantList]
    return found


def check_text(file: IO[bytes], memory_limit: int, place: str | None) -> None:
    """Text must not take more memory than there is; other files are as large as what is in them."""
    needed = 0
    while chunk := file.read(CHUNK):
        if not needed and chunk.startswith(b"PXR-USDC"):
            return
        needed += sum(chunk.count(mark) * size for mark, size in TEXT_SIZES.items()) + TEXT_SIZE * len(chunk)
        if needed > memory_limit:
            raise StageError("its text takes more memory than the limit allows", place, cause="resource")


def check_package(path: Path, memory_limit: int, place: str | None) -> None:
    """A .usdz holds files as they are, below itself."""
    try:
        with zipfile.ZipFile(path) as package:
            for entry in package.infolist():
                check_entry(entry, place)
                if entry.filename.lower().endswith((".usd", ".usda")):
                    with package.open(entry) as file:
                        check_text(file, memory_limit, place)
    except (zipfile.BadZipFile, OSError, NotImplementedError, ValueError, EOFError) as error:
        raise StageError(f"is no package that can be read: {str(error) or 'it ends early'}", place) from error


def check_entry(entry: zipfile.ZipInfo, place: str | None) -> None:
    """A file of a package."""
    parts = entry.filename.replace("\\", "/").split("/")
    if entry.filename.startswith(("/", "\\")) or ".." in parts or ":" in parts[0]:
        raise StageError(f"the package holds {entry.filename!r}, which leaves it", place)
    if entry.compress_type != zipfile.ZIP_STORED or entry.flag_bits & 1:
        raise StageError(
            f"the package holds {entry.filename!r} compressed or encrypted; USD wants files as they are", place
        )
