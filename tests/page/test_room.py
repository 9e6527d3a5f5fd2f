"""What stands around a level leaves it free, on phones held either way, low windows and large ones."""

from itertools import product
from pathlib import Path
from typing import Any

import pytest

from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import FRAMES, TICKED, opened
from tests.page.pointing import click, middle, place, tap
from tests.support.wholes import some_and_whole

LEVELS = ("truck_course", "ferry", "egg_drop", "bridge_budget", "chain_of_events", "crane")
PHONE, TURNED = (390, 844), (844, 390)
SIZES = (PHONE, TURNED, (640, 400), (1400, 900), (320, 568), (300, 200))
# The level's view as it is drawn, and all that stands around it, as left, top, right and bottom [pixels].
BOXES = """(() => {
  const { camera, level: { scene: { view: [left, low, right, high] } } } = page.toy;
  const there = 'header, #timeline, #tools > button, .key, #panel, #end-card, #makers > button';
  const found = [...document.querySelectorAll(there)].filter((each) => each.offsetParent).map((each) => {
    const box = each.getBoundingClientRect();
    return [each.id || each.textContent, box.left, box.top, box.right, box.bottom];
  });
  return [[...camera.toPixels(left, high), ...camera.toPixels(right, low)], found];
})()"""
# A view takes a while to where it has room.
GLIDDEN = f"{FRAMES}.then(() => {FRAMES})"


def page(browser: Browser, folder: Path, name: str, size: tuple[int, int]) -> Tab:
    width, height = size
    return opened(browser, folder, level_page(name), width=width, height=height, is_phone=size in (PHONE, TURNED))


def covering(tab: Tab) -> list[Any]:
    """What stands over the level or beyond the window; whether it is too small to be seen."""
    tab.evaluate(GLIDDEN)
    (left, top, right, bottom), boxes = tab.evaluate(BOXES)
    width, height = tab.evaluate("[innerWidth, innerHeight]")
    over = [
        each
        for each, *box in boxes
        if min(box[2], right) > max(box[0], left) + 1 and min(box[3], bottom) > max(box[1], top) + 1
    ]
    beyond = [each for each, *box in boxes if box[0] < -1 or box[1] < -1 or box[2] > width + 1 or box[3] > height + 1]
    is_large = max((right - left) / width, (bottom - top) / height) > 0.25
    is_seen = is_large and left >= 0 and top >= 0 and right <= width and bottom <= height
    return [*over, *beyond] if is_seen else ["level", left, top, right, bottom]


@pytest.mark.parametrize(
    ("name", "size"), some_and_whole([*zip(LEVELS, SIZES, strict=True)], product(LEVELS, SIZES)), ids=str
)
def test_bars_words_and_keys_leave_the_level_free(
    browser: Browser, tmp_path: Path, name: str, size: tuple[int, int]
) -> None:
    tab = page(browser, tmp_path, name, size)
    assert covering(tab) == []
    if size[0] > 400:
        click(tab, "#make")
        assert covering(tab) == []


@pytest.mark.parametrize("size", SIZES[:4], ids=str)
def test_the_open_panel_covers_neither_the_level_nor_a_key(
    browser: Browser, tmp_path: Path, size: tuple[int, int]
) -> None:
    tab = page(browser, tmp_path, "suspension_car", size)
    click(tab, "#tune")
    assert covering(tab) == []
    tab.evaluate("document.querySelector('.fields').scrollIntoView()")
    x, y = middle(tab, ".fields input")
    assert tab.evaluate(f"document.elementFromPoint({x}, {y}).closest('#panel') !== null")
    drives = "page.toy.world.view('state.actuator_value').some((value) => value !== 0)"
    tab.mouse("mousePressed", *middle(tab, "#keys-right .key"))
    assert tab.evaluate(drives)
    tab.mouse("mouseReleased", *middle(tab, "#keys-right .key"))
    assert not tab.evaluate(drives)


def test_a_small_page_folds_its_tools_and_unfolds_them_by_a_button(browser: Browser, tmp_path: Path) -> None:
    tab = page(browser, tmp_path, "suspension_car", (300, 200))
    shown = "[...document.querySelectorAll('#tools button')].filter((each) => each.offsetParent).map((each) => each.id)"
    assert tab.evaluate(shown) == ["again", "more"]
    click(tab, "#more")
    assert {"undo", "redo", "cut", "tune", "save"} < set(tab.evaluate(shown))
    assert tab.evaluate("document.getElementById('more').ariaExpanded") == "true"
    tab.evaluate("document.getElementById('more').scrollIntoView()")
    click(tab, "#more")
    assert tab.evaluate(shown) == ["again", "more"]


def test_words_that_go_once_somebody_has_played_leave_more_room_and_never_move_what_is_held(
    browser: Browser, tmp_path: Path
) -> None:
    tab = page(browser, tmp_path, "chain_of_events", TURNED)
    tab.evaluate(f"{TICKED}; {GLIDDEN}")
    zoom = tab.evaluate("page.toy.camera.zoom")
    x, y = place(tab, "marble")
    tab.touch("touchStart", (x, y))
    tab.touch("touchMove", (x + 30, y - 30))
    tab.evaluate(GLIDDEN)
    assert tab.evaluate("page.toy.hands.isBusy") and tab.evaluate("page.toy.camera.zoom") == zoom
    tab.touch("touchEnd")
    tab.evaluate(GLIDDEN)
    assert tab.evaluate("page.toy.camera.zoom") > zoom
    # By its button they are there again, and the level has the room that they leave.
    tap(tab, "#hint")
    tab.evaluate(GLIDDEN)
    assert tab.evaluate("page.toy.camera.zoom") == pytest.approx(zoom)
