"""In a page a gamepad, and two fingers at once, do what keys do; the caps say what presses them."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox.app.base.gamepads import controls_of
from sandbox.page.page import WEB
from sandbox.replay import read_replay, verify
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import FRAMES, opened, saved
from tests.page.site_server import served

PHONE = {"width": 390, "height": 844, "is_phone": True}
# A gamepad of the standard mapping that a test moves, and one more frame.
PAD = """globalThis.pad = { connected: true, mapping: 'standard', axes: [0, 0, 0, 0],
  buttons: Array.from({ length: 17 }, () => ({ pressed: false, value: 0 })) };
navigator.getGamepads = () => [null, globalThis.pad];
dispatchEvent(new Event('gamepadconnected'));"""
DRIVEN = "[...page.toy.world.view('state.actuator_value')]"
CAPS = "[...document.querySelectorAll('.key')].map((each) => each.textContent)"
# Where the keys are [pixels]: the middle, and the smaller side.
KEYS = """[...document.querySelectorAll('.key')].map((each) => each.getBoundingClientRect())
  .map(({ x, y, width, height }) => [x + width / 2, y + height / 2, Math.min(width, height)])"""


@pytest.fixture(scope="module")
def module(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A page beside the module."""
    folder = tmp_path_factory.mktemp("gamepad")
    for name in ("gamepad.js", "shared.js"):
        shutil.copy(WEB / name, folder)
    (folder / "index.html").write_text("<!doctype html>", encoding="utf-8")
    with served(folder) as at:
        yield at


def _moved(tab: Tab, change: str) -> list[float]:
    tab.evaluate(change)
    tab.evaluate(FRAMES)
    driven: list[float] = tab.evaluate(DRIVEN)
    return driven


@pytest.mark.parametrize("keys", ["ad", "dcaws", "d", "kjhgf", ["left", "right", "a", "d", "up", "down"]])
def test_a_page_maps_keys_as_the_window_does(browser: Browser, module: str, keys: str | list[str]) -> None:
    mapped = f"import('./gamepad.js').then(({{ controlsOf }}) => Object.fromEntries(controlsOf({list(keys)!r})))"
    assert browser.tab().show(module).evaluate(mapped) == controls_of(keys)


def test_stick_and_cross_drive_and_the_recording_has_it(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("suspension_car"))
    tab.evaluate("page.toy.restart(); page.toy.pause()")
    assert tab.evaluate(CAPS) == ["A", "D"]
    tab.evaluate(PAD)
    assert _moved(tab, "pad.axes[0] = 0.3") == [0, 0]
    assert _moved(tab, "pad.axes[0] = 0.8; page.toy.tick()") == [1, 1]
    assert tab.evaluate(CAPS) == ["\u2190", "\u2192"]
    assert tab.evaluate("document.querySelectorAll('.key[aria-pressed=true]').length") == 1
    assert _moved(tab, "pad.axes[0] = 0.4; for (let k = 0; k < 30; k++) page.toy.tick()") == [1, 1]
    assert _moved(tab, "pad.axes[0] = 0") == [0, 0]
    assert _moved(tab, "pad.buttons[14].pressed = true; page.toy.tick()") == [-1, -1]
    # A gamepad that is taken away lets go.
    assert _moved(tab, "pad.connected = false; page.toy.tick()") == [0, 0]
    types = tab.evaluate("page.toy.run.commands.map(({ record }) => record.type)")
    assert types == ["set_drive"] * 8
    assert verify(read_replay(saved(tab, tmp_path))) is None
    tab.key("a")
    assert tab.evaluate(CAPS) == ["A", "D"]
    assert tab.faults == []


def test_a_gamepad_that_comes_again_is_heard_again(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("suspension_car"))
    for _ in range(2):
        tab.evaluate(PAD)
        assert _moved(tab, "pad.buttons[15].pressed = true") == [1, 1]
        assert _moved(tab, "pad.connected = false") == [0, 0]


def test_two_fingers_hold_two_large_keys_at_once(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("pinball"), **PHONE)
    tab.evaluate("page.toy.pause()")
    tab.touch("touchStart", (200, 300))
    tab.touch("touchEnd")
    keys = tab.evaluate(KEYS)
    assert len(keys) == 2 and min(size for _, _, size in keys) >= 52
    # One for each thumb.
    assert keys[0][0] < 100 and keys[1][0] > 290
    first, second = ((x, y) for x, y, _ in keys)
    held = "[...document.querySelectorAll('.key')].map((each) => each.getAttribute('aria-pressed'))"
    tab.touch("touchStart", first)
    tab.touch("touchStart", first, second)
    assert tab.evaluate(held) == ["true", "true"]
    assert all(tab.evaluate(DRIVEN))
    tab.touch("touchEnd")
    tab.evaluate(FRAMES)
    assert not any(tab.evaluate(DRIVEN))
