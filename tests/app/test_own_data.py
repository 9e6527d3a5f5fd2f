"""Own data and the camera's companion in the editor, by mouse and by keyboard."""

import pygame
import pytest

from sandbox.editor.items import Item
from tests.app.conftest import small_level
from tests.app.test_side import click_row, entry, form, open_tab, press

PARTS = {"particles": [{"id": "ball", "position": [5, 1]}]}


@pytest.fixture
def driver(edit):
    driver = edit(small_level(**PARTS))
    driver.editor.folds["More"] = False
    return driver


def use(driver, widget, by_keyboard):
    """Press a button, which its page brings into sight."""
    driver.app.ui.focus_on(widget)
    driver.frames(2)
    if by_keyboard:
        driver.key(pygame.K_RETURN)
        driver.frames(2)
    else:
        press(driver, widget)


def add(driver, text, by_keyboard=False):
    use(driver, form(driver).buttons["extras"], by_keyboard)
    assert driver.app.ui.has_sheet
    driver.type(text)
    driver.key(pygame.K_RETURN)
    driver.frames(3)


def extras(driver):
    return driver.editor.document.level.particles[0].extras


@pytest.mark.parametrize("by_keyboard", [False, True])
def test_own_data_of_a_thing_is_added_changed_and_removed_and_all_of_it_can_be_undone(driver, by_keyboard):
    driver.editor.select(frozenset([Item("particle", "ball")]))
    driver.frames(2)
    add(driver, "points = 3", by_keyboard)
    assert extras(driver) == {"points": 3} and not driver.app.ui.has_sheet
    driver.fill(entry(driver, "extras.points"), "5")
    add(driver, "secret = yes", by_keyboard)
    assert extras(driver) == {"points": 5, "secret": True}
    use(driver, form(driver).removers["extras.points"], by_keyboard)
    assert extras(driver) == {"secret": True}
    for wanted in ({"points": 5, "secret": True}, {"points": 5}, {"points": 3}, {}):
        driver.key(pygame.K_z, pygame.KMOD_CTRL)
        driver.frames(2)
        assert extras(driver) == wanted


def test_what_is_no_entry_is_told_and_the_box_stays(driver):
    driver.editor.select(frozenset([Item("particle", "ball")]))
    driver.frames(2)
    add(driver, "points")
    assert driver.app.ui.has_sheet and extras(driver) == {}
    driver.key(pygame.K_ESCAPE)


def test_the_level_has_own_data_too(driver):
    open_tab(driver, "level")
    add(driver, "chapter = 2")
    assert driver.editor.document.level.extras == {"chapter": 2}


def test_what_the_camera_follows_is_chosen_from_the_things_of_the_level(driver):
    open_tab(driver, "level")
    press(driver, form(driver).buttons["look"])
    picker = form(driver).pickers["look.follow"]
    press(driver, picker)
    texts = [row.text for row in driver.app.ui.focus.rows]
    assert {"ball", "rope"} <= set(texts)
    click_row(driver, driver.app.ui.focus, texts.index("ball"))
    driver.frames(2)
    assert driver.editor.document.level.look.follow == "ball"
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.editor.document.level.look.follow is None
