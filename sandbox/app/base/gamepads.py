"""Gamepads: which keys of a level their sticks and buttons press, and what their events say."""

import contextlib
from collections.abc import Iterable
from typing import Any

import pygame

# Keys that go together: from left to right, and from below upwards.
ACROSS = (("a", "d"), ("left", "right"))
UPWARDS = (("s", "w"), ("down", "up"))
# Buttons that press all other keys of a level, in the order of the alphabet.
BUTTONS = ("A", "B", "X", "Y")
# The part of its way from which a stick presses, and below which it lets go.
PRESSES, LETS_GO = 0.5, 0.35
# The value of an axis at the end of its way.
_END = 32767

_BUTTONS = {
    pygame.CONTROLLER_BUTTON_A: "A",
    pygame.CONTROLLER_BUTTON_B: "B",
    pygame.CONTROLLER_BUTTON_X: "X",
    pygame.CONTROLLER_BUTTON_Y: "Y",
    pygame.CONTROLLER_BUTTON_DPAD_LEFT: "left",
    pygame.CONTROLLER_BUTTON_DPAD_RIGHT: "right",
    pygame.CONTROLLER_BUTTON_DPAD_UP: "up",
    pygame.CONTROLLER_BUTTON_DPAD_DOWN: "down",
}
_AXES = {pygame.CONTROLLER_AXIS_LEFTX: ("left", "right"), pygame.CONTROLLER_AXIS_LEFTY: ("up", "down")}
EVENTS = (
    pygame.CONTROLLERDEVICEADDED,
    pygame.CONTROLLERDEVICEREMOVED,
    pygame.CONTROLLERBUTTONDOWN,
    pygame.CONTROLLERBUTTONUP,
    pygame.CONTROLLERAXISMOTION,
)


def controls_of(keys: Iterable[str]) -> dict[str, str]:
    """The gamepad control for each key of a level: left, right, up, down, or a button; further keys have none."""
    unpaired = sorted(keys)
    found: dict[str, str] = {}
    for pairs, ways in ((ACROSS, ("left", "right")), (UPWARDS, ("down", "up"))):
        pair = next((pair for pair in pairs if set(pair) <= set(unpaired)), ())
        found |= dict(zip(pair, ways, strict=False))
        unpaired = [key for key in unpaired if key not in pair]
    return found | dict(zip(unpaired, BUTTONS, strict=False))


class Gamepads:
    """Opens gamepads as they come; a control is down while any stick or button of any gamepad holds it down."""

    def __init__(self) -> None:
        self._open: dict[int, Any] = {}
        # What holds a control down: the number of a gamepad, and the button or axis.
        self._down: dict[tuple[int, str], str] = {}

    def begin(self) -> None:
        """Start to listen to gamepads, those that are there and those that come."""
        from pygame._sdl2 import controller

        with contextlib.suppress(pygame.error):
            controller.init()

    def take(self, event: pygame.event.Event) -> list[tuple[str, bool]]:
        """The controls that an event of a gamepad lets go, and those that it presses: (control, whether it is down)."""
        before = set(self._down.values())
        if event.type == pygame.CONTROLLERDEVICEADDED:
            self._add(event.device_index)
        elif event.type == pygame.CONTROLLERDEVICEREMOVED:
            self._open.pop(event.instance_id, None)
            self._down = {source: held for source, held in self._down.items() if source[0] != event.instance_id}
        elif event.type == pygame.CONTROLLERAXISMOTION:
            self._set((event.instance_id, f"axis {event.axis}"), self._leaning(event))
        else:
            is_down = event.type == pygame.CONTROLLERBUTTONDOWN
            self._set((event.instance_id, f"button {event.button}"), _BUTTONS.get(event.button) if is_down else None)
        after = set(self._down.values())
        return [(each, False) for each in sorted(before - after)] + [(each, True) for each in sorted(after - before)]

    def _add(self, index: int) -> None:
        from pygame._sdl2 import controller

        # One that is gone again, or that this system cannot open, stays unheard.
        with contextlib.suppress(pygame.error):
            opened = controller.Controller(index)
            self._open[opened.as_joystick().get_instance_id()] = opened

    def _set(self, source: tuple[int, str], control: str | None) -> None:
        self._down.pop(source, None)
        if control is not None:
            self._down[source] = control

    def _leaning(self, event: pygame.event.Event) -> str | None:
        """The control that a stick is, where it leans far enough."""
        way = _AXES.get(event.axis)
        if way is None:
            return None
        control = way[event.value > 0]
        is_held = self._down.get((event.instance_id, f"axis {event.axis}")) == control
        return control if abs(event.value) >= (LETS_GO if is_held else PRESSES) * _END else None
