"""The window of a run: what is left of it when it is small, keys that levels have, and runs that left the view."""

import pygame
import pytest

from sandbox.app.base.shortcuts import label_of
from sandbox.app.play.problems import LEFT_VIEW as LEFT_VIEW
from sandbox.app.play.toolbar import LEAST_NAME, LEFT, MENU, RIGHT
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


def test_the_bar_has_nine_buttons_at_most_and_its_menu_all_other_actions(driver, open_app):
    bar = driver.app.play.toolbar
    assert len(bar.buttons) == 9 and {"pause", "reset", "undo", "gallery", "more"} <= set(bar.buttons)
    of_groups = {action for group in (*LEFT, RIGHT) for action, _ in group}
    assert of_groups == set(bar.buttons) | {"edit"}
    assert set(bar.left_out) == set(MENU) - set(bar.buttons) - {"keep", "ghost", "card", "as_it_was", "solution"}
    driver = open_app(edit=True)
    driver.app.act("play")
    driver.frames(2)
    bar = driver.app.play.toolbar
    assert "edit" in bar.buttons and "share" in bar.left_out and len(bar.buttons) == 9


@pytest.mark.parametrize("size", [(640, 480), (800, 600), (1280, 720)])
def test_the_bar_lies_inside_the_window_nothing_over_another_and_all_can_be_reached(driver, size):
    driver.app.display.window.size = size
    driver.frames(2)
    bar = driver.app.play.toolbar
    rects = [button.rect for button in bar.buttons.values()]
    assert all(pygame.Rect((0, 0), size).contains(rect) for rect in rects)
    assert all(rect.collidelist(rects[:index]) < 0 for index, rect in enumerate(rects))
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
    name = " ".join([name] * 4)
    title = title_of(open_app(small_level(name=name)), name, 1000)
    assert len(title.lines) == 2 and " ".join(title.lines) == name and title.tip == ""
    long = ("A name of many words <& more> " * 6).strip()
    driver = open_app(small_level(name=long))
    title = title_of(driver, long, 1000)
    assert title.lines[-1].endswith("…") and title.tip == long
    driver.move(title.rect.center)
    driver.pass_unseen(90)
    assert driver.app.ui.tip.text == long
    unbroken = "Llanfairpwllgwyngyllgogerychwyrndrobwll"
    assert title_of(open_app(small_level(name=unbroken * 3)), unbroken * 3, 1000).tip == unbroken * 3


def test_what_has_no_button_is_done_from_the_menu_which_says_what_is_on(driver):
    bar = driver.app.play.toolbar
    driver.app.act("timeline")
    driver.frames(2)
    bar = driver.app.play.toolbar
    driver.click_widget(bar.buttons["more"])
    rows = driver.app.ui.focus.rows
    assert [row.text for row in rows] == [label_of(action, "play") for action in bar.left_out]
    said = {action: row.aside for action, row in zip(bar.left_out, rows, strict=True)}
    assert said["timeline"] == "on" and said["graphs"] == "F8"
    for _ in range(bar.left_out.index("settings") + 1):
        driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
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
