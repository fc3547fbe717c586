"""The pytest plug-in: every folder in tests/images that holds a scene is a test.

`pytest` renders each case and compares it with its reference; `pytest --ajar-update` makes references anew and a page
to review them. Cases can run in parallel (`pytest -n 4`): each writes only into its own folder of artifacts. The
fixtures `ajar_render` and `ajar_compare` do the same for tests written in Python.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from ajar_tools.artifacts import Artifacts
from ajar_tools.cases import CONFIG, SCENE, RenderError, ajar, is_case, read_case, run
from ajar_tools.comparison import compare
from ajar_tools.image_item import CaseFailedError, ImageItem
from ajar_tools.junit import annotation
from ajar_tools.settings import Settings, SettingsError
from ajar_tools.verdict import Outcome, Verdict

# Probability that a suite of honest images raises any false alarm.
SUITE_ALPHA = 1e-3


def pytest_addoption(parser: pytest.Parser) -> None:
    """Command line and ini file."""
    group = parser.getgroup("ajar", "image regressions")
    group.addoption("--ajar-update", action="store_true", help="render references anew; refused where CI is set")
    group.addoption("--ajar-exact", action="store_true", help="fail where a picture is not equal to the last bit")
    group.addoption("--ajar-artifacts", metavar="DIR", default="ajar-artifacts", help="folder for images and reports")
    group.addoption("--ajar-alpha", type=float, metavar="P", default=SUITE_ALPHA, help="false alarms of a whole suite")
    group.addoption("--ajar-binary", metavar="FILE", help="the program [default: AJAR_BIN, then ajar on the PATH]")
    parser.addini("ajar_images", "folders whose subfolders are cases", type="args", default=["tests/images"])


def pytest_configure(config: pytest.Config) -> None:
    """Refuses to overwrite references where nobody looks."""
    if config.getoption("--ajar-update") and os.environ.get("CI"):
        raise pytest.UsageError("--ajar-update is refused because CI is set: references are made where somebody looks")
    if not 0 < config.getoption("--ajar-alpha") < 1:
        raise pytest.UsageError("--ajar-alpha is a probability, between 0 and 1")


def is_worker(config: pytest.Config) -> bool:
    """Whether this is one of pytest-xdist's processes."""
    return hasattr(config, "workerinput")


def artifacts_of(config: pytest.Config) -> Artifacts:
    """The folder of the run."""
    return Artifacts((config.invocation_params.dir / config.getoption("--ajar-artifacts")).resolve())


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """A case is collected by its compare.toml, or by its scene.toml where it has none."""
    folder = file_path.parent
    if file_path.name not in (SCENE, CONFIG) or not is_case(folder):
        return None
    if file_path.name == SCENE and (folder / CONFIG).exists():
        return None
    bases = {parent.config.rootpath, Path(parent.config.invocation_params.dir)}
    homes = {(base / name).resolve() for base in bases for name in parent.config.getini("ajar_images")}
    if folder.parent.resolve() not in homes:
        return None
    return CaseFile.from_parent(parent, path=file_path)


class CaseFile(pytest.File):
    """Collects the one test of a case."""

    def collect(self) -> Iterator[pytest.Item]:
        """Reads the case; a mistake in it is an error of collection."""
        try:
            case = read_case(self.path.parent)
        except SettingsError as error:
            raise self.CollectError(str(error)) from error
        yield ImageItem.from_parent(self, name=case.name, case=case)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Divides the suite's probability of a false alarm by its cases (Bonferroni)."""
    cases = [item for item in items if isinstance(item, ImageItem)]
    for name, count in Counter(item.case.name for item in cases).items():
        if count > 1:
            raise pytest.UsageError(f"{count} cases are called {name}, and each needs a folder of artifacts of its own")
    for item in cases:
        item.prepare(artifacts_of(config), config.getoption("--ajar-alpha") / len(cases))


def pytest_sessionstart(session: pytest.Session) -> None:
    """Removes the artifacts of the run before; with pytest-xdist, before the first of its processes starts."""
    config = session.config
    if is_worker(config) or config.option.collectonly:
        return
    try:
        artifacts_of(config).clear()
    except OSError as error:
        raise pytest.UsageError(str(error)) from error


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Where to look; on GitHub a line that shows at the case."""
    folder = artifacts_of(config)
    update = config.getoption("--ajar-update")
    title, lead = ("New references", "Old, new and their difference: look at each before you commit it.")
    if not update:
        title, lead = (
            "Image regressions",
            "Pictures that differ: reference, new image, difference; red is brighter, blue darker.",
        )
    page = folder.write_index(title, lead) if folder.folder.is_dir() else None
    if page:
        terminalreporter.write_line(f"ajar: {'review the new references' if update else 'results'} in {page}")
    if os.environ.get("GITHUB_ACTIONS"):
        for report in terminalreporter.getreports("failed"):
            headline = dict(report.user_properties).get("ajar")
            if headline:
                terminalreporter.write_line(annotation(Path(report.location[0]), str(headline)))


@pytest.fixture
def ajar_render(request: pytest.FixtureRequest, tmp_path: Path) -> Callable[..., Path]:
    """`ajar_render(scene, *arguments)` renders an image and returns its path."""

    def render(scene: str | Path, *arguments: str, name: str = "new.exr") -> Path:
        output = tmp_path / name
        command = [ajar(request.config.getoption("--ajar-binary")), "render", str(scene), "-o", str(output)]
        try:
            run([*command, "--quiet", *arguments], timeout=1200)
        except RenderError as error:
            pytest.fail(str(error), pytrace=False)
        return output

    return render


@pytest.fixture
def ajar_compare(request: pytest.FixtureRequest) -> Callable[..., Verdict]:
    """`ajar_compare(new, reference, **limits)` fails the test unless the images show the same."""

    def check(new: str | Path, reference: str | Path, **limits: object) -> Verdict:
        settings = replace(Settings(), **limits)  # type: ignore[arg-type]
        verdict = compare(new, reference, settings)
        if verdict.outcome is not Outcome.PASS:
            test = f"{request.path.stem}-{request.node.name}"
            name = "".join(c if c.isalnum() or c in "-_" else "-" for c in test)
            folder = artifacts_of(request.config).keep(name, verdict, settings, f"ajar-compare {new} {reference}")
            request.node.user_properties.append(("ajar", verdict.headline()))
            pytest.fail(str(CaseFailedError(f"{verdict.text()}\nmore in {folder}")), pytrace=False)
        return verdict

    return check
