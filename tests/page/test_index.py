"""The list of levels plays: a toy at its top, and each level in place while a pointer rests on it."""

from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pygame
import pytest

from sandbox.cli import main
from sandbox.level.reading.files import shipped_levels
from tests.page.browser import Browser, Tab
from tests.page.opened import FRAMES
from tests.page.site_server import AT, served

PHONE = {"width": 390, "height": 844, "is_phone": True}
# All that has come of the page until now [bytes], and where from.
COME = """performance.getEntriesByType('resource').concat(performance.getEntriesByType('navigation'))
  .map(({ name, encodedBodySize }) => [new URL(name).origin, encodedBodySize])"""
# The pixel of a particle of the toy that can be dragged.
PLACE = """(() => {
  const { toy } = page, k = toy.world.particles.findIndex((slot) => toy.world.canMove(slot));
  const [x, y] = toy.camera.toPixels(...toy.world.view('state.position').subarray(2 * k, 2 * k + 2));
  const { left, top } = toy.canvas.getBoundingClientRect();
  return [left + x, top + y];
})()"""
PREVIEW = """new Promise((done) => {
  const look = () => (page.previews.shown?.toy?.run.time > 60 ? done(page.previews.shown.link.getAttribute('href'))
    : requestAnimationFrame(look));
  look();
})"""
TIME = "page.toy.run.time"
# The pixels around a place in which a card of a level lies.
CARD = """(() => {
  const { x, y, width, height } = document.querySelector('.cards a[href*=STEM]').getBoundingClientRect();
  return [x + width / 2, y + height / 2];
})()"""


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    with served(site) as at:
        yield f"{at}index.html"


class _Card(HTMLParser):
    """What a page gives who shows a link to it."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.said: dict[str, str] = {}
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        name = given.get("property") or given.get("name") or ""
        if tag == "meta" and name.startswith(("og:", "twitter:")):
            self.said[name] = given.get("content") or ""


def _still(tab: Tab, wants: bool = True) -> Tab:
    features = [{"name": "prefers-reduced-motion", "value": "reduce" if wants else "no-preference"}]
    tab.send("Emulation.setEmulatedMedia", features=features)
    return tab


@pytest.mark.parametrize("how", [{"width": 1280, "height": 800}, PHONE], ids=["desk", "phone"])
def test_a_toy_plays_by_itself_and_all_that_comes_is_light_and_from_here(
    browser: Browser, address: str, how: dict[str, int]
) -> None:
    browser.tab().show("about:blank")
    tab = browser.tab(**how)
    tab.send("Network.enable")
    tab.send("Network.setCacheDisabled", cacheDisabled=True)
    tab.open(address)
    before = tab.evaluate(TIME)
    tab.evaluate(FRAMES)
    assert tab.evaluate(TIME) > before
    tab.evaluate("Promise.all([...document.images].slice(0, 2).map((each) => each.decode()))")
    # Nothing is fetched for levels that are far below.
    assert not tab.evaluate("[...document.images].at(-1).currentSrc")
    come = tab.evaluate(COME)
    assert {origin for origin, _ in come} == {address.rpartition("/")[0]}
    assert 250_000 < sum(size for _, size in come) <= 500_000
    assert tab.faults == []


def test_the_toy_is_dragged_by_mouse_and_begins_again_when_nobody_has_touched_it(
    browser: Browser, address: str
) -> None:
    tab = browser.tab(width=1280, height=800).open(address)
    x, y = tab.evaluate(f"page.toy.pause(); {PLACE}")
    tab.mouse("mousePressed", x, y)
    assert tab.evaluate("[page.toy.isPaused, page.toy.world.isHeld(0)]") == [False, True]
    tab.mouse("mouseMoved", x + 40, y - 40)
    tab.evaluate(FRAMES)
    tab.mouse("mouseReleased", x + 40, y - 40)
    assert not tab.evaluate("page.toy.world.isHeld(0)")
    assert (
        tab.evaluate("page.toy.pause(); for (let k = 0; k < 20 * 60 + 200; k++) page.toy.tick(); page.toy.run.time")
        < 600
    )
    assert tab.faults == []


def test_a_finger_drags_what_it_meets_and_else_moves_the_page(browser: Browser, address: str) -> None:
    tab = browser.tab(**PHONE).open(address)
    view = "[page.toy.camera.x, page.toy.camera.y, page.toy.camera.zoom]"
    x, y = tab.evaluate(f"page.toy.pause(); {PLACE}")
    tab.touch("touchStart", (x, y))
    tab.touch("touchMove", (x, y - 60))
    assert tab.evaluate("page.toy.world.isHeld(0)")
    tab.touch("touchEnd")
    whole = tab.evaluate(view)
    corner = tab.evaluate("(({ left, bottom }) => [left + 30, bottom - 20])(page.toy.canvas.getBoundingClientRect())")
    tab.touch("touchStart", (corner[0], corner[1]))
    for step in range(1, 9):
        tab.touch("touchMove", (corner[0], corner[1] - 25 * step))
    tab.touch("touchEnd")
    tab.evaluate(FRAMES)
    assert tab.evaluate("scrollY") > 100
    assert tab.evaluate(view) == whole and not tab.evaluate("page.toy.world.isHeld(0)")


def test_a_phone_that_draws_too_slowly_draws_fewer_pixels(browser: Browser, address: str) -> None:
    tab = browser.tab(**PHONE).open(address)
    slow = """new Promise((done) => {
      const { toy } = page, tick = toy.tick.bind(toy);
      toy.tick = () => {
        for (const end = performance.now() + 30; performance.now() < end;);
        tick();
      };
      toy.addEventListener('draw', () => { if (toy.canvas.width <= toy.camera.width + 1) done(true); });
    })"""
    assert tab.evaluate("page.toy.canvas.width > 1.4 * page.toy.camera.width")
    assert tab.evaluate(slow)


def test_the_toy_stands_while_it_is_out_of_view(browser: Browser, address: str) -> None:
    tab = browser.tab(width=1280, height=800).open(address)
    tab.evaluate("scrollTo(0, 3000)")
    tab.evaluate(FRAMES)
    before = tab.evaluate(TIME)
    tab.evaluate(FRAMES)
    assert tab.evaluate(TIME) == before
    tab.evaluate("scrollTo(0, 0)")
    tab.evaluate(FRAMES)
    assert tab.evaluate(TIME) > before


def test_nothing_moves_for_who_wants_less_motion_until_it_is_asked_for(browser: Browser, address: str) -> None:
    tab = _still(browser.tab(width=1280, height=800)).open(address)
    tab.evaluate(FRAMES)
    assert tab.evaluate(f"[{TIME}, page.toy.canvas.className]") == [0, "drawn"]
    assert tab.evaluate("document.querySelector('#hero button').getAttribute('aria-label')") == "Play"
    x, y = tab.evaluate(CARD.replace("STEM", "rope"))
    tab.evaluate(f"scrollTo(0, {y} - 400)")
    tab.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=400, button="none", buttons=0)
    tab.evaluate(FRAMES)
    assert tab.evaluate("document.querySelectorAll('.cards canvas').length") == 0
    tab.evaluate("scrollTo(0, 0); document.querySelector('#hero button').click()")
    tab.evaluate(FRAMES)
    assert tab.evaluate(TIME) > 0
    _still(tab, False)


# One that goes by itself, one with keys, one that stands still.
@pytest.mark.parametrize("stem", ["jelly_pile", "ferris_wheel", "truss_bridge"])
def test_a_level_plays_in_its_place_while_the_mouse_rests_on_it(browser: Browser, address: str, stem: str) -> None:
    tab = browser.tab(width=1280, height=800).open(address)
    tab.evaluate("page.toy.pause()")
    tab.evaluate(f"document.querySelector('.cards a[href*={stem}]').scrollIntoView({{ block: 'center' }})")
    x, y = tab.evaluate(CARD.replace("STEM", stem))
    tab.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, button="none", buttons=0)
    assert tab.evaluate(PREVIEW) == f"levels/{stem}.html"
    toy = "page.previews.shown.toy"
    tab.evaluate(f"for (let k = 0; k < 200; k++) {toy}.tick()")
    speed = f"Math.max(...{toy}.world.view('state.velocity').map(Math.abs))"
    driven = f"{toy}.run.commands.length + {speed}"
    assert tab.evaluate(driven) > 0.1
    tab.send("Input.dispatchMouseEvent", type="mouseMoved", x=5, y=5, button="none", buttons=0)
    tab.evaluate(FRAMES)
    assert tab.evaluate("[page.previews.shown, document.querySelectorAll('.cards canvas').length]") == [None, 0]
    assert tab.faults == []


def test_by_touch_the_level_plays_that_is_in_the_middle_once_the_list_rests(browser: Browser, address: str) -> None:
    tab = browser.tab(**PHONE).open(address)
    tab.send("Emulation.setEmulatedMedia", features=[{"name": "hover", "value": "none"}])
    tab.evaluate("document.querySelector('.cards a[href*=walker]').scrollIntoView({ block: 'center' })")
    assert tab.evaluate(PREVIEW) == "levels/walker.html"


def test_links_to_every_page_have_a_title_a_text_and_a_picture_that_is_there(site: Path) -> None:
    pages = [site / "index.html", *site.glob("levels/*.html")]
    assert len(pages) == 1 + len(list(shipped_levels()))
    for path in pages:
        said = _Card(path).said
        assert said["og:title"] and said["og:description"] and said["og:url"].startswith(f"{AT}/")
        picture = site / said["og:image"].removeprefix(f"{AT}/")
        assert picture.stat().st_size <= 60_000
        assert pygame.image.load(picture).get_size() == (1200, 630)


def test_without_an_address_links_have_words_and_nothing_names_another_place(tmp_path: Path) -> None:
    assert main(["site", "rope", "-o", str(tmp_path)]) == 0
    for path in (tmp_path / "index.html", tmp_path / "levels" / "rope.html"):
        assert set(_Card(path).said) == {"og:type", "og:title", "og:description"}
        assert "http://" not in path.read_text(encoding="utf-8").replace("http://www.w3.org", "")
        assert "https://" not in path.read_text(encoding="utf-8")
    assert not list(tmp_path.glob("pictures/*-card.jpg"))
