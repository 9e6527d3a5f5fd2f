"""Parts are dropped in a page by mouse, finger and keys; motors are driven there; the desktop has the same bits."""

import gzip
import json
from pathlib import Path

import pytest

from sandbox import load_level
from sandbox.app.share.playing import parts_for
from sandbox.editor.storage.level_file import catalogue
from sandbox.replay import Replay, read_replay, verify
from sandbox.session.replay.link import replay_of
from sandbox.tools.dropping import PARTS
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import ALL_SHOWN, SETTLED, START_OVER, opened, saved
from tests.page.pointing import click, middle, tap, text
from tests.support.wholes import some_and_whole

PHONE = {"width": 390, "height": 844, "is_phone": True}
COMMANDS = "page.toy.run.commands.map(({ record }) => record.type)"


def _opened(browser: Browser, folder: Path, name: str, **how: object) -> Tab:
    """A page that stands, with its parts."""
    tab = opened(browser, folder, level_page(name), **how)
    tab.evaluate(START_OVER)
    tab.evaluate(ALL_SHOWN)
    press = tap if how.get("is_phone") else click
    press(tab, "#make")
    press(tab, "#parts")
    tab.evaluate(SETTLED)
    return tab


def _steps(tab: Tab, count: int) -> None:
    tab.evaluate(f"for (let k = 0; k < {count}; k++) page.toy.tick()")


def _linked(tab: Tab) -> Replay:
    """The run that a link to what was done has."""
    return replay_of(str(tab.evaluate("page.toy.link()")))


def test_a_cart_that_was_dropped_in_a_page_is_driven_there_by_its_keys_and_comes_to_the_desktop_by_a_link(
    browser: Browser, tmp_path: Path
) -> None:
    tab = _opened(browser, tmp_path, "truck_bridge")
    before = tab.evaluate("document.querySelectorAll('.key').length")
    click(tab, "#part-cart")
    assert text(tab, "#state") == "Press where the cart is to be. Q and W drive it."
    click(tab, (640.0, 200.0))
    tab.evaluate(SETTLED)
    assert tab.evaluate("document.querySelectorAll('.key').length") == before + 2
    _steps(tab, 60)
    x, y = middle(tab, '.key[aria-label="Key w"]')
    tab.mouse("mousePressed", x, y)
    _steps(tab, 60)
    tab.mouse("mouseReleased", x, y)
    tab.press("q")
    _steps(tab, 30)
    tab.release("q")
    _steps(tab, 10)
    assert tab.evaluate(COMMANDS) == ["add_body", *["set_drive"] * 8]
    assert verify(_linked(tab)) is None
    assert verify(read_replay(saved(tab, tmp_path))) is None
    # The keys go with it.
    for _ in range(3):
        click(tab, "#undo")
    tab.evaluate(SETTLED)
    assert tab.evaluate(COMMANDS) == []
    assert tab.evaluate("document.querySelectorAll('.key').length") == before
    assert tab.faults == []


@pytest.mark.parametrize("part", some_and_whole(("ball", "cart"), PARTS))
def test_each_part_is_dropped_by_finger_where_it_taps(browser: Browser, tmp_path: Path, part: str) -> None:
    tab = _opened(browser, tmp_path, "jelly_pile", **PHONE)
    tap(tab, f"#part-{part}")
    count = len(tab.evaluate("[...page.toy.world.view('state.mass')]"))
    wanted, away = tab.evaluate("[page.toy.camera.toWorld(195, 300), 12 / page.toy.camera.zoom]")
    tab.touch("touchStart", (150.0, 250.0))
    tab.touch("touchMove", (195.0, 300.0))
    tab.touch("touchEnd")
    x, y = tab.evaluate(
        f"""(() => {{
          const at = page.toy.world.view('state.position').subarray(2 * {count});
          const middle = (u) => {{
            const own = [...at].filter((_, k) => k % 2 === u);
            return (Math.min(...own) + Math.max(...own)) / 2;
          }};
          return [middle(0), middle(1)];
        }})()"""
    )
    assert (x, y) == pytest.approx(wanted, abs=away)
    _steps(tab, 90)
    assert len(tab.evaluate(COMMANDS)) == 1
    assert verify(_linked(tab)) is None
    assert tab.faults == []


def test_a_car_of_the_catalogue_is_dropped_and_driven(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "truck_bridge")
    tab.evaluate("document.getElementById('catalogue').focus()")
    tab.key("c")
    assert tab.evaluate("page.toy.hands.tool") == "catalogue-car"
    click(tab, (640.0, 150.0))
    tab.evaluate(SETTLED)
    (key, *_) = tab.evaluate("Object.keys(page.toy.world.joinedKeys)")
    x, y = middle(tab, f'.key[aria-label="Key {key}"]')
    tab.mouse("mousePressed", x, y)
    _steps(tab, 60)
    tab.mouse("mouseReleased", x, y)
    assert verify(_linked(tab)) is None
    click(tab, "#part-ball")
    assert tab.evaluate("document.getElementById('catalogue').value") == ""
    assert tab.faults == []


def test_a_part_is_dropped_by_the_cursor_of_keys(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_pile")
    click(tab, "#part-box")
    tab.evaluate("document.getElementById('picture').focus()")
    for key in ("ArrowUp", "Enter", "ArrowLeft", "Enter"):
        tab.key(key)
    assert tab.evaluate(COMMANDS) == ["add_body", "add_body"]


@pytest.mark.parametrize("part", some_and_whole(("ball", "cart"), PARTS))
def test_a_part_that_hands_may_not_add_is_refused_over_the_level(browser: Browser, tmp_path: Path, part: str) -> None:
    tab = _opened(browser, tmp_path, "pinball_score")
    click(tab, f"#part-{part}")
    click(tab, (640.0, 300.0))
    assert text(tab, "#state") == "in this level hands may not add parts"
    assert tab.evaluate(COMMANDS) == []


def test_a_tool_that_is_seen_no_more_is_in_hand_no_more(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    for button in ("#parts", "#make"):
        click(tab, "#part-ball")
        assert tab.evaluate("page.toy.hands.tool") == "part-ball"
        click(tab, button)
        assert tab.evaluate("page.toy.hands.tool") == "drag"
        if button == "#parts":
            assert tab.evaluate("document.getElementById('jelly').offsetParent !== null")
            click(tab, "#parts")


def test_parts_of_a_page_are_those_of_the_window_and_small() -> None:
    made = parts_for(load_level("jelly_pile"), 8.0)
    assert [part["name"] for part in made["parts"]] == list(PARTS)
    shipped = {f"catalogue-{file.path.stem}" for file in catalogue() if not file.is_own}
    assert {part["id"] for part in made["catalogue"]} == shipped
    # As a page has it.
    assert len(gzip.compress(json.dumps(made).encode())) < 20_000
