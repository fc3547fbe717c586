"""Gate 1: both files hold the same kind of image."""

from __future__ import annotations

import math
from typing import Any

from ajar_tools.picture import CannotCompareError, Picture
from ajar_tools.settings import Settings
from ajar_tools.verdict import GateResult, Status

# Colours of other primaries or another encoding are other colours, whatever the numbers say.
COLOR_SPACE = ("chromaticities", "colorInteropID")
# Chromaticities that differ by no more than this are those of one standard, written to other places.
CHROMATICITY = 1e-4
# Optional planes: asking for a variance layer does not change the picture.
OPTIONAL = ("variance.",)


def check(new: Picture, reference: Picture, settings: Settings) -> GateResult:
    """Compares windows, channel names and types, and metadata.

    Raises:
        CannotCompareError: data windows differ: no pixel has a counterpart, and nothing is ever resampled.
    """
    check_windows(new, reference, settings)
    problems = list(colour_problems(new, reference) if settings.other_renderer else channel_problems(new, reference))
    problems += metadata_problems(new, reference, settings)
    if problems:
        strangers = not settings.other_renderer and made_by_ajar(new) != made_by_ajar(reference)
        hint = " (images of two renderers? --other-renderer compares their colours)" if strangers else ""
        return GateResult("structure", Status.FAIL, "; ".join(problems) + hint)
    names = ", ".join(new.color_channels)
    return GateResult("structure", Status.PASS, f"{new.data_window}, {names} and all else as in the reference")


def made_by_ajar(picture: Picture) -> bool:
    """Whether a file says so."""
    return "ajar:integrator" in picture.attributes


def check_windows(new: Picture, reference: Picture, settings: Settings) -> None:
    """Refuses images whose pixels do not correspond."""
    a, b = new.data_window, reference.data_window
    if (a.width, a.height) != (b.width, b.height):
        sizes = f"{a.width}×{a.height} and {b.width}×{b.height} pixels"
        raise CannotCompareError(f"{new.path} and {reference.path} have {sizes}, and images are never resampled")
    if a != b:
        raise CannotCompareError(f"the data windows differ: {a} in {new.path}, {b} in {reference.path}")
    if settings.other_renderer:
        return
    a, b = new.display_window, reference.display_window
    if a != b:
        raise CannotCompareError(f"the display windows differ: {a} in {new.path}, {b} in {reference.path}")


def colour_problems(new: Picture, reference: Picture) -> list[str]:
    """Across renderers only colours are compared."""
    if new.color_channels == reference.color_channels:
        return []
    return [f"{new.color_channels} cannot be compared with {reference.color_channels}"]


def channel_problems(new: Picture, reference: Picture) -> list[str]:
    """Channels that are missing, new, or of another type."""
    ours = {name: kind for name, kind in new.types.items() if not name.startswith(OPTIONAL)}
    theirs = {name: kind for name, kind in reference.types.items() if not name.startswith(OPTIONAL)}
    problems = []
    if missing := sorted(theirs.keys() - ours.keys()):
        problems.append(f"channels are missing: {', '.join(missing)}")
    if added := sorted(ours.keys() - theirs.keys()):
        problems.append(f"channels are new: {', '.join(added)}")
    changed = [name for name in sorted(ours.keys() & theirs.keys()) if ours[name] != theirs[name]]
    problems += [f"channel {name} is {ours[name]} instead of {theirs[name]}" for name in changed]
    return problems


def agree(name: str, a: Any, b: Any) -> bool:
    """Whether two values of an attribute are the same; chromaticities but for rounding, or to how many places they are
    known.
    """
    if name == "chromaticities" and isinstance(a, tuple) and isinstance(b, tuple) and len(a) == len(b):
        return all(math.isclose(x, y, rel_tol=0, abs_tol=CHROMATICITY) for x, y in zip(a, b, strict=True))
    return bool(a == b)


def metadata_problems(new: Picture, reference: Picture, settings: Settings) -> list[str]:
    """Attributes that must agree, and renders that were interrupted."""
    problems = []
    for picture in (new, reference):
        if picture.attributes.get("ajar:complete") == 0:
            problems.append(f"{picture.path} is an interrupted render (ajar:complete is 0)")
    # Without it statistics cannot judge, and what is left finds less.
    if reference.statistics is not None and new.statistics is None and not settings.other_renderer:
        problems.append(f"{new.path} does not declare its noise, as the reference does (ajar:blockVariance8 and so on)")
    for name in (*COLOR_SPACE, *settings.require):
        a, b = new.attributes.get(name), reference.attributes.get(name)
        if name in settings.require and (a is None or b is None):
            problems.append(f"the attribute {name} is missing")
        elif a is not None and b is not None and not agree(name, a, b):
            problems.append(f"the attribute {name} is {a!r} instead of {b!r}")
    return problems
