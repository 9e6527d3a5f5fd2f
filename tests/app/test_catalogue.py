"""The page of parts in the editor: put on the sheet by mouse and keyboard, kept, renamed, deleted."""

import pygame
import pytest

from sandbox.editor.scene import make_scene
from sandbox.editor.storage.level_file import catalogue
from tests.app.conftest import small_level

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


@pytest.fixture
def driver(edit):
    driver = edit(small_level())
    driver.key(pygame.K_p, SHIFT)
    return driver


def page(driver):
    return driver.editor.side.page


def card(driver, name):
    return next(card for card in page(driver).cards if card.part.name == name)


def ids(driver):
    return [body.id for body in driver.editor.document.level.bodies]


def own():
    return [part.name for part in catalogue() if part.is_own]


def keep(driver, name):
    """Keep the pair of the level as a part."""
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_ESCAPE)
    driver.click_at(1, 2)
    driver.key(pygame.K_k, CTRL)
    driver.app.ui.focus.typed = name
    driver.key(pygame.K_RETURN)
    driver.frames(2)


def _is_seen(driver, box):
    """Whether all of a box [m] is on the sheet."""
    camera = driver.editor.camera
    left, bottom = camera.to_pixels(box[:2])
    right, top = camera.to_pixels(box[2:])
    return pygame.Rect(camera.viewport).contains(pygame.Rect(round(left), round(top), right - left, bottom - top))


@pytest.mark.parametrize("way", ["key", "click", "drag"])
def test_a_part_that_was_put_on_the_sheet_is_seen_whole(driver, way):
    driver.app.display.window.size = (800, 600)
    driver.editor.camera.zoom *= 3.0
    driver.frames(2)
    crane = card(driver, "Crane")
    camera = driver.editor.camera
    corner = camera.viewport[0] + camera.viewport[2] - 20, camera.viewport[1] + 20
    if way == "key":
        driver.app.ui.focus_on(crane)
        driver.key(pygame.K_RETURN)
        ghost = make_scene(driver.editor.pointer_tool.ghost().level)
        assert _is_seen(driver, ghost.bounds(driver.editor.pointer_tool.ghost().selection))
        driver.key(pygame.K_RETURN)
    elif way == "click":
        driver.click_widget(crane)
        driver.click(corner)
    else:
        driver.press(crane.rect.center)
        driver.move(corner)
        driver.release(corner)
    assert driver.editor.history.labels[-1] == "Add Crane"
    assert _is_seen(driver, driver.editor.selection_box)


def test_the_sheet_stays_where_it_is_when_a_part_has_room(driver):
    camera = driver.editor.camera
    before = camera.centre, camera.zoom
    driver.click_widget(card(driver, "See-saw"))
    driver.click_at(2, -2)
    assert (camera.centre, camera.zoom) == before


def test_the_page_has_a_part_ready_for_enter_however_it_is_opened(driver):
    side = driver.editor.side
    driver.key(pygame.K_ESCAPE)
    side.choose("level")
    driver.frames(2)
    driver.click_widget(side._tab_button("parts"))
    assert driver.app.ui.focus is card(driver, "Car")
    driver.key(pygame.K_RETURN)
    assert driver.editor.pointer_tool.drawing.options.part.name == "Car"
    driver.click_widget(card(driver, "Tower"))
    side.choose("level")
    driver.frames(2)
    driver.key(pygame.K_p, SHIFT)
    assert driver.app.ui.focus is card(driver, "Tower"), "it was used last"


def test_a_click_takes_a_part_up_and_clicks_put_it_on_the_sheet_as_one_step_each(driver):
    driver.click_widget(card(driver, "Tower"))
    driver.move(driver.at(3, -2))
    ghost = driver.editor.pointer_tool.ghost()
    assert [body.id for body in ghost.level.bodies] == ["tower"] and "tower" not in ids(driver)
    driver.click_at(3, -2)
    driver.click_at(5, -2)
    assert ids(driver)[-2:] == ["tower", "tower 2"]
    assert driver.editor.document.level.bodies[-2].particles[0] == pytest.approx((3 - 1.2, -2))
    assert driver.editor.history.labels[-1] == "Add Tower"
    driver.key(pygame.K_z, CTRL)
    assert ids(driver)[-1] == "tower"


def test_a_drag_from_the_card_shows_the_part_and_lets_it_go_where_it_ends(driver):
    tower = card(driver, "Tower")
    driver.press(tower.rect.center)
    driver.move(driver.at(4, -1))
    assert driver.editor.pointer_tool.ghost() is not None
    driver.release(driver.at(4, -1))
    assert ids(driver)[-1] == "tower" and driver.editor.tool == "select"
    assert {item.key for item in driver.editor.document.selection} == {"tower"}


def test_a_drag_that_ends_beside_the_sheet_puts_nothing_on_it(driver):
    driver.press(card(driver, "Tower").rect.center)
    driver.release(card(driver, "Car").rect.center)
    assert ids(driver) == ["rope", "pair"]


def test_keys_alone_choose_a_part_move_it_and_put_it_down(driver):
    driver.key(pygame.K_RIGHT)
    driver.key(pygame.K_LEFT)
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_RIGHT)
    x = driver.editor.cursor[0]
    driver.key(pygame.K_RETURN)
    assert ids(driver)[-1] == "body", "the walker is below the car"
    assert driver.editor.scene.position[driver.editor.scene.slot("body.2"), 0] == pytest.approx(x)


def test_the_card_says_what_the_part_is_and_keys_that_a_level_uses_are_in_its_text(driver):
    driver.click_widget(card(driver, "Car"))
    driver.frames(2)
    assert "D drives it" in page(driver)._text.text


def test_what_is_selected_is_kept_as_a_part_and_is_there_at_once(driver):
    keep(driver, "My pair")
    assert own() == ["My pair"] and driver.editor.side.tab == "parts"
    assert driver.app.ui.focus is card(driver, "My pair")
    driver.click_widget(card(driver, "My pair"))
    driver.click_at(4, 3)
    assert ids(driver)[-1] == "pair 2"


def test_a_name_that_is_taken_keeps_the_question_open(driver):
    keep(driver, "My pair")
    keep(driver, "my pair")
    assert driver.app.ui.has_sheet and own() == ["My pair"]


def test_own_parts_are_renamed_and_deleted_by_buttons_that_others_do_not_have(driver):
    driver.click_widget(card(driver, "Car"))
    driver.frames(2)
    assert not page(driver).rename.is_enabled and not page(driver).delete.is_enabled
    keep(driver, "My pair")
    driver.click_widget(page(driver).rename)
    driver.app.ui.focus.typed = "Two"
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert own() == ["Two"]
    driver.click_widget(page(driver).delete)
    driver.choose("Delete it")
    driver.frames(2)
    assert own() == []


def test_a_broken_file_is_a_card_with_its_fault_and_can_only_be_deleted(driver, documents):
    folder = documents.parent / "data" / "parts"
    folder.mkdir(parents=True)
    (folder / "odd.json").write_text('{"wheels": 4')
    driver.key(pygame.K_p, SHIFT)
    page(driver).area.scroll_to(9999)
    driver.frames()
    driver.click_widget(card(driver, "odd"))
    driver.frames(2)
    assert "odd.json" in page(driver)._text.text and driver.editor.tool == "part"
    assert page(driver).delete.is_enabled and not page(driver).rename.is_enabled
    driver.click_at(3, -2)
    assert ids(driver) == ["rope", "pair"]


def test_the_page_and_the_part_in_hand_survive_a_new_layout(driver):
    driver.click_widget(card(driver, "Tower"))
    driver.app.rebuild()
    driver.frames(2)
    assert driver.editor.side.tab == "parts" and card(driver, "Tower").is_taken
    driver.click_at(3, -2)
    assert ids(driver)[-1] == "tower"


def test_a_low_page_shows_two_whole_rows_of_three_with_texts_as_tips_and_its_buttons_below(driver):
    driver.app.display.window.size = (1280, 720)
    driver.app.chosen.choose("scale", 2.0)
    driver.frames(2)
    if not driver.editor.show_side:
        driver.editor.toggle_side()
    driver.key(pygame.K_p, SHIFT)
    shown = page(driver)
    whole = [card for card in shown.cards if shown.area.view.rect.contains(card.rect)]
    assert len(whole) == 6 and len({card.rect.top for card in whole}) == 2
    assert "D drives it" in card(driver, "Car").tip
    driver.key(pygame.K_DOWN)
    assert driver.app.ui.focus is shown.cards[3]
    shown.area.scroll_to(9999)
    driver.frames(1)
    assert shown.area.view.rect.contains(shown.keep.rect) and shown.keep.rect.top > shown.cards[-1].rect.bottom
