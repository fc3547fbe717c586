"""Makes docs/compare-proof.md: what ajar-compare and other rules find and miss.

    .venv/bin/python tools/proof/tables.py            some three minutes
    .venv/bin/python tools/proof/tables.py --full     40 twins and 20 trials instead of 10 and 5

Images are synthetic (tools/tests/synthetic.py), so that the truth is known.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from ajar_tools import Outcome, Settings, compare
from rules import FixedThreshold, PixelZ, Rule, ajar_compare, idiff, rms
from synthetic import File, Recipe, file, scene

PAGE = Path(__file__).parents[2] / "docs" / "compare-proof.md"
RECIPE = Recipe(width=128, height=96, rounds=16, noise=0.5)
HEAD = """# What the comparison finds

Made by `.venv/bin/python tools/proof/tables.py{flags}`. Synthetic images of 128×96 pixels, 16 rounds, 50 % noise a
pixel and round (skewed, as light is), against a reference of 64 rounds. Every number is a fraction of trials with new
seeds. *Tuned* rules have the smallest limits that let five twins pass, and a tenth to spare. *z a pixel* is the rule
of Mitsuba 3's own tests.
"""


def multiplied(factor: float) -> Callable[[File], None]:
    def mutate(mutant: File) -> None:
        mutant.pixels[..., :3] *= factor

    return mutate


def light_off(mutant: File) -> None:
    mutant.pixels[:, 96:, :3] *= 0.9


def tile(mutant: File) -> None:
    mutant.pixels[40:56, 24:40, :3] *= 1.2


def swapped(mutant: File) -> None:
    mutant.pixels[..., :3] = mutant.pixels[..., 2::-1]


def shifted(mutant: File) -> None:
    mutant.pixels = np.roll(mutant.pixels, 1, axis=1)


def one_nan(mutant: File) -> None:
    mutant.pixels[20, 30, 1] = np.nan


def all_nan(mutant: File) -> None:
    mutant.pixels[:] = np.nan


def black(mutant: File) -> None:
    mutant.pixels[..., :3] = 0


def renamed(mutant: File) -> None:
    mutant.channels = ("R", "G", "B", "Z")


def cropped(mutant: File) -> None:
    mutant.pixels = mutant.pixels[:88]


def claims(mutant: File) -> None:
    mutant.variances = {side: variance / 2 for side, variance in mutant.variances.items()}
    mutant.recipe = replace(mutant.recipe, rounds=32)


MUTANTS: dict[str, tuple[Callable[[File], None], dict[str, object]]] = {
    "energy +2 %": (multiplied(1.02), {}),
    "a light off (a quarter of the image, 10 %)": (light_off, {}),
    "one tile of 16×16 +20 %": (tile, {}),
    "albedo swapped": (swapped, {}),
    "shifted by a pixel": (shifted, {}),
    "one NaN": (one_nan, {}),
    "all NaN": (all_nan, {}),
    "black": (black, {}),
    "a channel renamed": (renamed, {}),
    "cropped": (cropped, {}),
    "one seed for all rounds": (lambda mutant: None, {"equal_rounds": True}),
    "neighbours share their noise": (lambda mutant: None, {"shared": 0.5}),
    "half the rounds claimed as all": (claims, {}),
}


def main(full: bool) -> None:
    twins, trials = (40, 20) if full else (10, 5)
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        reference = file(RECIPE, seed=1000, rounds=64).write(home / "reference.exr")
        rules = make_rules(home, reference)
        text = HEAD.format(flags=" --full" if full else "")
        text += detections(home, reference, rules, twins, trials)
        text += power(home, trials)
    PAGE.write_text(text, "utf-8")


def make_rules(home: Path, reference: Path) -> dict[str, Rule]:
    """All rules; those with thresholds have them tuned to five twins, as people do."""
    worst = max(rms(file(RECIPE, seed=2000 + i).write(home / "twin.exr"), reference) for i in range(5))
    variance = (RECIPE.noise * scene(RECIPE.width, RECIPE.height)) ** 2
    return {
        "ajar-compare": ajar_compare,
        "idiff": idiff(),
        "idiff, tuned": idiff("-fail", f"{3 * worst:.4g}", "-failpercent", "5", "-hardfail", f"{100 * worst:.4g}"),
        "RMS, tuned": FixedThreshold(1.1 * worst),
        "z a pixel": PixelZ(variance, RECIPE.rounds),
    }


def detections(home: Path, reference: Path, rules: dict[str, Rule], twins: int, trials: int) -> str:
    """The table of mutants and of twins."""
    lines = [
        "\n## Mutants that must fail, twins that must pass\n",
        f"Found of {trials} mutants each; the last row: false alarms of {twins} twins.\n",
        "| | " + " | ".join(rules) + " |",
        "|---|" + "---|" * len(rules),
    ]
    for name, (mutate, changes) in MUTANTS.items():
        found = dict.fromkeys(rules, 0)
        for path in mutants(home, mutate, changes, trials):
            for rule, passes in rules.items():
                found[rule] += not passes(path, reference)
        lines.append(f"| {name} | " + " | ".join(f"{n / trials:.2f}" for n in found.values()) + " |")
    alarms = dict.fromkeys(rules, 0)
    for path in mutants(home, lambda mutant: None, {}, twins):
        for rule, passes in rules.items():
            alarms[rule] += not passes(path, reference)
    lines.append("| *false alarms* | " + " | ".join(f"{n / twins:.2f}" for n in alarms.values()) + " |")
    return "\n".join(lines) + "\n"


def mutants(home: Path, mutate: Callable[[File], None], changes: dict[str, object], trials: int) -> Iterator[Path]:
    """Files of new seeds, one after the other at the same place."""
    for seed in range(trials):
        mutant = file(RECIPE, seed=seed, **changes)
        mutate(mutant)
        yield mutant.write(home / "new.exr")


def power(home: Path, trials: int) -> str:
    """The smallest change of energy that is found, by the number of rounds."""
    lines = [
        "\n## Smallest change of energy that every trial finds\n",
        "| rounds of both images | change |",
        "|---|---|",
    ]
    for rounds in (16, 64, 256):
        recipe = replace(RECIPE, rounds=rounds)
        reference = file(recipe, seed=1000).write(home / "reference.exr")
        images = [file(recipe, seed=seed) for seed in range(trials)]
        for percent in (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0):
            if all(changed(image, percent, home, reference) for image in images):
                lines.append(f"| {rounds} | {percent:g} % |")
                break
    return "\n".join(lines) + "\n"


def changed(image: File, percent: float, home: Path, reference: Path) -> bool:
    """Whether more energy is found."""
    brighter = replace(image, pixels=image.pixels * np.array([1 + percent / 100] * 3 + [1]))
    return compare(brighter.write(home / "new.exr"), reference, Settings()).outcome is Outcome.FAIL


if __name__ == "__main__":
    main("--full" in sys.argv)
