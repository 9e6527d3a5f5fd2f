"""Modal pages: what they hold when the window is laid out anew or another screen comes."""

import pygame
import pytest

from sandbox.editor.items import Item
from sandbox.level.reading.files import read_level
from tests.app.conftest import small_level

CTRL = pygame.KMOD_CTRL


def field(driver):
    return driver.app.ui.focus


def lay_out_anew(driver):
    driver.app.rebuild()
    driver.frames(2)


def test_a_name_that_is_typed_survives_a_new_layout_and_the_next_letter_is_added(edit, documents):
    driver = edit()
    driver.app.documents.save_as()
    driver.type("my ")
    lay_out_anew(driver)
    driver.type("wheel")
    lay_out_anew(driver)
    assert field(driver).typed == "my wheel"
    driver.choose("Save")
    assert read_level(documents / "my wheel.json") == driver.editor.document.level
    assert not driver.app.ui.has_sheet


def test_a_form_survives_a_larger_scale_by_its_key(edit):
    driver = edit(small_level())
    driver.editor.select(frozenset({Item("body", "pair")}))
    driver.app.act("array")
    driver.choose("Along a line")
    driver.type("3")
    driver.key(pygame.K_EQUALS, CTRL)
    assert driver.app.scale > 1.0 and field(driver).typed == "3"
    driver.choose("Make")
    assert len(driver.editor.document.level.bodies) == 4


@pytest.mark.parametrize("action", ["help", "gallery", "open", "edit"])
def test_pages_over_a_run_survive_a_new_layout_as_often_as_the_window_changes(driver, action):
    driver.app.act(action)
    driver.frames(2)
    before = [button.text for button in driver.app.ui.buttons()]
    for _ in range(3):
        lay_out_anew(driver)
    assert [button.text for button in driver.app.ui.buttons()] == before


def test_faults_and_choices_survive_one_over_the_other_and_are_closed_one_by_one(edit):
    driver = edit(small_level())
    driver.app.act("menu")
    driver.app.show_faults("Faults", ["one", "two"])
    lay_out_anew(driver)
    driver.choose("Close")
    assert driver.app.ui.has_sheet
    driver.choose("Cancel")
    assert not driver.app.ui.has_sheet


def test_a_page_that_was_closed_does_not_come_back(edit):
    driver = edit(small_level())
    driver.app.documents.save_as()
    driver.key(pygame.K_ESCAPE)
    lay_out_anew(driver)
    assert not driver.app.ui.has_sheet


def test_pages_of_a_screen_end_with_it_but_questions_do_not(edit):
    driver = edit(small_level())
    driver.key(pygame.K_a)
    driver.click_at(3, 3)
    driver.app.act("menu")
    driver.app.quit()
    driver.app.documents.play()
    driver.frames(2)
    driver.choose("Cancel")
    assert not driver.app.ui.has_sheet and driver.app.running


def test_the_widgets_of_a_layout_end_with_it(edit):
    driver = edit(small_level())
    buttons = driver.app.ui.buttons()
    lay_out_anew(driver)
    assert buttons and not any(button.is_there for button in buttons)
