"""While time stands a drag in a page puts a thing elsewhere; its menu frees it and weighs it, as on the desktop."""

from pathlib import Path

import pytest

from sandbox.replay import Replay, read_replay, verify
from sandbox.session.replay.link import replay_of
from sandbox.tools.drag import TIME_STANDS
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import STANDS, START_OVER, opened, saved
from tests.page.pointing import click, drag, place, text

PHONE = {"width": 390, "height": 844, "is_phone": True}
COMMANDS = "page.toy.run.commands.length"


def _opened(browser: Browser, folder: Path, name: str, **how: object) -> Tab:
    """A page in which time stands."""
    tab = opened(browser, folder, level_page(name), **how)
    tab.evaluate(START_OVER)
    tab.evaluate(STANDS)
    return tab


def _steps(tab: Tab, count: int) -> None:
    tab.evaluate(f"for (let k = 0; k < {count}; k++) page.toy.tick()")


def _ends_as_on_the_desktop(tab: Tab, folder: Path) -> Replay:
    """The run, which is verified as a recording and as a link."""
    assert verify(replay_of(str(tab.evaluate("page.toy.link()")))) is None
    replay = read_replay(saved(tab, folder))
    assert verify(replay) is None
    return replay


@pytest.mark.parametrize("particle", ["rope.20", "rope.0"])
def test_a_drag_while_time_stands_puts_a_body_elsewhere_with_its_pins(
    browser: Browser, tmp_path: Path, particle: str
) -> None:
    tab = _opened(browser, tmp_path, "rope")
    x, y = place(tab, particle)
    other = place(tab, "rope.5")
    drag(tab, (x, y), (x + 20, y + 30), (x + 50, y + 70))
    assert place(tab, particle) == pytest.approx((x + 50, y + 70), abs=1.0)
    assert place(tab, "rope.5") == pytest.approx((other[0] + 50, other[1] + 70), abs=1.0)
    assert not tab.evaluate("page.toy.world.isHeld(0)")
    _steps(tab, 30)
    replay = _ends_as_on_the_desktop(tab, tmp_path)
    assert [line.record["type"] for line in replay.script] == ["move_body"] * 2
    click(tab, "#undo")
    assert place(tab, particle) == pytest.approx((x, y), abs=0.01)
    assert tab.faults == []


def test_a_finger_puts_a_body_elsewhere_while_time_stands(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_wheel", **PHONE)
    x, y = place(tab, "wheel.0")
    tab.touch("touchStart", (x, y))
    tab.touch("touchMove", (x + 30, y - 60))
    tab.touch("touchEnd")
    assert place(tab, "wheel.0") == pytest.approx((x + 30, y - 60), abs=1.0)
    _steps(tab, 30)
    _ends_as_on_the_desktop(tab, tmp_path)


def test_keys_put_a_body_elsewhere_while_time_stands(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_wheel")
    tab.evaluate("document.getElementById('picture').focus()")
    for key in ("n", "Enter", "ArrowUp", "ArrowUp", "Enter"):
        tab.key(key)
    _steps(tab, 10)
    replay = _ends_as_on_the_desktop(tab, tmp_path)
    assert [line.record["type"] for line in replay.script] == ["move_body"] * 2


def test_what_hands_may_not_move_stays_and_the_page_says_so(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "pinball_score", width=1400, height=900)
    x, y = place(tab, "left flipper.8")
    drag(tab, (x, y), (x + 40, y - 90))
    assert text(tab, "#state").startswith("in this level hands may not ")
    assert place(tab, "left flipper.8") == pytest.approx((x, y), abs=0.01)
    assert tab.evaluate(COMMANDS) == 0


def _chosen(tab: Tab, particle: str, words: str) -> None:
    """Choose a row of the menu of a thing."""
    click(tab, place(tab, particle), "right")
    rows = tab.evaluate("[...document.querySelectorAll('#menu button')].map((each) => each.textContent)")
    click(tab, f"#menu button:nth-child({rows.index(words) + 1})")


def test_the_menu_makes_a_thing_twice_and_half_as_heavy(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_wheel")
    mass = "page.toy.world.view('state.mass').reduce((sum, each) => sum + each, 0)"
    before = tab.evaluate(mass)
    _chosen(tab, "wheel.0", "twice as heavy")
    assert text(tab, "#state") == "wheel is twice as heavy now."
    assert tab.evaluate(mass) > before
    _chosen(tab, "wheel.0", "half as heavy")
    assert tab.evaluate(mass) == before
    _steps(tab, 20)
    _ends_as_on_the_desktop(tab, tmp_path)


def test_the_menu_frees_a_thing_that_was_put_into_another(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_pile")
    one, other = tab.evaluate("page.toy.particles.filter((name) => name.endsWith('.0')).slice(0, 2)")
    from_, to = place(tab, one), place(tab, other)
    drag(tab, from_, (to[0] + 6, to[1] + 6))
    _chosen(tab, one, "free it")
    assert text(tab, "#state") == f"{one.partition('.')[0]} is free now."
    _steps(tab, 20)
    replay = _ends_as_on_the_desktop(tab, tmp_path)
    assert [line.record["type"] for line in replay.script] == ["move_body", "free"]


def test_nothing_can_be_freed_where_nothing_touches(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    click(tab, place(tab, "rope.20"), "right")
    assert "free it" not in tab.evaluate("document.getElementById('menu').textContent")


def test_a_drag_while_time_stands_only_pulls_where_hands_may_not_move_things_at_once(
    browser: Browser, tmp_path: Path
) -> None:
    tab = _opened(browser, tmp_path, "ferry")
    x, y = place(tab, "crate 1.4")
    tab.mouse("mousePressed", x, y)
    tab.mouse("mouseMoved", x + 200, y - 100)
    assert place(tab, "crate 1.4") == pytest.approx((x, y), abs=0.01)
    assert text(tab, "#state") == TIME_STANDS
    _steps(tab, 20)
    assert place(tab, "crate 1.4")[0] > x + 2
    tab.mouse("mouseReleased", x + 200, y - 100)
    replay = _ends_as_on_the_desktop(tab, tmp_path)
    assert {line.record["type"] for line in replay.script} == {"grab", "move_grab", "release"}
    assert tab.faults == []
