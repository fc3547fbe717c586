"""Power: the smallest change of energy that is found."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from ajar_tools import Picture, Settings, read
from mutants import synthetic
from renders import REFERENCE, Render, make
from rules import differ
from synthetic import File, brighter

ROUNDS = (16, 64, 256)
RENDERS = (("cornell", "path"),)
# Of the trials, those that must find the change.
FOUND = 0.95
# Factors of energy that are tried, beyond 1, and how many halvings of their ratio.
LEAST, MOST, STEPS = 0.0002, 0.5, 9


def section(home: Path, trials: int) -> str:
    """The table."""
    seeds = [REFERENCE, *range(1, trials + 1)]
    make(Render(*kind, seed, rounds) for kind in RENDERS for rounds in ROUNDS for seed in seeds)
    kinds: dict[str, Callable[[int, int], File]] = {"synthetic": lambda seed, rounds: synthetic(seed, rounds=rounds)}
    for scene, integrator in RENDERS:
        name = f"`{scene}` by `{integrator}`"
        kinds[name] = lambda seed, rounds, kind=(scene, integrator): Render(*kind, seed, rounds).file()
    lines = [
        "\n## Smallest change of energy that is found\n",
        f"By rounds of both images: the change of the whole image's energy that {FOUND:.0%} of {trials} trials find.\n",
        "| | " + " | ".join(map(str, ROUNDS)) + " |",
        "|---|" + "---|" * len(ROUNDS),
    ]
    for name, image in kinds.items():
        found = [smallest(home, image, rounds, seeds) for rounds in ROUNDS]
        lines.append(f"| {name} | " + " | ".join(f"{100 * change:.2g} %" for change in found) + " |")
        print(lines[-1], flush=True)
    return "\n".join(lines) + "\n"


def smallest(home: Path, image: Callable[[int, int], File], rounds: int, seeds: list[int]) -> float:
    """The change that most seeds find."""
    right = read(image(seeds[0], rounds).write(home / "reference.exr"))
    changes = sorted(threshold(image(seed, rounds), home / "new.exr", right) for seed in seeds[1:])
    return changes[math.ceil(FOUND * len(changes)) - 1]


def threshold(image: File, new: Path, right: Picture) -> float:
    """The change from which on it is found in one image."""
    unchanged = read(image.write(new))
    return least_change(lambda change: differ(brighter(unchanged, 1 + change), right, Settings()))


def least_change(found: Callable[[float], bool]) -> float:
    """The change from which on it is found, by halving the interval."""
    low, high = LEAST, MOST
    for _ in range(STEPS):
        change = math.sqrt(low * high)
        if found(change):
            high = change
        else:
            low = change
    return high
