"""Hints name controls in the words of where they are read, and none that is not there."""

import json
import re
from collections.abc import Iterator

import pytest

from sandbox.app.base.shortcuts import hint, shortcuts, use_keys
from sandbox.app.gallery.sections import SECTIONS
from sandbox.level.hints import CONTROLS, Place, worded
from sandbox.level.plan.actuators import driving_keys
from sandbox.level.reading.files import load_level, shipped_folder, shipped_levels
from sandbox.page.page import WEB, hint_markup
from sandbox.physics.world import World
from sandbox.session.session import Session

PLACES: tuple[Place, ...] = ("window", "mouse", "finger")
LEVELS = [path.stem for path in shipped_levels()]
PARTS = sorted((shipped_folder("levels") / "parts").glob("*.json"))
CARDS = {stem: line for section in SECTIONS for stem, line in section.levels.items()}
# Letters of keys that pages have beside those of a level, each with the id of what it presses.
PAGE_KEYS = dict(re.findall(r"(\w): '(\w+)'", re.search(r"const KEYS = \{(.*?)\}", (WEB / "main.js").read_text())[1]))
# What hints of before named, by what is only in the window, and by what only a mouse has.
OF_THE_WINDOW = re.compile(r"ticks a second|Ctrl\+T|\bkey\b|wheel makes")
OF_A_MOUSE = re.compile(r"\b(mouse|click|Click|wheel makes|Ctrl\+\w|Space)\b")
# A letter that a hint says to press, if it is not the article, and formulas, whose letters nobody presses.
LETTER, FORMULA = re.compile(r"(?<![\w.+])[A-Z](?![\w'])"), re.compile(r"F = [^,]*,")


def _window_letters() -> set[str]:
    return {key for entry in shortcuts("play") for key in entry.keys if len(key) == 1}


def _said(name: str, place: Place) -> str:
    """All that people read of a shipped level in a place: its hint, goal and card, and what its rules say."""
    level = load_level(name)
    said = hint(level.description) if place == "window" else worded(level.description, place)
    spoken = re.findall(r'"(?:win|fail|say)": "([^"]*)"', json.dumps([rule.model_dump() for rule in level.rules]))
    return " ".join([said, level.goal, CARDS.get(name, ""), *spoken])


def _driven(name: str) -> set[str]:
    level = load_level(name)
    world: World = Session(level).world
    return {key.upper() for key in (*driving_keys(level), *world.rule_keys)}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", LEVELS)
def test_a_shipped_level_names_no_control_that_is_not_there(name: str, place: Place) -> None:
    said = FORMULA.sub("", _said(name, place))
    letters = set(LETTER.findall(said)) - {"A"}
    offered = {"window": _window_letters(), "mouse": {key.upper() for key in PAGE_KEYS}, "finger": set()}[place]
    assert letters <= _driven(name) | offered, said
    assert "{" not in said
    if place != "window":
        assert not OF_THE_WINDOW.search(said), said
    if place == "finger":
        assert not OF_A_MOUSE.search(said), said


@pytest.mark.parametrize("path", PARTS, ids=lambda path: path.stem)
def test_a_shipped_part_names_keys_that_it_has(path) -> None:
    said = json.loads(path.read_text())["description"]
    assert "{" not in said and not OF_A_MOUSE.search(said) and not OF_THE_WINDOW.search(said)


def _ids() -> Iterator[str]:
    yield from re.findall(r'\bid="([\w-]+)"', (WEB / "page.html").read_text())


@pytest.mark.parametrize("name", CONTROLS)
def test_what_a_hint_can_name_is_there_in_window_and_page(name: str) -> None:
    control = CONTROLS[name]
    assert not control.action or control.action in {entry.action for entry in shortcuts("play")}
    assert bool(control.element) == (control.mouse is not None) == (control.finger is not None)
    if control.mouse is not None:
        assert control.element in set(_ids())
        for letter in LETTER.findall(control.mouse):
            assert PAGE_KEYS[letter.lower()] == control.element
    assert not LETTER.findall(control.finger or "")


def test_a_hint_has_a_person_s_own_keys() -> None:
    use_keys({"play.reset": ("Ctrl+Backspace",)})
    try:
        assert hint("{Again} begins again.") == "Ctrl+Backspace begins again."
    finally:
        use_keys({})
    assert hint("{Again} begins again.") == "R begins again."


def test_a_sentence_about_what_a_place_lacks_is_left_out() -> None:
    text = "{Box} drops one. Fill the pit! {Again} begins again, {resize} sizes. Does it hold?  Well."
    assert worded(text, "finger") == "Fill the pit! Does it hold?  Well."
    assert worded("Press {toy}.", "mouse") == ""


def test_a_hint_that_names_no_control_reads_as_it_is() -> None:
    for text in ("", "Set {x} to {1}.  Then\nR. {AGAIN} {again ", "F = -k x - c u. {nothing} here."):
        assert [worded(text, place) for place in PLACES] == [text] * 3
        assert hint(text) == text


def test_a_page_holds_both_words_where_they_differ_and_markup_of_neither() -> None:
    assert hint_markup("<b> & R") == "&lt;b&gt; &amp; R"
    assert hint_markup("<i> {again}") == (
        "<span class=mouse>&lt;i&gt; R</span><span class=finger>&lt;i&gt; the round arrow</span>"
    )
