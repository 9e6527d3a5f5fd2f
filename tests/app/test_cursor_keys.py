"""Keys alone reach each thing of a run in the window, and do to it what the mouse does."""

import pygame
import pytest

from sandbox.app.base.shortcuts import action_of, shortcuts
from sandbox.level.reading.files import load_level
from sandbox.tools.axle import AxleTool
from sandbox.tools.click import ClickTool
from tests.app.conftest import small_level

SHIFT = pygame.KMOD_SHIFT
MENU_KEY = 0x40000065
# A ball that falls beside a rope of one's own.
BALL = {"id": "ball", "position": [5.0, 3.0], "mass": 1.0, "radius": 0.3}


@pytest.fixture
def driver(open_app):
    return open_app(small_level(particles=[BALL]))


def _at(driver):
    return driver.stage.at_cursor


def _name(driver):
    return driver.world.particle_names[_at(driver)]


def test_n_goes_from_thing_to_thing_and_back_and_page_keys_from_particle_to_particle(driver):
    driver.key(pygame.K_n)
    assert _name(driver) == "rope.2"
    driver.key(pygame.K_n)
    assert _name(driver).startswith("pair.")
    driver.key(pygame.K_n)
    assert _name(driver) == "ball"
    driver.key(pygame.K_n)
    assert _name(driver) == "rope.2"
    driver.key(pygame.K_PAGEDOWN)
    assert _name(driver) == "rope.3"
    for _ in range(2):
        driver.key(pygame.K_PAGEUP)
    assert _name(driver) == "rope.1"
    driver.key(pygame.K_n, SHIFT)
    assert _name(driver) == "ball"


def test_every_thing_of_a_large_level_is_visited_once_a_round(open_app):
    driver = open_app(load_level("rope_bridge_jelly"))
    driver.playback.clock.paused = True
    owners = []
    shown = driver.playback.current.owner[driver.stage._visited]
    for _ in range(len(set(shown.tolist()))):
        driver.key(pygame.K_n)
        owners.append(int(driver.playback.current.owner[_at(driver)]))
    assert sorted(owners) == sorted(set(shown.tolist()))


def test_the_cursor_goes_along_with_what_falls_until_arrows_move_it(open_app):
    driver = open_app(small_level(particles=[BALL], settings={"solver": "single_pass", "gravity": [0.0, -9.81]}))
    driver.key(pygame.K_n, SHIFT)
    driver.frames(60)
    assert _name(driver) == "ball"
    assert driver.stage.cursor[1] == pytest.approx(float(driver.playback.current.position[_at(driver)][1]))
    driver.key(pygame.K_UP)
    place = driver.stage.cursor
    driver.frames(5)
    assert driver.stage.cursor == place


@pytest.mark.parametrize("key, modifiers", [(pygame.K_q, 0), (MENU_KEY, 0), (pygame.K_F10, SHIFT)])
def test_the_menu_of_the_thing_at_the_cursor_opens_by_keys_and_does_what_it_says(driver, key, modifiers):
    driver.key(pygame.K_n)
    driver.key(key, modifiers)
    assert driver.app.ui.has_sheet
    driver.key(pygame.K_END)
    driver.key(pygame.K_RETURN)
    driver.frames(3)
    assert not driver.app.ui.has_sheet
    assert not driver.playback.current.particle_active[:5].any()


def test_the_menu_by_keys_says_where_nothing_is(driver):
    driver.key(pygame.K_q)
    assert not driver.app.ui.has_sheet
    assert any("N takes it to the next one" in notice for notice in driver.notices)


def test_enter_pins_cuts_and_erases_at_the_cursor_by_the_tool_in_hand(driver):
    driver.key(pygame.K_n)
    driver.key(pygame.K_p)
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert driver.world.inverse_mass[2] == 0.0
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert driver.world.inverse_mass[2] > 0.0
    driver.key(pygame.K_c)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_PAGEDOWN)
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert not driver.world.spring_active[:4].all()
    driver.key(pygame.K_n, SHIFT)
    assert _name(driver) == "ball"
    driver.key(pygame.K_x)
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert not driver.playback.current.particle_active[driver.world.particle_slot("ball")]


def test_a_rope_is_pulled_from_one_thing_to_another_by_keys(driver):
    rope = next(entry for entry in shortcuts("play") if entry.action == "tool_pull_rope").keys[0]
    count = int(driver.playback.current.particle_active.sum())
    driver.key(pygame.K_n)
    driver.key(ord(rope[-1].lower()), SHIFT if rope.startswith("Shift+") else 0)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_n, SHIFT)
    driver.key(pygame.K_RETURN)
    driver.frames(3)
    assert int(driver.playback.current.particle_active.sum()) > count


def test_tools_that_act_at_a_press_are_not_held(driver):
    for name, tool in driver.stage.tools.items():
        assert tool.is_held != isinstance(tool, (ClickTool, AxleTool)), name


def test_a_pair_of_runs_has_no_menu_by_keys_either(driver):
    driver.app.act("compare")
    driver.frames(2)
    driver.key(pygame.K_n)
    driver.key(pygame.K_q)
    assert not driver.app.ui.has_sheet


def test_a_key_that_means_something_at_the_cursor_means_nothing_else():
    assert action_of(pygame.K_q, 0) == action_of(MENU_KEY, 0) == action_of(pygame.K_F10, SHIFT) == "thing_menu"
