"""The tour: offered once, led by what the person does, ended at will, and there again from the page of F1."""

import pygame
import pytest

from sandbox.editor.storage.preferences import preference, set_preference

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


@pytest.fixture
def driver(edit):
    """The editor as a person finds it at the first start."""
    driver = edit()
    driver.app.guide.may_offer = True
    driver.app.documents.new()
    driver.frames(2)
    return driver


def press(driver, name):
    driver.click_widget(driver.app.guide.buttons[name])


def title(driver):
    return driver.app.guide.tour.step.title


def test_a_whole_tour_by_mouse_ends_with_the_makers_own_bridge_played(driver):
    guide, editor = driver.app.guide, lambda: driver.editor
    press(driver, "start")
    titles = [title(driver)]
    driver.click_widget(editor().palette.tools["rope"])
    titles.append(title(driver))
    driver.move(editor().options.fields["slack"][0].rect.center)
    for _ in range(2):
        driver.post(pygame.MOUSEWHEEL, x=0, y=1, precise_x=0.0, precise_y=1.0)
    driver.frames()
    titles.append(title(driver))
    driver.drag((-3, 1), (0, 1), (3, 1))
    titles.append(title(driver))
    driver.click_widget(editor().palette.tools["pin"])
    driver.click_at(3, 1)
    titles.append(title(driver))
    driver.click_widget(editor().palette.tools["particle"])
    driver.fill(editor().options.fields["mass"][0], "30")
    driver.click_at(*editor().scene.position[editor().scene.slot("rope.12")].tolist())
    titles.append(title(driver))
    driver.click_widget(editor().bar.buttons["play"])
    assert titles == ["A rope", "Some slack", "Across", "A pin", "A weight", "Play"]
    assert guide.tour.is_over and driver.app.mode == "play"
    driver.frames(120)
    position = driver.playback.current.position
    assert position[driver.world.particle_slot("particle")][1] < 0.0
    press(driver, "skip")
    assert guide.tour is None and driver.app.mode == "play"


def test_the_keyboard_alone_leads_through_the_tour(driver):
    driver.app.ui.focus_on(driver.app.guide.buttons["start"])
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_r)
    driver.key(pygame.K_t)
    driver.key(pygame.K_TAB)
    driver.type("0.2")
    driver.key(pygame.K_RETURN)
    driver.move((5, 5))

    def walk(key, steps):
        for _ in range(steps):
            driver.key(key)

    walk(pygame.K_LEFT, 8)
    driver.key(pygame.K_RETURN)
    walk(pygame.K_RIGHT, 16)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_p)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_a)
    driver.key(pygame.K_t)
    driver.type("20")
    driver.key(pygame.K_RETURN)
    walk(pygame.K_LEFT, 8)
    driver.key(pygame.K_RETURN)
    assert title(driver) == "Play"
    driver.key(pygame.K_e)
    assert driver.app.guide.tour.is_over


def test_the_tour_is_offered_at_the_first_empty_sheet_alone_and_can_be_skipped(driver):
    assert preference("tour_seen") is True
    press(driver, "skip")
    assert driver.app.guide.tour is None and not driver.app.guide.buttons
    driver.app.documents.new()
    driver.frames(2)
    assert not driver.app.guide.buttons


def test_the_tour_can_be_left_at_any_step_and_what_was_drawn_stays(driver):
    press(driver, "start")
    driver.key(pygame.K_r)
    driver.drag((-3, 1), (0, 1), (3, 1))
    level = driver.editor.document.level
    press(driver, "skip")
    assert driver.editor.document.level is level and len(level.bodies) == 1


def test_a_step_that_was_gone_back_to_stays_until_the_person_goes_on(driver):
    press(driver, "start")
    driver.key(pygame.K_r)
    assert title(driver) == "Some slack"
    press(driver, "back")
    driver.frames(5)
    assert title(driver) == "A rope"
    press(driver, "next")
    assert title(driver) == "Some slack"


def test_f1_has_the_tour_again_from_an_empty_sheet_and_asks_about_changes_first(driver):
    press(driver, "skip")
    driver.key(pygame.K_a)
    driver.click_at(2, -1)
    driver.key(pygame.K_F1)
    driver.choose("Take the tour")
    assert driver.app.guide.tour is None
    driver.choose("Discard the changes")
    assert title(driver) == "A rope" and not driver.editor.document.level.particles
    driver.key(pygame.K_F1, SHIFT)
    assert title(driver) == "A rope"


def test_the_card_lies_inside_the_canvas_whatever_it_points_at_and_at_every_size(driver):
    guide = driver.app.guide
    press(driver, "start")
    for size in ((1280, 720), (640, 440), (1920, 1080)):
        driver.app.display.window.size = size
        driver.frames(3)
        for tool in ("select", "rope", "pin"):
            driver.editor.choose_tool(tool)
            driver.frames(2)
            assert pygame.Rect(driver.editor.camera.viewport).contains(guide._card), (size, tool)


def test_preferences_are_kept_side_by_side_and_a_damaged_file_is_an_empty_one(tmp_path):
    set_preference("one", 1, tmp_path)
    set_preference("two", [2], tmp_path)
    assert preference("one", tmp_path) == 1 and preference("two", tmp_path) == [2]
    (tmp_path / "preferences.json").write_text("{")
    assert preference("one", tmp_path) is None
    set_preference("one", 3, tmp_path)
    assert preference("one", tmp_path) == 3


def test_the_offer_is_about_the_sheet_and_goes_while_its_level_is_played(driver):
    assert driver.app.guide._panel is not None
    driver.key(pygame.K_e)
    driver.frames(2)
    assert driver.app.mode == "play" and driver.app.guide._panel is None
    driver.key(pygame.K_e)
    driver.frames(2)
    assert driver.app.guide._panel is not None
