"""The page of `ajar watch` in a real browser, for tests: a scene, the program that watches it, and what is seen."""

from __future__ import annotations

import base64
import io
import json
import math
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from browser import NoBrowserError, started
from watching import SCENE, Watch, studio

FLAGS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
PATIENCE = 60_000
# Size of the image.
WIDTH, HEIGHT = 320, 200
# Parts of the canvas: left, top, right, bottom from 0 to 1.
ALL = [0, 0, 1, 1]
MIDDLE = [0.4, 0.4, 0.6, 0.6]

Pixels = npt.NDArray[np.int16]


def decoded(png: bytes) -> Pixels:
    """Rows of red, green and blue, 0 to 255."""
    from PIL import Image

    with Image.open(io.BytesIO(png)) as image:
        return np.asarray(image.convert("RGB"), dtype=np.int16)


class Bench:
    """A folder with a scene, the program that watches it, and its page."""

    def __init__(self, folder: Path, browser: Any) -> None:
        self.folder, self.browser, self.scene = folder, browser, studio(folder)
        self.problems: list[str] = []
        self.port = free_port()
        self.start()
        self.page = self.open()

    def start(self, *arguments: str) -> None:
        self.watch = Watch(self.scene, *arguments, "--port", str(self.port), state=self.folder)
        self.url = self.watch.url()

    def open(self, before: Callable[[Any], object] = lambda _page: None, **options: Any) -> Any:
        """Another page; `before` is done with it before it loads."""
        page = self.browser.new_page(**{"viewport": {"width": 1280, "height": 720}, **options})
        page.set_default_timeout(PATIENCE)
        page.on("pageerror", lambda error: self.problems.append(str(error)))
        page.on("request", lambda request: self.note(request.url))
        before(page)
        page.goto(self.url)
        self.done(1, page)
        return page

    def note(self, url: str) -> None:
        if not url.startswith((self.url, self.url.replace("http:", "ws:"), "data:", "blob:")):
            self.problems.append(url)

    def done(self, image: int, page: Any = None) -> None:
        """Waits until an image of at least this number is finished and drawn."""
        found = f"() => document.body.dataset.phase === 'done' && Number(document.body.dataset.image) >= {image}"
        (page or self.page).wait_for_function(found)
        (page or self.page).wait_for_function(f"() => document.getElementById('canvas').dataset.width === '{WIDTH}'")
        (page or self.page).wait_for_timeout(100)

    def reset(self) -> None:
        """The scene as at the beginning, nothing changed on the page, and the page as when it is opened."""
        self.page.reload()
        self.page.wait_for_function("() => document.body.dataset.link === 'open' && document.body.dataset.image > 0")
        if self.page.is_enabled("#revert"):
            self.page.click("#revert")
            self.page.wait_for_function("() => revert.disabled")
        (self.folder / "look.toml").unlink(missing_ok=True)
        studio(self.folder)
        # A comment of its own makes it another file, so that an image of it comes for certain.
        self.changed(lambda: self.scene.write_text(f"# {self.image()}\n{SCENE}"))

    def image(self) -> int:
        return int(self.page.evaluate("document.body.dataset.image"))

    def seen(self, part: list[float] = ALL, page: Any = None) -> Pixels:
        """Pixels of a part of the canvas."""
        page = page or self.page
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        url = page.evaluate("document.getElementById('canvas').toDataURL()")
        pixels = decoded(base64.b64decode(url.partition(",")[2]))
        height, width, _ = pixels.shape
        x0, x1 = (round(x * width) for x in part[::2])
        y0, y1 = (round(y * height) for y in part[1::2])
        return pixels[y0:y1, x0:x1]

    def mean(self, part: list[float] = ALL, page: Any = None) -> list[float]:
        """Mean of red, green and blue there."""
        return [float(x) for x in self.seen(part, page).mean(axis=(0, 1))]

    def saved(self) -> Pixels:
        """What the page saves as PNG."""
        with self.page.expect_download() as download:
            self.page.keyboard.press("s")
        return decoded(Path(download.value.path()).read_bytes())

    def at(self, x: float, y: float, page: Any = None) -> tuple[float, float]:
        """A point of the canvas, given from 0 to 1, on the page."""
        box = (page or self.page).locator("#canvas").bounding_box()
        return box["x"] + box["width"] * x, box["y"] + box["height"] * y

    def drag(self, start: tuple[float, float], end: tuple[float, float], button: str = "left") -> None:
        """From point to point of the canvas, given from 0 to 1."""
        ends = self.at(*start), self.at(*end)
        self.page.mouse.move(*ends[0])
        self.page.mouse.down(button=button)
        self.page.mouse.move(*ends[1], steps=4)
        self.page.mouse.up(button=button)

    def changed(self, act: Callable[[], object]) -> None:
        """Does something and waits for the image that comes of it."""
        image = self.image()
        act()
        self.done(image + 1)

    def copied(self, act: Callable[[], object]) -> str:
        """What is in the clipboard after doing something."""
        self.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        # What an earlier copy said may still stand there.
        self.page.evaluate("() => (document.getElementById('said').innerText = '')")
        act()
        self.page.wait_for_function("() => document.getElementById('said').innerText === 'Copied.'")
        return str(self.page.evaluate("navigator.clipboard.readText()"))


def telling(
    change: Callable[[dict[str, Any]], object] = lambda _document: None,
    spoil: Callable[[bytearray], object] = lambda _part: None,
) -> Callable[[Any], None]:
    """For `open`: the page hears each document of the program as `change` leaves it, and each part as `spoil` does."""

    def route(socket: Any) -> None:
        server = socket.connect_to_server()

        def hand_on(message: str | bytes) -> None:
            if isinstance(message, str):
                document = json.loads(message)
                change(document)
                message = json.dumps(document)
            else:
                part = bytearray(message)
                spoil(part)
                message = bytes(part)
            socket.send(message)

        server.on_message(hand_on)

    return lambda page: page.route_web_socket("**/socket", route)


def origin(canvas: int, image: int) -> int:
    """Where an image begins that is in the middle of a canvas, a pixel for a pixel."""
    return math.floor((canvas - image) / 2 + 0.5)


def free_port() -> int:
    import socket

    with socket.socket() as it:
        it.bind(("127.0.0.1", 0))
        return int(it.getsockname()[1])


@contextmanager
def benched(folder: Path) -> Iterator[Bench]:
    """A bench in this folder; skips the test where there is no browser or no program."""
    if "AJAR_BIN" not in os.environ:
        pytest.skip("AJAR_BIN names no program")
    with ExitStack() as stack:
        try:
            browser = stack.enter_context(started(*FLAGS))
        except NoBrowserError as error:
            pytest.skip(str(error))
        bench = Bench(folder, browser)
        yield bench
        assert bench.problems == []
    assert bench.watch.end() == 0
