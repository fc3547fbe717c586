"""The plug-in from outside: pytest runs on folders of cases, with a renderer that draws synthetic noise."""

import json
import os
import re
import shlex
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import OpenImageIO as oiio
import pytest
from ajar_tools import cli, read
from synthetic import file

# Copies the picture that lies beside the scene: fake-ajar render SCENE -o OUTPUT …
FAKE_AJAR = """#!/bin/sh
cp "${2%.toml}.exr" "$4" 2>/dev/null && exit
echo "scene.toml:1:1: error: no camera" >&2
exit 1
"""


@pytest.fixture
def project(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """A folder with a renderer and one case, door."""
    for name in ("CI", "GITHUB_ACTIONS", "PYTEST_ADDOPTS"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1]))
    program = pytester.path / "fake-ajar"
    program.write_text(FAKE_AJAR)
    program.chmod(0o755)
    monkeypatch.setenv("AJAR_BIN", str(program))
    write_scene(pytester.path, "door", seed=1)
    return pytester


def write_scene(root: Path, case: str, **recipe: object) -> Path:
    """A case whose render is a synthetic picture; one without recipe cannot be rendered."""
    folder = root / "tests" / "images" / case
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").touch()
    (folder / "scene.exr").unlink(missing_ok=True)
    if recipe:
        file(**recipe).write(folder / "scene.exr")
    return folder


def run(project: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    """In this process, which is quicker, but for those that start processes of their own."""
    plugins = ["-p", "ajar_tools.pytest_plugin", "-p", "xdist", "-p", "no:cacheprovider"]
    start = project.runpytest_subprocess if "-n" in arguments else project.runpytest_inprocess
    return start(*plugins, *arguments)


def test_missing_reference_fails_with_the_command_that_makes_it(
    project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    result = run(project, "--junitxml=junit.xml")
    result.assert_outcomes(failed=1)
    command = "pytest tests/images/door --ajar-update"
    result.stdout.fnmatch_lines(["*door has no reference image*", f"*{command}*"])
    result.stdout.re_match_lines([rf"::error file=.*,title=no reference image::door has no .*{command}"])
    properties = ElementTree.parse(project.path / "junit.xml").iter("property")
    assert any(command in str(item.get("value")) for item in properties)
    assert (project.path / "ajar-artifacts" / "door" / "new.exr").exists()
    index = (project.path / "ajar-artifacts" / "index.html").read_text()
    assert "<td>door<td" in index
    assert command in index


def test_update_writes_a_reference_and_a_review_page_then_twins_pass(project: pytest.Pytester) -> None:
    result = run(project, "--ajar-update")
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["*review the new references in*"])
    index = (project.path / "ajar-artifacts" / "index.html").read_text()
    assert '<td class="review">new reference<td>' in index
    assert "nothing to compare with" in index
    found = data(project)
    assert found["verdict"]["review"] == "new reference"
    assert found["verdict"]["problem"] == "nothing to compare with"
    assert found["command"] == "pytest tests/images/door --ajar-update"
    run(project).assert_outcomes(passed=1)
    write_scene(project.path, "door", seed=2)
    run(project).assert_outcomes(passed=1)
    run(project, "--ajar-exact").assert_outcomes(failed=1)


def data(project: pytest.Pytester, case: str = "door") -> dict[str, Any]:
    """What a report shows."""
    page = (project.path / "ajar-artifacts" / case / "report.html").read_text("utf-8")
    match = re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.DOTALL)
    assert match
    found: dict[str, Any] = json.loads(match[1])
    return found


def reproduced(project: pytest.Pytester, command: str, monkeypatch: pytest.MonkeyPatch) -> int:
    """The exit code of the command that a report names, run in the folder of the run."""
    program, *arguments = shlex.split(command)
    assert program == "ajar-compare"
    monkeypatch.chdir(project.path)
    return cli.main(arguments)


def test_changed_picture_fails_with_words_report_and_junit(project: pytest.Pytester) -> None:
    run(project, "--ajar-update").assert_outcomes(passed=1)
    write_scene(project.path, "door", seed=2, scale=1.05)
    result = run(project, "--junitxml=junit.xml")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        ["*DIFFERENT PICTURE*", "*statistics FAIL *brighter*", "*report.html*", "*--ajar-update*"]
    )
    assert "Traceback" not in result.stdout.str()
    failure = ElementTree.parse(project.path / "junit.xml").find(".//failure")
    assert failure is not None
    assert "DIFFERENT PICTURE" in str(failure.text)
    index = (project.path / "ajar-artifacts" / "index.html").read_text()
    assert 'href="door/report.html"' in index
    assert 'src="door/strip.png"' in index
    # Reference, new image, difference, with white between.
    strip = oiio.ImageBuf(str(project.path / "ajar-artifacts/door/strip.png")).get_pixels(oiio.FLOAT)
    width = (strip.shape[1] - 8) // 3
    reference, new, difference = (strip[:, start : start + width] for start in (0, width + 4, 2 * width + 8))
    assert new.mean() > reference.mean()
    assert difference[..., 0].mean() > difference[..., 2].mean()


def test_update_keeps_old_and_new_side_by_side(project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    run(project, "--ajar-update")
    reference = project.path / "tests/images/door/reference.exr"
    before = reference.read_bytes()
    write_scene(project.path, "door", seed=2, scale=1.05)
    run(project, "--ajar-update").assert_outcomes(passed=1)
    assert reference.read_bytes() != before
    assert (project.path / "ajar-artifacts/door/old.exr").read_bytes() == before
    index = (project.path / "ajar-artifacts/index.html").read_text()
    assert '<td class="review">changed reference<td>' in index
    assert 'class="fail"' not in index
    found = data(project)
    assert found["verdict"]["review"] == "changed reference"
    assert found["verdict"]["outcome"] == "fail"
    assert reproduced(project, found["command"], monkeypatch) == 1
    run(project, "--ajar-update").assert_outcomes(passed=1)
    assert '<td class="review">kept reference<td>' in (project.path / "ajar-artifacts/index.html").read_text()


def test_update_replaces_an_equal_picture_of_another_structure(project: pytest.Pytester) -> None:
    run(project, "--ajar-update").assert_outcomes(passed=1)
    folder = project.path / "tests/images/door"
    renamed = file(seed=1)
    renamed.channels = ("R", "G", "B", "coverage")
    renamed.write(folder / "scene.exr")
    (folder / "compare.toml").write_text(
        '[[excused]]\ngate = "structure"\nreason = "renamed, issue 13"\nuntil = 2999-01-01\n'
    )
    run(project).assert_outcomes(passed=1)
    run(project, "--ajar-update").assert_outcomes(passed=1)
    assert read(folder / "reference.exr").channels[-1] == "coverage"


def test_an_alpha_of_its_own_stays(project: pytest.Pytester) -> None:
    """Also one that is the default of a single comparison."""
    run(project, "--ajar-update").assert_outcomes(passed=1)
    write_scene(project.path, "other", seed=1)
    (project.path / "tests/images/door/compare.toml").write_text("alpha = 0.001\n")
    run(project)
    commands = {
        case: json.loads((project.path / "ajar-artifacts" / case / "verdict.json").read_text())["command"]
        for case in ("door", "other")
    }
    assert commands["door"].endswith("--alpha 0.001")
    assert commands["other"].endswith("--alpha 0.0005")


def test_noise_that_hides_everything_is_a_warning(project: pytest.Pytester) -> None:
    run(project, "--ajar-update").assert_outcomes(passed=1)
    noisy = file(seed=2)
    noisy.integrator = "bdpt"
    noisy.variances = {side: 1e6 * variance for side, variance in noisy.variances.items()}
    noisy.write(project.path / "tests/images/door/scene.exr")
    result = run(project)
    # pytest itself may warn too.
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["*so much noise is declared*"])


def test_names_of_cases_are_quoted_in_links(project: pytest.Pytester) -> None:
    write_scene(project.path, "50% #1", seed=1)
    run(project, "--ajar-update").assert_outcomes(passed=2)
    index = (project.path / "ajar-artifacts/index.html").read_text()
    assert 'href="50%25%20%231/report.html">50% #1</a>' in index


def test_update_is_refused_where_ci_is_set(project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CI", "true")
    result = run(project, "--ajar-update")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["*refused because CI is set*"])
    assert not (project.path / "tests/images/door/reference.exr").exists()


def test_parallel_runs_give_the_same_results(project: pytest.Pytester) -> None:
    for case in ("a", "b", "c", "d"):
        write_scene(project.path, case, seed=1)
    run(project, "--ajar-update").assert_outcomes(passed=5)
    write_scene(project.path, "c", seed=3, scale=0.9)
    run(project, "-n", "2").assert_outcomes(passed=4, failed=1)
    verdicts = sorted((project.path / "ajar-artifacts").glob("*/verdict.json"))
    assert [json.loads(path.read_text())["outcome"] for path in verdicts] == ["pass", "pass", "fail", "pass", "pass"]


def test_cases_of_one_name_are_refused(project: pytest.Pytester) -> None:
    write_scene(project.path / "more", "door", seed=1)
    result = run(project, "-o", "ajar_images=tests/images more/tests/images", "tests", "more")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["*2 cases are called door*"])


def test_github_sees_an_annotation_at_the_case(project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    run(project, "--ajar-update")
    write_scene(project.path, "door", seed=2, scale=1.05)
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    output = run(project).stdout.str()
    assert re.search(
        r"^::error file=tests/images/door/scene\.toml,title=image differs::DIFFERENT", output, re.MULTILINE
    )


def test_a_renderer_that_fails_is_quoted(project: pytest.Pytester) -> None:
    write_scene(project.path, "door")
    result = run(project)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*ended with exit code 1*", "*scene.toml:1:1: error: no camera*"])
    assert "no camera" in (project.path / "ajar-artifacts/index.html").read_text()


def test_a_renderer_that_is_missing_is_a_failure(project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AJAR_BIN", "/nowhere/ajar")
    result = run(project)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*there is no program /nowhere/ajar*"])


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("flip_maen = 0.1", '*unknown key "flip_maen"; did you mean "flip_mean"*'),
        ('alpha = "small"', "*alpha must be a number*"),
        ("alpha = 0", "*alpha must be a number, from 1e-100 to 0.5*"),
        ("alpha = 7", "*alpha must be a number, from 1e-100 to 0.5*"),
        ("max_luminance = 0", "*max_luminance must be a number, from 0.01 to 1e+06*"),
        ("max_error = inf", "*max_error must be a number, zero or more*"),
        ("excused = 3", "*exceptions are tables*"),
        ('[[excused]]\ngate = "flip"\nreason = "x"\nuntil = 2999-01-01T10:00:00', "*needs a date*"),
        ('[[excused]]\ngate = "flip"\nreason = "noise"', "*needs gate, reason and until*"),
        ('[[excused]]\ngate = "finite"\nreason = "x"\nuntil = 2999-01-01', "*cannot be excused*"),
        ('[[excused]]\ngate = "flip"\nreason = "old"\nuntil = 2020-01-01', "*ended on 2020-01-01 (old)*"),
        ("[render]\nscen = 1", "*knows scene, arguments, command and timeout*"),
    ],
)
def test_mistakes_in_compare_toml_are_errors(text: str, complaint: str, project: pytest.Pytester) -> None:
    (project.path / "tests/images/door/compare.toml").write_text(text)
    result = run(project)
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines([complaint])


def test_an_exception_lets_a_gate_fail_and_is_shown(project: pytest.Pytester) -> None:
    run(project, "--ajar-update")
    folder = write_scene(project.path, "door", seed=2, scale=1.05)
    (folder / "compare.toml").write_text(
        'flip_mean = 0.1\n[[excused]]\ngate = "statistics"\nreason = "new lamp, issue 12"\nuntil = 2999-01-01\n'
    )
    run(project).assert_outcomes(passed=1)
    verdict = json.loads((project.path / "ajar-artifacts/door/verdict.json").read_text())
    assert verdict["exceptions"] == ["statistics, until 2999-01-01: new lamp, issue 12"]


def test_another_renderer_is_run_by_its_command(project: pytest.Pytester) -> None:
    folder = project.path / "tests/images/door"
    command = [os.environ["AJAR_BIN"], "render", "{scene}", "-o", "{output}"]
    (folder / "compare.toml").write_text(f"[render]\ncommand = {json.dumps(command)}\n")
    run(project, "--ajar-update", "--ajar-binary", "/nowhere/ajar").assert_outcomes(passed=1)


def test_fixtures_compare_from_python(project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    file(seed=2).write(project.path / "twin.exr")
    project.makepyfile(
        """
        def test_same(ajar_render, ajar_compare):
            image = ajar_render("tests/images/door/scene.toml")
            assert ajar_compare(image, image).gates

        def test_other(ajar_render, ajar_compare):
            image = ajar_render("tests/images/door/scene.toml", name="the other.exr")
            ajar_compare(ajar_render("twin.toml"), image, max_error=0.0001)

        def test_mistake(ajar_compare):
            ajar_compare("twin.exr", "twin.exr", flip_maen=0.5)
        """
    )
    result = run(project, "test_fixtures_compare_from_python.py")
    result.assert_outcomes(passed=1, failed=2)
    result.stdout.fnmatch_lines(['*unknown key "flip_maen"; did you mean "flip_mean"*'])
    assert "TypeError" not in result.stdout.str()
    name = "test_fixtures_compare_from_python-test_other"
    artifacts = project.path / "ajar-artifacts" / name
    assert (artifacts / "new.exr").read_bytes() == (project.path / "twin.exr").read_bytes()
    # Without the test's limit it would be 0.
    assert reproduced(project, data(project, name)["command"], monkeypatch) == 1


def test_a_folder_of_somebody_else_is_not_emptied(project: pytest.Pytester) -> None:
    folder = project.path / "ajar-artifacts"
    folder.mkdir()
    (folder / "thesis.tex").touch()
    result = run(project)
    assert result.ret != 0
    assert (folder / "thesis.tex").exists()


@pytest.mark.parametrize("name", ["build", "dist", ".hidden"])
def test_cases_are_cases_whatever_they_are_called(name: str, project: pytest.Pytester) -> None:
    write_scene(project.path, name, seed=2)
    result = run(project, "tests/images")
    assert result.ret == 1
    result.stdout.fnmatch_lines([f"*{name} has no reference image*"])


def test_references_without_a_case_are_refused(project: pytest.Pytester) -> None:
    run(project, "--ajar-update")
    (project.path / "tests/images/door/scene.toml").rename(project.path / "tests/images/door/other.toml")
    write_scene(project.path, "window", seed=2)
    result = run(project, "tests/images")
    assert result.ret != 0
    result.stderr.fnmatch_lines(["*references without a case*door*reference.exr*"])


def test_artifacts_stay_where_no_case_is_asked_for(project: pytest.Pytester) -> None:
    run(project, "--ajar-update")
    kept = project.path / "ajar-artifacts" / "door" / "new.exr"
    assert kept.is_file()
    project.makepyfile(test_unit="def test_nothing(): pass")
    assert run(project, "test_unit.py").ret == 0
    assert kept.is_file()
