"""A finger that moves drags, one that rests asks; menus and tools end with what they belong to."""

import math
from pathlib import Path

import pytest

from sandbox.app.share.playing import page_of
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import FRAMES, SETTLED, START_OVER, opened
from tests.page.pointing import click, drag, place, text
from tests.support.rules_level import answering

PHONE = {"width": 390, "height": 844, "is_phone": True}
MENU = "!document.getElementById('menu').hidden"
TOOL = "[page.toy.hands.tool, ...[...document.querySelectorAll('#bars [aria-pressed=true]')].map((each) => each.id)]"
# A press that rests asks for a menu after half a second.
RESTED = "new Promise((done) => setTimeout(done, 700))"


def _phone(browser: Browser, folder: Path, name: str) -> Tab:
    tab = opened(browser, folder, level_page(name), **PHONE)
    tab.evaluate(START_OVER)
    return tab


@pytest.mark.parametrize("way", [11, 30])
def test_a_finger_that_has_moved_more_than_ten_pixels_drags_however_slowly(
    browser: Browser, tmp_path: Path, way: float
) -> None:
    tab = _phone(browser, tmp_path, "jelly_cube")
    x, y = tab.evaluate("[0, 1].map((k) => page.toy.picture.at[k])")
    tab.touch("touchStart", (x, y))
    for part in range(1, 5):
        tab.touch("touchMove", (x + way * part / 4, y))
    tab.evaluate(RESTED)
    assert not tab.evaluate(MENU)
    assert tab.evaluate("page.toy.hands.isBusy")
    tab.touch("touchEnd")
    assert not tab.evaluate(MENU)


def test_a_finger_that_trembles_less_than_that_asks_for_the_menu(browser: Browser, tmp_path: Path) -> None:
    tab = _phone(browser, tmp_path, "jelly_cube")
    x, y = tab.evaluate("[0, 1].map((k) => page.toy.picture.at[k])")
    tab.touch("touchStart", (x, y))
    for turn in range(6):
        tab.touch("touchMove", (x + 4 * math.cos(turn), y + 4 * math.sin(turn)))
    tab.evaluate(RESTED)
    assert tab.evaluate(MENU)
    assert not tab.evaluate("page.toy.hands.isBusy")


def test_a_finger_that_rests_asks_also_where_hands_may_not_take_the_thing(browser: Browser, tmp_path: Path) -> None:
    tab = _phone(browser, tmp_path, "egg_drop")
    tab.touch("touchStart", place(tab, "cushion.0"))
    tab.evaluate(RESTED)
    assert tab.evaluate(MENU)


def test_a_menu_ends_with_the_outcome_and_with_time_that_jumps(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(answering(goal="Bring the ball into the basket")))
    tab.evaluate("page.toy.pause()")
    ask = "page.menu.open({ particle: 0, x: 200, y: 200 })"
    tab.evaluate(ask)
    assert tab.evaluate(MENU)
    tab.evaluate("while (!page.toy.outcome) page.toy.tick()")
    assert not tab.evaluate(MENU)
    tab.evaluate(ask)
    click(tab, "#undo")
    tab.evaluate(ask)
    assert tab.evaluate(MENU)
    tab.evaluate("page.toy.seek(20)")
    assert not tab.evaluate(MENU)


@pytest.mark.parametrize("tool", ["erase", "jelly", "rope"])
def test_a_tool_ends_when_its_bar_is_shut(browser: Browser, tmp_path: Path, tool: str) -> None:
    tab = opened(browser, tmp_path, level_page("jelly_cube"))
    tab.evaluate(START_OVER)
    click(tab, "#make")
    click(tab, f"#{tool}")
    assert tab.evaluate(TOOL)[0] == tool and {tool, "make"} <= set(tab.evaluate(TOOL))
    click(tab, "#make")
    assert tab.evaluate(TOOL) == ["drag", "play", "drag"]
    assert text(tab, "#state") == ""
    tab.evaluate(SETTLED)
    x, y = place(tab, tab.evaluate("page.toy.particles[0]"))
    drag(tab, (x, y), (x + 20, y + 20))
    assert tab.evaluate("page.toy.run.commands.map(({ record }) => record.type)") == ["grab", "release"]


def test_two_fingers_turn_the_view_larger_while_a_tool_that_draws_is_in_hand(browser: Browser, tmp_path: Path) -> None:
    tab = _phone(browser, tmp_path, "jelly_cube")
    tab.evaluate("document.getElementById('make').click(); document.getElementById('jelly').click()")
    tab.evaluate(SETTLED)
    zoom = tab.evaluate("page.toy.camera.zoom")
    tab.touch("touchStart", (150, 300))
    tab.touch("touchStart", (150, 300), (250, 300))
    tab.touch("touchMove", (100, 300), (300, 300))
    tab.evaluate(FRAMES)
    tab.touch("touchEnd")
    assert tab.evaluate("page.toy.camera.zoom") == pytest.approx(2.0 * zoom, rel=0.01)
    assert tab.evaluate("page.toy.run.commands.length") == 0
    # One finger draws again.
    drag = [(120.0, 250.0), (260.0, 250.0), (260.0, 350.0), (120.0, 350.0)]
    tab.touch("touchStart", drag[0])
    for point in drag[1:]:
        tab.touch("touchMove", point)
        tab.evaluate("new Promise(requestAnimationFrame)")
    tab.touch("touchEnd")
    assert tab.evaluate("page.toy.run.commands.map(({ record }) => record.type)") == ["add_body"]
    assert tab.faults == []


def test_a_tip_ends_with_its_deed_or_when_another_tool_is_chosen(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("rope"))
    tab.evaluate(START_OVER)
    click(tab, "#make")
    click(tab, "#erase")
    assert text(tab, "#state").startswith("Touch a thing")
    click(tab, "#pin")
    assert text(tab, "#state") == ""
    click(tab, "#jelly")
    tab.evaluate(SETTLED)
    assert text(tab, "#state").startswith("Draw around a shape")
    for size, said in ((4, "Draw a larger outline: press, draw around, and let go."), (90, "")):
        drag(tab, (100, 250), (100 + size, 250), (100 + size, 250 + size), (100, 250 + size))
        tab.evaluate(FRAMES)
        assert text(tab, "#state") == said
    assert tab.faults == []
