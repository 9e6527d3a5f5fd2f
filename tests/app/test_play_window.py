"""The window of a run: what is left of it when it is small, keys that levels have, and runs that left the view."""

import pygame
import pytest

from sandbox.app.play.problems import LEFT_VIEW as LEFT_VIEW
from sandbox.app.play.toolbar import LEAST_NAME, LEFT, RIGHT, fitting
from tests.app.conftest import small_level

SHIFT = pygame.KMOD_SHIFT


def with_arrows():
    """A wheel that the right arrow turns one way and the left one the other."""
    motor = {"speed": -3.0, "torque": 50.0, "key": "right", "reverse_key": "left"}
    return small_level(
        bodies=[
            {"type": "wheel", "id": "wheel", "position": [0, 0], "radius": 1.0, "thickness": 0.3, "segments": 12,
             "motor": motor, "pin": ["hub"]},
        ],
    )  # fmt: skip


@pytest.mark.parametrize("width", [300, 500, 640, 800, 1280])
def test_buttons_that_do_not_fit_are_in_the_menu(width):
    actions = [action for group in (*LEFT, RIGHT) for action, _ in group]
    shown = fitting(actions, width)
    assert set(shown) <= set(actions) and {"pause", "reset", "undo", "gallery"} <= set(shown)
    assert (shown == actions) == (width >= 1280)


@pytest.mark.parametrize("size", [(640, 480), (800, 600), (1280, 720)])
def test_the_bar_lies_inside_the_window_nothing_over_another_and_all_can_be_reached(driver, size):
    driver.app.display.window.size = size
    driver.frames(2)
    bar = driver.app.play.toolbar
    rects = [button.rect for button in bar.buttons.values()]
    assert all(pygame.Rect((0, 0), size).contains(rect) for rect in rects)
    assert all(rect.collidelist(rects[:index]) < 0 for index, rect in enumerate(rects))
    assert bool(bar.left_out) == (size[0] < 1280)
    assert driver.app.play.show_panel == (size[0] >= 800)


@pytest.mark.parametrize("width", [1000, 1100, 1280, 1600])
def test_the_level_s_name_has_room_to_be_read_or_is_left_out(driver, width):
    driver.app.display.window.size = (width, 720)
    driver.frames(2)
    title = driver.app.play.toolbar.title
    assert title is None or title.rect.width >= LEAST_NAME
    assert width < 1600 or title is not None


def title_of(driver, name, width):
    """The title of the bar in a window of that width [pixels]."""
    driver.app.display.window.size = (width, 720)
    driver.frames(2)
    title = driver.app.play.toolbar.title
    assert title.text == name
    return title


def test_a_name_has_a_line_or_two_smaller_ones_and_what_does_not_fit_is_its_tooltip(open_app):
    name = "Truss bridge with a heavy load"
    driver = open_app(small_level(name=name))
    title = title_of(driver, name, 1600)
    assert title.lines == [name] and title.tip == ""
    title = title_of(driver, name, 1280)
    assert len(title.lines) == 2 and " ".join(title.lines) == name and title.tip == ""
    long = ("A name of many words <& more> " * 6).strip()
    driver = open_app(small_level(name=long))
    title = title_of(driver, long, 1280)
    assert title.lines[-1].endswith("…") and title.tip == long
    driver.move(title.rect.center)
    driver.pass_unseen(90)
    assert driver.app.ui.tip.text == long
    unbroken = "Llanfairpwllgwyngyllgogerychwyrndrobwll"
    assert title_of(open_app(small_level(name=unbroken)), unbroken, 1280).tip == unbroken


def test_what_has_no_room_is_done_from_the_menu(driver):
    driver.app.display.window.size = (640, 480)
    driver.frames(2)
    bar = driver.app.play.toolbar
    assert "settings" in bar.left_out
    driver.click_widget(bar.buttons["more"])
    (settings,) = [button for button in driver.app.ui.buttons() if button.text.startswith("Settings")]
    driver.app.ui.focus_on(settings)
    driver.frames(2)
    driver.click_widget(settings)
    assert any(button.text == "Light" for button in driver.app.ui.buttons())


def test_the_panel_folds_in_a_narrow_window_comes_back_with_room_and_obeys_the_person(driver):
    play = driver.app.play
    for size, expected in (((640, 480), False), ((1280, 720), True)):
        driver.app.display.window.size = size
        driver.frames(2)
        assert play.show_panel is expected
    driver.key(pygame.K_h)
    assert play.show_panel is False
    driver.app.display.window.size = (1300, 720)
    driver.frames(2)
    assert play.show_panel is False


def test_what_the_panel_has_no_room_for_is_scrolled_to_by_the_keyboard(driver):
    driver.app.display.window.size = (900, 480)
    driver.frames(2)
    area = driver.panel.area
    assert area.bar.needed
    driver.app.ui.focus_on(driver.panel.world.form.choices["hand"].buttons["strong"])
    driver.frames(2)
    view = area.view.rect
    assert view.contains(driver.panel.world.form.choices["hand"].buttons["strong"].rect)


def test_arrow_keys_of_a_level_win_are_shown_and_with_shift_move_the_cursor(open_app):
    driver = open_app(with_arrows())
    driver.frames(2)
    driver.post(pygame.KEYDOWN, key=pygame.K_RIGHT, mod=0, unicode="", scancode=0)
    driver.frames(5)
    assert driver.world.actuator_value[0] == 1.0
    assert driver.stage.cursor is None
    assert dict(driver.app.play._keys.shown()) == {"left": False, "right": True}
    driver.post(pygame.KEYUP, key=pygame.K_RIGHT, mod=0, unicode="", scancode=0)
    driver.frames(2)
    assert driver.playback.session.can_undo
    driver.key(pygame.K_RIGHT, SHIFT)
    assert driver.stage.cursor is not None


def test_again_is_offered_once_things_have_left_the_view_and_begins_anew(open_app):
    free = {"type": "rope", "id": "rope", "start": [0, 0], "end": [4, 0], "segments": 4, "material": "steel"}
    driver = open_app(small_level(bodies=[free], settings={"solver": "single_pass", "gravity": [0.0, -300.0]}))
    again = driver.app.play.restart_button
    assert not again.visible
    driver.frames(90)
    assert again.visible and LEFT_VIEW in driver.notices
    driver.playback.clock.paused = True
    driver.playback.seek(1)
    driver.frames()
    assert not again.visible and LEFT_VIEW not in driver.notices
    # How long it has been away is counted anew.
    driver.playback.seek(90)
    driver.playback.clock.paused = False
    driver.frames(90)
    assert again.visible
    driver.click_widget(again)
    assert driver.playback.session.tick < 20 and not again.visible
