"""The pytest plug-in: every folder in tests/images that holds a scene is a test.

`pytest` renders each case and compares it with its reference; `pytest --ajar-update` makes references anew and a page
to review them. Cases can run in parallel (`pytest -n 4`): each writes only into its own folder of artifacts.
`ajar_tools.fixtures` does the same for tests written in Python.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from ajar_tools.artifacts import artifacts_of
from ajar_tools.cases import CONFIG, REFERENCE, SCENE, is_case, read_case
from ajar_tools.image_item import ImageItem
from ajar_tools.junit import DIFFERS, annotation
from ajar_tools.settings import SettingsError, checked

pytest_plugins = ["ajar_tools.fixtures"]

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
    try:
        checked("alpha", config.getoption("--ajar-alpha"), SUITE_ALPHA, "--ajar-alpha")
    except SettingsError as error:
        raise pytest.UsageError(str(error)) from error


def is_worker(config: pytest.Config) -> bool:
    """Whether this is one of pytest-xdist's processes."""
    return hasattr(config, "workerinput")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """A case is collected by its compare.toml, or by its scene.toml where it has none."""
    folder = file_path.parent
    if file_path.name not in (SCENE, CONFIG) or not is_case(folder):
        return None
    if file_path.name == SCENE and (folder / CONFIG).exists():
        return None
    if folder.parent.resolve() not in homes(parent.config):
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


def homes(config: pytest.Config) -> set[Path]:
    """The folders whose subfolders are cases."""
    bases = {config.rootpath, Path(config.invocation_params.dir)}
    return {(base / name).resolve() for base in bases for name in config.getini("ajar_images")}


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Cases are cases whatever they are called, though pytest passes over folders called build or dist."""
    return False if collection_path.parent.resolve() in homes(config) and is_case(collection_path) else None


def check_orphans(config: pytest.Config) -> None:
    """Refuses references that no case belongs to: what they guarded would be lost in silence.

    Raises:
        UsageError: names them.
    """
    references = [path for home in sorted(homes(config)) for path in sorted(home.glob(f"*/{REFERENCE}"))]
    orphans = [str(path) for path in references if not is_case(path.parent)]
    if orphans:
        what = f"have neither {SCENE} nor {CONFIG} beside them"
        raise pytest.UsageError(f"references without a case ({what}): {', '.join(orphans)}")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Divides the suite's probability of a false alarm by its cases (Bonferroni)."""
    check_orphans(config)
    cases = [item for item in items if isinstance(item, ImageItem)]
    for name, count in Counter(item.case.name for item in cases).items():
        if count > 1:
            raise pytest.UsageError(f"{count} cases are called {name}, and each needs a folder of artifacts of its own")
    for item in cases:
        item.prepare(artifacts_of(config), config.getoption("--ajar-alpha") / len(cases))


def asks_for_cases(config: pytest.Config) -> bool:
    """Whether what pytest was asked for has to do with folders of cases; else what an earlier run left stays."""
    asked = [(config.invocation_params.dir / argument.split("::")[0]).resolve() for argument in config.args]
    return any(path in (home, *home.parents) or home in path.parents for path in asked for home in homes(config))


def pytest_sessionstart(session: pytest.Session) -> None:
    """Removes the artifacts of the run before; with pytest-xdist, before the first of its processes starts."""
    config = session.config
    if is_worker(config) or config.option.collectonly or not asks_for_cases(config):
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
            told = {name: str(value) for name, value in report.user_properties}
            if "ajar" in told:
                title = told.get("ajar-title", DIFFERS)
                terminalreporter.write_line(annotation(Path(report.location[0]), told["ajar"], title))
