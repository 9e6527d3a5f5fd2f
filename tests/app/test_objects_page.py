"""The page Objects: find, select, hide, lock, rename and order, by mouse and keys."""

import pygame
import pytest

from sandbox.editor.items import Item
from tests.app.conftest import small_level

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
ROPE, PAIR = Item("body", "rope"), Item("body", "pair")
GROUND = {"id": "ground", "polygon": [[-2, -2], [6, -2], [6, -1], [-2, -1]]}


@pytest.fixture
def driver(edit):
    driver = edit(small_level(terrain=[GROUND]))
    driver.editor.side.choose("objects")
    driver.frames(2)
    return driver


def page(driver):
    return driver.editor.side.page


def names(driver):
    return [row.text for row in page(driver).list.rows]


def click_row(driver, name, mods=0):
    """Click the line of a name."""
    rows = page(driver).list
    y = rows.rect.top + (rows._tops[names(driver).index(name)] + 8) - rows._offset
    pygame.key.set_mods(mods)
    driver.click((rows.rect.left + 40, y))
    pygame.key.set_mods(0)
    driver.app.input._last_press = None


def selected(driver):
    return set(driver.editor.document.selection)


def test_lines_select_on_the_sheet_and_the_sheet_marks_lines(driver):
    assert names(driver) == ["rope", "pair", "ground"]
    click_row(driver, "pair")
    assert selected(driver) == {PAIR}
    click_row(driver, "rope", CTRL)
    assert selected(driver) == {PAIR, ROPE}
    click_row(driver, "pair", CTRL)
    assert selected(driver) == {ROPE}
    click_row(driver, "rope")
    click_row(driver, "ground", SHIFT)
    assert len(selected(driver)) == 3
    driver.click_at(1, 2)
    assert page(driver).list.also == {1}


def test_words_narrow_the_list_while_they_are_typed(driver):
    driver.app.ui.focus_on(page(driver).search)
    driver.type("rub")
    assert names(driver) == ["pair"]
    driver.key(pygame.K_RETURN)
    assert selected(driver) == {PAIR} and driver.app.ui.focus is page(driver).list
    driver.app.ui.focus_on(page(driver).search)
    driver.type("x")
    assert names(driver) == []


def test_what_is_hidden_is_neither_drawn_nor_clicked_until_it_is_shown_again(driver):
    pixel = tuple(map(round, driver.at(0.5, 2)))
    before = driver.app.display.surface.get_at(pixel)
    click_row(driver, "pair")
    driver.choose("Hide")
    driver.frames(2)
    assert driver.app.display.surface.get_at(pixel) != before and selected(driver) == set()
    driver.click_at(0.5, 2)
    driver.drag((-2.5, 3.5), (6, 1.5))
    assert selected(driver) == set()
    click_row(driver, "pair")
    driver.choose("Show")
    driver.editor.select(frozenset())
    driver.move(driver.at(-2, 3.5))
    driver.frames(2)
    assert driver.app.display.surface.get_at(pixel) == before
    driver.click_at(0.5, 2)
    assert selected(driver) == {PAIR}


def test_what_is_locked_is_not_clicked_boxed_or_taken_by_select_all(driver):
    click_row(driver, "rope")
    driver.choose("Lock")
    driver.editor.select(frozenset())
    driver.click_at(1, 0)
    assert selected(driver) == set()
    driver.drag((-2.5, 3.5), (6, -0.8))
    assert selected(driver) == {PAIR}
    driver.app.act("select_all")
    assert ROPE not in selected(driver) and PAIR in selected(driver)
    click_row(driver, "rope")
    driver.choose("Unlock")
    driver.editor.select(frozenset())
    driver.click_at(1, 0)
    assert selected(driver) == {ROPE}


def test_a_name_given_here_is_taken_and_what_was_hidden_stays_so(driver):
    click_row(driver, "pair")
    driver.choose("Hide")
    click_row(driver, "pair")
    driver.choose("Rename")
    driver.type("twins")
    driver.key(pygame.K_RETURN)
    assert names(driver) == ["rope", "twins", "ground"]
    assert driver.editor.visibility.hidden == {Item("body", "twins")}
    driver.app.act("undo")
    driver.frames(2)
    assert names(driver) == ["rope", "pair", "ground"]


def test_a_name_that_is_taken_is_refused_in_the_box(driver):
    click_row(driver, "pair")
    driver.choose("Rename")
    driver.type("rope")
    driver.key(pygame.K_RETURN)
    assert driver.app.ui.has_sheet and names(driver)[1] == "pair"


def test_up_and_down_change_the_order_of_the_file(driver):
    click_row(driver, "pair")
    driver.choose("Up")
    assert [body.id for body in driver.editor.document.level.bodies] == ["pair", "rope"]
    driver.choose("Up")
    assert driver.notices[-1] == "Nothing of its kind is above it."
    driver.choose("Down")
    assert names(driver) == ["rope", "pair", "ground"]


def test_the_line_that_is_pointed_at_is_lit_on_the_sheet(driver):
    pixel = tuple(map(round, driver.at(0.5, 2)))
    before = driver.app.display.surface.get_at(pixel)
    rows = page(driver).list
    driver.move((rows.rect.left + 40, rows.rect.top + rows._tops[1] + 8))
    driver.frames(2)
    assert driver.app.display.surface.get_at(pixel) != before


def test_long_names_are_cut_in_the_middle_so_that_their_ends_tell_them_apart(edit):
    name = "a very long rope name which goes on and on and on without an end "
    ropes = [{"type": "rope", "id": f"{name}{k}", "start": [0, k], "end": [4, k], "segments": 4} for k in (1, 2)]
    driver = edit(small_level(bodies=ropes))
    driver.editor.side.choose("objects")
    driver.frames(2)
    shown = [lines[0] for lines, _ in driver.editor.side.page.list._lines]
    assert [(text[:6], "\N{HORIZONTAL ELLIPSIS}" in text, text[-1]) for text in shown] == [
        ("a very", True, "1"), ("a very", True, "2"),
    ]  # fmt: skip
