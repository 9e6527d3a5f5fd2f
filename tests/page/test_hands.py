"""What people do to a page by mouse and fingers is verified bit for bit on the desktop."""

from pathlib import Path

from sandbox.replay import Replay, read_replay, verify
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import START_OVER, opened, saved
from tests.page.pointing import place

PHONE = {"width": 390, "height": 844, "is_phone": True}


def _opened(browser: Browser, folder: Path, name: str, **how: object) -> Tab:
    tab = opened(browser, folder, level_page(name), **how)
    tab.evaluate(START_OVER)
    return tab


def _steps(tab: Tab, count: int) -> None:
    tab.evaluate(f"for (let k = 0; k < {count}; k++) page.toy.tick()")


def _saved(tab: Tab, folder: Path) -> Replay:
    return read_replay(saved(tab, folder))


def _types(replay: Replay) -> list[str]:
    return [line.record["type"] for line in replay.script]


def test_a_drag_by_mouse_is_verified(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    _steps(tab, 30)
    x, y = place(tab, "rope.20")
    tab.mouse("mousePressed", x, y)
    for k in range(8):
        tab.mouse("mouseMoved", x - 12 * k, y + 6 * k)
        _steps(tab, 4)
    assert tab.evaluate("page.toy.world.isHeld(0)")
    tab.mouse("mouseReleased", x - 84, y + 42)
    _steps(tab, 60)
    replay = _saved(tab, tmp_path)
    assert verify(replay) is None
    assert [_types(replay)[0], _types(replay)[-1], len({line.gesture for line in replay.script})] == [
        "grab",
        "release",
        1,
    ]
    assert tab.faults == []


def test_several_fingers_hold_several_bodies(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_wheel", **PHONE)
    _steps(tab, 20)
    held = "Array.from({ length: 10 }, (_, hand) => page.toy.world.isHeld(hand)).filter(Boolean).length"
    x, y, u, v = tab.evaluate("[0, 1, 40, 41].map((k) => page.toy.picture.at[k])")
    tab.touch("touchStart", (x, y))
    tab.touch("touchStart", (x, y), (u, v))
    assert tab.evaluate(held) == 2
    tab.touch("touchMove", (x - 30, y - 60), (u + 30, v - 60))
    _steps(tab, 40)
    tab.touch("touchEnd")
    assert tab.evaluate(held) == 0
    _steps(tab, 30)
    assert verify(_saved(tab, tmp_path)) is None


def test_two_fingers_on_one_particle_let_go_of_it(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope", **PHONE)
    _steps(tab, 20)
    x, y = place(tab, "rope.20")
    tab.touch("touchStart", (x, y))
    tab.touch("touchStart", (x, y), (x + 3, y + 2))
    tab.touch("touchMove", (x - 30, y), (x + 40, y - 20))
    _steps(tab, 20)
    tab.touch("touchEnd")
    _steps(tab, 20)
    assert not tab.evaluate("Array.from({ length: 10 }, (_, hand) => page.toy.world.isHeld(hand)).some(Boolean)")
    assert verify(_saved(tab, tmp_path)) is None


def test_what_is_dragged_is_let_go_where_somebody_goes_back_in_time(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    _steps(tab, 20)
    x, y = place(tab, "rope.20")
    tab.mouse("mousePressed", x, y)
    _steps(tab, 20)
    tab.evaluate("page.toy.seek(30)")
    # The button is still down.
    tab.mouse("mouseMoved", x + 90, y)
    tab.mouse("mouseReleased", x + 90, y)
    x, y = place(tab, "rope.10")
    tab.mouse("mousePressed", x, y)
    _steps(tab, 10)
    tab.mouse("mouseReleased", x, y)
    _steps(tab, 10)
    replay = _saved(tab, tmp_path)
    assert _types(replay) == ["grab", "release", "grab", "release"]
    assert (verify(replay), replay.ticks) == (None, 50)


def test_a_button_that_is_down_over_an_undo_moves_nothing_more(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    _steps(tab, 20)
    x, y = place(tab, "rope.20")
    tab.mouse("mousePressed", x, y)
    _steps(tab, 5)
    tab.evaluate("page.toy.undo()")
    tab.key("n")
    tab.key("Enter")
    tab.mouse("mouseMoved", x + 80, y)
    _steps(tab, 5)
    tab.mouse("mouseReleased", x + 80, y)
    assert tab.evaluate("page.toy.world.isHeld(0)")
    assert _types(_saved(tab, tmp_path)) == ["grab"]


def test_what_does_not_fit_is_not_recorded(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    records = {
        "{ type: 'push', position: [900, 900], radius: 1, impulse: [1, 0] }": "there is nothing to push there",
        "{ type: 'release', grab: 0 }": "hand 0 holds nothing",
        "{ type: 'unpin', particle: 'rope.20' }": "rope.20 is not pinned",
        "{ type: 'pin', particle: 'rope.0' }": "rope.0 is pinned already",
    }
    for record, words in records.items():
        told = tab.evaluate(f"try {{ page.toy.command({record}) }} catch (error) {{ error.message }}")
        assert told == words
    assert tab.evaluate("page.toy.run.commands.length") == 0
    # A particle that is pinned is not taken by the keyboard either.
    tab.key("n")
    tab.evaluate("page.toy.run.submit({ type: 'pin', particle: page.toy.hands.cursor.marked }, 1)")
    tab.key("Enter")
    _steps(tab, 5)
    replay = _saved(tab, tmp_path)
    assert (_types(replay), verify(replay)) == (["pin"], None)


def test_a_stroke_cuts_what_it_crosses_and_undo_makes_it_whole(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "curtain")
    _steps(tab, 60)
    before = tab.evaluate("page.toy.world.hash().whole")
    tab.evaluate("document.getElementById('cut').click()")
    x, y = 640.0, 250.0
    tab.mouse("mousePressed", x - 160, y)
    tab.mouse("mouseMoved", x, y + 10)
    tab.mouse("mouseMoved", x + 160, y + 10)
    tab.mouse("mouseReleased", x + 160, y + 10)
    _steps(tab, 60)
    replay = _saved(tab, tmp_path)
    assert verify(replay) is None
    assert set(_types(replay)) == {"cut_springs"}
    tab.evaluate("document.getElementById('undo').click()")
    assert tab.evaluate("page.toy.world.hash().whole") == before


def test_a_particle_is_pinned_and_unpinned(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    _steps(tab, 10)
    tab.evaluate("document.getElementById('pin').click()")
    for _ in range(2):
        x, y = place(tab, "rope.20")
        tab.mouse("mousePressed", x, y)
        tab.mouse("mouseReleased", x, y)
        _steps(tab, 40)
    replay = _saved(tab, tmp_path)
    assert (verify(replay), _types(replay)) == (None, ["pin", "unpin"])


def test_sliders_and_words_set_cs_and_cd(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_wheel")
    tab.evaluate("document.getElementById('tune').click()")
    _steps(tab, 20)
    for slider, share in (("slider0", 0.3), ("slider1", 0.8)):
        box = f"document.getElementById('{slider}').getBoundingClientRect()"
        x, y, width, height = tab.evaluate(f"(({{ x, y, width, height }}) => [x, y, width, height])({box})")
        tab.mouse("mousePressed", x + width / 2, y + height / 2)
        tab.mouse("mouseMoved", x + share * width, y + height / 2)
        tab.mouse("mouseReleased", x + share * width, y + height / 2)
        _steps(tab, 30)
    tab.evaluate("document.querySelector('.words button').click()")
    _steps(tab, 30)
    # Shown at once, and in force a little later.
    assert tab.evaluate("page.toy.world.view('state.ramp_ticks').some((ticks) => ticks === 45)")
    replay = _saved(tab, tmp_path)
    assert verify(replay) is None
    assert (set(_types(replay)), len({line.gesture for line in replay.script})) == ({"set_coefficients"}, 3)
    assert {line.record["duration"] for line in replay.script} == {75}


def test_after_an_undo_the_run_goes_on_from_where_it_was(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_wheel")
    _steps(tab, 20)
    for way in (60, -60, 80):
        x, y = place(tab, "wheel.0")
        tab.mouse("mousePressed", x, y)
        tab.mouse("mouseMoved", x + way, y - 40)
        _steps(tab, 15)
        tab.mouse("mouseReleased", x + way, y - 40)
        _steps(tab, 15)
        if way < 0:
            tab.evaluate("document.getElementById('undo').click()")
            assert tab.evaluate("page.toy.run.time") == 50
    replay = _saved(tab, tmp_path)
    assert (verify(replay), replay.ticks) == (None, 80)
    assert len({line.gesture for line in replay.script}) == 2


def test_keys_drive_motors_while_they_are_held(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "suspension_car")
    keys = tab.evaluate("Object.keys(page.toy.drives.keys)")
    _steps(tab, 30)
    for key in keys:
        name = f"Arrow{key.capitalize()}" if key in ("left", "right", "up", "down") else key
        tab.press(name)
        # Keys repeat while they are held.
        tab.press(name)
        _steps(tab, 40)
        tab.release(name)
        _steps(tab, 10)
    replay = _saved(tab, tmp_path)
    assert verify(replay) is None
    assert set(_types(replay)) == {"set_drive"} and len({line.gesture for line in replay.script}) == len(keys)


def test_a_bridge_is_torn_by_mouse(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "breaking_bridge")
    tab.evaluate("globalThis.torn = []; page.toy.addEventListener('break', (e) => torn.push(...e.detail.springs))")
    _steps(tab, 30)
    x, y = place(tab, "deck.8")
    tab.mouse("mousePressed", x, y)
    for k in range(20):
        tab.mouse("mouseMoved", x, min(y + 25 * k, 715))
        _steps(tab, 8)
    tab.mouse("mouseReleased", x, 715)
    _steps(tab, 60)
    assert tab.evaluate("torn")
    replay = _saved(tab, tmp_path)
    assert verify(replay) is None
    assert _types(replay)[0] == "grab" and tab.faults == []
