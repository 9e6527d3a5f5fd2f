"""A page that plays runs, in a real browser: keys play, step and seek it."""

from pathlib import Path

from tests.page.browser import Browser, Tab, page_address
from tests.support.player_page import TICKS, rope_page

TICK = "Number(document.documentElement.dataset.tick)"
PLAYING = "document.documentElement.dataset.playing"
DRAWN = """[...document.querySelectorAll('canvas')].map((each) =>
  each.getContext('2d').getImageData(0, 0, each.width, each.height).data.some((value) => value > 0))"""
# Until time has gone on.
LATER = f"""new Promise((done) => {{
  const look = () => ({TICK} > 0 ? done() : requestAnimationFrame(look));
  look();
}})"""


def _tick_after(tab: Tab, key: str) -> int:
    tab.key(key)
    tick: int = tab.evaluate(TICK)
    return tick


def test_in_a_browser_keys_play_step_and_seek(browser: Browser, tmp_path: Path) -> None:
    file = tmp_path / "player.html"
    file.write_text(rope_page().text(), encoding="utf-8")
    tab = browser.tab().show(page_address(file))
    assert tab.evaluate(TICK) == 13
    keys = ("Home", "ArrowRight", "ArrowRight", "ArrowLeft", "End", "ArrowRight", "d", "Home")
    assert [_tick_after(tab, key) for key in keys] == [0, 3, 6, 3, TICKS, TICKS, 13, 0]
    tab.evaluate("document.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', shiftKey: true }))")
    assert tab.evaluate(TICK) == 27
    scrub = "document.getElementById('scrub')"
    tab.evaluate(f"{scrub}.value = 2; {scrub}.dispatchEvent(new Event('input'))")
    assert _tick_after(tab, "o") == 6
    assert tab.evaluate("document.getElementById('over').getAttribute('aria-pressed')") == "true"
    assert tab.evaluate(DRAWN) == [True, True]
    tab.key("Home")
    tab.key(" ")
    assert tab.evaluate(PLAYING) == "true"
    tab.evaluate(LATER)
    # It may have come to its end meanwhile, which lets time stand too.
    tab.evaluate(f"if ({PLAYING} === 'true') document.getElementById('play').click()")
    assert (tab.evaluate(PLAYING), tab.evaluate(TICK) > 0) == ("false", True)
    assert tab.evaluate("document.getElementById('now').textContent").endswith("m apart")
    assert tab.faults == []


def test_in_a_browser_a_line_of_what_happened_goes_to_its_tick(browser: Browser, tmp_path: Path) -> None:
    file = tmp_path / "player.html"
    file.write_text(rope_page().text(), encoding="utf-8")
    tab = browser.tab().show(page_address(file))
    lines = "[...document.querySelectorAll('#happened button')]"
    assert tab.evaluate(f"{lines}.map((each) => each.textContent)") == [
        "rope.3 was grabbed",
        "only actual: rope:4 was cut",
    ]
    current = f"{lines}.map((each) => each.getAttribute('aria-current'))"
    assert tab.evaluate(current) == ["false", "true"]
    tab.evaluate(f"{lines}[0].click()")
    assert tab.evaluate(TICK) == 0 and tab.evaluate(current) == ["true", "false"]
    assert tab.faults == []
