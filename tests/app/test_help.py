"""The page of keys: whole where the window has room, scrolled to where it has not, never squeezed."""

import pygame
import pytest

from sandbox.app.widgets.scroll import ScrollBar
from sandbox.app.window.help import ShortcutTable


def table(driver):
    sprites = driver.app.ui.walk()
    return next(sprite for sprite in sprites if isinstance(sprite, ShortcutTable))


@pytest.mark.parametrize("mode", ["edit", "play"])
def test_all_keys_are_seen_at_once_in_the_usual_window(edit, mode):
    driver = edit()
    driver.app.display.window.size = (1280, 720)
    driver.frames(2)
    if mode == "play":
        driver.app.act("play")
    driver.key(pygame.K_F1)
    shown = table(driver)
    assert driver.app.mode == mode and shown.parent.rect.contains(shown.rect)
    assert not isinstance(driver.app.ui.focus, ScrollBar)
    driver.key(pygame.K_RETURN)
    assert not driver.app.ui.has_sheet


def test_a_small_window_scrolls_to_the_last_key_by_the_keyboard(edit):
    driver = edit()
    driver.app.display.window.size = (640, 440)
    driver.frames(2)
    driver.key(pygame.K_F1)
    bar, shown = driver.app.ui.focus, table(driver)
    top = shown.rect.top
    assert isinstance(bar, ScrollBar) and bar.needed
    driver.key(pygame.K_END)
    assert shown.rect.top < top and shown.rect.bottom <= bar.rect.bottom + 1
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.ui.has_sheet


@pytest.mark.parametrize("width", [700, 860, 1000, 1150])
def test_no_line_is_cut_in_any_window(edit, width):
    driver = edit()
    driver.app.display.window.size = (width, 720)
    driver.frames(2)
    driver.key(pygame.K_F1)
    shown = table(driver)
    picture = pygame.surfarray.array_alpha(shown.image)
    assert picture.any() and not picture[-3:].any()
