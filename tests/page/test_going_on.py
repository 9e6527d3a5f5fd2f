"""A run goes on: by redo, by the next puzzle, by a link for others; no reload or failed fetch ends it."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox.app.share.playing import page_of
from sandbox.cli import main
from sandbox.session.replay.link import MARK
from tests.page.browser import Browser, Tab, page_address
from tests.page.levels import level_page
from tests.page.opened import FRAMES, START_OVER, VERDICT, opened
from tests.page.pointing import click, drag, place, text
from tests.page.site_server import served
from tests.support.rules_level import answering

SITE = ("chain_of_events", "squeeze", "rope")
HASH = "page.toy.world.hash().whole"
UNTIL_SAID = "new Promise((done) => { const look = () => (SAID ? done() : requestAnimationFrame(look)); look(); })"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    assert main(["site", *SITE, "-o", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    with served(site) as at:
        yield at


def _dragged(tab: Tab, particle: str) -> None:
    x, y = place(tab, particle)
    drag(tab, (x, y), (x + 30, y - 20))


def test_what_was_undone_is_done_again_by_button_and_keys_until_something_else_is_done(
    browser: Browser, tmp_path: Path
) -> None:
    tab = opened(browser, tmp_path, level_page("rope"))
    tab.evaluate(START_OVER)
    tab.evaluate("for (let k = 0; k < 20; k++) page.toy.tick()")
    _dragged(tab, "rope.20")
    tab.evaluate("for (let k = 0; k < 20; k++) page.toy.tick()")
    before = tab.evaluate(f"[page.toy.run.time, {HASH}]")
    for undo, redo in (("z", "y"), ("z", "Z"), (None, None)):
        for key, button in ((undo, "#undo"), (redo, "#redo")):
            if key is None:
                click(tab, button)
            else:
                tab.key_with_ctrl(key)
            if button == "#undo":
                assert tab.evaluate("[page.toy.run.time, page.toy.run.commands.length]") == [20, 0]
        assert tab.evaluate(f"[page.toy.run.time, {HASH}]") == before
    click(tab, "#redo")
    assert text(tab, "#state") == "There is nothing to redo."
    click(tab, "#undo")
    _dragged(tab, "rope.30")
    click(tab, "#redo")
    assert text(tab, "#state") == "There is nothing to redo."
    assert tab.faults == []


def test_a_reload_asks_where_something_was_done_that_no_link_or_file_holds(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}levels/rope.html")
    asks = "!dispatchEvent(new Event('beforeunload', { cancelable: true }))"
    tab.evaluate(START_OVER)
    assert not tab.evaluate(asks)
    _dragged(tab, "rope.20")
    assert tab.evaluate(asks)
    # A real one, too.
    assert tab.is_asked("location.reload()", stays=True)
    assert tab.evaluate("page.toy.run.commands.length") == 2
    click(tab, "#link")
    tab.evaluate(UNTIL_SAID.replace("SAID", "location.hash"))
    assert not tab.evaluate(asks)
    tab.evaluate("page.toy.step()")
    _dragged(tab, "rope.10")
    assert tab.evaluate(asks)
    tab.evaluate("HTMLAnchorElement.prototype.click = () => {}; document.getElementById('save').click()")
    tab.evaluate(UNTIL_SAID.replace("SAID", "document.getElementById('state').textContent.startsWith('Saved')"))
    assert not tab.evaluate(asks)
    _dragged(tab, "rope.30")
    # Who follows a link of the page means to leave.
    tab.led(lambda: click(tab, "header a"))
    assert tab.evaluate("document.querySelector('.cards') !== null")


def test_time_goes_on_after_a_link_was_copied_and_after_a_file_was_saved(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}levels/rope.html")
    for button, said in (("link", "link"), ("save", "Saved")):
        tab.evaluate(f"HTMLAnchorElement.prototype.click = () => {{}}; document.getElementById('{button}').click()")
        tab.evaluate(UNTIL_SAID.replace("SAID", f"document.getElementById('state').textContent.includes('{said}')"))
        assert not tab.evaluate("page.toy.isPaused")


def test_who_has_won_is_led_to_the_next_puzzle_and_can_send_the_run(browser: Browser, address: str, site: Path) -> None:
    pages = {stem: (site / "levels" / f"{stem}.html").read_text(encoding="utf-8") for stem in SITE}
    assert '<a href="squeeze.html">Next: ' in pages["chain_of_events"]
    assert "Next: " not in pages["squeeze"] + pages["rope"]
    tab = browser.tab(390, 844, is_phone=True).open(f"{address}levels/chain_of_events.html")
    tab.evaluate("navigator.share = async (what) => { globalThis.sent = what; }")
    for is_won in ("false", "true"):
        value = f"{{ isWon: {is_won}, text: '', stars: 1, tick: 5 }}"
        tab.evaluate(f"Object.defineProperty(page.toy, 'outcome', {{ configurable: true, value: {value} }})")
        tab.evaluate("page.toy.dispatchEvent(new CustomEvent('outcome'))")
        assert tab.evaluate("document.querySelector('#end-card a').offsetParent !== null") == (is_won == "true")
    click(tab, "#end-send")
    tab.evaluate(UNTIL_SAID.replace("SAID", "globalThis.sent"))
    assert f"chain_of_events.html#{MARK}" in tab.evaluate("sent.url")
    tab.led(lambda: click(tab, "#end-card a"))
    assert tab.evaluate("document.title") == "Squeeze through"


def test_a_link_to_another_level_leads_to_it(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}levels/rope.html")
    fragment = tab.evaluate("page.toy.link()")
    tab = browser.tab().open(f"{address}levels/squeeze.html{fragment}")
    assert tab.evaluate(VERDICT) == "This link is to another level. Open it there."
    tab.led(lambda: click(tab, "#verdict a"))
    assert str(tab.evaluate(VERDICT)).startswith("Verified")


def test_what_could_not_be_fetched_is_fetched_again(browser: Browser, address: str) -> None:
    for cut in ("*kernels.wasm.gz", "*.toy"):
        tab = browser.tab()
        tab.send("Network.enable")
        tab.send("Network.setBlockedURLs", urls=[cut])
        tab.open(f"{address}levels/rope.html")
        assert text(tab, "#error").endswith("could not be fetched.")
        tab.send("Network.setBlockedURLs", urls=[])
        click(tab, "#retry")
        tab.evaluate(UNTIL_SAID.replace("SAID", "globalThis.page"))
        assert tab.evaluate("document.getElementById('fault').innerText").strip() == ""


def test_a_list_that_is_opened_from_a_disk_says_why_nothing_plays(browser: Browser, address: str, site: Path) -> None:
    shown = "document.getElementById('why').offsetParent !== null"
    tab = browser.tab().open(f"{address}index.html")
    assert not tab.evaluate(shown)
    tab.show(page_address(site / "index.html"))
    assert tab.evaluate(shown) and "web server" in text(tab, "#why")


def test_a_verdict_stands_whatever_else_is_said(browser: Browser, tmp_path: Path) -> None:
    level = answering(goal="Bring the ball into the basket")
    tab = opened(browser, tmp_path, page_of(level, [], 60))
    said = tab.evaluate(VERDICT)
    assert said.startswith("Verified")
    tab.evaluate("page.toy.seek(0); while (!page.toy.outcome) page.toy.tick()")
    tab.evaluate(FRAMES)
    assert text(tab, "#state") == "Through the ring"
    click(tab, "#make")
    click(tab, "#erase")
    assert text(tab, "#verdict") == said
    # Words of rules go with what they were about.
    left = "(document.getElementById('again').click(), document.getElementById('state').textContent)"
    assert tab.evaluate(left) != "Through the ring"
    assert text(tab, "#verdict") == said
    assert json.dumps(tab.faults) == "[]"
