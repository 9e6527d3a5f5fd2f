"""Goals in pages: what a level asks is shown, a win comes up as a card, and time gone back takes it away."""

import json
from pathlib import Path

from sandbox.app.share.playing import page_of
from sandbox.level.reading.files import read_level
from sandbox.level.reading.parse import parse_level
from sandbox.session.outcome import outcome
from sandbox.session.session import Session
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import opened
from tests.support.rules_level import answering
from tests.test_documentation import ROOT

SHOWN = (
    "[...document.querySelectorAll('#goal, #score, #end-card')].filter((each) => !each.hidden).map((each) => each.id)"
)
UNTIL_END = (
    """new Promise((resolve) => page.toy.addEventListener('outcome', () => setTimeout(() => resolve(true), 100)))"""
)


def text_of(tab: Tab, chosen: str) -> str:
    found = tab.evaluate(f"document.querySelector('{chosen}').innerText")
    assert isinstance(found, str)
    return found


def test_a_level_without_rules_shows_nothing_of_goals(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, level_page("rope"))
    tab.evaluate("page.toy.step()")
    assert tab.evaluate(SHOWN) == []


def test_a_win_comes_up_as_a_card_with_its_stars_and_undoing_time_takes_it_away(
    browser: Browser, tmp_path: Path
) -> None:
    tab = opened(browser, tmp_path, page_of(answering(goal="Bring the ball into the basket")))
    assert text_of(tab, "#goal") == "Bring the ball into the basket"
    assert tab.evaluate(UNTIL_END)
    assert tab.evaluate(SHOWN) == ["goal", "score", "end-card"]
    assert text_of(tab, "#end-card h2") == "Won" and text_of(tab, "#end-card p") == (
        "In!\n1.28 s, Score 6\n3 stars: at most 1 s"
    )
    assert tab.evaluate("document.querySelectorAll('.star.earned').length") == 2
    assert tab.evaluate("[page.toy.isPaused, document.activeElement.id]") == [True, "end-again"]
    assert text_of(tab, "#score").split() == ["Score", "6", "1.3", "s", "★★☆"]
    # What is closed is had again.
    tab.evaluate("document.getElementById('end-on').click()")
    assert tab.evaluate("[document.getElementById('end-card').hidden, page.toy.isPaused]") == [True, False]
    tab.evaluate("document.getElementById('score').click()")
    assert tab.evaluate("[document.getElementById('end-card').hidden, page.toy.isPaused]") == [False, True]
    tab.evaluate("page.toy.seek(20)")
    assert tab.evaluate("document.getElementById('end-card').hidden") is True
    assert tab.evaluate("page.toy.outcome") is None


def test_again_keeps_what_was_tuned_and_as_it_was_does_not(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(answering(goal="Bring the ball into the basket")))
    for pull in (-9, -9.5):
        record = f"{{ type: 'set_gravity', gravity: [0, {pull}], duration: 30 }}"
        tab.evaluate(f"page.toy.run.submit({record}, page.toy.run.newGesture(), console.error)")
    assert tab.evaluate(UNTIL_END) and tab.evaluate("document.getElementById('end-was').hidden") is False
    done = "page.toy.run.commands.map(({ tick, record }) => [tick, record.type, record.gravity, record.duration])"
    tab.evaluate("document.getElementById('end-again').click()")
    assert tab.evaluate(done) == [[0, "set_gravity", [0, -9.5], 0]]
    assert tab.evaluate(UNTIL_END)
    tab.evaluate("document.getElementById('end-was').click()")
    assert tab.evaluate(done) == []
    assert tab.evaluate(UNTIL_END) and tab.evaluate("document.getElementById('end-was').hidden") is True


def test_a_level_that_is_lost_can_be_begun_again(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(read_level(ROOT / "docs" / "rules" / "bumpers.json")))
    assert tab.evaluate(UNTIL_END)
    assert text_of(tab, "#end-card h2") == "Lost" and text_of(tab, "#end-card p").startswith("The ball is gone.")
    tab.evaluate("document.getElementById('end-again').click()")
    found = tab.evaluate("[document.getElementById('end-card').hidden, page.toy.isPaused, page.toy.run.time < 30]")
    assert found == [True, False, True]


def test_a_button_holds_a_key_that_a_rule_asks_for(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(read_level(ROOT / "docs" / "rules" / "chain.json")))
    assert tab.evaluate("document.querySelector('.key').getAttribute('aria-label')") == "Key g"
    tab.evaluate("page.toy.drives.press('g')")
    assert tab.evaluate(UNTIL_END)
    assert text_of(tab, "#end-card p").startswith("All down")


def test_what_hands_may_not_do_has_no_button_no_key_and_no_part_of_the_panel(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(answering(hands={"may": ["grab", "air"]})))
    shown = "['drag', 'pin', 'cut', 'make', 'tune'].filter((id) => !document.getElementById(id).hidden)"
    assert tab.evaluate(shown) == ["drag", "tune"]
    for key in "cpjbh":
        tab.key(key)
    parts = (
        "['.springs', '.world', '.engineers'].filter((each) => document.querySelector(`#panel ${each}`)?.offsetHeight)"
    )
    assert tab.evaluate("page.toy.hands.tool") == "drag" and tab.evaluate(parts) == [".world"]
    tab = opened(browser, tmp_path, page_of(answering(hands={"may": []})))
    tab.key("h")
    assert tab.evaluate(shown) == [] and tab.evaluate("document.getElementById('panel').hidden") is True


def test_a_page_counts_each_of_several_things_and_wins_as_the_desktop_does(browser: Browser, tmp_path: Path) -> None:
    data = {
        "format": "spring-sandbox/level", "version": 4, "name": "Each",
        "terrain": [{"id": "floor", "polyline": [[-9, 0], [9, 0]]}], "counters": [{"id": "score", "text": "Score"}],
        "particles": [{"id": f"ball {k}", "position": [k, 0.5 + k], "radius": 0.1, "group": "balls"} for k in range(3)],
        "rules": [
            {"id": "count", "when": {"touches": ["floor"], "each_of": ["balls"]}, "once": True,
             "then": [{"count": "score"}]},
            {"id": "won", "when": {"counter": "score", "at_least": 3.0}, "then": [{"win": "All down"}]},
        ],
    }  # fmt: skip
    level = parse_level(json.dumps(data).encode(), "each")
    session = Session(level)
    while outcome(level, session.world) is None:
        session.advance()
    tab = opened(browser, tmp_path, page_of(level))
    assert tab.evaluate(UNTIL_END)
    assert tab.evaluate("page.toy.outcome.tick") == session.tick
    assert text_of(tab, "#end-card p").startswith("All down")
