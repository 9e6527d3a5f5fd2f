"""DriveKeys: keys that a level gives to its motors, hydraulics and rules, held while it is played; and their caps."""

from collections.abc import Sequence

import pygame

from sandbox.app.base.gamepads import controls_of
from sandbox.app.draw.colours import ACCENT, BACKGROUND, LINE, MUTED, NOTICE, TEXT, Colour
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.ui import Ui
from sandbox.level.plan.actuators import driving_keys
from sandbox.session.commands import HoldKey, SetDrive

ARROWS = {"left": pygame.K_LEFT, "right": pygame.K_RIGHT, "up": pygame.K_UP, "down": pygame.K_DOWN}


def code_of(key: str) -> int:
    """The key of a keyboard that a level names."""
    return ARROWS.get(key) or ord(key)


class DriveKeys:
    """Drives parts of one run, and answers its rules, while keys are held; a press and its release are one gesture.

    is_on_pad: whether a gamepad has pressed the last one.
    """

    def __init__(self, playback: Playback, is_on_pad: bool = False) -> None:
        self.playback = playback
        self.is_on_pad = is_on_pad
        # The key that each control of a gamepad holds.
        self._controlled: dict[str, int] = {}
        self._joined: object = None
        self._all: dict[int, list[tuple[int, float]]] = {}
        asked = playback.session.world.rule_keys
        self._names: dict[int, str] = {code_of(key): key for key in asked}
        # The place of each key that rules ask for among them.
        self._asked = {code_of(key): slot for slot, key in enumerate(asked)}
        # The gesture of each key that is held, in the order of pressing.
        self._held: dict[int, int] = {}

    @property
    def has_arrows(self) -> bool:
        """Whether arrow keys drive something, or answer a rule."""
        return any(code in self._codes for code in ARROWS.values())

    def shown(self) -> list[tuple[str, bool]]:
        """The keys that have a meaning in the level, by name, each with whether it is held."""
        return [(self._names[code], code in self._held) for code in sorted(self._codes)]

    @property
    def _codes(self) -> set[int]:
        return {*self._keys, *self._asked}

    @property
    def _keys(self) -> dict[int, list[tuple[int, float]]]:
        """The parts that each key drives: of the level, and of what has joined it and is there."""
        world = self.playback.session.world
        joined, motors = world.joined, world.actuators.motors
        if self._joined is not joined:
            self._joined, self._all = joined, {}
            for level, first in [(self.playback.level, 0), *((each.level, each.first_part) for each in joined)]:
                for key, parts in driving_keys(level).items():
                    self._names[code_of(key)] = key
                    self._all.setdefault(code_of(key), []).extend((first + part, value) for part, value in parts)
        gone = set(motors.part[~world.particle_active[motors.hub]].tolist())
        there = {key: [each for each in parts if each[0] not in gone] for key, parts in self._all.items()}
        return {key: parts for key, parts in there.items() if parts}

    def press(self, key: int, modifiers: int) -> bool:
        """Drive the parts of a key, and answer rules that ask for it; whether the key does anything here."""
        if key not in self._codes or modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META | pygame.KMOD_ALT):
            return False
        if modifiers & pygame.KMOD_SHIFT and key in ARROWS.values():
            # With Shift they move the marked particle, as they do elsewhere.
            return False
        self.is_on_pad = False
        if key not in self._held:
            self._held[key] = self.playback.session.new_gesture()
            for part, value in self._keys.get(key, []):
                self.playback.submit(SetDrive(part, value), self._held[key])
            if key in self._asked:
                self.playback.submit(HoldKey(self._asked[key], True), self._held[key])
        return True

    def release(self, key: int) -> None:
        """Stop what the key drove, or let the key go on that still drives it another way."""
        gesture = self._held.pop(key, None)
        if gesture is None:
            return
        for part, _ in self._keys.get(key, []):
            still = [value for held in self._held for other, value in self._keys.get(held, []) if other == part]
            self.playback.submit(SetDrive(part, still[-1] if still else 0.0), gesture)
        if key in self._asked:
            self.playback.submit(HoldKey(self._asked[key], False), gesture)

    def press_control(self, control: str) -> None:
        """Press the key that a control of a gamepad is for."""
        controls = controls_of(name for name, _ in self.shown())
        key = next((code_of(name) for name, found in controls.items() if found == control), None)
        if key is not None and self.press(key, 0):
            self._controlled[control], self.is_on_pad = key, True

    def release_control(self, control: str) -> None:
        """Release the key that a control of a gamepad has pressed."""
        key = self._controlled.pop(control, None)
        if key is not None:
            self.release(key)


# Sizes in layout units.
CAP, _GAP, _INSET = 26.0, 5.0, 14.0
_TEXT_SIZE = 12.5
# Where the stick and the cross of a gamepad point: right and down.
_WAYS = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}
# What they take of the lower edge, from a level that has some: in a narrower world, notices lie above them.
KEYS_HEIGHT, ROOM_BESIDE = CAP + _INSET, 720.0


def draw_key_caps(
    surface: pygame.Surface,
    ui: Ui,
    keys: Sequence[tuple[str, bool]],
    viewport: tuple[int, int, int, int],
    on_pad: bool = False,
) -> None:
    """Draw the caps of keys, (name, whether it is held) each, at the lower right of a viewport [pixels].

    on_pad: show what presses them on a gamepad, in round caps.
    """
    left, top, width, height = viewport
    font, side = ui.font(_TEXT_SIZE, True), ui.px(CAP)
    x, y = left + width - ui.px(_INSET), top + height - ui.px(_INSET) - side
    if on_pad:
        held = dict(keys)
        keys = [(control, held[name]) for name, control in controls_of(held).items()]
    rounding = side // 2 if on_pad else ui.px(6)
    for name, is_held in reversed(keys):
        colour = BACKGROUND if is_held else TEXT
        picture = font.render(name.upper() if len(name) == 1 else name, True, colour)
        is_arrow = on_pad and name in _WAYS
        cap = pygame.Rect(0, y, side if is_arrow else max(side, picture.get_width() + ui.px(12)), side)
        cap.right = x
        pygame.draw.rect(surface, ACCENT if is_held else NOTICE, cap, border_radius=rounding)
        pygame.draw.rect(surface, ACCENT if is_held else LINE, cap, max(1, ui.px(1.2)), border_radius=rounding)
        if is_arrow:
            _draw_arrow(surface, cap, _WAYS[name], colour)
        else:
            surface.blit(picture, picture.get_rect(center=cap.center))
        x = cap.left - ui.px(_GAP)
    if keys and not on_pad:
        word = ui.font(_TEXT_SIZE).render("keys", True, MUTED)
        surface.blit(word, word.get_rect(midright=(x - ui.px(3), y + side // 2)))


def _draw_arrow(surface: pygame.Surface, cap: pygame.Rect, way: tuple[int, int], colour: Colour) -> None:
    """Draw a triangle in a cap; way: right and down, a unit."""
    middle, (x, y), size = pygame.Vector2(cap.center), way, cap.height * 0.22
    along, across = pygame.Vector2(x, y) * size, pygame.Vector2(-y, x) * size
    pygame.draw.polygon(surface, colour, (middle + along, middle - along + across, middle - along - across))
