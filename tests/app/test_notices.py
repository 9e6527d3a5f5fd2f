"""Notices: whole in any window, and beside the parts to play with."""

import pygame

from sandbox.app.play.palette import PartsPalette

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
