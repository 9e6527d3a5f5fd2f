"""Trying a range in the editor, by keys and mouse."""

import pygame
import pytest

from sandbox.editor.items import Item
from tests.app.conftest import small_level

STONE = Item("particle", "stone")


@pytest.fixture
def driver(edit):
    stone = {"id": "stone", "position": [-2, 3], "velocity": [3, 0], "mass": 1}
    check = {"name": "far", "metric": "x", "particle": "stone", "at_least": 2, "after": 1}
    level = small_level(particles=[stone], settings={"gravity": [0, -1], "tick_rate": 60}, checks=[check])
    driver = edit(level)
    driver.editor.select(frozenset([STONE]))
    driver.key(pygame.K_r, pygame.KMOD_CTRL)
    driver.frames(2)
    return driver


def choose_row(driver, text):
    rows = driver.editor.side.page.list
    index = [row.text for row in rows.rows].index(text)
    rows._reveal(index)
    driver.click((rows.rect.left + 30, rows.rect.top + rows._tops[index] - rows._offset + 8))


def tried(driver):
    choose_row(driver, "Velocity x [m/s]")
    driver.fill(driver.editor.side.page.form.fields["How many"][0], "4")
    driver.frames(120)
    return driver.editor.side.page.list


def test_a_number_is_chosen_tried_and_its_best_value_taken(driver):
    rows = tried(driver)
    assert [(row.text, row.aside) for row in rows.rows] == [
        ("1.5", "fails"), ("2.5", "fails"), ("3.5", "fails"), ("4.5", "holds"),
    ]  # fmt: skip
    choose_row(driver, "4.5")
    driver.choose("Take this value")
    (stone,) = driver.editor.document.level.particles
    assert stone.velocity == (4.5, 0.0)
    assert driver.editor.history.labels[-1] == "Velocity x [m/s]: 4.5"
    driver.app.act("undo")
    assert driver.editor.document.level.particles[0].velocity == (3.0, 0.0)


def test_the_ways_are_drawn_and_go_with_the_page(driver):
    at = tuple(map(round, driver.at(-2 + 4.5 * 1.0, 2.5)))
    before = driver.app.display.surface.get_at(at)
    tried(driver)
    assert driver.app.display.surface.get_at(at) != before
    driver.choose("Close")
    driver.editor.select(frozenset([STONE]))
    driver.move(driver.at(-2, -2))
    driver.frames(2)
    assert driver.editor.side.tab == "properties" and driver.app.display.surface.get_at(at) == before


def test_a_window_laid_out_anew_still_shows_what_was_tried(driver):
    tried(driver)
    driver.app.rebuild()
    driver.frames(2)
    assert len(driver.editor.side.page.list.rows) == 4


def test_a_range_that_is_no_number_is_told_in_a_line(driver):
    choose_row(driver, "Mass [kg]")
    driver.fill(driver.editor.side.page.form.fields["From"][0], "light")
    assert "light" in driver.notices[-1] and driver.editor.watch.range_trial is None
