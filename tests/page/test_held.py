"""What a key or a pointer holds goes on only while somebody holds it; what ends that is heard, wherever it happens."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox.cli import main
from sandbox.replay import read_replay, verify
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import FRAMES, READY, TICKED, opened, saved
from tests.page.site_server import served

PHONE = {"width": 390, "height": 844, "is_phone": True}
OWN = """<!doctype html>
<canvas id="toy" style="width: 300px; height: 200px"></canvas><input id="field"><button id="button">Drive</button>
<script type="module">
import { open } from './sandbox/toy.js';
globalThis.toy = await open(document.getElementById('toy'), 'levels/suspension_car.toy');
const button = document.getElementById('button');
button.onpointerdown = () => toy.drives.press('d');
button.onpointerup = () => toy.drives.release('d');
</script>"""
# Whether something is driven or held in a toy.
GOES_ON = """TOY.world.view('state.actuator_value').some(Boolean)
  || Array.from({ length: TOY.world.hands.count }, (_, hand) => TOY.world.isHeld(hand)).some(Boolean)"""
# Of a page, where the middle of its first key and a particle of the car are.
PLACES = """(() => {
  const { x, y, width, height } = document.querySelector('.key').getBoundingClientRect(), { toy } = page;
  const k = toy.level.about.names.particle.findIndex((name, slot) => toy.world.canMove(slot));
  const at = toy.camera.toPixels(...toy.world.view('state.position').subarray(2 * k, 2 * k + 2));
  return [[x + width / 2, y + height / 2], at];
})()"""
LEAVING = {
    "another window": "dispatchEvent(new Event('blur'))",
    "another tab": "document.dispatchEvent(new Event('visibilitychange'))",
    "another page": "dispatchEvent(new Event('pagehide'))",
    "out of sight": "toy.canvas.style.display = 'none'",
    "out of the page": "toy.canvas.remove()",
}


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("held")
    assert main(["site", "suspension_car", "-o", str(folder)]) == 0
    (folder / "own.html").write_text(OWN, encoding="utf-8")
    with served(folder) as at:
        yield at


def _goes_on(tab: Tab) -> bool:
    return bool(tab.evaluate(GOES_ON.replace("TOY", "(globalThis.page?.toy ?? toy)")))


def _own(browser: Browser, address: str) -> Tab:
    tab = browser.tab().show(f"{address}own.html")
    tab.evaluate(READY)
    tab.evaluate("toy.canvas.focus()")
    return tab


def _car(browser: Browser, folder: Path, **how: object) -> Tab:
    tab = opened(browser, folder, level_page("suspension_car"), **how)
    tab.evaluate(TICKED)
    return tab


@pytest.mark.parametrize("leaving", LEAVING)
def test_who_leaves_lets_go_of_everything(browser: Browser, tmp_path: Path, leaving: str) -> None:
    tab = _car(browser, tmp_path, **PHONE)
    keys, particle = tab.evaluate(PLACES)
    tab.press("d")
    tab.touch("touchStart", keys)
    tab.touch("touchStart", keys, particle)
    held = "[document.querySelectorAll('.key[aria-pressed=true]').length, page.toy.world.isHeld(0)]"
    assert tab.evaluate(held) == [2, True]
    tab.evaluate(f"{{ const {{ toy }} = page; {LEAVING[leaving]} }}")
    tab.evaluate(FRAMES)
    assert tab.evaluate(held) == [0, False]
    assert not _goes_on(tab)
    assert verify(read_replay(saved(tab, tmp_path))) is None
    assert tab.faults == []


def test_a_button_that_a_key_holds_is_let_go_with_the_focus(browser: Browser, tmp_path: Path) -> None:
    tab = _car(browser, tmp_path)
    for leaving in ("document.getElementById('time').focus()", LEAVING["another window"]):
        tab.evaluate("document.querySelector('.key').focus()")
        tab.press(" ")
        assert _goes_on(tab)
        tab.evaluate(leaving)
        assert not _goes_on(tab)
        tab.release(" ")


@pytest.mark.parametrize("end", ["touchEnd", "touchCancel", "lost"])
def test_a_finger_lets_go_however_it_ends(browser: Browser, tmp_path: Path, end: str) -> None:
    tab = _car(browser, tmp_path, **PHONE)
    tab.evaluate("addEventListener('pointerdown', ({ pointerId }) => { globalThis.finger = pointerId; })")
    for place in tab.evaluate(PLACES):
        tab.touch("touchStart", place)
        assert _goes_on(tab)
        if end == "lost":
            # Another script may take the pointer: at the next move it has it.
            for taking in ("0", "document.body.setPointerCapture(finger)"):
                tab.evaluate(taking)
                tab.touch("touchMove", (place[0] + len(taking), place[1]))
                tab.evaluate(FRAMES)
        else:
            tab.touch(end)
            # A browser answers before a page has heard of what cannot be prevented.
            tab.evaluate(FRAMES)
        assert not _goes_on(tab)
        if end == "lost":
            tab.touch("touchEnd")


def test_a_mouse_whose_button_was_lifted_elsewhere_drags_nothing(browser: Browser, tmp_path: Path) -> None:
    tab = _car(browser, tmp_path)
    x, y = tab.evaluate(PLACES)[1]
    tab.mouse("mousePressed", x, y)
    assert _goes_on(tab)
    tab.send("Input.dispatchMouseEvent", type="mouseMoved", x=x + 50, y=y, button="none", buttons=0)
    assert not _goes_on(tab)


def test_only_the_left_button_of_a_mouse_holds_a_key_of_the_page(browser: Browser, tmp_path: Path) -> None:
    tab = _car(browser, tmp_path)
    x, y = tab.evaluate(PLACES)[0]
    tab.send("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="right", buttons=2, clickCount=1)
    assert not _goes_on(tab)


def test_a_key_that_is_lifted_elsewhere_drives_nothing_on(browser: Browser, address: str) -> None:
    tab = _own(browser, address)
    tab.press("a")
    assert tab.evaluate("[...toy.world.view('state.actuator_value')]") == [-1, -1]
    tab.evaluate("document.getElementById('field').focus()")
    assert not _goes_on(tab)
    tab.release("a")
    tab.evaluate("toy.canvas.focus()")
    tab.press("d")
    assert tab.evaluate("[...toy.world.view('state.actuator_value')]") == [1, 1]
    tab.release("d")
    assert not _goes_on(tab)


def test_what_a_button_of_ones_own_page_holds_does_not_end_with_the_focus(browser: Browser, address: str) -> None:
    tab = _own(browser, address)
    x, y = tab.evaluate(
        "(({ x, y, width, height }) => [x + width / 2, y + height / 2])(button.getBoundingClientRect())"
    )
    tab.mouse("mousePressed", x, y)
    assert tab.evaluate("document.activeElement.id") == "button"
    assert _goes_on(tab)
    tab.mouse("mouseReleased", x, y)
    assert not _goes_on(tab)


@pytest.mark.parametrize(
    "lifting",
    [
        # The same key is called otherwise while Option is down.
        {"code": "KeyD", "key": "\u2202"},
        # Of keys that go up while Meta is down a Mac tells nothing.
        {"code": "MetaLeft", "key": "Meta"},
    ],
    ids=["called otherwise", "not told"],
)
def test_a_key_is_lifted_whatever_it_is_called_then(browser: Browser, address: str, lifting: dict[str, str]) -> None:
    tab = _own(browser, address)
    tab.send("Input.dispatchKeyEvent", type="keyDown", key="d", code="KeyD", text="d")
    assert _goes_on(tab)
    tab.send("Input.dispatchKeyEvent", type="keyUp", **lifting)
    assert not _goes_on(tab)


def test_a_particle_that_enter_took_stays_in_hand_until_escape(browser: Browser, address: str) -> None:
    tab = _own(browser, address)
    tab.key("n")
    tab.key("Enter")
    tab.evaluate("document.getElementById('field').focus(); dispatchEvent(new Event('blur'))")
    assert _goes_on(tab)
    tab.evaluate("toy.canvas.focus()")
    tab.key("Escape")
    assert not _goes_on(tab)


# The last value to which each part of the sound goes.
GOALS = """globalThis.goals = new Map();
const { setTargetAtTime } = AudioParam.prototype;
AudioParam.prototype.setTargetAtTime = function (value, ...rest) {
  goals.set(this, value);
  return setTargetAtTime.call(this, value, ...rest);
};"""
# Of motors, which sound first: pitch, loudness and so on.
LOUDNESS = "[...goals.values()].slice(0, 2 * toy.sound.motors.length).filter((_, k) => k % 2)"


@pytest.mark.parametrize("standing", ["toy.pause()", *LEAVING.values()])
def test_a_motor_does_not_hum_on_while_time_stands(browser: Browser, address: str, standing: str) -> None:
    tab = _own(browser, address)
    tab.evaluate(f"toy.pause(); {GOALS}")
    tab.evaluate("toy.sound.toggle(); toy.drives.press('d'); for (let k = 0; k < 20; k++) toy.tick()")
    loud = tab.evaluate(LOUDNESS)
    assert loud and min(loud) > 0
    tab.evaluate(f"toy.isPaused = false; {standing}")
    tab.evaluate(FRAMES)
    assert not any(tab.evaluate(LOUDNESS))
