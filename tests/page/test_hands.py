"""What people do to a page by mouse and fingers is verified bit for bit on the desktop."""

from pathlib import Path

from sandbox import Session, load_level
from sandbox.app.share.playing import page_of
from sandbox.commands import Grab, Release
from sandbox.replay import Replay, read_replay, verify
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import START_OVER, VERDICT, opened, saved

PHONE = {"width": 390, "height": 844, "is_phone": True}


def _opened(browser: Browser, folder: Path, name: str, **how: object) -> Tab:
    tab = opened(browser, folder, level_page(name), **how)
    tab.evaluate(START_OVER)
    return tab


def _steps(tab: Tab, count: int) -> None:
    tab.evaluate(f"for (let k = 0; k < {count}; k++) page.toy.tick()")


def _place(tab: Tab, particle: str) -> tuple[float, float]:
    slot = f"page.toy.level.about.names.particle.indexOf('{particle}')"
    position = "page.toy.world.view('state.position')"
    x, y = tab.evaluate(f"page.toy.camera.toPixels({position}[2 * {slot}], {position}[2 * {slot} + 1])")
    return x, y


def _saved(tab: Tab, folder: Path) -> Replay:
    return read_replay(saved(tab, folder))


def _types(replay: Replay) -> list[str]:
    return [line.record["type"] for line in replay.script]


def test_a_drag_by_mouse_is_verified(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "rope")
    _steps(tab, 30)
    x, y = _place(tab, "rope.20")
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
        x, y = _place(tab, "rope.20")
        tab.mouse("mousePressed", x, y)
        tab.mouse("mouseReleased", x, y)
        _steps(tab, 40)
    replay = _saved(tab, tmp_path)
    assert (verify(replay), _types(replay)) == (None, ["pin", "unpin"])


def test_a_bridge_that_is_torn_breaks_as_it_does_on_the_desktop(browser: Browser, tmp_path: Path) -> None:
    session, file = Session(load_level("breaking_bridge")), tmp_path / "torn.replay.gz"
    session.record_to(file)
    middle = session.world.particle_slot("deck.8")
    x, y = session.world.position[middle].tolist()
    session.submit(Grab(0, middle, (x, y - 5.0), strength=300.0), 1)
    while len(session.breaks) < 2:
        session.advance()
    session.submit(Release(0), 1)
    for _ in range(60):
        session.advance()
    session.stop_recording()
    replay = read_replay(file)
    tab = opened(browser, tmp_path, page_of(replay.level, replay.script, replay.ticks))
    assert tab.evaluate(VERDICT).startswith("Verified")
