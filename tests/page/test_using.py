"""A page can be used by touch alone, by keys alone, and read by a screen reader."""

from pathlib import Path

import pytest

from tests.page.browser import Browser, Tab
from tests.page.contrast import CONTRAST, LEAST_CONTRAST
from tests.page.levels import level_page
from tests.page.opened import FRAMES, SETTLED, opened
from tests.page.pointing import middle, tap

PHONE = {"width": 390, "height": 844, "is_phone": True}
# Colours of text and of what is behind it, by their names in a page.
PAIRS = (
    ["text", "surface"], ["muted", "field"], ["text", "back"], ["muted", "back"], ["on", "accent"], ["accent", "back"],
    ["danger", "back"],
)  # fmt: skip


def _opened(browser: Browser, folder: Path, name: str, **how: object) -> Tab:
    return opened(browser, folder, level_page(name), **how)


def test_everything_that_can_be_used_has_a_name(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "suspension_car")
    tab.evaluate("document.getElementById('tune').click()")
    nameless = """[...document.querySelectorAll('button, input, select, canvas')].filter((each) =>
      !(each.getAttribute('aria-label') || each.labels?.[0]?.textContent.trim() || each.textContent.trim())
    ).map((each) => each.outerHTML)"""
    assert tab.evaluate(nameless) == []
    assert tab.evaluate("[document.title, document.documentElement.lang]") == ["Car with suspension", "en"]


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_text_can_be_read_in_both_themes(browser: Browser, tmp_path: Path, scheme: str) -> None:
    tab = _opened(browser, tmp_path, "rope", scheme=scheme)
    assert tab.evaluate("document.documentElement.dataset.theme") == scheme
    for pair in PAIRS:
        assert tab.evaluate(f"({CONTRAST})({pair})") >= LEAST_CONTRAST, pair


def test_nothing_lies_outside_a_phone_and_all_is_large_enough_for_a_finger(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "suspension_car", **PHONE)
    wrong = """[...document.querySelectorAll('#bars button')].filter((each) => each.offsetParent)
      .map((each) => each.getBoundingClientRect()).filter((box) => box.left < 0 || box.right > innerWidth ||
        box.bottom > innerHeight || Math.min(box.width, box.height) < 44)"""
    assert tab.evaluate(wrong) == []
    tab.evaluate("document.getElementById('make').click()")
    assert tab.evaluate("document.getElementById('rod').offsetParent !== null") and tab.evaluate(wrong) == []


def test_two_fingers_zoom_and_one_moves_the_view(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope", **PHONE)
    zoom = tab.evaluate("page.toy.camera.zoom")
    tab.touch("touchStart", (150, 500), (250, 500))
    tab.touch("touchMove", (100, 500), (300, 500))
    tab.touch("touchEnd")
    assert tab.evaluate("page.toy.camera.zoom") == pytest.approx(2.0 * zoom, rel=0.01)
    x = tab.evaluate("page.toy.camera.x")
    tab.touch("touchStart", (150, 500))
    tab.touch("touchMove", (100, 500))
    tab.touch("touchEnd")
    assert tab.evaluate(f"(page.toy.camera.x - {x!r}) * page.toy.camera.zoom") == pytest.approx(50, rel=0.01)


def test_two_taps_beside_everything_or_a_key_show_the_whole_level_again(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope", **PHONE)
    view = "[page.toy.camera.x, page.toy.camera.y, page.toy.camera.zoom]"
    # Words that go once somebody has played leave more room.
    tap(tab, "#hint")
    tab.evaluate(SETTLED)
    whole = tab.evaluate(view)
    for again in ("taps", "f"):
        tab.touch("touchStart", (150, 250))
        tab.touch("touchMove", (100, 310))
        tab.touch("touchEnd")
        assert tab.evaluate(view) != whole
        if again == "taps":
            tab.tap_twice((60, 250))
        else:
            tab.key("f")
        assert tab.evaluate(view) == whole
    tab.evaluate("page.toy.camera.x += 1")
    moved = tab.evaluate(view)
    for _ in range(2):
        tab.touch("touchStart", (60, 600))
        tab.touch("touchCancel")
    assert tab.evaluate(view) == moved


def test_firmness_is_set_by_touch(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "jelly_wheel", **PHONE)
    tap(tab, "#tune")
    tap(tab, ".words button:first-child")
    soft = tab.evaluate("page.panel.pair")
    assert tab.evaluate("document.querySelector('.words button').getAttribute('aria-pressed')") == "true"
    x, y = middle(tab, ".pad")
    tab.touch("touchStart", (x, y))
    tab.touch("touchMove", (x + 80, y - 20))
    # A finger that is lifted while it moves would be a flick, whose next tap only stops it.
    tab.evaluate(FRAMES)
    tab.touch("touchEnd")
    stiff = tab.evaluate("page.panel.pair")
    assert stiff[0] > soft[0]
    tab.evaluate("page.toy.pause()")
    tap(tab, "#undo")
    assert tab.evaluate("page.panel.pair") == soft


def test_gravity_is_typed_and_undone(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "hourglass")
    tab.evaluate("page.toy.pause(); document.getElementById('tune').click()")
    assert tab.evaluate("document.querySelector('#panel h2').textContent") == "World"
    field = "document.querySelectorAll('.fields input')[1]"
    for typed, wanted in (("9.81", 9.81), ("", 9.81), ("1e9", 9.81), ("-3", -3)):
        tab.evaluate(f"{field}.focus(); {field}.value = '{typed}'; {field}.dispatchEvent(new Event('change'))")
        assert tab.evaluate("page.toy.world.settings().gravity[1]") == wanted
        assert tab.evaluate(f"Number({field}.value)") == wanted
    tab.evaluate(f"{field}.blur(); page.toy.undo()")
    assert tab.evaluate(f"[page.toy.world.settings().gravity[1], Number({field}.value)]") == [9.81, 9.81]


def test_a_button_drives_a_motor_while_it_is_touched(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "suspension_car", **PHONE)
    tab.touch("touchStart", middle(tab, ".key"))
    assert tab.evaluate("page.toy.world.view('state.actuator_value').some((value) => value !== 0)")
    tab.touch("touchEnd")
    assert not tab.evaluate("page.toy.world.view('state.actuator_value').some((value) => value !== 0)")


def test_keys_pause_step_and_drive(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "suspension_car")
    tab.key(" ")
    assert tab.evaluate("page.toy.isPaused")
    time = tab.evaluate("page.toy.world.time")
    tab.key(".")
    assert tab.evaluate("page.toy.world.time") == time + 1
    tab.key("d")
    types = tab.evaluate("page.toy.run.commands.map(({ record }) => [record.type, Math.abs(record.value)])")
    assert types[-1] == ["set_drive", 0]
    assert tab.faults == []


def test_sound_is_off_until_it_is_touched_and_then_plays_without_a_fault(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "suspension_car", **PHONE)
    assert not tab.evaluate("page.toy.sound.isOn")
    tap(tab, "#sound")
    tab.evaluate("page.toy.drives.press('d'); for (let k = 0; k < 200; k++) page.toy.tick()")
    tab.evaluate("page.toy.drives.releaseAll()")
    assert tab.evaluate("page.toy.sound.isOn")
    assert tab.faults == []


def test_a_hint_has_the_words_of_what_people_have_at_hand(browser: Browser, tmp_path: Path) -> None:
    hints = "document.getElementById('hints').innerText"
    by_mouse = _opened(browser, tmp_path, "egg_drop").evaluate(hints)
    assert "Right click the cushion" in by_mouse and by_mouse.endswith("R begins again.")
    by_finger = _opened(browser, tmp_path, "egg_drop", **PHONE).evaluate(hints)
    assert "Rest a finger on the cushion" in by_finger and by_finger.endswith("The round arrow begins again.")
