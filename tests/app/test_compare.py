"""Two settings side by side: one hand works on both, settings on one; undo and reset keep them in step."""

import numpy as np
import pygame
import pytest

from sandbox.app.compare.compare_screen import PILL_TOP, WELCOME, CompareScreen
from sandbox.app.play.legend import MARGIN
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import Grab, Pin, SetCoefficients
from tests.app.conftest import small_level


@pytest.fixture
def pair(open_app):
    """The app with the small level twice."""
    driver = open_app(small_level())
    driver.key(pygame.K_F9)
    driver.frames(2)
    return driver


def worlds(driver):
    screen = driver.app.play
    return screen.playback.session.world, screen.other.session.world


def stiffnesses(driver):
    return [float(world.stiffness[world.spring_slot("rope:0")]) for world in worlds(driver)]


def beside(driver, pixel):
    """The same place in B."""
    (left, top, *_), (other_left, other_top, *_) = driver.app.play.viewport, driver.app.play.other_viewport
    return pixel[0] - left + other_left, pixel[1] - top + other_top


def test_what_is_said_of_two_runs_is_not_said_of_one(pair):
    assert WELCOME in pair.notices
    pair.key(pygame.K_F9)
    pair.frames(2)
    assert WELCOME not in pair.notices


def test_what_is_said_of_two_runs_does_not_lie_over_the_gallery(pair):
    pair.key(pygame.K_g)
    assert WELCOME not in pair.notices


@pytest.mark.parametrize("in_second", [False, True])
def test_a_drag_in_either_half_pulls_the_same_particle_in_both(pair, in_second):
    start = pair.pixel_of("rope.end")
    end = start[0] + 40, start[1] - 60
    if in_second:
        start, end = beside(pair, start), beside(pair, end)
    pair.press(start)
    pair.move(end)
    pair.frames(10)
    assert len(pair.stage.drag.holds) == 1
    one, other = worlds(pair)
    assert state_hash(one) == state_hash(other)
    assert np.ptp(one.position[:5, 1]) > 0.01
    pair.release(end)
    assert not one.any_held() and not other.any_held()


def test_the_panel_sets_one_side_and_undo_takes_back_what_was_done_last_in_both(pair):
    pair.click_widget(pair.panel.ways.buttons["pad"])
    pair.click_widget(pair.panel.sides.buttons["B"])
    pair.frames(1)
    pair.fill(pair.panel.form.fields["stiffness"][0], "0.05")
    assert stiffnesses(pair) == [0.3, 0.05]
    at = pair.pixel_of("rope.end")
    pair.press(at)
    pair.move((at[0], at[1] - 50))
    pair.frames(5)
    pair.release((at[0], at[1] - 50))
    one, other = worlds(pair)
    assert not np.array_equal(one.position, other.position)
    pair.key(pygame.K_z, pygame.KMOD_CTRL)
    kinds = [
        {type(entry.command) for entry in each.session.history.timeline}
        for each in (pair.app.play.playback, pair.app.play.other)
    ]
    assert not any(Grab in each for each in kinds) and SetCoefficients in kinds[1] - kinds[0]
    assert stiffnesses(pair) == [0.3, 0.05]
    pair.key(pygame.K_z, pygame.KMOD_CTRL)
    assert stiffnesses(pair) == [0.3, 0.3]


def test_the_beginning_comes_back_with_the_settings_of_both(pair):
    pair.fill(pair.panel.form.fields["stiffness"][0], "0.05")
    pair.take_sliders()
    pair.click_widget(pair.panel.engineers.form.choices["solver"].buttons["direct"])
    pair.frames(20)
    pair.key(pygame.K_r)
    one, other = worlds(pair)
    assert max(one.tick, other.tick) <= 4 and one.tick == other.tick
    assert stiffnesses(pair) == [0.05, 0.3]
    assert (one.settings.solver, other.settings.solver) == ("direct", "single_pass")
    at = pair.pixel_of("rope.end")
    pair.press(at)
    pair.frames(2)
    assert one.any_held() or worlds(pair)[1].any_held()
    pair.release(at)


def test_a_recording_holds_one_run_and_says_which(pair):
    pair.app.act("record")
    pair.frames(3)
    screen = pair.app.play
    assert screen.playback.session.recording is not None and screen.other.session.recording is None
    assert any("holds A alone" in notice for notice in pair.notices)


def test_pause_single_ticks_and_the_camera_are_of_both(pair):
    pair.key(pygame.K_SPACE)
    before = [world.tick for world in worlds(pair)]
    pair.key(pygame.K_PERIOD)
    assert [world.tick for world in worlds(pair)] == [tick + 1 for tick in before]
    pair.app.play.turn_wheel(beside(pair, (100.0, 100.0)), 3)
    pair.frames(1)
    mine, its = pair.app.play.stage.camera, pair.app.play.beside.camera
    assert (mine.centre, mine.zoom) == (its.centre, its.zoom)


def test_going_back_in_time_takes_both_there_and_on_again(pair):
    at = pair.pixel_of("rope.end")
    pair.press(at)
    pair.move((at[0], at[1] - 50))
    pair.frames(20)
    pair.release((at[0], at[1] - 50))
    one, other = worlds(pair)
    screen, tick = pair.app.play, one.tick
    screen.playback.seek(10)
    pair.frames(1)
    assert one.tick == other.tick and one.tick < tick
    pair.frames(tick)
    assert one.tick == other.tick and state_hash(one) == state_hash(other)


def test_f9_leads_back_to_the_run_that_was_left_for_it(driver):
    driver.key(pygame.K_F9)
    driver.key(pygame.K_F9)
    driver.frames(30)
    driver.playback.submit(Pin(2))
    driver.frames(2)
    before = driver.playback
    driver.key(pygame.K_F9)
    driver.frames(5)
    driver.key(pygame.K_F9)
    assert driver.playback is before and driver.playback.session.can_undo


def test_halves_are_alike_in_any_window_and_f9_leads_back(pair):
    for size in ((640, 480), (700, 1000), (1280, 720)):
        pair.app.display.window.size = size
        pair.frames(2)
        screen = pair.app.play
        one, other = pygame.Rect(screen.viewport), pygame.Rect(screen.other_viewport)
        assert one.size == other.size and not one.colliderect(other)
        assert one.union(other).height <= screen.area[3]
    assert pair.app.play.difference.text == "A and B are in the same place"
    pair.key(pygame.K_F9)
    pair.frames(1)
    assert not isinstance(pair.app.play, CompareScreen)


def test_the_legend_leaves_what_stands_over_the_halves_free(pair, monkeypatch):
    rooms = []
    monkeypatch.setattr("sandbox.app.play.legend.Legend.draw", lambda *rest: rooms.append(rest[-1]))
    ui = pair.app.ui
    for size, below in (((1280, 720), PILL_TOP + 10), ((600, 900), 50)):
        pair.app.display.window.size = size
        pair.frames(3)
        left, top, width, _ = pair.app.play.viewport
        assert rooms[-1].right == left + width
        assert rooms[-1].top + ui.px(MARGIN) >= top + ui.px(below)
