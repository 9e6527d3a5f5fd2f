"""Touching on and off, friction and bounce, for every level while it is played."""

import numpy as np
import pygame
import pytest

from sandbox.level.reading.files import load_level
from tests.app.conftest import small_level

DISCS = [
    {"id": "low", "position": [0, 0], "pinned": True, "radius": 0.5},
    {"id": "high", "position": [0, 3], "radius": 0.3},
]


@pytest.fixture
def driver(open_app):
    """The app on a disc that falls on a pinned one, in a level without contacts."""
    driver = open_app(small_level(bodies=[], particles=DISCS, settings={"gravity": [0, -9.81]}, view=[-3, -3, 3, 5]))
    return driver


def height(driver):
    return float(driver.world.position[driver.world.particle_slot("high"), 1])


def test_off_falls_through_and_on_is_caught(driver):
    touch, friction = driver.panel.world.form.choices["contacts"], driver.entry("friction")
    assert touch.chosen == "off" and friction.text == "" and friction.hint == "\u2013"
    driver.frames(120)
    assert height(driver) < -5.0
    driver.click_in_panel(touch.buttons["on"])
    driver.frames(2)
    assert driver.world.tick < 10 and driver.panel.world.form.choices["contacts"].chosen == "on"
    driver.frames(100)
    assert height(driver) == pytest.approx(0.8, abs=0.01)


def test_bounce_and_friction_are_typed(driver):
    driver.fill(driver.entry("bounce"), "0.9")
    driver.frames(2)
    assert driver.panel.world.form.choices["contacts"].chosen == "on" and driver.entry("bounce").text == "0.9"
    highest = 0.0
    for tick in range(110):
        driver.playback.session.advance()
        highest = max(highest, height(driver) if tick > 45 else 0.0)
    assert highest > 0.8 + 0.75 * 2.2
    driver.fill(driver.entry("friction"), "-1")
    assert driver.entry("friction").text == "0.5" and any("Friction" in notice for notice in driver.notices)


def test_a_key_does_it_and_springs_that_were_set_stay(open_app):
    driver = open_app(load_level("beating_heart"))
    driver.fill(driver.panel.form.fields["stiffness"][0], "0.3")
    driver.key(pygame.K_t, pygame.KMOD_SHIFT)
    driver.frames(3)
    assert driver.world.has_contacts and np.any(driver.world.stiffness == 0.3)
    driver.key(pygame.K_t, pygame.KMOD_SHIFT)
    driver.frames(3)
    assert not driver.world.has_contacts


def test_terrain_is_always_touched(open_app):
    driver = open_app(load_level("jelly_pile"))
    driver.key(pygame.K_t, pygame.KMOD_SHIFT)
    assert driver.notices[-1] == "This level has terrain or walls, so contacts stay on."
    assert driver.world.has_contacts
