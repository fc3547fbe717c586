"""Mutants: spoiled renders, which must fail, under this comparison and under the rules of others."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from renders import REFERENCE, ROUNDS, Render, make
from rules import FixedThreshold, PixelZ, Rule, ajar_compare, idiff, rms
from synthetic import File, Recipe, file, scene
from twins import reference, twins

SYNTHETIC = Recipe(width=256, height=192, rounds=ROUNDS, noise=0.5)
SCENE = "caustic-glass"
INTEGRATORS = ("path", "mlt")
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


def repeated(mutant: File) -> None:
    """As rounds that are all equal would declare it: without noise."""
    mutant.variances = {side: 0 * variance for side, variance in mutant.variances.items()}
    mutant.recipe = replace(mutant.recipe, rounds=ROUNDS)


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
    for name, edit in EDITS.items():
        yield Mutant(name, edited(lambda seed: Render(SCENE, integrator, seed).file(), edit))
    for name, changes in CHANGES.items():
        yield Mutant(name, lambda seed, changes=changes: Render(SCENE, integrator, seed, changes=changes).file())
    yield Mutant(
        "a tile of 16×16, +20 %", edited(lambda seed: Render(SCENE, integrator, seed).file(), scaled(1.2, TILE))
    )
    yield Mutant("one seed for all rounds", edited(lambda seed: Render(SCENE, integrator, seed, 2).file(), repeated))


def sections(home: Path, count: int, trials: int) -> str:
    """All tables: of synthetic images, and of renders by two integrators."""
    variance = (SYNTHETIC.noise * scene(SYNTHETIC.width, SYNTHETIC.height)) ** 2
    good = [synthetic(seed) for seed in range(count)]
    right = synthetic(REFERENCE, rounds=4 * ROUNDS).write(home / "reference.exr")
    title = "synthetic images of 256×192 pixels with 50 % of noise a pixel and round"
    text = table(title, home, right, good, variance, list(synthetic_mutants()), trials)
    for integrator in INTEGRATORS:
        seeds = range(1, trials + 1)
        make(Render(SCENE, integrator, seed, changes=changes) for seed in seeds for changes in CHANGES.values())
        make(Render(SCENE, integrator, seed, 2) for seed in seeds)
        good = [render.file() for render in twins(SCENE, integrator, count)]
        variance = ROUNDS * np.var([image.pixels[..., :3] for image in good], axis=0, ddof=1)
        right = reference(SCENE, integrator).file().write(home / "reference.exr")
        mutants = list(rendered_mutants(integrator))
        text += table(f"`{SCENE}` by `{integrator}`", home, right, good, variance, mutants, trials)
    return text


def table(
    title: str, home: Path, right: Path, good: list[File], variance: np.ndarray, mutants: list[Mutant], trials: int
) -> str:
    """Mutants and twins of one kind under every rule; `variance` is that of a round, which only a test can know."""
    new = home / "new.exr"
    worst = max(rms(image.write(new), right) for image in good[:TUNED])
    rules: dict[str, Rule] = {
        "ajar-compare": ajar_compare,
        "idiff": idiff(),
        "idiff, tuned": idiff("-fail", f"{3 * worst:.4g}", "-failpercent", "5", "-hardfail", f"{100 * worst:.4g}"),
        "RMS, tuned": FixedThreshold(1.1 * worst),
        "z a pixel": PixelZ(variance, ROUNDS),
    }

    def share(files: list[File]) -> str:
        found = dict.fromkeys(rules, 0)
        for image in files:
            image.write(new)
            for rule, passes in rules.items():
                found[rule] += not passes(new, right)
        return " | ".join(f"{n / len(files):.2f}" for n in found.values())

    lines = [
        f"\n### Mutants of {title}\n",
        f"| {trials} of each; {len(good)} twins | " + " | ".join(rules) + " |",
        "|---|" + "---|" * len(rules),
    ]
    for mutant in mutants:
        lines.append(f"| {mutant.name} | {share([mutant.make(seed) for seed in range(1, trials + 1)])} |")
        print(lines[-1], flush=True)
    lines.append(f"| *twins: false alarms* | {share(good)} |")
    print(lines[-1], flush=True)
    return "\n".join(lines) + "\n"
