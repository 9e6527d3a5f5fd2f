"""Input: pygame's events to widgets first, then to the world; pygame's events end here."""

import math

import pygame

from sandbox.app.base.gamepads import EVENTS, Gamepads
from sandbox.app.base.shortcuts import action_of
from sandbox.app.contracts.application import Application
from sandbox.app.widgets.widget import ENTER_KEYS

# A press of Space shorter than this [s], without a drag, is the pause key; longer ones are a hand for panning.
TAP_SECONDS = 0.35
# The second press of a double click comes no later [s].
DOUBLE_SECONDS = 0.4
# A finger that rests for so long [s], within so many pixels, is the right button.
REST_SECONDS, REST_PIXELS = 0.5, 8
# With Ctrl these belong to the line of text: all, copy, paste, cut, undo, redo.
EDITING_KEYS = (pygame.K_a, pygame.K_c, pygame.K_v, pygame.K_x, pygame.K_z, pygame.K_y)
# Actions that go on while their key is held down.
REPEATED = (
    "step", "back", "zoom_in", "zoom_out", "undo", "redo",
    "next_thing", "previous_thing", "next_particle", "previous_particle", "next_item", "previous_item",
)  # fmt: skip
# Keys that press a button, take a line and close a page: held down, they do so once.
PRESSED_ONCE = (*ENTER_KEYS, pygame.K_SPACE, pygame.K_ESCAPE)
# Actions that lay the widgets out again, which keeps what is being typed; they work over a page, too.
LAYOUT = ("fullscreen", "larger", "smaller")
# Actions that open something else to play, or a page over it, which a gallery that nothing lies over has too.
OF_GALLERY = ("open", "open_file", "recent", "recordings", "new", "settings", "help", "tour")
HIDING = (pygame.WINDOWMINIMIZED, pygame.WINDOWHIDDEN)
SHOWING = (pygame.WINDOWRESTORED, pygame.WINDOWSHOWN, pygame.WINDOWEXPOSED, pygame.WINDOWMAXIMIZED)
ARROWS = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_UP: (0, 1), pygame.K_DOWN: (0, -1)}

Pixel = tuple[float, float]


def _works_while_typing(event: pygame.event.Event) -> bool:
    """Whether a key is no part of a text and no editing of it."""
    with_ctrl = bool(event.mod & (pygame.KMOD_CTRL | pygame.KMOD_META))
    return event.key in (pygame.K_F1, pygame.K_F11) or (with_ctrl and event.key not in EDITING_KEYS)


# Codes of keys whose letters are of other alphabets than the Latin one; and how many letters that has.
OTHER_LETTERS, LATIN_LETTERS = (0x250, 0x40000000), 26


def by_place(event: pygame.event.Event) -> pygame.event.Event:
    """A key event whose letter is that of the key's place, where the layout has no Latin letter there.

    So shortcuts and the keys of levels work under Cyrillic, Greek, Hebrew and other layouts; what is typed is not this.
    """
    if event.type not in (pygame.KEYDOWN, pygame.KEYUP) or not OTHER_LETTERS[0] <= event.key < OTHER_LETTERS[1]:
        return event
    place = event.dict.get("scancode", -1) - pygame.KSCAN_A
    if not 0 <= place < LATIN_LETTERS:
        return event
    return pygame.event.Event(event.type, {**event.dict, "key": pygame.K_a + place})


class Input:
    """Decides who gets an event."""

    def __init__(self, app: Application) -> None:
        self.app = app
        self.gamepads = Gamepads()
        self._panning = False
        self._pressed = False
        self._space_down: int | None = None
        self._space_used = False
        # What was seen when the keys were pressed that are down.
        self._held_keys: dict[int, tuple[object, ...]] = {}
        self._is_repeated = self._is_from_before = False
        self._last_press: tuple[int, Pixel] | None = None
        # When and where a finger came down that has not moved since.
        self._finger: tuple[int, Pixel] | None = None

    def process(self, events: list[pygame.event.Event]) -> None:
        """Hand out the events of a frame."""
        self._rest_finger()
        for event in map(by_place, events):
            if self._goes_on(event):
                continue
            if event.type == pygame.QUIT or event.type == pygame.WINDOWCLOSE:
                self.app.quit()
            elif event.type == pygame.DROPFILE:
                self.app.files.open_path(event.file)
            elif event.type in HIDING:
                self.app.display.hidden = True
            elif event.type in SHOWING:
                self.app.display.hidden = False
            elif event.type == pygame.AUDIODEVICEREMOVED:
                self.app.sounds.look_again()
            elif event.type in EVENTS:
                self._to_controls(self.gamepads.take(event))
            elif event.type == pygame.WINDOWFOCUSGAINED:
                self.app.documents.look_at_disk()
            elif self._follows_world(event) or not self.app.ui.process(event):
                self._to_world(event)

    def _goes_on(self, event: pygame.event.Event) -> bool:
        """Whether a key that is held down comes again for nothing: nor does it anything to what it opened."""
        if event.type == pygame.KEYDOWN:
            seen = self.app.screen, self.app.gallery, self.app.ui.top_sheet
            self._is_repeated = event.key in self._held_keys
            self._is_from_before = self._held_keys.setdefault(event.key, seen) != seen
            return self._is_from_before or (self._is_repeated and event.key in PRESSED_ONCE)
        if event.type == pygame.KEYUP:
            self._held_keys.pop(event.key, None)
            self._is_from_before = False
        # The letter of a key comes after it.
        return event.type == pygame.TEXTINPUT and self._is_from_before

    def pointer_over_world(self) -> Pixel | None:
        """Where the mouse is, while it is over the world and no widget."""
        pixel = self._pixel(pygame.mouse.get_pos())
        screen = self.app.screen
        if screen is None or self.app.ui.has_sheet or not pygame.mouse.get_focused() or not screen.contains(pixel):
            return None
        return pixel

    def _pixel(self, position: tuple[int, int]) -> Pixel:
        ratio = self.app.display.pixel_ratio
        return position[0] * ratio[0], position[1] * ratio[1]

    def _follows_world(self, event: pygame.event.Event) -> bool:
        """Whether a drag that began over the world goes on: then no widget gets in its way."""
        return event.type in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONUP) and (self._pressed or self._panning)

    def _to_world(self, event: pygame.event.Event) -> None:
        if event.type == pygame.KEYUP and self.app.screen is not None:
            self.app.screen.release_key(event.key)
        if event.type == pygame.KEYDOWN:
            self._key(event)
        elif event.type == pygame.KEYUP and event.key == pygame.K_SPACE:
            self._space_up()
        elif event.type == pygame.MOUSEWHEEL and self.app.gallery is not None:
            self.app.gallery.scroll(event.precise_y or event.y)
        elif event.type == pygame.MOUSEBUTTONUP:
            self._button_up(event)
        elif self.app.screen is None or self.app.ui.has_sheet:
            return
        elif event.type == pygame.MOUSEBUTTONDOWN:
            self._button_down(event)
        elif event.type == pygame.MOUSEMOTION:
            self._motion(event)
        elif event.type == pygame.MOUSEWHEEL:
            pixel = self.pointer_over_world()
            if pixel is not None:
                self.app.screen.turn_wheel(pixel, event.precise_y or event.y)

    def _to_controls(self, changes: list[tuple[str, bool]]) -> None:
        """Press and release keys of the played level by controls of gamepads."""
        play = self.app.play
        for control, is_down in changes:
            if play is None:
                continue
            if not is_down:
                play.keys.release_control(control)
            elif not self.app.ui.has_sheet and self.app.gallery is None:
                play.keys.press_control(control)

    def _key(self, event: pygame.event.Event) -> None:
        app = self.app
        if app.gallery is not None and app.gallery.press_key(event):
            return
        if app.ui.typing and not _works_while_typing(event):
            return
        if app.screen is not None and not app.ui.has_sheet and app.screen.press_key(event.key, event.mod):
            return
        if event.key in ARROWS and app.screen is not None and not app.ui.has_sheet:
            app.screen.press_arrow(*ARROWS[event.key], event.mod)
            return
        if event.key == pygame.K_SPACE and not app.ui.has_sheet:
            if self._space_down is None:
                self._space_down, self._space_used = pygame.time.get_ticks(), False
            return
        action = action_of(event.key, event.mod, app.mode)
        if self._is_repeated and action not in REPEATED:
            return
        if action is None or (app.ui.has_sheet and not self._works_over_pages(action)):
            return
        if app.ui.typing and action not in LAYOUT:
            # What is being typed counts: it is not saved without it.
            app.ui.blur()
        app.act(action)

    def _works_over_pages(self, action: str) -> bool:
        gallery = self.app.gallery
        in_gallery = gallery is not None and gallery.is_on_top
        return action in ("quit", *LAYOUT) or (in_gallery and action in OF_GALLERY)

    def _space_up(self) -> None:
        pressed, self._space_down = self._space_down, None
        if pressed is None or self._space_used or self.app.ui.has_sheet:
            return
        if pygame.time.get_ticks() - pressed <= 1000 * TAP_SECONDS:
            action = action_of(pygame.K_SPACE, 0, self.app.mode)
            if action is not None:
                self.app.act(action)

    def _button_down(self, event: pygame.event.Event) -> None:
        screen, pixel = self.app.screen, self._pixel(event.pos)
        if screen is None or not screen.contains(pixel):
            return
        self.app.ui.blur()
        if event.button == 2 or (event.button == 1 and self._space_down is not None):
            self._panning, self._space_used = True, True
        elif event.button == 1:
            self._pressed = True
            self._finger = (pygame.time.get_ticks(), pixel) if event.dict.get("touch") and screen.takes_rest else None
            screen.point("down", pixel, pygame.key.get_mods(), self._clicks(pixel))
        elif event.button == 3 and not self._pressed:
            screen.open_menu(pixel)

    def _rest_finger(self) -> None:
        """Open a menu by a finger that rests on the world, in place of what it presses."""
        screen = self.app.screen
        if self._finger is None or screen is None or not self._pressed:
            return
        began, pixel = self._finger
        if pygame.time.get_ticks() - began >= 1000 * REST_SECONDS:
            self._finger, self._pressed = None, False
            screen.point("up", pixel, pygame.key.get_mods())
            screen.open_menu(pixel)

    def _clicks(self, pixel: Pixel) -> int:
        """1 for a single press, 2 for the second of a double click."""
        before, now = self._last_press, pygame.time.get_ticks()
        is_second = before is not None and now - before[0] <= 1000 * DOUBLE_SECONDS and math.dist(before[1], pixel) <= 6
        self._last_press = None if is_second else (now, pixel)
        return 2 if is_second else 1

    def _motion(self, event: pygame.event.Event) -> None:
        screen, ratio = self.app.screen, self.app.display.pixel_ratio
        if screen is None:
            return
        if self._panning:
            screen.camera.pan(event.rel[0] * ratio[0], event.rel[1] * ratio[1])
        elif self._pressed:
            pixel = self._pixel(event.pos)
            if self._finger is not None and math.dist(self._finger[1], pixel) > REST_PIXELS:
                self._finger = None
            screen.point("move", pixel, pygame.key.get_mods())

    def _button_up(self, event: pygame.event.Event) -> None:
        screen = self.app.screen
        if screen is None:
            return
        if self._panning and event.button in (1, 2):
            self._panning = False
        elif self._pressed and event.button == 1:
            self._pressed, self._finger = False, None
            screen.point("up", self._pixel(event.pos), pygame.key.get_mods())
