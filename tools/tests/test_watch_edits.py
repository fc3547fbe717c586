"""The page of `ajar watch` in a real browser: what can be changed on it."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from live_page import HEIGHT, MIDDLE
from watching import SCENE, material, painted, swatch

if TYPE_CHECKING:
    from live_page import Bench


@pytest.fixture(autouse=True)
def _from_the_beginning(bench: Bench) -> None:
    bench.reset()


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
    field = "#material input[type=number][data-key=roughness]"
    shown = bench.page.input_value(field)
    bench.page.fill(field, "7")
    bench.page.wait_for_selector("#banner:not([hidden])")
    # Who leaves the field sees what is.
    bench.page.locator(field).blur()
    bench.page.wait_for_function(
        "([field, shown]) => document.querySelector(field).value === shown", arg=[field, shown]
    )
    assert "roughness" in bench.page.inner_text("#banner")
    assert bench.page.inner_text("#edits") == edits
    bench.changed(lambda: bench.page.fill("#material input[type=number][data-key=roughness]", "0.9"))
    assert bench.page.is_hidden("#banner")


def test_a_light_is_changed(bench: Bench) -> None:
    before = bench.mean(MIDDLE)
    bench.page.select_option("#lights", "sun")
    bench.changed(lambda: bench.page.fill("#light input[type=number]", "2"))
    darker = bench.mean(MIDDLE)
    assert max(darker) < 0.9 * min(before)
    bench.changed(lambda: bench.page.fill("#light input[type=color]", "#ff2020"))
    red = bench.mean(MIDDLE)
    assert red[0] / red[1] > 1.1 * darker[0] / darker[1]
    # A wide sun casts soft shadows.
    sharp = bench.seen()
    bench.changed(lambda: bench.page.fill("#light input[type=number][data-key=angle]", "60"))
    assert np.abs(bench.seen() - sharp).max() > 20
    table = tomllib.loads(bench.page.inner_text("#edits"))["light"][0]
    assert (table["name"], table["illuminance"], table["angle"]) == ("sun", 2, 60)
    assert tomllib.loads(bench.copied(lambda: bench.page.click("#copy")))["light"][0] == table
    bench.changed(lambda: bench.page.click("#revert"))
    assert bench.mean(MIDDLE) == before


def test_it_is_looked_through_another_camera(bench: Bench) -> None:
    before = bench.seen()
    top = '[[camera]]\nname = "top"\nposition = [0, 9, 0.1]\ntarget = [0, 0, 0]\n'
    bench.changed(lambda: bench.scene.write_text(SCENE + top))
    assert bench.page.locator("#cameras option").all_inner_texts() == ["main", "top"]
    bench.changed(lambda: bench.page.select_option("#cameras", "top"))
    assert np.abs(bench.seen() - before).max() > 50
    assert tomllib.loads(bench.page.inner_text("#edits"))["render"]["camera"] == "top"
    bench.changed(lambda: bench.page.select_option("#cameras", "main"))
    assert np.array_equal(bench.seen(), before)
    bench.changed(lambda: bench.page.click("#revert"))
    bench.changed(lambda: bench.scene.write_text(SCENE))


def camera_of(bench: Bench) -> dict[str, Any]:
    return dict(tomllib.loads(bench.page.inner_text("#edits"))["camera"][0])


def test_the_camera_is_moved_with_the_pointer(bench: Bench) -> None:
    before = bench.seen()
    bench.page.focus("#canvas")
    bench.page.keyboard.press("c")
    assert bench.page.evaluate("document.getElementById('canvas').dataset.tool") == "camera"
    bench.changed(lambda: bench.drag((0.5, 0.5), (0.62, 0.53)))
    turned = camera_of(bench)
    assert turned["name"] == "main"
    # It turns about what is in the middle, the front of the box.
    assert turned["target"][2] == pytest.approx(1, abs=0.01)
    assert turned["position"][0] < 2.5
    assert np.abs(bench.seen() - before).max() > 50

    bench.page.keyboard.down("Shift")
    bench.changed(lambda: bench.drag((0.5, 0.5), (0.5, 0.75)))
    bench.page.keyboard.up("Shift")
    moved = camera_of(bench)
    by = [np.subtract(moved[key], turned[key]) for key in ("position", "target")]
    assert np.allclose(*by, atol=1e-4)
    # The image goes with the pointer: a quarter of its height, at the distance of the target, is what it moves by.
    distance = np.linalg.norm(np.subtract(turned["position"], turned["target"]))
    canvas = bench.page.evaluate("[canvas.clientWidth, canvas.clientHeight, Number(canvas.dataset.zoom)]")
    shown = canvas[1] / (HEIGHT * canvas[2])
    assert np.linalg.norm(by[0]) == pytest.approx(0.25 * shown * 2 * distance * math.tan(math.radians(20)), rel=0.02)

    bench.page.mouse.move(*bench.at(0.5, 0.5))
    bench.changed(lambda: bench.page.mouse.wheel(0, -200))
    nearer = camera_of(bench)
    assert nearer["target"] == pytest.approx(moved["target"], abs=1e-4)
    reach = np.linalg.norm(np.subtract(nearer["position"], nearer["target"]))
    assert reach == pytest.approx(distance * math.exp(-0.5), rel=0.01)

    bench.changed(lambda: bench.drag((0.5, 0.5), (0.5, 0.6), button="right"))
    assert np.linalg.norm(np.subtract(camera_of(bench)["position"], nearer["target"])) > 1.05 * reach
    bench.page.keyboard.press("c")
    bench.changed(lambda: bench.page.click("#revert"))
    assert bench.page.inner_text("#edits") == "None."
    assert np.array_equal(bench.seen(), before)


def test_a_camera_that_was_dropped_is_forgotten(bench: Bench) -> None:
    bench.page.focus("#canvas")
    bench.page.keyboard.press("c")
    places = []
    for _ in range(2):
        bench.changed(lambda: bench.drag((0.5, 0.5), (0.62, 0.53)))
        places.append(camera_of(bench)["position"])
        bench.changed(lambda: bench.page.click("#revert"))
    # Browsers may make one movement of several, which turns a little otherwise.
    assert places[1] == pytest.approx(places[0], abs=0.02)
    bench.page.keyboard.press("c")


def test_the_camera_is_copied_as_it_is(bench: Bench) -> None:
    text = bench.copied(lambda: bench.page.click("#copy-camera"))
    camera = tomllib.loads(text)["camera"][0]
    assert camera["name"] == "main"
    assert camera["position"] == [3, 2, 4]
    assert camera["yfov"] == pytest.approx(40)
    # It takes the place of the one in the file, and the image is the same.
    before = bench.seen()
    start, end = SCENE.index("[[camera]]"), SCENE.index("[[light]]")
    bench.changed(lambda: bench.scene.write_text(SCENE[:start] + text + SCENE[end:]))
    assert np.abs(bench.seen() - before).mean() < 1
    bench.changed(lambda: bench.scene.write_text(SCENE))


def test_a_camera_that_was_turned_in_the_file_is_taken_over(bench: Bench) -> None:
    turned = SCENE.replace("target = [0, 0, 0]", "target = [-1, 0, 0]")
    bench.changed(lambda: bench.scene.write_text(turned))
    text = bench.copied(lambda: bench.page.click("#copy-camera"))
    camera = tomllib.loads(text)["camera"][0]
    way = np.subtract(camera["target"], camera["position"])
    assert way / np.linalg.norm(way) == pytest.approx(np.array([-4, -2, -4]) / 6, abs=1e-4)
    bench.changed(lambda: bench.scene.write_text(SCENE))


def test_pages_from_elsewhere_copy_too(bench: Bench) -> None:
    # Over plain HTTP from another machine there is no such thing.
    gone = "Object.defineProperty(navigator, 'clipboard', { value: undefined })"
    page = bench.open(lambda page: page.add_init_script(gone))
    page.click("#copy-camera")
    page.wait_for_function("() => document.getElementById('said').innerText === 'Copied.'")
    page.evaluate("document.body.append(Object.assign(document.createElement('textarea'), { id: 'pasted' }))")
    page.focus("#pasted")
    page.keyboard.press("Control+v")
    assert page.input_value("#pasted").startswith("[[camera]]")
    page.close()


def test_an_orthographic_camera_sees_less_and_moves_sideways(bench: Bench) -> None:
    lens = "target = [0, 0, 0]\nhalf_height = 2"
    bench.changed(lambda: bench.scene.write_text(SCENE.replace("target = [0, 0, 0]", lens)))
    bench.page.focus("#canvas")
    bench.page.keyboard.press("c")
    bench.page.mouse.move(*bench.at(0.5, 0.5))
    bench.changed(lambda: bench.page.mouse.wheel(0, -200))
    nearer = camera_of(bench)
    assert nearer["half_height"] == pytest.approx(2 * math.exp(-0.5), rel=0.01)
    assert nearer["position"] == pytest.approx([3, 2, 4])

    bench.page.keyboard.down("Shift")
    bench.changed(lambda: bench.drag((0.5, 0.5), (0.5, 0.75)))
    bench.page.keyboard.up("Shift")
    moved = camera_of(bench)
    assert moved["half_height"] == nearer["half_height"]
    by = np.linalg.norm(np.subtract(moved["position"], nearer["position"]))
    canvas = bench.page.evaluate("[canvas.clientWidth, canvas.clientHeight, Number(canvas.dataset.zoom)]")
    shown = canvas[1] / (HEIGHT * canvas[2])
    assert by == pytest.approx(0.25 * shown * 2 * nearer["half_height"], rel=0.02)
    bench.page.keyboard.press("c")
    bench.changed(lambda: bench.page.click("#revert"))
    bench.changed(lambda: bench.scene.write_text(SCENE))


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
