"""The page of `ajar watch` in a real browser: it follows edits of files and makes its own."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from watching import SCENE, Watch, material, painted, studio, swatch

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
PATIENCE = 60_000
# Mean of red, green and blue in a part of the canvas: left, top, right, bottom from 0 to 1.
MEAN = """([x0, y0, x1, y1]) => {
    const c = document.getElementById("canvas");
    const copy = new OffscreenCanvas(c.width, c.height).getContext("2d");
    copy.drawImage(c, 0, 0);
    const [x, y] = [Math.round(x0 * c.width), Math.round(y0 * c.height)];
    const { data } = copy.getImageData(x, y, Math.round((x1 - x0) * c.width), Math.round((y1 - y0) * c.height));
    const sum = [0, 0, 0];
    data.forEach((value, i) => { if (i % 4 < 3) sum[i % 4] += value; });
    return sum.map((value) => value / (data.length / 4));
}"""
ALL = [0, 0, 1, 1]
MIDDLE = [0.4, 0.4, 0.6, 0.6]


class Bench:
    """A folder with a scene, the program that watches it, and its page."""

    def __init__(self, folder: Path, browser: Any) -> None:
        self.folder, self.browser, self.scene = folder, browser, studio(folder)
        self.problems: list[str] = []
        self.start()
        self.page = self.open()

    def start(self, *arguments: str) -> None:
        self.watch = Watch(self.scene, *arguments, "--port", str(PORT), state=self.folder)
        self.url = self.watch.url()

    def open(self) -> Any:
        page = self.browser.new_page(viewport={"width": 1280, "height": 720})
        page.set_default_timeout(PATIENCE)
        page.on("pageerror", lambda error: self.problems.append(str(error)))
        page.on("request", lambda request: self.note(request.url))
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
        (page or self.page).wait_for_function("() => document.getElementById('canvas').dataset.width === '320'")
        (page or self.page).wait_for_timeout(100)

    def image(self) -> int:
        return int(self.page.evaluate("document.body.dataset.image"))

    def mean(self, part: list[float] = ALL) -> list[float]:
        self.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return list(self.page.evaluate(MEAN, part))

    def changed(self, act: Callable[[], object]) -> None:
        """Does something and waits for the image that comes of it."""
        image = self.image()
        act()
        self.done(image + 1)


def free_port() -> int:
    import socket

    with socket.socket() as it:
        it.bind(("127.0.0.1", 0))
        return int(it.getsockname()[1])


PORT = free_port()


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    if CHROMIUM is None:
        pytest.skip("there is no chromium (Debian: apt-get install chromium)")
    if "AJAR_BIN" not in os.environ:
        pytest.skip("AJAR_BIN names no program")
    sync_api = pytest.importorskip("playwright.sync_api")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        bench = Bench(tmp_path_factory.mktemp("watch"), browser)
        yield bench
        browser.close()
        assert bench.watch.end() == 0


def test_the_image_is_there_without_errors_and_without_the_network(bench: Bench) -> None:
    assert min(bench.mean(MIDDLE)) > 20
    assert bench.page.inner_text("#phase") == "done"
    assert "320×200, 8 samples a pixel" in bench.page.inner_text("#numbers")
    assert bench.problems == []


def test_an_edit_of_a_file_is_seen(bench: Bench) -> None:
    before = bench.mean(MIDDLE)
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.7 0.05 0.05")))
    after = bench.mean(MIDDLE)
    assert after[0] / after[1] > 1.5 * before[0] / before[1]
    assert "box.mtl" in bench.page.inner_text("#changed")


def test_exposure_and_tone_map_change_what_is_seen_alone(bench: Bench) -> None:
    before, image = bench.mean(), bench.image()
    bench.page.keyboard.press("]")
    bench.page.keyboard.press("]")
    assert bench.page.inner_text("#exposure-value") == "+0.5 EV"
    assert sum(bench.mean()) > sum(before)
    bench.page.keyboard.press("0")
    assert bench.mean() == before
    seen = set()
    for curve in ["aces", "neutral", "srgb", "false", "agx"]:
        bench.page.select_option("#tonemap", curve)
        seen.add(tuple(bench.mean()))
    assert len(seen) == 5
    assert bench.mean() == before
    assert bench.image() == image


def test_the_pixel_under_the_pointer_is_told(bench: Bench) -> None:
    box = bench.page.locator("#canvas").bounding_box()
    bench.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    bench.page.wait_for_function("() => document.getElementById('probe').innerText.includes('clay')")
    text = bench.page.inner_text("#probe")
    # The middle of an odd number of screen pixels is on either side.
    assert re.match(r"\((159|160), (99|100)\)", text)
    assert "±" in text
    # The front of the box, three quarters of the way to where the camera looks.
    assert re.search(r"4\.0\d+ m away, normal 0\.00 0\.00 1\.00", text)


def test_a_broken_edit_shows_where_and_the_image_stays(bench: Bench) -> None:
    before = bench.mean(MIDDLE)
    bench.scene.write_text(SCENE.replace("illuminance = 10", "illuminance = = 10"))
    bench.page.wait_for_selector("#banner:not([hidden])")
    assert "scene.toml:14:" in bench.page.inner_text("#banner")
    assert bench.mean([0.45, 0.5, 0.55, 0.6]) != [0, 0, 0]
    bench.changed(lambda: bench.scene.write_text(SCENE.replace("illuminance = 10", "illuminance = 20")))
    assert bench.page.is_hidden("#banner")
    assert sum(bench.mean(MIDDLE)) > sum(before)


def test_what_the_camera_sees_first_is_shown_and_follows(bench: Bench) -> None:
    image = bench.mean(MIDDLE)
    seen = {tuple(image)}
    for name in ["albedo", "normal", "geometric_normal", "depth", "position", "material_id", "object_id", "variance"]:
        bench.page.select_option("#layer", name)
        bench.page.wait_for_function(f"() => (document.body.dataset.shown ?? '').startsWith('{name} ')")
        seen.add(tuple(bench.mean(MIDDLE)))
    # A box is flat, and it is alone: both normals are the same, and both numbers.
    assert len(seen) == 7
    bench.page.select_option("#layer", "albedo")
    bench.page.wait_for_function("() => (document.body.dataset.shown ?? '').startsWith('albedo ')")
    before = bench.mean(MIDDLE)
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.1 0.5 0.1")))
    bench.page.wait_for_function(f"() => document.body.dataset.shown === 'albedo {bench.image()} 0'")
    after = bench.mean(MIDDLE)
    assert after[1] / after[0] > 1.5 * before[1] / before[0]
    # Albedos are no light: exposure leaves them.
    bench.page.keyboard.press("]")
    assert bench.mean(MIDDLE) == after
    bench.page.keyboard.press("0")
    bench.page.focus("#canvas")
    bench.page.select_option("#layer", "variance")
    bench.page.focus("#canvas")
    bench.page.keyboard.press("v")
    assert bench.page.evaluate("document.getElementById('layer').value") == ""
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.7 0.05 0.05")))


def test_images_of_before_are_compared(bench: Bench) -> None:
    left, right = [0.3, 0.4, 0.45, 0.6], [0.55, 0.4, 0.7, 0.6]
    now = [bench.mean(left), bench.mean(right)]
    bench.page.keyboard.press("w")
    bench.page.wait_for_function("() => document.body.dataset.mode === 'wipe'")
    assert bench.page.locator("#snapshots button").count() >= 1
    assert bench.mean(left) != now[0]
    assert bench.mean(right) == now[1]
    bench.page.keyboard.press("b")
    assert bench.mean(right) != now[1]
    bench.page.keyboard.press("d")
    assert sum(bench.mean()) > 0
    bench.page.keyboard.press("d")
    assert [bench.mean(left), bench.mean(right)] == now


def test_stop_and_continue(bench: Bench) -> None:
    bench.page.keyboard.press(" ")
    bench.page.wait_for_function("() => document.body.dataset.phase === 'rendering'")
    bench.page.keyboard.press(" ")
    bench.page.wait_for_function("() => document.body.dataset.phase === 'stopped'")
    samples = bench.page.inner_text("#numbers").split(", ")[1]
    assert int(samples.split()[0]) >= 8
    bench.page.keyboard.press("n")
    bench.done(bench.image())


def test_a_region_is_rendered_alone(bench: Bench) -> None:
    box = bench.page.locator("#canvas").bounding_box()
    at = [(box["x"] + box["width"] * f, box["y"] + box["height"] * f) for f in (0.4, 0.6)]
    bench.page.keyboard.press("r")
    bench.page.mouse.move(*at[0])
    bench.page.mouse.down()
    bench.page.mouse.move(*at[1], steps=4)
    bench.page.mouse.up()
    bench.page.wait_for_function("() => document.body.dataset.region !== ''")
    bench.done(bench.image())
    x0, y0, x1, y1 = (int(n) for n in bench.page.evaluate("document.body.dataset.region").split(","))
    assert 0 < x0 < x1 < 320
    assert 0 < y0 < y1 < 200
    bench.page.keyboard.press("a")
    bench.page.wait_for_function("() => document.body.dataset.region === ''")
    bench.done(bench.image())


def test_a_material_is_changed_and_the_change_saved_beside_the_scene(bench: Bench) -> None:
    asset = (bench.folder / "box.mtl").read_text()
    before = bench.mean(MIDDLE)
    bench.changed(lambda: bench.page.fill("#material input[type=color]", "#10c020"))
    after = bench.mean(MIDDLE)
    assert after[1] / after[0] > 2 * before[1] / before[0]
    assert "[material.clay]" in bench.page.inner_text("#edits")
    bench.page.click("#save")
    bench.page.wait_for_function("() => document.getElementById('saved').innerText.includes('look.toml')")
    layer = (bench.folder / "look.toml").read_text()
    assert layer.startswith('extends = "scene.toml"')
    assert "base_color" in layer
    assert (bench.folder / "box.mtl").read_text() == asset


def test_everything_is_clay_until_it_is_not(bench: Bench) -> None:
    (bench.folder / "box.mtl").write_text(material("0.1 0.6 0.1"))
    bench.changed(lambda: bench.scene.write_text(SCENE))
    red, green, blue = bench.mean(MIDDLE)
    assert green > 1.2 * max(red, blue)
    bench.changed(lambda: bench.page.keyboard.press("m"))
    red, green, blue = bench.mean(MIDDLE)
    assert max(red, green, blue) - min(red, green, blue) < 3
    # No file says it.
    assert bench.page.inner_text("#edits") == "None."
    bench.changed(lambda: bench.page.click("#clay"))
    red, green, blue = bench.mean(MIDDLE)
    assert green > 1.2 * max(red, blue)


def test_what_cannot_be_is_taken_back(bench: Bench) -> None:
    edits = bench.page.inner_text("#edits")
    bench.page.fill("#material input[type=number][data-key=roughness]", "7")
    bench.page.wait_for_selector("#banner:not([hidden])")
    assert "roughness" in bench.page.inner_text("#banner")
    assert bench.page.inner_text("#edits") == edits
    bench.changed(lambda: bench.page.fill("#material input[type=number][data-key=roughness]", "0.9"))
    assert bench.page.is_hidden("#banner")


def test_the_camera_is_moved_with_the_pointer(bench: Bench) -> None:
    before = bench.mean(ALL)
    box = bench.page.locator("#canvas").bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    bench.page.focus("#canvas")
    bench.page.keyboard.press("c")
    assert bench.page.evaluate("document.getElementById('canvas').dataset.tool") == "camera"
    bench.page.mouse.move(*middle)

    def turn() -> None:
        bench.page.mouse.down()
        bench.page.mouse.move(middle[0] + 120, middle[1] + 20, steps=3)
        bench.page.mouse.up()

    bench.changed(turn)
    bench.page.keyboard.press("c")
    assert bench.mean(ALL) != before
    assert "[[camera]]" in bench.page.inner_text("#edits")
    bench.changed(lambda: bench.page.click("#revert"))
    assert bench.page.inner_text("#edits") == "None."


@pytest.mark.parametrize(
    ("write", "offered", "green"),
    [
        (swatch, ["as the file shows", "Red", "Green"], "Green"),
        (painted, ["Green", "Red"], "/Box:paint=Green"),
    ],
)
def test_a_variant_is_chosen_and_saved(
    bench: Bench, write: Callable[[Path], Path], offered: list[str], green: str
) -> None:
    bench.changed(lambda: bench.scene.write_text(SCENE.replace("box.obj", write(bench.folder).name)))
    before = bench.mean(MIDDLE)
    assert bench.page.locator("#variants option").all_inner_texts() == offered
    bench.changed(lambda: bench.page.select_option("#variants select", label="Green"))
    after = bench.mean(MIDDLE)
    assert after[1] / after[0] > 2 * before[1] / before[0]
    assert f'variant = ["{green}"]' in bench.page.inner_text("#edits")
    bench.page.click("#save")
    bench.page.wait_for_function("() => document.getElementById('saved').innerText.includes('look.toml')")
    shown = [os.environ["AJAR_BIN"], "inspect", str(bench.folder / "look.toml")]
    environment = {"AJAR_USD_PYTHON": sys.executable, **os.environ}
    assert green in subprocess.run(shown, check=True, capture_output=True, text=True, env=environment).stdout
    (bench.folder / "look.toml").unlink()
    bench.changed(lambda: bench.page.click("#revert"))
    assert bench.mean(MIDDLE) == before
    bench.changed(lambda: bench.scene.write_text(SCENE))
    assert bench.page.is_hidden("#variants-section")


def test_notes_are_no_errors(bench: Bench) -> None:
    # A colour that no surface can have is bounded, with a warning; then something that is wrong.
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.6 0.6 0.6") + "disp bumps.png\n"))
    assert bench.page.is_hidden("#banner")
    assert bench.page.is_visible("#notes-section")
    bench.page.click("#notes-title")
    assert "disp" in bench.page.inner_text("#notes")
    bench.scene.write_text(SCENE.replace("spp = 8", "spp = 0"))
    bench.page.wait_for_selector("#banner:not([hidden])")
    assert bench.page.locator("#banner p").count() == 1
    assert "disp" not in bench.page.inner_text("#banner")
    (bench.folder / "box.mtl").write_text(material("0.6 0.6 0.6"))
    bench.changed(lambda: bench.scene.write_text(SCENE))
    assert bench.page.is_hidden("#banner")


def test_a_tablet_has_all_of_it(bench: Bench) -> None:
    context = bench.browser.new_context(viewport={"width": 768, "height": 1024}, has_touch=True)
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    page.goto(bench.url)
    bench.done(1, page)
    for name in ["run", "help-button", "layer", "exposure", "materials", "lights", "save"]:
        page.locator(f"#{name}").scroll_into_view_if_needed()
        assert page.locator(f"#{name}").is_visible()
    assert page.evaluate("document.documentElement.scrollWidth") == 768
    box = page.locator("#canvas").bounding_box()
    assert box["width"] == 768
    assert box["height"] > 400
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.touchscreen.tap(*middle)
    page.wait_for_function("() => document.getElementById('probe').innerText.includes('clay')")
    touch = context.new_cdp_session(page)
    zoom = "Number(document.getElementById('canvas').dataset.zoom)"
    before = page.evaluate(zoom)
    for kind, apart in [("touchStart", 50), ("touchMove", 75), ("touchMove", 100), ("touchEnd", None)]:
        fingers = [] if apart is None else [{"x": middle[0] + side * apart, "y": middle[1]} for side in (-1, 1)]
        points = [{**finger, "id": i} for i, finger in enumerate(fingers)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    page.wait_for_function(f"() => {zoom} > 1.8 * {before}")
    context.close()


def test_several_pages_see_the_same_and_find_the_program_again(bench: Bench) -> None:
    other = bench.open()
    assert other.inner_text("#phase") == "done"
    assert bench.watch.end() == 0
    for page in (bench.page, other):
        page.wait_for_selector("#offline:not([hidden])")
    bench.start()
    for page in (bench.page, other):
        page.wait_for_selector("#offline", state="hidden")
        bench.done(1, page)
    other.close()
    assert min(bench.mean(MIDDLE)) > 20


def test_the_sheet_names_the_keys(bench: Bench) -> None:
    bench.page.keyboard.press("?")
    assert bench.page.is_visible("#help")
    assert "wipe" in bench.page.inner_text("#keys")
    bench.page.click("#help button")
    assert bench.problems == []
