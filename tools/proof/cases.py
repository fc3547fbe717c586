"""Makes tests/images/README.md: the smallest change of light that each of the project's own cases finds.

cargo build --release
.venv/bin/python tools/proof/cases.py         165 small renders, some 20 minutes of CPU; kept in target/proof
"""

from __future__ import annotations

import hashlib
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from ajar_tools import Picture, Settings, read
from ajar_tools.cases import Case, is_case, read_case
from ajar_tools.pytest_plugin import SUITE_ALPHA
from power import least_change
from renders import ROOT, folder, program
from rules import differ
from synthetic import brighter

FOLDER = ROOT / "tests" / "images"
INTEGRATORS = ("path", "bdpt", "mlt", "ajar")
SEEDS = range(1, 6)
PAGE = """# The project's own images

Each folder is a [case](../../docs/guard-images.md): a scene of `scenes/` by one of the integrators, small and with few
samples. On the machine and with the build that made them, renders equal the references to the last bit, and anything
that changes a bit is seen by `pytest tests/images --ajar-exact`. Elsewhere they are compared by statistics, and what is
too small for these passes. Albedo, normals and depth are compared everywhere, nearly exactly
([compare.md](../../docs/compare.md)): they find what moved, and colours of materials. `door-ajar` is rendered without
its door, and `caustic-glass` with a larger lamp of the same power: as they are, they take too many samples for a test.

## Smallest change of light that is found

How much brighter all light has to become until all of {seeds} renders with other seeds fail against the reference, in a
suite that raises a false alarm once in {runs:.0f} runs. None of the {count} renders failed unchanged.

| | {integrators} |
|---|{rule}
{rows}

Made by `.venv/bin/python tools/proof/cases.py`.
"""


def path(case: Case, seed: int) -> Path:
    """Where a render is kept."""
    digest = hashlib.sha256(repr(case.arguments).encode()).hexdigest()[:8]
    return folder() / f"case-{case.name}-{seed}-{digest}.exr"


def make(case: Case, seed: int) -> None:
    """Renders a case with another seed."""
    target = path(case, seed)
    if not target.exists():
        begun = target.with_name(f"part-{target.name}")
        other = replace(case, arguments=(*case.arguments, "--seed", str(seed), "--threads", "1"))
        other.render(begun, program())
        begun.rename(target)


def smallest(case: Case, settings: Settings) -> float:
    """The change that all seeds find.

    Raises:
        RuntimeError: an image that did not change is taken for a changed one.
    """
    right = read(case.reference)
    changes = []
    for seed in SEEDS:
        image = read(path(case, seed))
        if differ(image, right, settings):
            raise RuntimeError(f"{case.name} with seed {seed} raises a false alarm")
        changes.append(least_change(lambda change, image=image: found(image, change, right, settings)))
    return max(changes)


def found(image: Picture, change: float, right: Picture, settings: Settings) -> bool:
    """Whether the comparison sees that there is more light."""
    return differ(brighter(image, 1 + change), right, settings)


def main() -> None:
    """Renders what is missing and writes the page."""
    cases = {case.name: case for case in map(read_case, sorted(filter(is_case, FOLDER.iterdir())))}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda job: make(*job), [(case, seed) for case in cases.values() for seed in SEEDS]))
    settings = Settings(alpha=SUITE_ALPHA / len(cases))
    rows: dict[str, dict[str, str]] = {}
    for name, case in cases.items():
        scene, _, kind = name.rpartition("-")
        if kind not in INTEGRATORS:
            scene, kind = name, case.arguments[case.arguments.index("--integrator") + 1]
        rows.setdefault(scene, {})[kind] = f"{100 * smallest(case, settings):.2g} %"
        print(name, rows[scene][kind], flush=True)
    table = [f"| `{scene}` | " + " | ".join(row.get(i, "") for i in INTEGRATORS) + " |" for scene, row in rows.items()]
    text = PAGE.format(
        seeds=len(SEEDS),
        runs=1 / SUITE_ALPHA,
        count=len(cases) * len(SEEDS),
        integrators=" | ".join(f"`{name}`" for name in INTEGRATORS),
        rule="---|" * len(INTEGRATORS),
        rows="\n".join(table),
    )
    (FOLDER / "README.md").write_text(text, "utf-8")


if __name__ == "__main__":
    main()
