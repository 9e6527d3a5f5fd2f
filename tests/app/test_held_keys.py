"""Keys that are held down: what a press opens does not have the key again, and a button is pressed once."""

import pygame
import pytest

from sandbox.app.settings.settings_sheet import KeyRow
from sandbox.level.reading.files import load_level

CTRL = pygame.KMOD_CTRL
TIMES = 12


def hold(driver, key, text="", mod=0):
    """Hold a key down, as the system says it: again and again, each time with its letter, and up in the end."""
    for _ in range(TIMES):
        driver.post(pygame.KEYDOWN, key=key, mod=mod, unicode=text, scancode=0)
        if text:
            driver.post(pygame.TEXTINPUT, text=text)
        driver.pass_unseen()
    driver.post(pygame.KEYUP, key=key, mod=mod, unicode=text, scancode=0)
    driver.frames(2)


def test_a_key_that_opens_the_gallery_begins_no_search_there(driver):
    hold(driver, pygame.K_g, "g")
    assert driver.app.gallery is not None and driver.app.gallery.query == ""
    hold(driver, pygame.K_r, "r")
    assert driver.app.gallery.query == "r" * TIMES


def button(driver, text):
    return next(each for each in driver.app.ui.buttons() if each.text == text)


@pytest.mark.parametrize("key", [pygame.K_RETURN, pygame.K_SPACE])
def test_a_key_that_opens_a_page_presses_nothing_on_it(driver, key):
    driver.pass_unseen(30)
    driver.app.ui.focus_on(button(driver, "Share"))
    hold(driver, key)
    assert driver.app.ui.has_sheet and driver.app.sharing.step == "choose"


def test_a_key_presses_a_button_once(open_app):
    driver = open_app(load_level("rope"))
    driver.app.ui.focus_on(driver.panel.play.melt)
    assert TIMES % 2 == 0
    hold(driver, pygame.K_RETURN)
    assert driver.panel.play.melt.text == "Make whole" and driver.world.settings.solver == "single_pass"


def test_a_row_of_keys_does_not_take_the_key_that_chose_it(driver):
    driver.key(pygame.K_COMMA, CTRL)
    driver.click_widget(button(driver, "Keys in play"))
    row = next(each for each in driver.app.ui.walk() if isinstance(each, KeyRow))
    before = row.entry
    driver.app.ui.focus_on(row)
    hold(driver, pygame.K_RETURN)
    assert row.takes_all_keys and row.entry == before


def test_escape_closes_one_page_and_leaves_the_one_below(driver):
    driver.key(pygame.K_g)
    driver.key(pygame.K_COMMA, CTRL)
    hold(driver, pygame.K_ESCAPE)
    assert driver.app.gallery is not None and driver.app.gallery.is_on_top


def test_a_key_that_is_let_go_in_what_it_opened_works_there(driver):
    hold(driver, pygame.K_g, "g")
    driver.press_letters("gg")
    assert driver.app.gallery.query == "gg"


def test_what_is_typed_is_typed_again_while_its_key_is_held(driver):
    driver.key(pygame.K_g)
    driver.press_letters("a")
    hold(driver, pygame.K_SPACE, " ")
    assert driver.app.ui.focus.typed == "a" + " " * TIMES
