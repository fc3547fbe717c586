"""`--ajar-exact` on this machine: two renders with other numbers of threads are equal to the last bit.

The references of tests/images were made elsewhere. These are made here, so that the exact mode is asked in every run.
"""

import json
import os
from pathlib import Path

import pytest
from ajar_tools import read

SCENE = Path(__file__).parents[2] / "scenes" / "caustic-glass" / "scene.toml"
INTEGRATORS = ("path", "bdpt", "mlt", "ajar")
OPTIONS = ["--size", "32x24", "--spp", "8", "--aov", "albedo,normal,depth"]


@pytest.fixture
def project(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """A folder for cases that the program renders."""
    if not os.environ.get("AJAR_BIN"):
        pytest.skip("AJAR_BIN does not name an ajar program")
    for name in ("CI", "GITHUB_ACTIONS", "PYTEST_ADDOPTS"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    return pytester


def write_case(project: pytest.Pytester, integrator: str, *arguments: str) -> None:
    """A case by an integrator."""
    folder = project.path / "tests" / "images" / integrator
    folder.mkdir(parents=True, exist_ok=True)
    words = json.dumps(["--integrator", integrator, *OPTIONS, *arguments])
    (folder / "compare.toml").write_text(f"[render]\nscene = {json.dumps(str(SCENE))}\narguments = {words}\n")


def run(project: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    return project.runpytest_inprocess("-p", "ajar_tools.pytest_plugin", "-p", "no:cacheprovider", *arguments)


def gates(project: pytest.Pytester, integrator: str) -> list[str]:
    """The gates that were asked, in order."""
    verdict = json.loads((project.path / "ajar-artifacts" / integrator / "verdict.json").read_text("utf-8"))
    return [gate["gate"] for gate in verdict["gates"]]


def test_bits_depend_on_no_number_of_threads(project: pytest.Pytester) -> None:
    for integrator in INTEGRATORS:
        write_case(project, integrator, "--threads", "1")
    run(project, "--ajar-update").assert_outcomes(passed=len(INTEGRATORS))
    reference = read(project.path / "tests" / "images" / "ajar" / "reference.exr")
    assert reference.attributes["ajar:mutationsPerSample"] > 1, "chains are part of what is compared"
    for integrator in INTEGRATORS:
        write_case(project, integrator, "--threads", "3")
    run(project, "--ajar-exact").assert_outcomes(passed=len(INTEGRATORS))
    for integrator in INTEGRATORS:
        assert gates(project, integrator)[-1] == "exact"


def test_another_seed_is_a_twin_but_not_exact(project: pytest.Pytester) -> None:
    write_case(project, "path", "--seed", "1")
    run(project, "--ajar-update").assert_outcomes(passed=1)
    write_case(project, "path", "--seed", "2")
    run(project).assert_outcomes(passed=1)
    assert "statistics" in gates(project, "path")
    result = run(project, "--ajar-exact")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*exact*FAIL*not equal to the last bit*"])
