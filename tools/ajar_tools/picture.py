"""Reading OpenEXR files, suspiciously.

Whatever is not one complete flat OpenEXR image of sane size is refused with one sentence; nothing is ever resampled,
clipped or filled in.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio

from ajar_tools.statistics import BlockStatistics, read_statistics

# Samples (pixels × channels) that are read at most: 1.6 GB of floats.
MOST_SAMPLES = 400_000_000
# From this many on the memory that is there is asked for first.
LARGE = 100_000_000
# Bytes that a comparison holds for each sample of each image: as a float, and what gates make of it.
BYTES = 16
MAGIC = b"\x76\x2f\x31\x01"
# Channels that a person sees, the first of these that a file has.
COLORS = (["R", "G", "B"], ["Y"])


class CannotCompareError(Exception):
    """There is nothing to compare: the message is a sentence that says why."""


@dataclass(frozen=True)
class Window:
    """A rectangle of pixels: left, top, width, height."""

    x: int
    y: int
    width: int
    height: int

    def __str__(self) -> str:
        return f"{self.width}×{self.height} at ({self.x}, {self.y})"


@dataclass
class Picture:
    """An image with all its channels as floats."""

    path: Path
    pixels: np.ndarray
    """rows × columns × channels, float32."""
    channels: list[str]
    types: dict[str, str]
    """OpenImageIO's name of every channel's type in the file: half, float, uint."""
    data_window: Window
    display_window: Window
    attributes: dict[str, Any] = field(default_factory=dict)
    integers: dict[str, np.ndarray] = field(default_factory=dict)
    """Channels of whole numbers as they are: those above 2²⁴ are not all floats."""

    def plane(self, channel: str) -> np.ndarray:
        """One channel, rows × columns."""
        if channel in self.integers:
            return self.integers[channel]
        return self.pixels[..., self.channels.index(channel)]

    @functools.cached_property
    def color(self) -> np.ndarray:
        """R, G and B, or Y."""
        indices = [self.channels.index(name) for name in self.color_channels]
        return np.take(self.pixels, indices, axis=2)

    def has(self, names: list[str]) -> bool:
        """Whether all of these channels are there."""
        return set(names) <= set(self.channels)

    @property
    def color_channels(self) -> list[str]:
        """The channels that a person sees: R, G, B, or Y.

        Raises:
            CannotCompareError: there are none.
        """
        for names in filter(self.has, COLORS):
            return names
        have = ", ".join(self.channels[:8])
        raise CannotCompareError(f"{self.path} has neither the channels R, G and B nor Y, but {have}")

    @property
    def statistics(self) -> BlockStatistics | None:
        """What the file says about the noise of R, G and B; `None` where it says nothing."""
        if not self.has(COLORS[0]):
            return None
        return read_statistics(self.attributes, (self.data_window.width, self.data_window.height))

    def rounding(self) -> float:
        """Relative rounding error of stored colours: half of the last bit."""
        return 2.0**-12 if any(self.types[c] == "half" for c in self.color_channels) else 2.0**-25


def read(path: str | Path, most_samples: int = MOST_SAMPLES) -> Picture:
    """Reads a flat single-part OpenEXR file.

    Raises:
        CannotCompareError: it is something else, damaged, or larger than `most_samples`.
    """
    path = Path(path)
    check_file(path)
    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise CannotCompareError(f"{path} cannot be read: {complaint(oiio)}")
    try:
        spec = source.spec()
        check_spec(path, source, spec, most_samples)
        pixels = source.read_image(0, 0, 0, spec.nchannels, oiio.FLOAT)
        whole = [i for i, name in enumerate(spec.channelnames) if is_whole(spec, i)]
        integers = {spec.channelnames[i]: source.read_image(0, 0, i, i + 1, oiio.UINT32) for i in whole}
        if pixels is None or source.has_error or any(plane is None for plane in integers.values()):
            raise CannotCompareError(f"{path} is damaged: {complaint(source)}")
    finally:
        source.close()
    return Picture(
        path=path,
        pixels=np.asarray(pixels, np.float32).reshape(spec.height, spec.width, spec.nchannels),
        channels=list(spec.channelnames),
        types={name: str(spec.channelformat(i)) for i, name in enumerate(spec.channelnames)},
        data_window=Window(spec.x, spec.y, spec.width, spec.height),
        display_window=Window(spec.full_x, spec.full_y, spec.full_width, spec.full_height),
        attributes={item.name: item.value for item in spec.extra_attribs},
        integers={name: np.asarray(plane).reshape(spec.height, spec.width) for name, plane in integers.items()},
    )


def is_whole(spec: oiio.ImageSpec, channel: int) -> bool:
    """Whether a channel holds whole numbers."""
    return str(spec.channelformat(channel)).startswith("uint")


def check_file(path: Path) -> None:
    """Refuses what is no OpenEXR file before any library looks at it."""
    try:
        str(path).encode("utf-8")
    except UnicodeEncodeError as error:
        name = str(path).encode("utf-8", "backslashreplace").decode("utf-8")
        raise CannotCompareError(f"{name} has a name that is not UTF-8, which OpenImageIO cannot open") from error
    if not path.exists():
        raise CannotCompareError(f"{path} does not exist")
    if not path.is_file():
        raise CannotCompareError(f"{path} is not a file")
    try:
        with path.open("rb") as file:
            start = file.read(len(MAGIC))
    except OSError as error:
        raise CannotCompareError(f"{path} cannot be read: {error.strerror}") from error
    if not start:
        raise CannotCompareError(f"{path} is empty")
    if start != MAGIC:
        raise CannotCompareError(f"{path} is not an OpenEXR file")


def check_spec(path: Path, source: oiio.ImageInput, spec: oiio.ImageSpec, most_samples: int) -> None:
    """Refuses what the header promises but nobody can compare."""
    if spec.deep:
        raise CannotCompareError(f"{path} is a deep image; only flat images can be compared")
    if int(spec.getattribute("oiio:subimages") or 1) > 1 or source.seek_subimage(1, 0):
        raise CannotCompareError(f"{path} has several parts; only single-part images can be compared")
    source.seek_subimage(0, 0)
    integers = [name for i, name in enumerate(spec.channelnames) if is_whole(spec, i)]
    if colors := [name for name in ("R", "G", "B", "Y") if name in integers]:
        raise CannotCompareError(f"{path} has whole numbers in channel {colors[0]}, where light is a half or a float")
    if spec.depth > 1:
        raise CannotCompareError(f"{path} is a volume; only flat images can be compared")
    samples = spec.width * spec.height * spec.nchannels
    if samples > most_samples:
        size = f"{spec.width}×{spec.height} with {spec.nchannels} channels"
        raise CannotCompareError(f"{path} is too large to compare: {size} are more than {most_samples:,} samples")
    needed, there = 2 * samples * BYTES, available_memory()
    if samples > LARGE and needed > there:
        raise CannotCompareError(
            f"{path} is too large to compare here: {samples:,} samples need {needed / 1e9:.1f} GB of memory, "
            f"of which {there / 1e9:.1f} GB are there"
        )


def available_memory() -> float:
    """Bytes that can be had without swapping; infinite where the system does not tell."""
    try:
        lines = Path("/proc/meminfo").read_text("ascii").splitlines()
        return 1024.0 * next(int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration):
        return math.inf


def complaint(source: Any) -> str:
    """What OpenImageIO has to say, without line breaks and final full stop."""
    try:
        message = source.geterror()
    except UnicodeDecodeError:  # It quotes damaged names.
        message = "its header is damaged"
    return " ".join(message.split()).rstrip(".") or "no reason given"
