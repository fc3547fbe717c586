"""Makes docs/compare-proof.md: what the comparison finds and misses, beside the rules of others.

cargo build --release
.venv/bin/python tools/proof             some 700 small renders, 45 minutes of CPU; kept in target/proof
.venv/bin/python tools/proof --quick     few of them, to standard output

Exit code 1: more false alarms than chance explains, or a mutant survived that must not.
"""

from __future__ import annotations

import datetime
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import mutants
import power
import twins

PAGE = Path(__file__).parents[2] / "docs" / "compare-proof.md"
HEAD = """# What the comparison finds

Made by `.venv/bin/python tools/proof` from a release build, on {date}. It ends with exit code 1 where there are more
false alarms than chance explains, or where a mutant survives that noise does not hide. Renders have 48×32 pixels with
albedo, normals and depth and paths of up to 6 edges; where nothing else is said 16 rounds of one sample a pixel, and
references four times as many rounds.
"""
RULES = """
## Mutants that must fail

Fractions of mutants that each rule finds, against the same reference. *idiff* is OpenImageIO's program as it comes;
*tuned* rules have the limits that let five twins pass, and a tenth to spare: `idiff -fail -failpercent -hardfail`, and
the root mean square error as in `assert rms < limit`. *z a pixel* is the rule of Mitsuba 3's own tests
(src/render/tests/test_renders.py), which gets the true variance of every pixel, from all twins. *One seed for all
rounds* is an image of few rounds that declares no noise.

The synthetic images are as large as a reference may be. The renders are tiny and as noisy as it gets, to see what hides
in noise; below each table stands what is not found every time. An image that claims twice its rounds has the right mean
and is betrayed by scatter alone, which takes some thousand blocks. A change of light within what the image says of its
own noise cannot be found; more pixels or rounds bring it out, as the last table shows. What changes albedo, normals or
depth too, by more than 3 % of a block of pixels, is found whatever the noise.
"""


def main(quick: bool) -> int:
    """Makes the page; returns the exit code."""
    count, trials, spoiled = (6, 3, 2) if quick else (40, 20, 10)
    twins.render(count)
    with (
        tempfile.TemporaryDirectory() as mutant,
        tempfile.TemporaryDirectory() as brighter,
        ProcessPoolExecutor() as pool,
    ):
        parts = [
            pool.submit(twins.section, count),
            pool.submit(mutants.sections, Path(mutant), count, spoiled),
            pool.submit(power.section, Path(brighter), trials),
        ]
        (tables, alarms), (rules, survivors), found = (part.result() for part in parts)
    text = HEAD.format(date=datetime.date.today()) + tables + RULES + rules + found
    if quick:
        print(text)
    else:
        PAGE.write_text(text, "utf-8")
    return exit_code(alarms + survivors)


def exit_code(problems: list[str]) -> int:
    """Tells what is wrong."""
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main("--quick" in sys.argv))
