"""`python -m ajar_tools average PASS… -o OUT`: independent renders of any renderer become one that knows its noise.

Renders of one scene with different seeds are rounds (docs/image-statistics.md). Their mean, stored with the spread of
its blocks, can be compared by statistics.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from ajar_tools.gates.structure import COLOR_SPACE
from ajar_tools.picture import CannotCompareError, Picture, read
from ajar_tools.statistics import BlockStatistics, as_attributes, from_rounds

# Fewer do not tell their spread.
FEWEST = 2
# R, G and B (docs/image-statistics.md).
CHANNELS = 3


def parser() -> argparse.ArgumentParser:
    """The command line."""
    p = argparse.ArgumentParser(prog="python -m ajar_tools average", description="Average independent renders.")
    p.add_argument("passes", nargs="+", metavar="PASS", help="OpenEXR images of one scene, each with another seed")
    p.add_argument("-o", "--output", type=Path, required=True, metavar="OUT", help="the image to write")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns the exit code, 2 where nothing was written."""
    options = parser().parse_args(arguments)
    try:
        average(options.passes, options.output)
    except CannotCompareError as error:
        print(f"CANNOT AVERAGE: {error}", file=sys.stderr)
        return 2
    print(f"wrote {options.output}, the mean of {len(options.passes)} rounds")
    return 0


def average(passes: Sequence[str | Path], output: Path) -> None:
    """Writes the mean of the colours of several images, with statistics.

    Raises:
        CannotCompareError: there are too few, they cannot be read or differ in size, two are equal, or OUT cannot be
            written.
    """
    if len(passes) < FEWEST:
        raise CannotCompareError("a single render does not tell its noise")
    first = read(passes[0])
    if len(first.color_channels) != CHANNELS:
        raise CannotCompareError(f"{first.path} has no R, G and B, whose noise is what statistics are of")
    rounds = [first.color]
    for path in passes[1:]:
        picture = read(path)
        if (picture.data_window, picture.color_channels) != (first.data_window, first.color_channels):
            raise CannotCompareError(f"{path} and {first.path} have different windows or colours")
        if any(np.array_equal(picture.color, other) for other in rounds):
            raise CannotCompareError(f"{path} is equal to another pass: give each pass a seed of its own")
        rounds.append(picture.color)
    stack = np.stack(rounds)
    write(first, stack.mean(axis=0, dtype=np.float64), from_rounds(stack), output)


def write(like: Picture, color: np.ndarray, statistics: BlockStatistics, output: Path) -> None:
    """Writes full floats, with the windows of `like`."""
    data, display = like.data_window, like.display_window
    spec = oiio.ImageSpec(data.width, data.height, color.shape[2], oiio.FLOAT)
    spec.channelnames = tuple(like.color_channels)
    spec.x, spec.y = data.x, data.y
    spec.full_x, spec.full_y, spec.full_width, spec.full_height = display.x, display.y, display.width, display.height
    # Elsewhere they would be other colours.
    for name in (name for name in COLOR_SPACE if name in like.attributes):
        value = like.attributes[name]
        kind = oiio.TypeDesc(f"float[{len(value)}]") if isinstance(value, tuple) else oiio.TypeDesc("string")
        spec.attribute(name, kind, value)
    spec.attribute("ajar:rounds", statistics.rounds)
    for name, values in as_attributes(statistics).items():
        spec.attribute(name, oiio.TypeDesc(f"float[{values.size}]"), values)
    image = oiio.ImageBuf(spec)
    image.set_pixels(spec.roi, np.ascontiguousarray(color, np.float32))
    if not image.write(str(output)):
        raise CannotCompareError(f"{output} cannot be written: {image.geterror()}")
