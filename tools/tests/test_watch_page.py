"""The page of `ajar watch` in a real browser: it follows files and the program, and says how things stand."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np
import pytest
from live_page import HEIGHT, MIDDLE, PATIENCE, WIDTH
from watching import SCENE, material

if TYPE_CHECKING:
    from live_page import Bench


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


def test_a_broken_edit_shows_where_and_the_image_stays(bench: Bench) -> None:
    before = bench.mean(MIDDLE)
    bench.scene.write_text(SCENE.replace("illuminance = 10", "illuminance = = 10"))
    bench.page.wait_for_selector("#banner:not([hidden])")
    assert "scene.toml:14:" in bench.page.inner_text("#banner")
    # The banner takes of the canvas, and the image is fitted into what is left.
    assert bench.mean(MIDDLE) == pytest.approx(before, abs=3)
    bench.changed(lambda: bench.scene.write_text(SCENE.replace("illuminance = 10", "illuminance = 20")))
    assert bench.page.is_hidden("#banner")
    assert sum(bench.mean(MIDDLE)) > sum(before)


def samples(bench: Bench) -> int:
    return int(bench.page.inner_text("#numbers").split(", ")[1].split()[0])


def test_stop_and_continue(bench: Bench) -> None:
    more = "(least) => Number(document.getElementById('numbers').innerText.split(', ')[1].split(' ')[0]) > least"
    bench.page.keyboard.press(" ")
    bench.page.wait_for_function(more, arg=samples(bench))
    bench.page.keyboard.press(" ")
    bench.page.wait_for_function("() => document.body.dataset.phase === 'stopped'")
    stopped, image = samples(bench), bench.seen()
    bench.page.wait_for_timeout(1000)
    assert samples(bench) == stopped
    assert np.array_equal(bench.seen(), image)
    bench.page.keyboard.press(" ")
    bench.page.wait_for_function(more, arg=stopped)
    bench.page.keyboard.press("n")
    bench.done(bench.image())
    assert samples(bench) == 8


def test_a_region_is_rendered_alone(bench: Bench) -> None:
    bench.page.keyboard.press("r")
    bench.drag((0.4, 0.4), (0.6, 0.6))
    bench.page.wait_for_function("() => document.body.dataset.region !== ''")
    bench.done(bench.image())
    x0, y0, x1, y1 = (int(n) for n in bench.page.evaluate("document.body.dataset.region").split(","))
    assert 0 < x0 < x1 < WIDTH
    assert 0 < y0 < y1 < HEIGHT
    before = bench.saved()
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.05 0.05 0.7")))
    after = bench.saved()
    inside = np.zeros(before.shape[:2], dtype=bool)
    inside[y0:y1, x0:x1] = True
    assert np.array_equal(before[~inside], after[~inside])
    assert np.abs(before - after)[inside].max(axis=-1).min() > 20
    bench.page.keyboard.press("a")
    bench.page.wait_for_function("() => document.body.dataset.region === ''")
    bench.done(bench.image())
    assert np.abs(before - bench.saved())[~inside].max() > 20


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
    seen = bench.mean(MIDDLE)
    bench.page.keyboard.press("b")
    bench.page.wait_for_function("() => document.body.dataset.mode === 'before'")
    assert bench.watch.end() == 0
    for page in (bench.page, other):
        page.wait_for_selector("#offline:not([hidden])")
        assert "not there" in page.inner_text("#offline")
    bench.start()
    for page in (bench.page, other):
        page.wait_for_selector("#offline", state="hidden")
        bench.done(1, page)
    # Images of before were those of the other program.
    assert bench.page.evaluate("document.body.dataset.mode") == "now"
    assert bench.page.locator("#snapshots button").count() == 0
    assert bench.page.is_disabled("#wipe")
    assert bench.page.locator("button.on").count() == 0
    assert bench.mean(MIDDLE) == pytest.approx(seen, abs=3)
    assert bench.mean(MIDDLE, other) == bench.mean(MIDDLE)
    other.close()


def test_a_page_too_many_says_so_and_waits(bench: Bench) -> None:
    # One place is taken by the page of the bench.
    bench.page.evaluate("""async () => {
        const address = new URL("socket", location.href);
        address.protocol = "ws:";
        window.others = Array.from({ length: 15 }, () => new WebSocket(address));
        await Promise.all(window.others.map((it) => new Promise((done) => (it.onopen = done))));
    }""")
    page = bench.browser.new_page()
    page.set_default_timeout(PATIENCE)
    page.goto(bench.url)
    page.wait_for_function("() => document.getElementById('offline').innerText.startsWith('Too many pages')")
    bench.page.evaluate("window.others.forEach((it) => it.close())")
    page.wait_for_selector("#offline", state="hidden")
    bench.done(1, page)
    page.close()


def test_without_webgl_the_page_says_so(bench: Bench) -> None:
    page = bench.browser.new_page()
    page.set_default_timeout(PATIENCE)
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(bench.url)
    page.wait_for_selector("#banner:not([hidden])")
    assert "WebGL 2" in page.inner_text("#banner")
    assert page.inner_text("#phase") == "not shown"
    page.close()


def test_a_lost_graphics_card_comes_back_with_the_image(bench: Bench) -> None:
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.05 0.7 0.05")))
    bench.page.keyboard.press("w")
    bench.page.wait_for_function("() => document.body.dataset.mode === 'wipe'")
    before = bench.seen()
    bench.page.evaluate("""() => new Promise((done) => {
        const canvas = document.getElementById("canvas");
        const card = canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
        canvas.dataset.width = "";
        canvas.addEventListener("webglcontextrestored", done, { once: true });
        canvas.addEventListener("webglcontextlost", () => setTimeout(() => card.restoreContext()), { once: true });
        card.loseContext();
    })""")
    bench.done(1)
    for _ in range(100):
        if np.array_equal(bench.seen(), before):
            break
    assert np.array_equal(bench.seen(), before)
    bench.page.keyboard.press("w")


def test_the_sheet_names_the_keys(bench: Bench) -> None:
    bench.page.keyboard.press("?")
    assert bench.page.is_visible("#help")
    assert "wipe" in bench.page.inner_text("#keys")
    bench.page.click("#help button")
    assert bench.problems == []


def test_memory_of_the_page_does_not_grow(bench: Bench) -> None:
    inspector = bench.page.context.new_cdp_session(bench.page)

    def held() -> float:
        """Bytes that scripts and the page's elements hold, and what lies beside them."""
        inspector.send("HeapProfiler.collectGarbage")
        usage = inspector.send("Runtime.getHeapUsage")
        return float(sum(usage[key] for key in ("usedSize", "embedderHeapUsedSize", "backingStorageSize")))

    def edit(times: int) -> None:
        for number in range(times):
            color = f"0.7 {0.1 + 0.001 * number} 0.05"
            bench.changed(lambda color=color: (bench.folder / "box.mtl").write_text(material(color)))  # type: ignore[misc]

    # Many more than are run by default tell more (the list of images of before has at most 48).
    edits = int(os.environ.get("AJAR_PAGE_EDITS", "6"))
    edit(edits)
    frames, before = bench.page.evaluate("Number(canvas.dataset.frames)"), held()
    edit(edits)
    after = held()
    frames = bench.page.evaluate("Number(canvas.dataset.frames)") - frames
    print(f"{edits} edits, {frames} frames: {before / 1e6:.2f} MB, then {after / 1e6:.2f} MB")
    # One frame held for each edit would be 1.5 times this.
    assert after - before < edits * WIDTH * HEIGHT * 6 / 1.5
