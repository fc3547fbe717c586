"""Mutants: spoiled renders, which must fail, under this comparison and under the rules of others."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from renders import LONGER, REFERENCE, ROUNDS, Render, make
from rules import FixedThreshold, PixelZ, Rule, ajar_compare, idiff, rms
from synthetic import File, Recipe, file, scene

SYNTHETIC = Recipe(width=256, height=192, rounds=ROUNDS, noise=0.5)
SCENE = "caustic-glass"
# Rounds of the images by each integrator, and samples a pixel in each. How bright a round of `mlt` is as a whole has
# noise of its own, which all blocks have in common.
RENDERED = {"path": (ROUNDS, 4), "mlt": (16 * ROUNDS, 4)}
# Mutants that noise may hide; all others have to be found every time.
HIDDEN = {
    "synthetic": {"half the rounds claimed as all"},
    "path": {"energy +2 %", "half the rounds claimed as all"},
    "mlt": {"energy +2 %", "half the rounds claimed as all"},
}
# Twins that fixed thresholds are tuned to.
TUNED = 5
Edit = Callable[[File], None]


def scaled(factor: float, where: tuple[Any, ...] = (...,)) -> Edit:
    """Other energy in a part of the image."""

    def edit(mutant: File) -> None:
        mutant.pixels[(*where, slice(3))] *= factor

    return edit


def put(value: float, where: tuple[Any, ...]) -> Edit:
    """Some values replaced."""
    return lambda mutant: mutant.pixels.__setitem__(where, value)


def shifted(mutant: File) -> None:
    """By a pixel."""
    mutant.pixels = np.roll(mutant.pixels, 1, axis=1)


def swapped(mutant: File) -> None:
    """Red for blue."""
    mutant.pixels[..., :3] = mutant.pixels[..., 2::-1].copy()


def cropped(mutant: File) -> None:
    """Without its last rows."""
    mutant.pixels = mutant.pixels[:-8]
    mutant.variances = {}


def claims(mutant: File) -> None:
    """Half the rounds claimed as all."""
    mutant.variances = {side: variance / 2 for side, variance in mutant.variances.items()}
    mutant.recipe = replace(mutant.recipe, rounds=2 * mutant.recipe.rounds)


def repeated(rounds: int) -> Edit:
    """As rounds that are all equal would declare it: without noise."""

    def edit(mutant: File) -> None:
        mutant.variances = {side: 0 * variance for side, variance in mutant.variances.items()}
        mutant.recipe = replace(mutant.recipe, rounds=rounds)

    return edit


EVERYWHERE = (Ellipsis, slice(3))
EDITS: dict[str, Edit] = {
    "energy +2 %": scaled(1.02),
    "shifted by a pixel": shifted,
    "one NaN": put(np.nan, (20, 30, 1)),
    "all NaN": put(np.nan, EVERYWHERE),
    "empty": put(0.0, EVERYWHERE),
    "a channel renamed": lambda mutant: setattr(mutant, "channels", ("R", "G", "B", "Z")),
    "cropped": cropped,
    "half the rounds claimed as all": claims,
}
TILE = (slice(8, 24), slice(24, 40))


@dataclass
class Mutant:
    """A kind of mutants, and how one of a seed is made."""

    name: str
    make: Callable[[int], File]


def edited(make_file: Callable[[int], File], edit: Edit) -> Callable[[int], File]:
    """What `make_file` makes, spoiled."""

    def make_mutant(seed: int) -> File:
        mutant = make_file(seed)
        edit(mutant)
        return mutant

    return make_mutant


def synthetic(seed: int, **changes: object) -> File:
    """An image of known noise."""
    return file(SYNTHETIC, seed=seed, **changes)


def synthetic_mutants() -> Iterator[Mutant]:
    """Those whose truth is known."""
    for name, edit in EDITS.items():
        yield Mutant(name, edited(synthetic, edit))
    yield Mutant("a light off (a quarter of the image, 10 %)", edited(synthetic, scaled(0.9, (..., slice(192, None)))))
    yield Mutant("a tile of 16×16, +20 %", edited(synthetic, scaled(1.2, TILE)))
    yield Mutant("albedo swapped", edited(synthetic, swapped))
    yield Mutant("one seed for all rounds", lambda seed: synthetic(seed, equal_rounds=True))
    yield Mutant("neighbours share their noise", lambda seed: synthetic(seed, shared=0.5))


CHANGES = {
    "a light off (the window)": ("light.window.radiance=0",),
    "albedo swapped (the backdrop, red and blue)": ("material.Backdrop.base_color=[0.33,0.3,0.28]",),
}


def rendered_mutants(integrator: str) -> Iterator[Mutant]:
    """Those of renders: edited files, changed scenes, and one round that is counted often."""
    rounds, samples = RENDERED[integrator]

    def render(seed: int, changes: tuple[str, ...] = ()) -> File:
        return Render(SCENE, integrator, seed, rounds, changes, samples).file()

    for name, edit in EDITS.items():
        yield Mutant(name, edited(render, edit))
    for name, changes in CHANGES.items():
        yield Mutant(name, lambda seed, changes=changes: render(seed, changes))
    yield Mutant("a tile of 16×16, +20 %", edited(render, scaled(1.2, TILE)))
    few = edited(lambda seed: Render(SCENE, integrator, seed, 2, (), samples).file(), repeated(rounds))
    yield Mutant("one seed for all rounds", few)


def sections(home: Path, count: int, trials: int) -> tuple[str, list[str]]:
    """All tables, of synthetic images and of renders by two integrators, and mutants that must not survive and do."""
    variance = (SYNTHETIC.noise * scene(SYNTHETIC.width, SYNTHETIC.height)) ** 2
    good = [synthetic(seed) for seed in range(count)]
    right = synthetic(REFERENCE, rounds=4 * ROUNDS).write(home / "reference.exr")
    title = "synthetic images of 256×192 pixels with 50 % of noise a pixel and round"
    text, found = table(title, home, right, good, variance, ROUNDS, list(synthetic_mutants()), trials)
    problems = survivors("synthetic", found)
    for integrator, (rounds, samples) in RENDERED.items():
        seeds = range(1, trials + 1)
        twins = [Render(SCENE, integrator, seed, rounds, (), samples) for seed in range(1, count + 1)]
        longer = Render(SCENE, integrator, REFERENCE, rounds * LONGER, (), samples)
        make([*twins, longer])
        make(
            Render(SCENE, integrator, seed, rounds, changes, samples) for seed in seeds for changes in CHANGES.values()
        )
        make(Render(SCENE, integrator, seed, 2, (), samples) for seed in seeds)
        good = [render.file() for render in twins]
        variance = rounds * np.var([image.pixels[..., :3] for image in good], axis=0, ddof=1)
        right = longer.file().write(home / "reference.exr")
        mutants = list(rendered_mutants(integrator))
        title = f"`{SCENE}` by `{integrator}`, {rounds} rounds of {samples} samples a pixel"
        lines, found = table(title, home, right, good, variance, rounds, mutants, trials)
        text += lines
        problems += survivors(integrator, found)
    return text, problems


def survivors(kind: str, found: dict[str, float]) -> list[str]:
    """Mutants that are not found every time though noise does not hide them, in words."""
    missed = {name: share for name, share in found.items() if share < 1 and name not in HIDDEN[kind]}
    return [f"{kind}: {1 - share:.0%} of the mutants {name} survive" for name, share in missed.items()]


def table(
    title: str,
    home: Path,
    right: Path,
    good: list[File],
    variance: np.ndarray,
    rounds: int,
    mutants: list[Mutant],
    trials: int,
) -> tuple[str, dict[str, float]]:
    """Mutants and twins of one kind under every rule, and what fraction of each mutant this comparison finds.

    `variance` is that of a round, which only a test can know.
    """
    new = home / "new.exr"
    worst = max(rms(image.write(new), right) for image in good[:TUNED])
    rules: dict[str, Rule] = {
        "ajar-compare": ajar_compare,
        "idiff": idiff(),
        "idiff, tuned": idiff("-fail", f"{3 * worst:.4g}", "-failpercent", "5", "-hardfail", f"{100 * worst:.4g}"),
        "RMS, tuned": FixedThreshold(1.1 * worst),
        "z a pixel": PixelZ(variance, rounds),
    }

    def share(files: list[File]) -> dict[str, float]:
        found = dict.fromkeys(rules, 0)
        for image in files:
            image.write(new)
            for rule, passes in rules.items():
                found[rule] += not passes(new, right)
        return {rule: n / len(files) for rule, n in found.items()}

    def row(name: str, shares: dict[str, float]) -> str:
        return f"| {name} | " + " | ".join(f"{value:.2f}" for value in shares.values()) + " |"

    lines = [
        f"\n### Mutants of {title}\n",
        f"| {trials} of each; {len(good)} twins | " + " | ".join(rules) + " |",
        "|---|" + "---|" * len(rules),
    ]
    ours = {}
    for mutant in mutants:
        shares = share([mutant.make(seed) for seed in range(1, trials + 1)])
        ours[mutant.name] = shares["ajar-compare"]
        lines.append(row(mutant.name, shares))
        print(lines[-1], flush=True)
    lines.append(row("*twins: false alarms*", share(good)))
    print(lines[-1], flush=True)
    missed = [f"{name} ({value:.2f})" for name, value in ours.items() if value < 1]
    lines += ["", "Not found every time: " + (", ".join(missed) or "none") + "."]
    return "\n".join(lines) + "\n", ours
