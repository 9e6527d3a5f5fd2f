"""A page in a browser comes to the bits of the desktop, and what it saves is verified there."""

import json
from pathlib import Path

import pytest

from sandbox import Session, load_level
from sandbox.physics.snapshot import state_hash
from sandbox.replay import read_replay, verify
from tests.page.browser import Browser
from tests.page.levels import LEVELS, level_page
from tests.page.opened import START_OVER, opened, saved
from tests.support.wholes import some_and_whole

TICKS = 90


@pytest.mark.parametrize("name", some_and_whole(("suspension_car", "walker", "curtain"), LEVELS))
def test_a_page_opens_without_a_fault_and_steps_as_the_desktop_does(
    browser: Browser, tmp_path: Path, name: str
) -> None:
    tab = opened(browser, tmp_path, level_page(name))
    tab.evaluate(START_OVER)
    found = tab.evaluate(f"for (let k = 0; k < {TICKS}; k++) page.toy.tick(); page.toy.world.hash().whole")
    session = Session(load_level(name))
    for _ in range(TICKS):
        session.advance()
    assert found == state_hash(session.world)
    assert tab.faults == []


def test_what_a_page_saves_is_verified_bit_for_bit(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("suspension_car"))
    tab.evaluate(START_OVER)
    tab.evaluate(
        """for (let k = 0; k < 700; k++) {
          if (k === 20) page.toy.drives.press(Object.keys(page.toy.drives.keys)[0]);
          if (k === 120) page.toy.drives.releaseAll();
          if (k === 60) page.toy.command({ type: 'set_coefficients', stiffness: 0.3, damping: 0.6 });
          page.toy.tick();
        }"""
    )
    recording = read_replay(saved(tab, tmp_path))
    assert verify(recording) is None
    assert recording.ticks == 700
    assert recording.script[0].record["type"] == "set_drive"


# What hands do, by level: a record at a tick; slots of the level.
_DONE = {
    "rope": [
        (5, {"type": "grab", "grab": 0, "particle": 9, "target": [1.0, 2.0], "strength": 100.0, "radius": 0.0}),
        (9, {"type": "move_grab", "grab": 0, "target": [2.0, 3.0]}),
        (40, {"type": "cut_springs", "springs": [4]}),
        (60, {"type": "release", "grab": 0}),
        (70, {"type": "pin", "particle": 7}),
        (90, {"type": "unpin", "particle": 7}),
    ],
    "jelly_pile": [
        (10, {"type": "grab", "grab": 1, "particle": 40, "target": [0.5, 2.0], "strength": 100.0, "radius": 0.4}),
        (12, {"type": "grab", "grab": 3, "particle": 90, "target": [-0.5, 2.0], "strength": 60.0, "radius": 0.4}),
        (30, {"type": "cut_springs", "springs": [3, 4, 50]}),
        (50, {"type": "release", "grab": 1}),
        (60, {"type": "push", "position": [0.0, 1.0], "radius": 2.0, "impulse": [3.0, 9.0], "outward": 1.0}),
        (80, {"type": "pin", "particle": 44}),
    ],
    "breaking_bridge": [
        (5, {"type": "grab", "grab": 0, "particle": 12, "target": [0.0, -9.0], "strength": 900.0, "radius": 0.0}),
        (30, {"type": "set_coefficients", "stiffness": 0.2, "damping": 0.4, "material": None, "duration": 45}),
        (50, {"type": "set_gravity", "gravity": [2.0, -3.0], "duration": 30}),
        (60, {"type": "set_air", "wind": [5.0, 0.0], "drag": 0.5, "duration": 100}),
    ],
}


@pytest.mark.parametrize("name", _DONE)
def test_what_hands_do_in_a_page_is_verified_bit_for_bit(browser: Browser, tmp_path: Path, name: str) -> None:
    tab = opened(browser, tmp_path, level_page(name))
    tab.evaluate(START_OVER)
    broken = tab.evaluate(
        f"""const done = {json.dumps(_DONE[name])}; let broken = 0;
        for (let k = 0; k < 130; k++) {{
          done.filter(([tick]) => tick === k).forEach(([, record], i) => page.toy.run.submit(record, 100 + k + i));
          page.toy.tick();
          broken += page.toy.world.broken.length;
        }}
        broken"""
    )
    assert (broken > 0) == (name == "breaking_bridge")
    recording = read_replay(saved(tab, tmp_path))
    assert len(recording.script) == len(_DONE[name]) and recording.ticks == 130
    assert verify(recording) is None
    assert tab.faults == []


def test_an_undo_brings_back_the_state_before_the_gesture(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("rope"))
    tab.evaluate(START_OVER)
    before = tab.evaluate("for (let k = 0; k < 70; k++) page.toy.tick(); page.toy.world.hash().whole")
    tab.evaluate("page.toy.run.submit({ type: 'set_coefficients', stiffness: 0.2, damping: 0.3, material: null }, 1)")
    tab.evaluate("for (let k = 0; k < 100; k++) page.toy.tick(); document.getElementById('undo').click()")
    assert tab.evaluate("[page.toy.world.time, page.toy.world.hash().whole]") == [70, before]
    assert verify(read_replay(saved(tab, tmp_path))) is None


def test_a_page_that_was_cut_off_says_so_in_a_line(browser: Browser, tmp_path: Path) -> None:
    text = level_page("rope")
    for share in (0.3, 0.9):
        tab = opened(browser, tmp_path, text[: int(share * len(text))])
        assert tab.evaluate("document.getElementById('error').textContent").startswith("This page was cut off")
