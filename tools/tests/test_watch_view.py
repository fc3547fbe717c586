"""The page of `ajar watch` in a real browser: how images are looked at and compared."""

from __future__ import annotations

import math
import os
import re
import struct
import subprocess
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from live_page import HEIGHT, MIDDLE, WIDTH, decoded, origin, telling
from watching import material

if TYPE_CHECKING:
    from live_page import Bench


def test_exposure_and_tone_map_change_what_is_seen_alone(bench: Bench) -> None:
    before, image = bench.mean(), bench.image()
    bench.page.keyboard.press("]")
    bench.page.keyboard.press("]")
    assert bench.page.inner_text("#exposure-value") == "+0.5 EV"
    assert sum(bench.mean()) > sum(before)
    bench.page.keyboard.press("0")
    assert bench.mean() == before
    # Some keyboards have brackets behind AltGr or Option; other keys with Alt are the browser's.
    bench.page.keyboard.press("Alt+]")
    assert bench.page.inner_text("#exposure-value") == "+0.25 EV"
    bench.page.keyboard.press("Alt+0")
    assert bench.page.inner_text("#exposure-value") == "+0.25 EV"
    bench.page.keyboard.press("0")
    seen = set()
    for curve in ["aces", "neutral", "srgb", "false", "agx"]:
        bench.page.select_option("#tonemap", curve)
        seen.add(tuple(bench.mean()))
    assert len(seen) == 5
    assert bench.mean() == before
    assert bench.image() == image


@pytest.mark.parametrize("curve", ["agx", "aces", "neutral", "srgb"])
def test_tone_maps_are_those_of_the_program(bench: Bench, curve: str) -> None:
    image = bench.folder / "image.exr"
    render = [os.environ["AJAR_BIN"], "render", str(bench.scene), "-o", str(image), "--tone-map", curve]
    subprocess.run([*render, "--exposure", "0.5"], check=True, capture_output=True)
    bench.page.select_option("#tonemap", curve)
    bench.page.keyboard.press("]")
    bench.page.keyboard.press("]")
    shown = bench.saved()
    bench.page.keyboard.press("0")
    bench.page.select_option("#tonemap", "agx")
    made = decoded(image.with_suffix(".png").read_bytes())
    assert made.std() > 10
    assert np.abs(shown - made).max() <= 2


def test_a_pixel_is_a_pixel(bench: Bench) -> None:
    # What is left beside the image cannot be halved.
    size = bench.page.evaluate("[innerWidth - canvas.clientWidth, innerHeight - canvas.clientHeight]")
    bench.page.set_viewport_size({"width": 801 + size[0], "height": 601 + size[1]})
    bench.page.keyboard.press("1")
    canvas, image = bench.seen(), bench.saved()
    assert image.shape == (HEIGHT, WIDTH, 3)
    height, width, _ = canvas.shape
    assert (width - WIDTH) % 2 == 1
    assert (height - HEIGHT) % 2 == 1
    left, top = origin(width, WIDTH), origin(height, HEIGHT)
    assert np.array_equal(canvas[top : top + HEIGHT, left : left + WIDTH], image)
    bench.page.keyboard.press("f")
    bench.page.set_viewport_size({"width": 1280, "height": 720})


def test_the_image_is_moved_and_fitted(bench: Bench) -> None:
    zoom = "Number(document.getElementById('canvas').dataset.zoom)"
    bench.page.wait_for_function("() => canvas.width === canvas.clientWidth && canvas.clientWidth > 900")
    seen = bench.seen()
    fitted = bench.page.evaluate(zoom)
    # It stays fitted while nobody zooms or moves it.
    bench.page.set_viewport_size({"width": 900, "height": 600})
    bench.page.wait_for_function(f"() => {zoom} < {0.9 * fitted}")
    assert bench.page.evaluate(zoom) == pytest.approx(bench.seen().shape[1] / WIDTH)
    bench.page.set_viewport_size({"width": 1280, "height": 720})
    bench.page.wait_for_function(f"() => {zoom} === {fitted}")
    assert np.array_equal(bench.seen(), seen)
    bench.page.mouse.move(*bench.at(0.5, 0.5))
    bench.page.mouse.wheel(0, -400)
    bench.page.wait_for_function(f"() => {zoom} > 2 * {fitted}")
    near = bench.seen()
    bench.page.set_viewport_size({"width": 1281, "height": 720})
    assert bench.page.evaluate(zoom) > 2 * fitted
    bench.page.set_viewport_size({"width": 1280, "height": 720})
    bench.drag((0.5, 0.5), (0.6, 0.5))
    moved = bench.seen()
    by = round(moved.shape[1] * 0.1)
    assert np.abs(moved[:, 2 * by :] - near[:, by:-by]).mean() < 1
    bench.page.keyboard.press("f")
    assert np.array_equal(bench.seen(), seen)


def test_white_balance_warms_and_cools(bench: Bench) -> None:
    before = bench.mean(MIDDLE)
    bench.page.fill("#balance", "0.5")
    warm = bench.mean(MIDDLE)
    bench.page.fill("#balance", "-0.5")
    cool = bench.mean(MIDDLE)
    bench.page.fill("#balance", "0")
    assert warm[0] / warm[2] > 1.05 * before[0] / before[2] > 1.1 * cool[0] / cool[2]
    assert bench.mean(MIDDLE) == before


def test_keys_change_the_view(bench: Bench) -> None:
    curve = "document.getElementById('tonemap').value"
    bench.page.keyboard.press("t")
    assert bench.page.evaluate(curve) == "aces"
    bench.page.keyboard.press("l")
    assert bench.page.evaluate(curve) == "false"
    bench.page.keyboard.press("l")
    assert bench.page.evaluate(curve) == "agx"
    width = bench.seen().shape[1]
    bench.page.keyboard.press("p")
    assert bench.page.is_hidden("#panel")
    bench.page.wait_for_function(f"() => document.getElementById('canvas').width > {width + 200}")
    bench.page.keyboard.press("p")
    assert bench.page.is_visible("#panel")


def test_keys_work_after_menus_and_buttons(bench: Bench) -> None:
    is_focused = """(menu) => {
        menu.dispatchEvent(new Event("change", { bubbles: true }));
        return document.activeElement === menu;
    }"""
    for menu in ["#tonemap", "#layer", "#materials", "#lights"]:
        bench.page.click(menu)
        assert not bench.page.eval_on_selector(menu, is_focused)
    # Who goes about with keys stays where they are.
    bench.page.keyboard.press("Tab")
    bench.page.focus("#tonemap")
    assert bench.page.eval_on_selector("#tonemap", is_focused)
    bench.page.click("#fit")
    bench.page.keyboard.press("]")
    assert bench.page.inner_text("#exposure-value") == "+0.25 EV"
    bench.page.keyboard.press("0")
    image = bench.image()
    bench.page.focus("#help-button")
    bench.page.keyboard.press(" ")
    assert bench.page.is_visible("#help")
    bench.page.keyboard.press("Escape")
    assert bench.page.evaluate("document.body.dataset.phase") == "done"
    assert bench.image() == image


def test_the_scene_says_how_it_is_looked_at(bench: Bench) -> None:
    view = {"exposure": 1.0, "tone_map": "neutral"}
    page = bench.open(telling(lambda it: it.update(view=view) if it["type"] == "scene" else None))

    def shown() -> tuple[str, str]:
        return page.inner_text("#exposure-value"), page.input_value("#tonemap")

    assert shown() == ("+1 EV", "neutral")
    page.keyboard.press("t")
    page.keyboard.press("[")
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.2 0.5 0.5")))
    bench.done(bench.image(), page)
    # What somebody chose stays until the file says something else.
    assert shown() == ("+0.75 EV", "srgb")
    view["exposure"] = 2.0
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.6 0.6 0.6")))
    bench.done(bench.image(), page)
    assert shown() == ("+2 EV", "srgb")
    page.keyboard.press("[")
    page.keyboard.press("0")
    assert shown() == ("+2 EV", "srgb")
    page.close()


@pytest.mark.parametrize("width", [768, 1024, 1280])
def test_all_that_is_said_has_room(bench: Bench, width: int) -> None:
    told = {"noise": 0.0123, "worst_tile": 0.0456, "seconds": 3000, "seconds_left": 2000, "rejected": 12}
    told |= {"samples": 1234, "rounds": 9, "shown_for": ["box.mtl"]}
    size = {"width": width, "height": 768}
    page = bench.open(telling(lambda it: it.update(told) if it["type"] == "state" else None), viewport=size)
    told["phase"] = "rendering"
    bench.page.keyboard.press("n")
    page.wait_for_function("() => words.innerText.includes('about 33 min left')")
    assert "12 contributions were negative or not finite" in page.inner_text("#words")
    assert page.evaluate("(({ scrollWidth, clientWidth }) => scrollWidth <= clientWidth)(words)")
    assert page.evaluate("document.documentElement.scrollWidth") == width
    for name in ["words", "run", "help-button"]:
        box = page.locator(f"#{name}").bounding_box()
        assert 0 <= box["x"] < box["x"] + box["width"] <= width
    page.close()


def test_the_pixel_under_the_pointer_is_told(bench: Bench) -> None:
    # One round knows no error of its pixels: asked again until there are more.
    for _ in range(40):
        bench.page.mouse.move(*bench.at(0.5, 0.52))
        bench.page.mouse.move(*bench.at(0.5, 0.5))
        told = "() => /^.(159|160), (99|100).*clay/s.test(document.getElementById('probe').innerText)"
        bench.page.wait_for_function(told)
        text = bench.page.inner_text("#probe")
        if "±" in text:
            break
        bench.page.wait_for_timeout(250)
    # The middle of an odd number of screen pixels is on either side.
    assert re.match(r"\((159|160), (99|100)\)", text)
    assert "±" in text
    assert "object default" in text
    # The front of the box, three quarters of the way to where the camera looks.
    assert re.search(r"4\.0\d+ m away, normal 0\.00 0\.00 1\.00", text)
    bench.page.mouse.move(*bench.at(0.5, 0.51))
    bench.page.mouse.move(5, 5)
    bench.page.wait_for_timeout(500)
    assert bench.page.is_hidden("#probe")


def test_the_pixel_is_told_anew_while_the_pointer_rests(bench: Bench) -> None:
    bench.page.mouse.move(*bench.at(0.5, 0.5))
    bench.page.wait_for_function("() => document.getElementById('probe').innerText.includes('clay')")
    text = bench.page.inner_text("#probe")
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.1 0.2 0.3")))
    bench.page.wait_for_function("(text) => document.getElementById('probe').innerText !== text", arg=text)
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.6 0.6 0.6")))
    bench.page.mouse.move(5, 5)


def test_what_is_not_finite_is_told_so(bench: Bench) -> None:
    page = bench.open(telling(lambda it: it.update(value=[None, 1, 2]) if it["type"] == "probe" else None))
    page.mouse.move(*bench.at(0.5, 0.5, page))
    page.wait_for_function("() => document.getElementById('probe').innerText.includes('R not finite')")
    page.close()


def test_what_is_no_number_is_pink(bench: Bench) -> None:
    def spoil(part: bytearray) -> None:
        # The red of the first pixel of the first tile, behind the header of the part and the number of the tile.
        if struct.unpack_from("<I", part, 16) == (0,):
            struct.pack_into("<e", part, 20, math.nan)

    def pink(page: Any) -> int:
        return int((bench.seen(page=page) == [255, 0, 255]).all(axis=2).sum())

    page = bench.open(telling(spoil=spoil))
    zoom = page.evaluate("Number(canvas.dataset.zoom)")
    assert pink(bench.page) == 0
    assert pink(page) == pytest.approx(zoom**2, abs=2 * zoom + 1)
    page.close()


def test_what_the_camera_sees_first_is_shown_and_follows(bench: Bench) -> None:
    image = bench.mean(MIDDLE)
    seen = {tuple(image)}
    names = ["albedo", "normal", "geometric_normal", "depth", "position", "uv", "material_id", "object_id", "variance"]
    for name in names:
        bench.page.select_option("#layer", name)
        bench.page.wait_for_function(f"() => (document.body.dataset.shown ?? '').startsWith('{name} ')")
        seen.add(tuple(bench.mean(MIDDLE)))
    # A box is flat, and it is alone: both normals are the same, and both numbers. It has no texture coordinates.
    assert len(seen) == 8
    assert (0, 0, 0) in seen
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
    bench.changed(lambda: (bench.folder / "box.mtl").write_text(material("0.05 0.7 0.05")))
    now = [bench.mean(left), bench.mean(right)]
    bench.page.keyboard.press("w")
    bench.page.wait_for_function("() => document.body.dataset.mode === 'wipe'")
    assert "samples a pixel" in bench.page.inner_text("#snapshots button >> nth=0")
    before = bench.mean(left)
    assert before[1] < 0.9 * now[0][1]
    assert bench.mean(right) == now[1]
    bench.page.keyboard.press("b")
    assert bench.mean(right)[1] < 0.9 * now[1][1]
    bench.page.keyboard.press("d")
    difference = bench.mean([0.45, 0.45, 0.55, 0.55])
    assert max(difference) > 40
    assert bench.seen([0.02, 0.4, 0.1, 0.6]).max() == 0
    bench.page.keyboard.press("d")
    assert [bench.mean(left), bench.mean(right)] == now


def test_the_wipe_is_dragged(bench: Bench) -> None:
    bench.page.keyboard.press("w")
    bench.page.wait_for_function("() => document.body.dataset.mode === 'wipe'")
    part = [0.55, 0.4, 0.65, 0.6]
    now = bench.mean(part)
    box = bench.page.locator("#wiper").bounding_box()
    bench.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 100)
    bench.page.mouse.down()
    bench.page.mouse.move(*bench.at(0.66, 0.5), steps=3)
    bench.page.mouse.up()
    assert bench.mean(part)[1] < 0.9 * now[1]
    # What is saved is wiped at the same place of the image.
    wiped = bench.saved()
    bench.page.keyboard.press("w")
    width, zoom = bench.page.evaluate("[canvas.clientWidth, Number(canvas.dataset.zoom)]")
    edge = (0.66 * width - (width - WIDTH * zoom) / 2) / zoom
    differs = np.nonzero(np.abs(wiped - bench.saved()).max(axis=(0, 2)))[0]
    assert wiped.shape == (HEIGHT, WIDTH, 3)
    assert differs.max() == pytest.approx(edge, abs=2)
    assert bench.mean(part) == now


def test_an_image_of_before_is_seen_while_the_pointer_is_on_it(bench: Bench) -> None:
    now = bench.mean(MIDDLE)
    bench.page.hover("#snapshots button >> nth=0")
    bench.page.wait_for_function("() => document.body.dataset.peek > 0")
    assert bench.mean(MIDDLE)[1] < 0.9 * now[1]
    bench.page.mouse.move(*bench.at(0.01, 0.01))
    bench.page.wait_for_function("() => document.body.dataset.peek === ''")
    assert bench.mean(MIDDLE) == now
    # A click compares with it instead.
    bench.page.click("#snapshots button >> nth=0")
    bench.page.wait_for_function("() => document.body.dataset.mode === 'wipe'")
    assert bench.page.evaluate("document.body.dataset.peek") == ""
    bench.page.click("#wipe")
    assert bench.mean(MIDDLE) == now
