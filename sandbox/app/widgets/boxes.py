"""What a form has beside lines to type into: a box to tick, one that takes a key, labels that are dragged, headings."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, FIELD, LINE, MUTED, TEXT, mixed
from sandbox.app.widgets.styles import BoxLook, box
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pixel, Pressable, Widget

TEXT_SIZE = 12.5
# Keys that a level can name, with their names.
KEYS = {ord(letter): letter for letter in "abcdefghijklmnopqrstuvwxyz0123456789"} | {
    pygame.K_LEFT: "left", pygame.K_RIGHT: "right", pygame.K_UP: "up", pygame.K_DOWN: "down",
}  # fmt: skip
NO_KEY = "none"
# A label is dragged so far for each step [layout units].
SCRUB_STEP = 5.0
# Sizes in layout units.
HEADING_SIZE, MARK = 11.0, 3.5


class CheckBox(Pressable):
    """A box to tick; its state may be MIXED."""

    def __init__(self, ui: Ui, rect: pygame.Rect, label: str, toggle: Callable[[bool], object], container: Any) -> None:
        super().__init__(ui, rect, container)
        self.label, self.state = label, False
        self.mixed = False
        self._toggle = toggle

    def show_state(self, state: bool, is_mixed: bool) -> None:
        """Show the box ticked, not ticked, or mixed."""
        if (state, is_mixed) != (self.state, self.mixed):
            self.state, self.mixed = state, is_mixed
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Box, tick or dash, and label."""
        ui = self.ui
        surface, side = pygame.Surface(size, pygame.SRCALPHA), ui.px(16)
        look = BoxLook(ACCENT, ACCENT, TEXT) if self.state else BoxLook(FIELD, LINE, TEXT)
        place = pygame.Rect(0, (size[1] - side) // 2, side, side)
        surface.blit(box(place.size, look, ui.px(4), 1), place)
        x, y, part = place.centerx, place.centery, side / 4
        if self.mixed:
            pygame.draw.line(surface, MUTED, (x - part, y), (x + part, y), ui.px(2))
        elif self.state:
            points = [(x - part, y), (x - part / 4, y + part * 0.8), (x + part * 1.1, y - part * 0.8)]
            pygame.draw.lines(surface, FIELD, False, points, ui.px(2))
        text = ui.font(12.5).render(self.label, True, TEXT)
        surface.blit(text, (side + ui.px(7), (size[1] - text.get_height()) // 2))
        return surface

    def press(self) -> None:
        """Tick the box, or untick it."""
        self._toggle(not self.state)


class KeyBox(Pressable):
    """Shows a key; after a click, Enter or Space it takes the next one that is pressed, Delete takes it away.

    choose(key) is called with it, or with None.
    """

    def __init__(self, ui: Ui, rect: pygame.Rect, choose: Callable[[str | None], object], container: Any) -> None:
        super().__init__(ui, rect, container)
        self.key: str | None = None
        self.listening = False
        self._choose = choose

    def show_key(self, key: str | None) -> None:
        """Show a key, or a word in its place."""
        if key != self.key:
            self.key = key
            self.repaint()

    def _listen(self, listening: bool) -> None:
        self.listening = listening
        self.repaint()

    def on_blur(self) -> None:
        """Wait for no key any more."""
        self._listen(False)

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Paint the key's cap, or a hint of what to do."""
        ui, look = self.ui, BoxLook(FIELD, ACCENT if self.listening else LINE, TEXT)
        surface = box(size, look, ui.px(6), 1).copy()
        has_key = self.key in KEYS.values() and not self.listening
        words = "letter, digit or arrow" if self.listening else self.key or NO_KEY
        words = words.upper() if len(words) == 1 else words
        picture = ui.font(TEXT_SIZE).render(words, True, TEXT if has_key else MUTED)
        at = picture.get_rect(midleft=(ui.px(9), size[1] // 2))
        if has_key:
            cap = pygame.Rect(ui.px(5), ui.px(4), max(at.width + ui.px(12), size[1] - ui.px(8)), size[1] - ui.px(8))
            pygame.draw.rect(surface, mixed(FIELD, TEXT, 0.16), cap, border_radius=ui.px(4))
            at = picture.get_rect(center=cap.center)
        surface.blit(picture, at)
        return surface

    def press(self) -> None:
        """Wait for the next key."""
        self.ui.focus_on(self)
        self._listen(True)

    def press_key(self, event: pygame.event.Event) -> bool:
        """Take the pressed key as the box's value."""
        if not self.listening:
            return super().press_key(event)
        if event.mod & (pygame.KMOD_CTRL | pygame.KMOD_META | pygame.KMOD_ALT):
            return False
        if event.key in KEYS:
            self._listen(False)
            self._choose(KEYS[event.key])
        elif event.key in (pygame.K_DELETE, pygame.K_BACKSPACE):
            self._listen(False)
            self._choose(None)
        return True


class Scrub(Widget):
    """The label of a number, which a drag to the right or left counts up or down.

    turn(steps) is called as it goes, done() at its end.
    """

    is_lit = True

    def __init__(
        self,
        ui: Ui,
        rect: pygame.Rect,
        text: str,
        turn: Callable[[int], object],
        done: Callable[[], object],
        container: Any,
    ) -> None:
        super().__init__(ui, rect, container)
        self._text, self._turn, self._done = text, turn, done
        self._from = 0

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The text; brighter under the mouse, with a dotted line that says it can be dragged."""
        ui, surface = self.ui, pygame.Surface(size, pygame.SRCALPHA)
        is_lit = self.hovered or self.ui.held is self
        text = wrapped(self._text, ui.font(TEXT_SIZE), size[0], 1)[0]
        picture = ui.font(TEXT_SIZE).render(text, True, TEXT if is_lit else MUTED)
        at = picture.get_rect(midleft=(0, size[1] // 2))
        surface.blit(picture, at)
        if is_lit:
            for x in range(0, at.width, ui.px(4)):
                surface.fill(ACCENT, (x, at.bottom, ui.px(2), max(1, ui.px(1))))
        return surface

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Begin a drag."""
        self._from = at[0]
        return True

    def on_drag(self, at: Pixel) -> None:
        """Change the value by a step for every so many pixels."""
        step = self.ui.px(SCRUB_STEP)
        steps = int((at[0] - self._from) / step)
        if steps:
            self._from += steps * step
            self._turn(steps)

    def on_release(self, at: Pixel) -> None:
        """End the drag."""
        self.repaint()
        self._done()


class FoldHeading(Pressable):
    """A heading; toggle() is called by a click or key."""

    is_lit = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, text: str, is_folded: bool, toggle: Callable[[], None], container: Any = None
    ) -> None:
        super().__init__(ui, rect, container)
        self.text, self.is_folded, self._toggle = text, is_folded, toggle

    def press(self) -> None:
        """Fold the section, or unfold it."""
        self._toggle()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """A mark that points down where it is open, to the right where it is folded, and the words."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        colour = TEXT if self.hovered else MUTED
        k, middle = self.ui.px(MARK), size[1] / 2
        x = self.ui.px(1) + k
        if self.is_folded:
            corners = [(x - k / 2, middle - k), (x + k / 2, middle), (x - k / 2, middle + k)]
        else:
            corners = [(x - k, middle - k / 2), (x, middle + k / 2), (x + k, middle - k / 2)]
        pygame.draw.lines(surface, colour, False, corners, max(1, self.ui.px(1.5)))
        words = self.ui.font(HEADING_SIZE, True).render(self.text.upper(), True, colour)
        surface.blit(words, words.get_rect(midleft=(x + k + self.ui.px(6), middle)))
        return surface


class ProgressBar(Widget):
    """A bar filled to a fraction, 0..1."""

    def __init__(self, ui: Ui, rect: pygame.Rect, container: Any) -> None:
        super().__init__(ui, rect, container)
        self.fraction = 0.0

    def show_fraction(self, fraction: float) -> None:
        """Show how much."""
        if fraction != self.fraction:
            self.fraction = fraction
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """A bar that fills from the left."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        round_by = size[1] // 2
        pygame.draw.rect(surface, LINE, surface.get_rect(), border_radius=round_by)
        filled = pygame.Rect(0, 0, max(size[1], round(size[0] * min(self.fraction, 1.0))), size[1])
        pygame.draw.rect(surface, ACCENT, filled, border_radius=round_by)
        return surface
