"""Trails on the sheet: by key and button, beside the way of the last run."""

import pygame
import pytest

from sandbox.editor.items import Item
from tests.app.conftest import small_level

STONE = Item("particle", "stone")


@pytest.fixture
def driver(edit):
    stone = {"id": "stone", "position": [-2, 3], "velocity": [3, 0], "mass": 1}
    return edit(small_level(particles=[stone], settings={"gravity": [0, -1], "tick_rate": 60}))


def test_the_trail_of_what_is_selected_is_drawn_once_it_is_worked_out(driver):
    driver.editor.select(frozenset([STONE]))
    driver.frames(2)
    at = tuple(map(round, driver.at(-2 + 3 * 2.0, 3 - 0.5 * 4)))
    before = driver.app.display.surface.get_at(at)
    driver.key(pygame.K_t, pygame.KMOD_SHIFT)
    driver.frames(60)
    assert driver.editor.watch.trail.is_done and driver.app.display.surface.get_at(at) != before
    driver.key(pygame.K_t, pygame.KMOD_SHIFT)
    driver.frames(2)
    assert driver.app.display.surface.get_at(at) == before


def test_an_edit_brings_another_trail(driver):
    driver.editor.select(frozenset([STONE]))
    driver.app.act("trail")
    driver.frames(60)
    first = driver.editor.watch.trail
    driver.key(pygame.K_RIGHT)
    driver.frames(60)
    assert driver.editor.watch.trail is not first and driver.editor.watch.trail.is_done


def test_after_playing_the_way_of_that_run_is_shown_too(driver):
    driver.app.act("trail")
    driver.app.act("play")
    driver.frames(30)
    ran = driver.playback.session.tick
    assert ran > 10
    driver.app.act("edit")
    driver.frames(60)
    trail = driver.editor.watch.last_trail
    assert trail.is_done and len(trail.places) == 1 + ran // 2
    assert [is_last for _, is_last in driver.editor.watch.shown_trails] == [True, False]
    driver.app.act("trail")
    assert driver.editor.watch.shown_trails == []


def test_without_a_selection_the_person_is_told_to_select(driver):
    driver.app.act("trail")
    assert driver.notices[-1] == "Select something to see where it will go."
