"""Take home: from a jelly that feels right to its numbers for another engine, in a few deeds."""

import pygame
import pytest
from pygame_gui.elements import UIDropDownMenu

from sandbox.app.panel.take_home_page import TARGETS
from sandbox.app.widgets.painted import TextBlock
from sandbox.level.reading.files import load_level


@pytest.fixture
def page(open_app):
    driver = open_app(load_level("jelly_pile"))
    driver.app.display.window.size = (1280, 860)
    driver.frames(2)
    driver.panel.choose_body("cube 1")
    driver.click_widget(driver.panel.play.take_home)
    driver.frames(2)
    return driver


def shown(driver):
    texts = [each for each in driver.app.ui.manager.get_sprite_group().sprites() if isinstance(each, TextBlock)]
    return max((each.text for each in texts), key=len)


def test_the_page_opens_on_the_body_that_is_spoken_of_with_all_numbers(page):
    text = shown(page)
    assert text.startswith('"cube 1" of "Jelly pile": 72 springs of jelly.')
    for name in ("Box2D", "Unity", "Godot", "Rapier", "pymunk", "Chipmunk", "single pass"):
        assert name in text


@pytest.mark.parametrize("target", TARGETS)
def test_every_target_has_a_text_that_can_be_copied(page, target):
    menus = [widget for widget in page.app.ui._ring() if isinstance(widget, UIDropDownMenu)]
    page.app.ui._choosers[menus[1]](target)
    page.frames(2)
    assert len(shown(page)) > 200
    page.key(pygame.K_RETURN)
    assert any("clipboard" in notice for notice in page.notices)


def test_it_says_what_the_springs_are_now(page):
    page.key(pygame.K_ESCAPE)
    page.frames(1)
    page.fill(page.panel.stiffness_field, "0.05")
    page.fill(page.panel.damping_field, "0.07")
    page.click_widget(page.panel.play.take_home)
    page.frames(2)
    assert "Here: Cs 0.05, Cd 0.07 in a tick of 1/60 s" in shown(page)
    assert "the level's own numbers are inside" in shown(page)
