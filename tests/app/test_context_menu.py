"""The menu of the right button: what lies under the pointer, and what can be done there."""

import pygame
import pytest

from sandbox.editor.edits.copying import place_part
from sandbox.editor.items import Item
from sandbox.editor.storage.level_file import catalogue
from tests.app.conftest import small_level

ROPE, PAIR = Item("body", "rope"), Item("body", "pair")
CROSSING = {"type": "rope", "id": "crossing", "start": [1, -1], "end": [1, 1], "segments": 2}


@pytest.fixture
def driver(edit):
    level = small_level()
    return edit(small_level(bodies=[*(body.model_dump(exclude_unset=True) for body in level.bodies), CROSSING]))


def open_menu(driver, x, y):
    """Press the right button at a point [m]; the menu's list."""
    driver.press(driver.at(x, y), 3)
    driver.release(driver.at(x, y), 3)
    return driver.app.ui.focus


def take(driver, text):
    """Click an entry of the menu."""
    menu = driver.app.ui.focus
    index = [row.text for row in menu.rows].index(text)
    driver.click((menu.rect.left + 30, menu.rect.top + menu._tops[index] - menu._offset + 8))
    driver.app.input._last_press = None


def selected(driver):
    return set(driver.editor.document.selection)


def test_the_right_button_selects_what_is_there_and_offers_what_can_be_done(driver):
    open_menu(driver, 3.5, 0)
    assert selected(driver) == {ROPE}
    take(driver, "Delete")
    assert [body.id for body in driver.editor.document.level.bodies] == ["pair", "crossing"]


def test_things_that_lie_over_each_other_are_offered_one_by_one(driver):
    menu = open_menu(driver, 1, 0)
    assert [row.text for row in menu.rows][-2:] == ["Select crossing", "Select rope"]
    take(driver, "Select rope")
    assert selected(driver) == {ROPE}


def test_a_selection_stays_under_the_right_button(driver):
    driver.click_at(0.5, 2)
    driver.click_at(3.5, 0, pygame.KMOD_SHIFT)
    open_menu(driver, 3.5, 0)
    assert selected(driver) == {ROPE, PAIR}
    take(driver, "Group")
    assert {body.group for body in driver.editor.document.level.bodies[:2]} == {"group"}


def test_what_is_pasted_from_the_menu_comes_to_where_it_was_opened(driver):
    driver.click_at(0.5, 2)
    driver.app.act("copy")
    open_menu(driver, 4, -2)
    take(driver, "Paste here")
    rope = driver.editor.document.level.bodies[-1]
    middle = [(a + b) / 2 for a, b in zip(rope.start, rope.end, strict=True)]
    assert middle == pytest.approx([4, -2], abs=driver.editor.grid)


def test_over_nothing_the_menu_shows_all_again_that_is_hidden(driver):
    driver.click_at(0.5, 2)
    driver.app.act("hide")
    assert driver.editor.visibility.hidden == {PAIR}
    open_menu(driver, 4, -2)
    take(driver, "Hide; with nothing selected: show all")
    assert not driver.editor.visibility.hidden


def test_a_group_is_taken_whole_and_one_of_it_by_the_menu(edit):
    driver = edit()
    part = next(part for part in catalogue() if part.path.stem == "car")
    driver.editor.edit("Put", lambda document: place_part(document, part.level, (0, 0)))
    driver.app.act("fit")
    driver.editor.select(frozenset())
    driver.frames(2)
    wheel = next(body for body in driver.editor.document.level.bodies if body.type == "wheel")
    menu = open_menu(driver, *driver.editor.scene.position[driver.editor.scene.slot(f"{wheel.id}.hub")])
    assert len(selected(driver)) > 2 and menu.rows[-1].text.startswith("Select ")
    driver.key(pygame.K_ESCAPE)
    assert len(selected(driver)) > 2


def test_escape_leaves_everything_as_it_is(driver):
    before = driver.editor.document.level
    open_menu(driver, 3.5, 0)
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.ui.has_sheet and driver.editor.document.level is before


def test_find_opens_the_list_of_objects_with_its_search(driver):
    driver.app.act("find")
    driver.frames(2)
    driver.type("pair")
    assert [row.text for row in driver.editor.side.page.list.rows] == ["pair"]
