"""A case: a folder with a scene, the reference image of it, and perhaps a `compare.toml`.

`compare.toml` holds limits (`ajar_tools.settings`) and, under `[render]`, how the image is made: `scene` (by default
scene.toml) and `arguments` for Ajar, or a whole `command` for another renderer, with places `{scene}` and `{output}`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from ajar_tools.settings import Settings, SettingsError, load, parse

SCENE, REFERENCE, CONFIG = "scene.toml", "reference.exr", "compare.toml"
# Seconds after which a render is stopped, unless the case allows more.
TIMEOUT = 1200
LONGEST = 1_000_000
# Lines of a renderer's complaint that are shown.
MOST_LINES = 30


class RenderError(Exception):
    """The image could not be made: the message says why."""


@dataclass(frozen=True)
class Case:
    """One image regression."""

    folder: Path
    settings: Settings
    scene: Path
    arguments: tuple[str, ...] = ()
    command: tuple[str, ...] = ()
    timeout: float = TIMEOUT

    @property
    def name(self) -> str:
        """The folder's name."""
        return self.folder.name

    @property
    def reference(self) -> Path:
        """The image that is right."""
        return self.folder / REFERENCE

    def render(self, output: Path, binary: str | None = None) -> None:
        """Makes the image.

        Raises:
            RenderError: the renderer is missing, fails, takes too long or writes nothing.
        """
        places = {"{scene}": str(self.scene), "{output}": str(output)}
        if self.command:
            command = [replaced(part, places) for part in self.command]
        else:
            command = [ajar(binary), "render", str(self.scene), "-o", str(output), "--quiet", *self.arguments]
        run(command, self.timeout)
        if not output.is_file():
            raise RenderError(f"{command[0]} reported success but did not write {output}")


def is_case(folder: Path) -> bool:
    """Whether a folder is one."""
    return (folder / SCENE).is_file() or (folder / CONFIG).is_file()


def read_case(folder: Path, base: Settings | None = None) -> Case:
    """The case in a folder, with `base` for all limits that it does not set.

    Raises:
        SettingsError: its compare.toml is wrong.
    """
    config = folder / CONFIG
    if not config.is_file():
        return Case(folder, base or Settings(), folder / SCENE)
    settings = load(config, base)
    table = parse(config).get("render", {})
    if not isinstance(table, dict) or not table.keys() <= {"scene", "arguments", "command", "timeout"}:
        raise SettingsError(f"{config}: [render] knows scene, arguments, command and timeout")
    timeout = table.get("timeout", TIMEOUT)
    if isinstance(timeout, bool) or not isinstance(timeout, (int, float)) or not 0 < timeout <= LONGEST:
        raise SettingsError(f"{config}: timeout must be a number of seconds, up to {LONGEST}")
    scene = table.get("scene", SCENE)
    if not isinstance(scene, str):
        raise SettingsError(f"{config}: scene must be a path")
    # Shown in messages, hence without detours.
    path = Path(os.path.normpath(folder / scene))
    return Case(folder, settings, path, words(table, "arguments", config), words(table, "command", config), timeout)


def words(table: dict[str, object], key: str, config: Path) -> tuple[str, ...]:
    """A list of strings."""
    value = table.get(key, [])
    if isinstance(value, list) and all(isinstance(word, str) and "\0" not in word for word in value):
        return tuple(value)
    raise SettingsError(f"{config}: {key} must be a list of strings")


def replaced(text: str, places: dict[str, str]) -> str:
    """The text with its places filled."""
    for place, value in places.items():
        text = text.replace(place, value)
    return text


def ajar(binary: str | None = None) -> str:
    """The program: as given, from AJAR_BIN, or on the search path.

    Raises:
        RenderError: there is none.
    """
    name = binary or os.environ.get("AJAR_BIN") or "ajar"
    found = shutil.which(name)
    if found is None:
        raise RenderError(f"there is no program {name}: put ajar on the PATH, or name it in AJAR_BIN")
    return found


def run(command: list[str], timeout: float) -> None:
    """Runs a renderer.

    Raises:
        RenderError: with the end of what it said.
    """
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=timeout)
    except subprocess.TimeoutExpired as error:
        raise RenderError(f"{command[0]} did not finish within {timeout:g} s") from error
    except OSError as error:
        raise RenderError(f"{command[0]} cannot be started: {error.strerror}") from error
    if done.returncode != 0:
        said = "\n".join((done.stderr or done.stdout).strip().splitlines()[-MOST_LINES:])
        raise RenderError(f"{' '.join(command)}\nended with exit code {done.returncode}:\n{said}")
