"""Small windows and tips in the editor: nothing is too small to hit, nothing lies over what is needed next."""

import pygame
import pytest


@pytest.fixture
def driver(edit):
    return edit()


def resize(driver, width, height):
    driver.app.display.window.size = (width, height)
    driver.frames(2)


def test_tools_stay_large_enough_in_a_low_window_and_do_not_overlap(driver):
    resize(driver, 640, 480)
    places = [button.rect for button in driver.editor.palette.tools.values()]
    assert min(min(place.size) for place in places) >= 24
    assert all(place.collidelist(places[:index]) < 0 for index, place in enumerate(places))
    assert all(driver.editor.palette.back.rect.contains(place) for place in places)
    assert not driver.editor.palette.back.rect.colliderect(pygame.Rect(driver.editor.camera.viewport))


def test_what_has_no_room_on_the_bar_is_in_its_menu(driver):
    assert driver.editor.without_button == ()
    resize(driver, 640, 480)
    left_out = driver.editor.without_button
    assert "align" in left_out and "undo" not in left_out
    driver.key(pygame.K_F10)
    labels = [button.text for button in driver.app.ui.buttons()]
    assert any(label.startswith("Align") for label in labels)


def test_the_panel_folds_in_a_narrow_window_comes_back_with_room_and_obeys_the_person(driver):
    driver.editor.side.choose("level")
    driver.fill(driver.editor.side.page.form.fields["author"][0], "Ann")
    for width, expected in ((640, False), (1280, True)):
        resize(driver, width, 720)
        assert (driver.editor.side is not None) is expected
    assert driver.editor.document.level.author == "Ann"
    driver.app.act("panel")
    resize(driver, 1300, 720)
    assert driver.editor.side is None


def test_in_a_narrow_window_the_panel_lies_over_the_sheet_and_closes_once_something_is_drawn(driver):
    resize(driver, 640, 480)
    before = driver.editor.camera.viewport
    driver.app.act("panel")
    driver.frames(2)
    side = driver.editor.side
    assert side is not None and driver.editor.camera.viewport == before
    driver.key(pygame.K_r)
    left, top, width, height = before
    driver.click((left + 60, top + 60))
    assert driver.editor.side is side, "a click may be one on what the panel then shows"
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_r)
    points = [(left + 60, top + 60), (left + 100, top + 80), (left + width - 40, top + height - 60)]
    assert side.back.rect.collidepoint(points[-1])
    driver.press(points[0])
    driver.move(points[1])
    assert driver.editor.side is None
    driver.move(points[-1])
    driver.release(points[-1])
    assert [body.id for body in driver.editor.document.level.bodies] == ["rope"]
    driver.app.act("panel")
    driver.frames(2)
    assert driver.editor.side is not None, "it comes back by its key"
    driver.move(driver.editor.side.back.rect.center)
    assert driver.app.input.pointer_over_world() is None


def test_a_tip_of_the_panel_lies_beside_it_and_there_is_one_at_a_time(driver):
    side, tip, places = driver.editor.side, driver.app.ui.tip, []
    for tab in ("materials", "level"):
        button = side._tab_button(tab)
        driver.move(button.rect.center)
        assert tip.place is None
        driver.pass_unseen(60)
        assert tip.text == button.tip and not tip.place.colliderect(side.back.rect)
        assert pygame.Rect((0, 0), driver.app.ui.size).contains(tip.place)
        places.append(tip.place)
    assert places[0] != places[1]
    driver.press(side._tab_button("level").rect.center)
    assert tip.text == ""
