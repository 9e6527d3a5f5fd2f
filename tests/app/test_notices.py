"""Notices: whole in any window, and beside the parts to play with."""

import pygame
import pytest

from sandbox.app.play.key_caps import KEYS_HEIGHT
from sandbox.app.play.palette import PartsPalette
from sandbox.app.play.playback import Playback
from sandbox.level.format.files import load_level

LONG = "A line of many words " * 12


def seen(driver, text):
    """Columns of pixels of the window that a notice changes."""
    driver.app._describe("")
    driver.frames(2)
    before = pygame.surfarray.array3d(driver.app.display.surface)
    driver.app.say(text)
    driver.frames(1)
    after = pygame.surfarray.array3d(driver.app.display.surface)
    return (before != after).any(axis=(1, 2)).nonzero()[0]


def test_a_notice_is_as_narrow_as_the_window(driver):
    driver.app.act("pause")
    driver.app.display.window.size = (640, 480)
    driver.app.chosen.choose("scale", 1.5)
    driver.frames(2)
    columns = seen(driver, LONG)
    assert len(columns) and columns.max() < 640 - 10


def test_a_notice_lies_beside_the_parts(driver):
    driver.app.act("pause")
    driver.app.act("palette")
    driver.frames(2)
    palette = driver.app.play.palette
    assert isinstance(palette, PartsPalette)
    columns = seen(driver, LONG)
    assert columns.min() >= palette.back.rect.right


@pytest.mark.parametrize(("size", "above"), [((640, 480), KEYS_HEIGHT), ((1280, 720), 0.0)])
def test_a_notice_leaves_the_keys_of_a_level_in_sight(driver, size, above):
    driver.app.start(Playback(load_level("pinball")))
    driver.app.act("pause")
    driver.app.display.window.size = size
    driver.frames(2)
    assert driver.app.play._keys.shown()
    assert driver.app.play.notices_place[1] == driver.app.play._below + above
