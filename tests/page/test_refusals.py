"""What a level does not let hands do is said where it was asked for, and the control goes back."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import ALL_SHOWN, SETTLED, START_OVER, opened
from tests.page.pointing import click, drag, middle, place, text

# Levels that keep hands from the world and from materials.
LEVELS = ("bridge_budget", "pinball_score")
MAY_NOT = "in this level hands may not "
AIR, MATERIAL = f"{MAY_NOT}change gravity or air", f"{MAY_NOT}change Cs and Cd"
FIRMNESS = f"{MAY_NOT}make bodies softer or firmer"
SAID, TOLD = "#refused", "#state"
GRAVITY = "page.toy.world.settings().gravity"
COMMANDS = "page.toy.run.commands.length"
# Something that can be taken, in each level, and the middle of what is drawn there.
THINGS = {"bridge_budget": "truck.0", "pinball_score": "left flipper.8"}


@pytest.fixture(params=LEVELS)
def level(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def tab(browser: Browser, tmp_path: Path, level: str) -> Iterator[Tab]:
    """A page of the level, which stands; nothing of it is changed by what is tried."""
    made = opened(browser, tmp_path, level_page(level), width=1400, height=900)
    made.evaluate(START_OVER)
    made.evaluate(ALL_SHOWN)
    yield made
    assert made.evaluate(COMMANDS) == 0
    assert made.faults == []


def test_gravity_that_may_not_be_set_goes_back_in_its_field(tab: Tab) -> None:
    click(tab, "#tune")
    before = tab.evaluate(GRAVITY)
    for field in (1, 2):
        chosen = f".fields label:nth-child({field}) input"
        shown = f"Number(document.querySelector('{chosen}').value)"
        click(tab, chosen)
        tab.evaluate(f"document.querySelector('{chosen}').select()")
        tab.key("5")
        assert tab.evaluate(shown) == 5
        click(tab, "#panel h2")
        assert tab.evaluate(shown) == before[field - 1]
        assert text(tab, SAID) == AIR
    assert tab.evaluate(GRAVITY) == before


@pytest.mark.parametrize("control", [".words button:first-child", ".pad", "#slider0", "#slider1"])
def test_firmness_that_may_not_be_set_goes_back_in_words_pad_and_sliders(tab: Tab, control: str) -> None:
    click(tab, "#tune")
    shown = """[page.panel.pair, [...document.querySelectorAll('#panel .slider input')].map((each) => each.value),
      document.querySelector('.pad').getAttribute('aria-label'),
      [...document.querySelectorAll('.words button')].map((each) => each.ariaPressed)]"""
    before = tab.evaluate(shown)
    x, y = middle(tab, control)
    drag(tab, (x - 20, y), (x - 45, y + 10)) if control == ".pad" else drag(tab, (x, y), (x - 15, y))
    assert text(tab, SAID) == MATERIAL
    assert tab.evaluate(shown) == before


@pytest.mark.parametrize("tool", ["drag", "pin", "cut"])
def test_a_tool_that_may_not_be_used_says_so_over_the_level(tab: Tab, level: str, tool: str) -> None:
    click(tab, f"#{tool}")
    x, y = place(tab, THINGS[level])
    drag(tab, *([(x - 40, y - 60), (x + 40, y + 60)] if tool == "cut" else [(x, y), (x + 40, y - 90)]))
    assert text(tab, TOLD).startswith(MAY_NOT)


@pytest.mark.parametrize("level", ["pinball_score"])
@pytest.mark.parametrize("tool", ["rope", "jelly", "erase"])
def test_what_may_not_be_made_says_so_over_the_level(tab: Tab, level: str, tool: str) -> None:
    click(tab, "#make")
    click(tab, f"#{tool}")
    tab.evaluate(SETTLED)
    x, y = place(tab, THINGS[level])
    drag(tab, (x, y), (x + 90, y), (x + 90, y - 90))
    assert text(tab, TOLD).startswith(MAY_NOT)


def test_a_word_of_the_menu_that_is_refused_is_not_said_to_be_done(tab: Tab, level: str) -> None:
    click(tab, place(tab, THINGS[level]), "right")
    click(tab, "#menu button:first-child")
    assert tab.evaluate("document.getElementById('menu').hidden")
    assert text(tab, TOLD) == FIRMNESS


def test_a_refusal_ends_when_something_is_done(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("bridge_budget"), width=1400, height=900)
    tab.evaluate(START_OVER)
    x, y = place(tab, "truck.0")
    drag(tab, (x, y), (x + 40, y - 90))
    assert text(tab, TOLD).startswith(MAY_NOT)
    tab.press("d")
    tab.evaluate("page.toy.step()")
    tab.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    tab.release("d")
    assert tab.evaluate(f"document.querySelector('{TOLD}').textContent") == ""
