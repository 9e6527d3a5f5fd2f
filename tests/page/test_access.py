"""axe-core finds nothing, and text is seen on what is drawn behind it, in both themes."""

from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest

from sandbox.app.share.playing import page_of
from sandbox.cli import main
from sandbox.level.reading.files import load_level, shipped_levels
from tests.page.axe import violations
from tests.page.browser import Browser, Tab
from tests.page.contrast import LEAST_CONTRAST, contrasts
from tests.page.levels import level_page
from tests.page.opened import opened
from tests.page.site_server import served
from tests.support.rules_level import answering
from tests.support.wholes import some_and_whole

THEMES = ("dark", "light")
PHONE = {"width": 390, "height": 844, "is_phone": True}
# What is opened over the picture, by the ids of its buttons.
OPENED = ((), ("tune",), ("make",), ("tune", "make"))
LEVELS = [path.stem for path in shipped_levels()]


@pytest.fixture(scope="module")
def index(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("access")
    assert main(["site", "-o", str(folder), "levels/trampoline.json", "levels/squeeze.json"]) == 0
    with served(folder) as address:
        yield address


@pytest.mark.parametrize("scheme", THEMES)
def test_axe_finds_nothing_on_the_index(browser: Browser, index: str, scheme: str) -> None:
    assert violations(browser.tab(scheme=scheme).open(f"{index}index.html")) == []


@pytest.mark.parametrize(
    ("name", "scheme"), some_and_whole([("rope", "dark"), ("low_door", "light")], product(("rope", "low_door"), THEMES))
)
def test_axe_finds_nothing_on_a_level_whatever_is_open(
    browser: Browser, tmp_path: Path, name: str, scheme: str
) -> None:
    tab = opened(browser, tmp_path, level_page(name), scheme=scheme)
    tab.evaluate("page.toy.pause()")
    for buttons in OPENED:
        for each in buttons:
            tab.evaluate(f"document.getElementById('{each}').click()")
        assert violations(tab) == [], buttons
        for each in buttons:
            tab.evaluate(f"document.getElementById('{each}').click()")
    tab.evaluate("document.getElementById('picture').focus()")
    tab.key("n")
    tab.key("q")
    assert not tab.evaluate("document.getElementById('menu').hidden")
    assert violations(tab) == []


@pytest.mark.parametrize("scheme", THEMES)
def test_axe_finds_nothing_on_the_card_of_an_end(browser: Browser, tmp_path: Path, scheme: str) -> None:
    tab = opened(browser, tmp_path, page_of(answering(goal="Bring the ball into the basket")), scheme=scheme)
    tab.evaluate("for (let k = 0; k < 600 && !page.toy.outcome; k++) page.toy.tick()")
    assert not tab.evaluate("document.getElementById('end-card').hidden")
    assert violations(tab) == []


def test_axe_finds_what_is_wrong(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("rope"))
    tab.evaluate("document.getElementById('undo').removeAttribute('aria-label')")
    tab.evaluate("document.getElementById('undo').removeAttribute('title')")
    assert [rule for rule, _ in violations(tab)] == ["button-name"]


def _told(tab: Tab) -> None:
    """Let the page say something at each place, while time stands."""
    tab.evaluate("page.toy.pause(); for (let k = 0; k < 48; k++) page.toy.tick()")
    tab.evaluate("page.toy.say('Something that was refused.'); document.getElementById('pace').textContent = 'slower'")
    tab.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


# On the picture of each level.
@pytest.mark.parametrize("name", some_and_whole(("squeeze", "crane"), LEVELS))
def test_every_text_is_read_on_what_is_drawn_behind_it(browser: Browser, tmp_path: Path, name: str) -> None:
    for size in ({}, PHONE):
        tab = opened(browser, tmp_path, page_of(load_level(name)), **size)
        _told(tab)
        for theme in THEMES:
            tab.evaluate(f"page.toy.theme = '{theme}'")
            tab.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            low = {text: round(ratio, 2) for text, ratio in contrasts(tab).items() if ratio < LEAST_CONTRAST}
            assert low == {}, (theme, size)
