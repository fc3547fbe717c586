"""tests/images: no scene and no integrator is without a case."""

from pathlib import Path

import pytest
from ajar_tools.cases import is_case, read_case

ROOT = Path(__file__).parents[2]
SCENES = sorted(path.parent.name for path in (ROOT / "scenes").glob("*/scene.*"))
INTEGRATORS = ("path", "bdpt", "mlt", "ajar")


def test_scenes_are_found() -> None:
    folders = {path.parent.name for path in (ROOT / "scenes").glob("*/generate.py")}
    assert folders == set(SCENES)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("scene", SCENES)
def test_every_scene_has_a_case_by_every_integrator(scene: str, integrator: str) -> None:
    folder = ROOT / "tests" / "images" / f"{scene}-{integrator}"
    assert is_case(folder)
    case = read_case(folder)
    assert case.reference.is_file()
    assert case.scene.parent == ROOT / "scenes" / scene
    assert case.arguments[case.arguments.index("--integrator") + 1] == integrator
