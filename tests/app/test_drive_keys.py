"""Keys of a level drive its parts while they are held."""

import numpy as np
import pygame
import pytest

from sandbox.app.contracts.screen import Figures
from sandbox.session.commands import CutSprings, SetSolver
from tests.app.conftest import small_level

WHEEL = {"type": "wheel", "id": "w", "position": [2, 2], "radius": 1, "thickness": 0.3, "segments": 6, "pin": ["hub"]}
MOTOR = {"speed": 3, "torque": 50, "key": "d", "reverse_key": "a"}


@pytest.fixture
def driving(open_app):
    """A level whose wheel is driven by D and A; D is the drag tool elsewhere."""
    return open_app(small_level(bodies=[{**WHEEL, "motor": MOTOR}]))


def test_a_key_drives_while_it_is_held_and_opposite_keys_take_turns(driving):
    values = []
    for kind, key in [("down", "d"), ("down", "d"), ("down", "a"), ("up", "a"), ("up", "d")]:
        driving.post(pygame.KEYDOWN if kind == "down" else pygame.KEYUP, key=ord(key), mod=0, unicode=key)
        driving.frames(2)
        values.append(driving.world.actuator_value[0])
    assert values == [1.0, 1.0, -1.0, 1.0, 0.0]
    assert driving.world.velocity.any()


def test_a_key_with_ctrl_is_a_shortcut_and_one_of_no_part_too(driving):
    driving.post(pygame.KEYDOWN, key=pygame.K_d, mod=pygame.KMOD_CTRL, unicode="d")
    driving.post(pygame.KEYDOWN, key=pygame.K_p, mod=0, unicode="p")
    driving.frames(2)
    assert driving.world.actuator_value[0] == 0.0
    assert driving.stage.tool_name == "pin"


def test_a_key_that_is_held_over_a_fresh_start_lets_go_without_a_trace(driving):
    driving.post(pygame.KEYDOWN, key=pygame.K_d, mod=0, unicode="d")
    driving.frames(3)
    driving.key(pygame.K_r)
    driving.post(pygame.KEYUP, key=pygame.K_d, mod=0)
    driving.frames(2)
    assert driving.world.actuator_value[0] == 0.0
    assert not driving.playback.session.can_undo
    driving.post(pygame.KEYDOWN, key=pygame.K_a, mod=0, unicode="a")
    driving.frames(2)
    assert driving.world.actuator_value[0] == -1.0


def test_undo_takes_a_whole_press_back(driving):
    driving.post(pygame.KEYDOWN, key=pygame.K_d, mod=0, unicode="d")
    driving.frames(5)
    driving.post(pygame.KEYUP, key=pygame.K_d, mod=0)
    driving.frames(2)
    driving.key(pygame.K_z, pygame.KMOD_CTRL)
    driving.frames(2)
    assert not driving.world.velocity.any()


def told(driving):
    """What the status line says."""
    return [text for text, _ in driving.app.play.status(Figures(60.0, 60.0, 1.0))]


def test_the_status_line_says_what_a_motor_gives_and_what_the_single_pass_cannot_carry(driving):
    driving.post(pygame.KEYDOWN, key=pygame.K_d, mod=0, unicode="d")
    driving.frames(3)
    assert any(text.startswith("motor w: ") and text.endswith(" of 50 N m") for text in told(driving))
    assert any("cannot carry loaded wheels" in text for text in told(driving))
    driving.playback.submit(SetSolver(solver="direct"))
    driving.frames(3)
    assert not any("cannot carry loaded wheels" in text for text in told(driving))
    spokes = np.flatnonzero(driving.world.particle_a == driving.world.particle_slot("w.hub"))
    driving.playback.submit(CutSprings(tuple(spokes.tolist())))
    driving.frames(3)
    assert "motor w: it turns freely" in told(driving)
