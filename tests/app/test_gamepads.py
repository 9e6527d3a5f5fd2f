"""A gamepad drives what the keys of a level drive, and a recording has it as it has keys."""

import numpy as np
import pygame
import pytest

from sandbox.app.base.gamepads import controls_of
from sandbox.replay import read_replay, verify
from tests.app.conftest import small_level
from tests.app.test_drive_keys import MOTOR, WHEEL

END = 32767


@pytest.fixture
def driving(open_app):
    """A level whose wheel is driven by D and A, and whose rules ask for G."""
    rules = [{"id": "go", "when": {"key": "g"}, "then": [{"say": "Go"}]}]
    return open_app(small_level(bodies=[{**WHEEL, "motor": MOTOR}], rules=rules))


def _button(driver, name, is_down=True, pad=0):
    kind = pygame.CONTROLLERBUTTONDOWN if is_down else pygame.CONTROLLERBUTTONUP
    driver.post(kind, instance_id=pad, button=getattr(pygame, f"CONTROLLER_BUTTON_{name}"))
    driver.frames(2)


def _stick(driver, value, axis=pygame.CONTROLLER_AXIS_LEFTX):
    driver.post(pygame.CONTROLLERAXISMOTION, instance_id=0, axis=axis, value=round(value * END))
    driver.frames(2)
    return driver.world.actuator_value[0]


def test_pairs_of_keys_lie_on_the_stick_and_others_on_buttons_in_their_order():
    assert controls_of("ad") == {"a": "left", "d": "right"}
    assert controls_of("dcaws") == {"a": "left", "d": "right", "s": "down", "w": "up", "c": "A"}
    assert controls_of(["right", "left", "a", "d"]) == {"a": "left", "d": "right", "left": "A", "right": "B"}
    assert controls_of("d") == {"d": "A"}
    assert controls_of("kjhgf") == {"f": "A", "g": "B", "h": "X", "j": "Y"}


def test_a_stick_drives_as_keys_do_and_does_not_flutter(driving):
    values = [_stick(driving, value) for value in (0.3, 0.6, 0.4, 0.3, -1.0, 1.0, 0.0)]
    assert values == [0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0]
    # The other axis is for keys that this level has not.
    assert _stick(driving, 1.0, pygame.CONTROLLER_AXIS_LEFTY) == 0.0


def test_the_cross_and_the_stick_hold_one_key_until_both_let_go(driving):
    _button(driving, "DPAD_RIGHT")
    _stick(driving, 1.0)
    _button(driving, "DPAD_RIGHT", is_down=False)
    assert driving.world.actuator_value[0] == 1.0
    assert _stick(driving, 0.0) == 0.0


def test_two_controls_at_once_are_two_keys(driving):
    _button(driving, "A")
    _button(driving, "DPAD_LEFT")
    assert driving.world.key_down[0] and driving.world.actuator_value[0] == -1.0
    _button(driving, "A", is_down=False)
    assert not driving.world.key_down[0] and driving.world.actuator_value[0] == -1.0


def test_a_gamepad_that_is_taken_away_lets_go(driving):
    _button(driving, "DPAD_RIGHT", pad=3)
    driving.post(pygame.CONTROLLERDEVICEREMOVED, instance_id=3)
    driving.frames(2)
    assert driving.world.actuator_value[0] == 0.0


def test_a_button_without_a_meaning_does_nothing_and_one_gamepad_that_is_gone_at_once_neither(driving):
    for name in ("B", "START", "LEFTSHOULDER"):
        _button(driving, name)
        _button(driving, name, is_down=False)
    driving.post(pygame.CONTROLLERDEVICEADDED, device_index=77)
    driving.frames(2)
    assert not driving.playback.session.can_undo


def test_what_a_gamepad_did_is_one_gesture_and_in_the_recording(driving, tmp_path):
    _button(driving, "DPAD_RIGHT")
    driving.frames(20)
    _button(driving, "DPAD_RIGHT", is_down=False)
    moved = driving.world.velocity.copy()
    assert moved.any()
    path = tmp_path / "padded.replay.gz"
    driving.playback.session.save_to(path)
    assert verify(read_replay(path)) is None
    driving.key(pygame.K_z, pygame.KMOD_CTRL)
    driving.frames(2)
    assert not driving.world.velocity.any()


def test_no_control_reaches_a_level_under_a_page(driving):
    driving.app.act("settings")
    driving.frames(2)
    _button(driving, "DPAD_RIGHT")
    assert driving.world.actuator_value[0] == 0.0


def test_caps_are_round_and_name_the_gamepad_while_it_was_used_last(driving):
    def caps():
        driving.frames(1)
        left, top, width, height = driving.app.play.viewport
        corner = pygame.Rect(left + width - 240, top + height - 60, 240, 60)
        return pygame.surfarray.array3d(driving.app.display.surface.subsurface(corner))

    of_keys = caps()
    _button(driving, "DPAD_RIGHT")
    _button(driving, "DPAD_RIGHT", is_down=False)
    of_pad = caps()
    assert not np.array_equal(of_keys, of_pad)
    for kind in (pygame.KEYDOWN, pygame.KEYUP):
        driving.post(kind, key=pygame.K_a, mod=0, unicode="a")
        driving.frames(2)
    assert np.array_equal(caps()[-90:], of_keys[-90:])
