"""A page is played by keys alone, and says to who listens what was done."""

from pathlib import Path

import pytest

from sandbox.app.share.playing import page_of
from sandbox.level.reading.files import read_level
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import TICKED, opened
from tests.support.rules_level import answering
from tests.test_documentation import ROOT

# What is said, once the frame is over in which it was.
SPOKEN = """new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() =>
  done(document.getElementById('spoken').textContent))))"""
OWNER = "page.toy.world.view('state.owner')[page.toy.hands.cursor.marked]"
MARKED = "page.toy.world.names.particle[page.toy.hands.cursor.marked]"
FOCUS = "document.activeElement.id || document.activeElement.textContent"


def _opened(browser: Browser, folder: Path, name: str) -> Tab:
    tab = opened(browser, folder, level_page(name))
    tab.evaluate(TICKED)
    tab.evaluate(SPOKEN)
    return tab


def _said(tab: Tab, *keys: str) -> str:
    for key in keys:
        tab.key(key)
    said = tab.evaluate(SPOKEN)
    assert isinstance(said, str)
    return said


def _tick(tab: Tab, count: int) -> None:
    tab.evaluate(f"for (let k = 0; k < {count}; k++) page.toy.tick()")


def test_n_goes_from_thing_to_thing_and_back_and_says_which_and_where(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_pile")
    owners = []
    for number in range(1, 17):
        said = _said(tab, "n")
        owners.append(tab.evaluate(OWNER))
        assert f", {number} of 16, " in said and said.split(",")[0] in tab.evaluate(MARKED)
    assert len(set(owners)) == 16
    _said(tab, "n")
    assert tab.evaluate(OWNER) == owners[0]
    _said(tab, "Shift+N")
    assert tab.evaluate(OWNER) == owners[-1]
    first = tab.evaluate(MARKED)
    said = _said(tab, "PageDown")
    assert said.startswith(f"{tab.evaluate(MARKED)}, ")
    assert tab.evaluate(OWNER) == owners[-1] and tab.evaluate(MARKED) != first
    _said(tab, "PageUp")
    assert tab.evaluate(MARKED) == first


def test_a_thing_is_held_moved_and_let_go_by_keys_and_said_so(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_pile")
    thing = _said(tab, "Shift+N").split(",")[0]
    name = tab.evaluate(MARKED)
    before = tab.evaluate(f"page.toy.particle('{name}').y")
    assert _said(tab, "Enter") == f"Holding {thing}."
    for _ in range(6):
        tab.key("Shift+ArrowUp")
        _tick(tab, 5)
    _tick(tab, 60)
    assert tab.evaluate(f"page.toy.particle('{name}').y - {before}") > 0.5
    assert _said(tab, "Enter") == f"Let go of {thing}."
    types = tab.evaluate("page.toy.run.commands.map(({ record }) => record.type)")
    assert (types[0], types[-1]) == ("grab", "release")


def test_enter_pins_cuts_and_erases_with_the_tool_that_is_chosen(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    thing = _said(tab, "n").split(",")[0]
    assert _said(tab, "p", "Enter") == f"{thing} is pinned."
    assert _said(tab, "Enter") == f"{thing} is free."
    active = "page.toy.world.view('state.spring_active').reduce((sum, is) => sum + Number(is), 0)"
    springs = tab.evaluate(active)
    assert _said(tab, "c", "Enter", "Enter") == "Cut: 1 spring."
    assert tab.evaluate(active) == springs - 1
    _said(tab, "x")
    assert _said(tab, "Enter") == f"{thing} is gone."
    assert tab.evaluate(active) < springs - 1
    assert tab.evaluate("page.toy.run.commands.map(({ record }) => record.type)") == [
        "pin", "unpin", "cut_springs", "remove",
    ]  # fmt: skip


def test_a_rope_is_pulled_between_two_things_by_keys(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_pile")
    _said(tab, "b", "o", "n", "Enter", "n")
    # The view may go on to where it has room meanwhile.
    tab.evaluate("page.toy.camera.y += 30")
    assert _said(tab, "Enter") == "A new rope is there."
    types = tab.evaluate("page.toy.run.commands.map(({ record }) => record.type)")
    assert types == ["add_body", "add_spring", "add_spring"]


def test_a_jelly_is_drawn_by_arrows(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_pile")
    tab.evaluate("document.getElementById('make').click(); document.getElementById('picture').focus()")
    _said(tab, "j", *["Shift+ArrowUp"] * 3, "Enter")
    for way in ("Up", "Right", "Down", "Left"):
        _said(tab, *[f"Shift+Arrow{way}"] * 2)
    assert _said(tab, "Enter") == "A new jelly is there."


def test_enter_where_nothing_is_says_so_and_holds_nothing(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    _said(tab, *["Shift+ArrowDown"] * 5)
    assert "N goes to the next thing" in _said(tab, "Enter")
    zoom = "[page.toy.camera.x, page.toy.camera.y]"
    view = tab.evaluate(zoom)
    _said(tab, "ArrowLeft")
    assert tab.evaluate(zoom) == view and tab.evaluate("page.toy.run.commands.length") == 0


@pytest.mark.parametrize("key", ["q", "ContextMenu", "Shift+F10"])
def test_the_menu_of_a_thing_opens_by_keys_and_gives_focus_back(browser: Browser, tmp_path: Path, key: str) -> None:
    tab = _opened(browser, tmp_path, "jelly_pile")
    thing = _said(tab, "n").split(",")[0]
    tab.key(key)
    menu = "document.getElementById('menu')"
    assert tab.evaluate(f"[{menu}.hidden, {menu}.getAttribute('role'), {menu}.getAttribute('aria-label')]") == [
        False, "menu", thing,
    ]  # fmt: skip
    rows = tab.evaluate(f"[...{menu}.querySelectorAll('[role=menuitem]')].map((each) => each.textContent)")
    assert tab.evaluate(FOCUS) == rows[0]
    tab.key("ArrowDown")
    assert tab.evaluate(FOCUS) == rows[1]
    for step in ("Home", "ArrowUp"):
        tab.key(step)
    assert tab.evaluate(FOCUS) == rows[-1] == "erase"
    tab.key("Escape")
    assert tab.evaluate(f"[{menu}.hidden, {FOCUS}]") == [True, "picture"]
    # Keys of the menu do nothing to the picture behind it.
    assert tab.evaluate(MARKED).startswith(thing)
    tab.key(key)
    tab.key("End")
    tab.evaluate("document.activeElement.click()")
    assert tab.evaluate(SPOKEN) == f"{thing} is gone."
    assert tab.evaluate(FOCUS) == "picture"


def test_a_press_of_the_mouse_takes_the_cursor_of_keys_away(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    _said(tab, "n", "ArrowLeft")
    assert tab.evaluate("page.toy.hands.cursor.place !== null")
    tab.mouse("mousePressed", 640, 300)
    tab.mouse("mouseReleased", 640, 300)
    assert tab.evaluate("page.toy.hands.cursor.place") is None


def test_letters_work_with_capslock_and_shift_makes_other_keys_of_them(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    tool = "page.toy.hands.tool"
    tab.key("P")
    assert tab.evaluate(tool) == "pin"
    tab.key("Shift+C")
    assert tab.evaluate(tool) == "pin"
    tab.key("N")
    assert tab.evaluate("page.toy.hands.cursor.marked") is not None


def test_the_end_is_said_and_its_card_is_a_dialog_that_keys_stay_in(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(answering(goal="Bring the ball into the basket")))
    tab.evaluate("for (let k = 0; k < 600 && !page.toy.outcome; k++) page.toy.tick()")
    assert tab.evaluate(SPOKEN).endswith("Won. In! 2 of 3 stars.")
    card = "document.getElementById('end-card')"
    assert tab.evaluate(f"[{card}.getAttribute('role'), {card}.getAttribute('aria-modal')]") == ["dialog", "true"]
    assert tab.evaluate(f"{card}.querySelector('[role=img]').getAttribute('aria-label')") == "2 of 3 stars"
    visited = []
    for _ in range(6):
        visited.append(tab.evaluate(FOCUS))
        tab.key("Tab")
    assert visited[0] == "end-again" and len(set(visited)) > 1
    assert tab.evaluate(f"{card}.contains(document.activeElement)")
    tab.key("Shift+Tab")
    assert tab.evaluate(f"{card}.contains(document.activeElement)")
    tab.key("Escape")
    assert tab.evaluate(f"[{card}.hidden, {FOCUS}]") == [True, "picture"]


def test_what_is_lost_is_said(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(read_level(ROOT / "docs" / "rules" / "bumpers.json")))
    tab.evaluate("for (let k = 0; k < 3000 && !page.toy.outcome; k++) page.toy.tick()")
    assert tab.evaluate(SPOKEN).startswith("Lost. The ball is gone.")


def test_a_page_has_one_live_region_and_no_clock_in_it(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    live = "[...document.querySelectorAll('[aria-live], [role=status], [role=log]')].map((each) => each.id)"
    assert tab.evaluate(live) == ["spoken"]
    _tick(tab, 200)
    assert tab.evaluate(SPOKEN) == ""


def test_a_title_names_no_key_that_drives_something(browser: Browser, tmp_path: Path) -> None:
    for level, keyed in (("suspension_car", False), ("rope", True)):
        tab = _opened(browser, tmp_path, level)
        assert tab.evaluate("document.getElementById('drag').title.includes('(D)')") is keyed
