"""Hangers, waves and beginning at rest by mouse and keyboard."""

import pygame
import pytest

from tests.app.conftest import small_level

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


@pytest.fixture
def driver(edit):
    bodies = [
        {"type": "rope", "id": "cable", "start": [0, 2], "end": [4, 2], "segments": 4, "pin": ["start", "end"],
         "rest_length": 1.1, "material": "steel"},
        {"type": "rope", "id": "deck", "start": [0, 0], "end": [4, 0], "segments": 4, "material": "steel"},
    ]  # fmt: skip
    return edit(small_level(bodies=bodies, settings={"gravity": [0.0, -9.81]}))


def test_hangers_and_a_wave_through_them_are_a_drag_each_and_undone_as_one_step(driver):
    driver.key(pygame.K_s, SHIFT)
    driver.drag((0, 2), (2, 1), (4, 0))
    assert len(driver.editor.document.level.springs) == 5
    driver.key(pygame.K_w, SHIFT)
    driver.drag((0, 1), (2, 1), (4, 1))
    assert any("no muscle" in notice for notice in driver.notices)
    driver.key(pygame.K_z, CTRL)
    assert not driver.editor.document.level.springs


def test_it_begins_at_rest_by_a_key_and_by_the_button_and_undo_takes_it_back(driver):
    before = driver.editor.document.level
    driver.key(pygame.K_u, SHIFT)
    for _ in range(600):
        if driver.editor.document.level is not before:
            break
        driver.frames()
    assert driver.editor.document.level.bodies[0].pose[2][1] < 1.9
    assert driver.editor.history.labels[-1] == "Begin at rest" and not driver.editor.watch.forecasts
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level is before
    driver.click_widget(driver.editor.bar.buttons["rest"])
    assert driver.editor.watch.forecasts
