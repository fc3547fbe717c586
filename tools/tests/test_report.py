"""The report in a real browser: it draws what it says, without errors and without the network."""

import json
import re
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from ajar_tools import Settings, compare, read
from ajar_tools.report import write_report
from browser import NoBrowserError, started
from synthetic import file

# The sum of all colours on the canvas.
BRIGHTNESS = """() => {
    const c = document.getElementById("canvas");
    return c.getContext("2d").getImageData(0, 0, c.width, c.height).data.reduce((sum, v) => sum + v, 0);
}"""


def report(folder: Path, name: str = "new.exr") -> Path:
    """Of an image whose green block is too bright."""
    spoiled = file(seed=2)
    spoiled.pixels[40:48, 16:24, 1] *= 1.5
    reference = file(seed=1, rounds=64).write(folder / "reference.exr")
    verdict = compare(spoiled.write(folder / name), reference)
    path = folder / "report.html"
    write_report(path, verdict, Settings(), f"ajar-compare {name} reference.exr")
    return path


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with ExitStack() as stack:
        try:
            browser = stack.enter_context(started())
        except NoBrowserError as error:
            pytest.skip(str(error))
        yield browser


@pytest.fixture(scope="module")
def page(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return opened(browser, report(tmp_path_factory.mktemp("report")))


def opened(browser: Any, path: Path) -> Any:
    """The page, once it has drawn; what goes wrong on it is collected in `problems`."""
    page = browser.new_page(viewport={"width": 1280, "height": 900}, offline=True)
    page.problems = []
    page.on("pageerror", lambda error: page.problems.append(str(error)))
    page.on("request", lambda request: request.url.startswith("http") and page.problems.append(request.url))
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready=yes]", timeout=60_000)
    return page


def shown(page: Any) -> str:
    return page.get_attribute("#canvas", "data-shown")


def test_verdict_gates_and_command_are_there(page: Any) -> None:
    assert page.inner_text("#word") == "Different picture"
    assert "brighter in G" in page.inner_text("#reason")
    assert page.locator("#gates tbody tr").count() == 7
    assert page.locator("#gates td.fail").count() >= 1
    assert page.inner_text("#command") == "ajar-compare new.exr reference.exr"
    assert page.problems == []


def test_both_images_are_told_apart_by_what_they_are(page: Any) -> None:
    rows = page.locator("#about tbody tr").all_inner_texts()
    assert "rounds\t16\t64" in rows
    assert "seed\t2\t1" in rows


def test_thumbs_show_all_modes_at_once(page: Any) -> None:
    sums = page.evaluate(
        """() => [...document.querySelectorAll("#modes canvas")].map((c) =>
            c.getContext("2d").getImageData(0, 0, c.width, c.height).data.reduce((sum, v) => sum + v, 0))"""
    )
    assert len(sums) == 7
    assert sums[0] == sums[2]
    assert len(set(sums)) == 6


def test_b_blinks(page: Any) -> None:
    page.keyboard.press("b")
    for name in ("reference", "new"):
        page.wait_for_function(f"$('canvas').dataset.shown === '{name}' && $('left').textContent === '{name}'")
    page.keyboard.press("b")
    assert shown(page) == "new"


def test_holding_the_mouse_or_space_swaps(page: Any) -> None:
    page.keyboard.press("1")
    assert shown(page) == "new"
    new = page.evaluate(BRIGHTNESS)
    page.keyboard.down(" ")
    assert shown(page) == "reference"
    assert page.evaluate(BRIGHTNESS) != new
    page.keyboard.up(" ")
    page.hover("#frame")
    page.mouse.down()
    assert shown(page) == "reference"
    page.mouse.up()
    assert shown(page) == "new"


def test_exposure_brightens(page: Any) -> None:
    page.keyboard.press("3")
    assert page.is_enabled("#exposure")
    before = page.evaluate(BRIGHTNESS)
    page.fill("#exposure", "1.5")
    assert page.inner_text("#stops") == "+1.5 EV"
    assert page.evaluate(BRIGHTNESS) > before


def test_wipe_follows_the_pointer(page: Any) -> None:
    page.keyboard.press("2")
    box = page.locator("#frame").bounding_box()
    images = []
    for fraction in (0.2, 0.9):
        page.mouse.move(box["x"] + fraction * box["width"], box["y"] + 30)
        images.append(page.evaluate(BRIGHTNESS))
        line = page.locator("#line").bounding_box()
        # A pixel of the screen, not of the image.
        assert (line["x"] - box["x"], line["width"]) == pytest.approx((fraction * box["width"], 1), abs=1)
    assert images[0] != images[1]
    page.keyboard.press("3")
    assert not page.is_visible("#line")


def test_pixels_are_read_where_the_pointer_is(page: Any, tmp_path: Path) -> None:
    """Values are those of the file, but for the last digits, which a page does not hold."""
    box = page.locator("#frame").bounding_box()
    x, y = 20, 44
    page.mouse.move(box["x"] + (x + 0.5) * box["width"] / 96, box["y"] + (y + 0.5) * box["height"] / 72)
    text = page.inner_text("#pixel")
    assert text.startswith(f"pixel ({x}, {y})")
    spoiled, reference = read(report(tmp_path).with_name("new.exr")), read(tmp_path / "reference.exr")
    told = [float(word) for word in re.findall(r"\d\S*", text.split(")")[1])]
    expected = [*spoiled.color[y, x], *reference.color[y, x]]
    assert told == pytest.approx(expected, abs=float(max(expected)) / 200)


def test_all_numbers_are_those_of_the_gates(page: Any) -> None:
    page.click("summary")
    numbers = json.loads(page.inner_text("#numbers"))
    assert [gate["gate"] for gate in numbers][3:] == ["statistics", "variance", "flip", "numbers"]
    assert numbers[3]["numbers"]["block"] == [16, 40, 24, 48]


def test_the_command_is_copied(page: Any) -> None:
    page.evaluate("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    page.click("#copy")
    page.wait_for_function("document.getElementById('copy').textContent === 'copied'")
    assert page.evaluate("window.copied") == page.inner_text("#command")


@pytest.mark.parametrize("mode", ["difference", "significance", "flip"])
def test_maps_are_brightest_at_the_spoiled_block(mode: str, page: Any) -> None:
    page.click(f"button[data-mode={mode}]")
    assert shown(page) == mode
    assert page.is_visible("#scale")
    assert page.is_disabled("#exposure")
    colour = (
        """([x, y]) => Array.from(document.getElementById("canvas").getContext("2d").getImageData(x, y, 1, 1).data)"""
    )
    inside, outside = page.evaluate(colour, [20, 44]), page.evaluate(colour, [60, 20])
    if mode == "difference":
        assert inside[0] > inside[2]
    else:
        assert sum(inside) > sum(outside)


def test_the_block_is_framed_and_zoom_scales(page: Any) -> None:
    page.select_option("#zoom", "4")
    box = page.locator("#block").bounding_box()
    frame = page.locator("#frame").bounding_box()
    assert (box["x"] - frame["x"], box["width"]) == pytest.approx((64, 32), abs=1)


def reviewed(folder: Path, **changes: object) -> Path:
    """Of a reference that was made anew."""
    new = file(seed=2).write(folder / "new.exr")
    verdict = compare(new, file(seed=1, scale=1.2).write(folder / "old.exr"))
    path = folder / "report.html"
    write_report(path, replace(verdict, **changes), Settings(), "ajar-compare new.exr old.exr")
    return path


def test_a_change_that_is_meant_is_no_failure(browser: Any, tmp_path: Path) -> None:
    page = opened(browser, reviewed(tmp_path, review="changed reference"))
    assert page.inner_text("#word") == "Changed reference"
    assert page.get_attribute("#head", "class") == "review"
    assert page.locator("td.fail").count() == 0
    assert "differs" in page.inner_text("#gates")
    page.keyboard.press("4")
    assert page.inner_text("#left") == page.inner_text("#theirs") == "old reference"
    assert page.problems == []


def test_a_first_reference_is_shown_alone(browser: Any, tmp_path: Path) -> None:
    first = {"review": "new reference", "problem": "nothing to compare with", "gates": []}
    page = opened(browser, reviewed(tmp_path, **first))
    assert page.inner_text("#word") == "New reference"
    assert page.inner_text("#reason") == "Nothing to compare with"
    assert page.locator("#modes button").count() == 1
    assert shown(page) == "new"
    assert not page.is_visible("#gates")
    assert "reference" not in page.inner_text("#about")
    assert page.problems == []


def test_names_cannot_inject(tmp_path: Path) -> None:
    text = report(tmp_path, name="a<script>alert(1)<!--.exr").read_text("utf-8")
    assert "<script>alert" not in text.split('<script id="data"')[0]
    data = text.split('type="application/json">')[1].split("</script>")[0]
    assert "<!--" not in data
