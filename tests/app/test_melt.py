"""The melt: the same Cs and Cd solved one by one and at once, by a button, a key and a lesson."""

import numpy as np
import pygame

from sandbox.level.reading.files import load_level
from sandbox.physics.analysis.query import strain
from sandbox.physics.ramps import SPRINGS, in_force


def stretched(driver):
    """How far the springs of the run are from their lengths: of twenty, all but one."""
    found = np.abs(strain(driver.world))
    return float(np.quantile(found[np.isfinite(found)], 0.95))


def run(driver, seconds):
    for _ in range(round(60 * seconds)):
        driver.playback.session.advance()


def test_jellies_melt_and_are_whole_again(open_app):
    driver = open_app(load_level("jelly_pile"))
    run(driver, 5.0)
    whole = stretched(driver)
    stiffness = driver.world.stiffness.copy()
    driver.click_widget(driver.panel.play.melt)
    driver.frames(2)
    assert driver.world.settings.solver == "single_pass" and driver.panel.play.melt.text == "Make whole"
    assert "May explode: too stiff for a single pass" in driver.panel.note.text
    run(driver, 2.0)
    assert stretched(driver) > 5.0 * whole
    driver.key(pygame.K_z)
    driver.frames(2)
    assert driver.world.settings.solver == "direct" and driver.panel.play.melt.text == "Melt"
    # It firms up rather than leaps.
    assert driver.world.ramp_ticks.any() and in_force(driver.world, SPRINGS)[0][0] < 0.2
    run(driver, 3.0)
    assert stretched(driver) < 2.0 * whole and np.array_equal(driver.world.stiffness, stiffness)
    for _ in range(2):
        driver.key(pygame.K_z, pygame.KMOD_CTRL)
        driver.frames(60)
    assert driver.world.settings.solver == "direct"


def test_the_lesson_has_one_button_that_says_what_it_does_now(open_app):
    driver = open_app(load_level("rope"))
    driver.app.start_melt()
    driver.frames(3)
    lesson = driver.app.play
    assert lesson.melt.text == "Melt them" and driver.playback.level.name == "Jelly pile"
    driver.click_widget(lesson.melt)
    driver.frames(2)
    assert lesson.melt.text == "Make them whole" and driver.world.settings.solver == "single_pass"
    driver.app.display.window.size = (900, 620)
    driver.frames(2)
    assert driver.app.play.melt.text == "Make them whole"
    driver.click_widget(driver.app.play.melt)
    driver.frames(2)
    assert driver.world.settings.solver == "direct"


def test_the_gallery_offers_it_among_its_lessons(open_app):
    driver = open_app(load_level("rope"))
    driver.app.act("gallery")
    driver.frames(3)
    (card,) = [card for card in driver.app.gallery.cards if card.name == "Melt the jellies"]
    card.press()
    driver.frames(3)
    assert driver.app.play.melt.text == "Melt them"
