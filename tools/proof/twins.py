"""Twins: other seeds of the same scene, which must pass."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

from ajar_tools import Picture, Settings, read
from renders import LONGER, REFERENCE, ROUNDS, Render, make
from rules import differ, is_too_noisy

SCENES = ("cornell", "caustic-glass", "door-ajar")
INTEGRATORS = ("path", "bdpt", "mlt", "ajar")
# The default, and one that is bold enough for alarms to be counted.
ALPHAS = (0.001, 0.05)
# Probability that chance alone exceeds what is allowed to it.
BAD_LUCK = 0.001


def twins(scene: str, integrator: str, count: int) -> list[Render]:
    """Renders that differ by their seeds."""
    return [Render(scene, integrator, seed) for seed in range(1, count + 1)]


def reference(scene: str, integrator: str) -> Render:
    """What they are compared with."""
    return Render(scene, integrator, REFERENCE, ROUNDS * LONGER)


CELLS = [(scene, integrator) for scene in SCENES for integrator in INTEGRATORS]


def render(count: int) -> None:
    """Renders all of them, and what they are compared with."""
    make(render for cell in CELLS for render in [*twins(*cell, count), reference(*cell)])


def section(count: int) -> tuple[str, list[str]]:
    """The table, and what is wrong in it."""
    pairs = count * (count - 1) // 2
    lines = [
        "\n## Twins that must pass\n",
        f"{count} renders with other seeds, each against one of {LONGER} times as many rounds, and each against",
        f"each other ({pairs} pairs): false alarms at the default α of 0.001 and at one of 0.05. The last column",
        "has the renders that are *too noisy* for the reference: twice the light would not be seen. `ajar diff` says",
        "so and lets FLIP judge, which finds most of them different: such images want more samples.",
        "Pairs are not independent: one image that is unlike the others alarms in many of them.\n",
        "| scene | integrator | α 0.001: reference | pairs | α 0.05: reference | pairs | too noisy |",
        "|---|---|---|---|---|---|---|",
    ]
    sums = [0] * 4
    for scene, integrator in CELLS:
        images = [read(render.path) for render in twins(scene, integrator, count)]
        longer = read(reference(scene, integrator).path)
        counts = list(alarms(images, longer))
        sums = [a + b for a, b in zip(sums, counts)]
        noisy = sum(is_too_noisy(image, longer) for image in images)
        lines.append(f"| `{scene}` | `{integrator}` | " + " | ".join(map(str, [*counts, noisy])) + " |")
        print(lines[-1], flush=True)
    total = [f"**{n}** of {len(CELLS) * (pairs if i % 2 else count)}" for i, n in enumerate(sums)]
    allowed = [most(len(CELLS), count, alpha, in_pairs) for alpha in ALPHAS for in_pairs in (False, True)]
    lines.append("| all | | " + " | ".join(total) + " | |")
    lines.append("| *exceeded by chance once in 1000 runs* | | " + " | ".join(map(str, allowed)) + " | |")
    return "\n".join(lines) + "\n", excess(sums, allowed)


def excess(alarms: list[int], allowed: list[int]) -> list[str]:
    """Sums of false alarms that chance does not explain, in words."""
    return [f"{n} false alarms, chance explains {k}" for n, k in zip(alarms, allowed, strict=True) if n > k]


def most(cells: int, count: int, alpha: float, in_pairs: bool) -> int:
    """The false alarms that chance exceeds with the probability `BAD_LUCK`.

    Of the pairs of a cell only half as many as it has images are independent; the others are counted as their copies.
    """
    trials = cells * (count // 2 if in_pairs else count)
    return quantile(trials, alpha) * (count - 1 if in_pairs else 1)


def quantile(trials: int, alpha: float) -> int:
    """The successes that a binomial distribution exceeds with at most the probability `BAD_LUCK`."""
    beyond, successes = 1.0, -1
    while beyond > BAD_LUCK:
        successes += 1
        beyond -= math.comb(trials, successes) * alpha**successes * (1 - alpha) ** (trials - successes)
    return successes


def alarms(images: list[Picture], longer: Picture) -> Iterator[int]:
    """False alarms against the reference and in pairs, for each alpha."""
    for alpha in ALPHAS:
        for couples in ([(image, longer) for image in images], list(combinations(images, 2))):
            yield sum(differ(*couple, Settings(alpha=alpha)) for couple in couples)
