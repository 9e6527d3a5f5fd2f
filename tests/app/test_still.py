"""What does not change is not drawn again, what moves moves evenly, and less is drawn while frames are late."""

from dataclasses import replace

import numpy as np
import pygame
import pytest

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.renderer import FRAMES, FULL, LATE, NO_EFFECTS, NO_SHADOWS, TRY_AFTER, Detail, Overlay, Renderer
from sandbox.app.run.playback import Playback, interpolated
from sandbox.physics.jit import COMPILED
from sandbox.session.session import Session
from tests.app.conftest import small_level

FRAME = 1 / 60


class Watched:
    """A renderer whose drawing of things is counted."""

    def __init__(self, monkeypatch, level):
        self.renderer, self.drawn = Renderer(1.0, level), 0
        self.camera = Camera((2.0, 0.0), 20.0, (0, 0, 160, 120))
        self.surface = pygame.Surface((160, 120), 0, 32)
        draw = self.renderer._draw_things

        def counted(*arguments):
            self.drawn += 1
            draw(*arguments)

        monkeypatch.setattr(self.renderer, "_draw_things", counted)

    def draw(self, state, before=None, alpha=1.0, **overlay):
        self.surface.fill(0)
        self.renderer.draw(self.surface, self.camera, before or state, state, alpha, Overlay(**overlay))
        return pygame.surfarray.array2d(self.surface)


@pytest.fixture
def session():
    return Session(small_level())


@pytest.fixture
def watched(monkeypatch, session):
    return Watched(monkeypatch, session.level)


def test_a_world_at_rest_is_drawn_twice_and_then_shown_again_to_the_last_pixel(watched, session):
    pictures = []
    for _ in range(6):
        session.advance()
        pictures.append(watched.draw(session.snapshot()))
    assert watched.drawn == 2
    assert all((picture == pictures[1]).all() for picture in pictures[1:])


def test_whatever_changes_what_is_seen_has_it_drawn_again(watched, session):
    state = session.snapshot()

    def is_drawn(**overlay):
        before = watched.drawn
        watched.draw(state, **overlay)
        return watched.drawn > before

    for _ in range(3):
        watched.draw(state)
    assert not is_drawn()
    assert is_drawn(hovered=1) and is_drawn(cursor=(0.0, 0.0)) and is_drawn()
    assert is_drawn() and not is_drawn()
    moved = state.position.copy()
    moved[2] += 0.2 / watched.camera.zoom
    state = replace(state, arrays={**state.arrays, "position": moved})
    assert is_drawn() and is_drawn() and not is_drawn()
    watched.camera.zoom *= 1.01
    assert is_drawn() and is_drawn() and not is_drawn()
    for name in ("lattice", "velocities"):
        watched.renderer.overlays.shown.add(name)
        assert is_drawn() and is_drawn() and not is_drawn()
    session.advance()
    state = session.snapshot()
    assert is_drawn()
    cut = state.spring_active.copy()
    cut[1] = False
    state = replace(state, arrays={**state.arrays, "spring_active": cut})
    assert is_drawn()


def test_small_movements_add_up_until_they_are_seen(watched, session):
    state = session.snapshot()
    moved = state.position.copy()
    for _ in range(40):
        moved = moved + 0.01 / watched.camera.zoom
        watched.draw(replace(state, arrays={**state.arrays, "position": moved}))
    assert 4 <= watched.drawn <= 14


def test_what_flies_about_goes_on_while_nothing_else_moves(watched, session):
    for _ in range(3):
        session.advance()
        watched.draw(session.snapshot())
    session.world.cut([1])
    before = watched.drawn
    for _ in range(8):
        session.advance()
        watched.draw(session.snapshot())
    assert watched.drawn == before + 8


@pytest.mark.parametrize("speed", [1.0, 0.5, 0.125])
def test_slow_motion_moves_evenly_between_ticks(speed):
    level = small_level(particles=[{"id": "p", "position": [0, 3], "velocity": [2, 0], "radius": 0.1}])
    playback = Playback(level)
    playback.clock.speed = speed
    slot, xs = playback.session.world.particle_slot("p"), []
    for _ in range(64):
        playback.advance(FRAME)
        alpha = playback.clock.alpha(60)
        xs.append(interpolated(playback.previous, playback.current, alpha)[slot, 0])
    steps = np.diff(xs[int(2 / speed) :])
    assert steps == pytest.approx(np.full(len(steps), 2.0 * FRAME * speed), rel=1e-6)


def noted(detail, seconds, count):
    for _ in range(count):
        detail.note(seconds)
    return detail.level


def test_shadows_then_effects_are_left_out_while_frames_are_late_and_come_back():
    detail = Detail()
    assert noted(detail, FRAME, 10 * FRAMES) == FULL
    assert noted(detail, 2 * LATE, FRAMES) == NO_SHADOWS
    assert noted(detail, 2 * LATE, FRAMES) == NO_EFFECTS
    assert noted(detail, 2 * LATE, 9 * FRAMES) == NO_EFFECTS
    assert noted(detail, FRAME, TRY_AFTER) == NO_SHADOWS
    assert noted(detail, FRAME, TRY_AFTER) == FULL


def test_a_machine_that_is_too_slow_for_more_tries_it_ever_more_seldom():
    detail, tries = Detail(), []
    noted(detail, 2 * LATE, FRAMES)
    for frame in range(20 * TRY_AFTER):
        before = detail.level
        detail.note(2 * LATE if detail.level == FULL else FRAME)
        if detail.level < before:
            tries.append(frame)
    gaps = np.diff(tries)
    assert 3 <= len(tries) <= 5 and (gaps[1:] > 1.8 * gaps[:-1]).all()


def test_a_single_late_frame_changes_nothing():
    detail = Detail()
    for _ in range(20):
        noted(detail, 1.0, 1)
        assert noted(detail, FRAME, 9) == FULL


@pytest.mark.skipif(not COMPILED, reason="shadows need kernels")
def test_without_shadows_the_picture_is_another(watched, session):
    whole = watched.draw(session.snapshot())
    watched.renderer.detail = NO_SHADOWS
    assert (watched.draw(session.snapshot()) != whole).any()


def test_a_window_that_nobody_sees_is_not_drawn_while_the_run_goes_on(driver, monkeypatch):
    drawn = []
    monkeypatch.setattr(driver.stage, "draw", lambda *_: drawn.append(1))
    driver.post(pygame.WINDOWMINIMIZED)
    driver.frames(1)
    tick, before = driver.playback.session.tick, len(drawn)
    driver.frames(5)
    assert len(drawn) == before and driver.playback.session.tick > tick
    driver.post(pygame.WINDOWRESTORED)
    driver.frames(2)
    assert len(drawn) > before


def test_a_run_with_terrain_is_drawn_again_from_its_beginning(open_app):
    ground = {"id": "ground", "polygon": [[-3, -3], [7, -3], [7, -2], [-3, -2]]}
    driver = open_app(small_level(terrain=[ground]))
    driver.frames(3)
    driver.key(pygame.K_r)
    driver.frames(3)
    assert driver.playback.session.tick < 10
