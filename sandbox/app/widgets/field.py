"""Field: a line to type into."""

from collections.abc import Callable
from typing import NamedTuple

import pygame

from sandbox.app.base.desktop import copied_text, copy_text
from sandbox.app.draw.colours import ACCENT, MUTED, TEXT
from sandbox.app.widgets.styles import BRIGHT, FIELD_LOOK, FOCUSED_FIELD, HOVERED_FIELD, SELECTION, box
from sandbox.app.widgets.widget import ENTER_KEYS, Pixel, Widget, WindowLayout

# What stands in the place of a number where there is none, and where things differ in it.
DASH, MIXED = "\u2013", "mixed"
# Sizes in layout units: of letters, of the room at both ends, of the corners.
TEXT_SIZE, PADDING, CORNER = 13.0, 9.0, 6.0
# The caret is seen and not seen for so long [s].
BLINK = 0.5
# Steps that Ctrl+Z takes back.
MOST_STEPS = 200
CTRL = pygame.KMOD_CTRL | pygame.KMOD_META


class _Line(NamedTuple):
    """A text that is typed, with the caret, and the other end of what is selected."""

    text: str
    caret: int
    mark: int


class Field(Widget):
    """A line to type into; commit gets the text and says whether it is taken, else the old text comes back.

    text: what is taken; typed: what stands in the line; hint: what it says while it is empty. enter: gets the text in
    place of commit, by Enter; turn: what a notch of the wheel over it does, and an arrow key in it, +1 or -1.
    """

    is_focusable = True
    is_lit = True

    def __init__(
        self, ui: WindowLayout, rect: pygame.Rect, text: str, commit: Callable[[str], bool],
        parent: Widget | None = None, limit: int = 200, hint: str = "",
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, parent)
        self.commit, self.text, self.limit, self.hint = commit, text, limit, hint
        self.enter: Callable[[str], object] | None = None
        self.step_value: Callable[[int], object] | None = None
        self._line = _Line(text, 0, 0)
        self._before: list[_Line] = []
        self._after: list[_Line] = []
        self._joins = False
        # What an input method has not settled yet.
        self.composed = ""
        self._scrolled = 0
        self._age = 0.0
        # A click has just begun to edit it: on a number, it selects all of it.
        self._is_begun = False

    # What it holds.

    @property
    def typed(self) -> str:
        """The typed text."""
        return self._line.text

    @typed.setter
    def typed(self, text: str) -> None:
        self._show(_Line(text, len(text), len(text)))
        self._before, self._after = [], []

    @property
    def selected(self) -> tuple[int, int]:
        """First and last place of the selected letters; both are the caret's where none are selected."""
        low, high = sorted((self._line.caret, self._line.mark))
        return low, high

    def select(self, mark: int, caret: int) -> None:
        """Select the letters between two places, the caret at the second."""
        self._show(_Line(self.typed, caret, mark))

    @property
    def is_number(self) -> bool:
        """Whether the field holds a number, or a word in the place of one."""
        try:
            float(self.text)
        except ValueError:
            return self.text in (DASH, MIXED)
        return True

    def show(self, text: str) -> None:
        """Show a value, unless the person is typing one."""
        if text != self.text and not self.focused:
            self.text = self.typed = text

    def finish(self) -> None:
        """Take the typed text, or bring the old one back."""
        if self.typed == self.text:
            return
        before, self.text = self.text, self.typed
        if not self.commit(self.text):
            self.text = self.typed = before

    def step(self, by: int) -> bool:
        """Take what was typed, and change the value by a step; whether it has steps."""
        if self.step_value is None:
            return False
        self.finish()
        self.step_value(by)
        return True

    def revert(self) -> None:
        """Bring the old text back."""
        self.typed = self.text

    def _show(self, line: _Line) -> None:
        self._line, self._age, self._joins = line, 0.0, False
        self.repaint()

    def _change(self, line: _Line, joins: bool = False) -> None:
        """Change the text; joins: one letter after another is taken back as one."""
        if not (joins and self._joins):
            self._before = [*self._before[-MOST_STEPS:], self._line]
        self._after = []
        self._show(line)
        self._joins = joins

    def insert(self, text: str) -> None:
        """Put a text in the place of the selection."""
        self.composed = ""
        low, high = self.selected
        # Ends of lines, tabs and the spaces of other scripts part words too.
        kept = (letter for letter in text if letter.isspace() or letter.isprintable())
        text = "".join(" " if letter.isspace() else letter for letter in kept)
        text = text[: max(self.limit - len(self.typed) + high - low, 0)]
        if text or low != high:
            end = low + len(text)
            self._change(_Line(self.typed[:low] + text + self.typed[high:], end, end), joins=True)

    def compose(self, text: str) -> None:
        """Show the unfinished text of an input method."""
        self.composed = text
        self.repaint()

    # The keyboard.

    def on_focus(self) -> None:
        """Begin to type, with all of the text selected."""
        self.select(0, len(self.typed))
        ratio = self.ui.pixel_ratio
        corner, size = (tuple(round(at / per) for at, per in zip(pair, ratio, strict=True))
                        for pair in (self.rect.topleft, self.rect.size))  # fmt: skip
        # Where an input method shows what it offers.
        pygame.key.set_text_input_rect(pygame.Rect(corner, size))

    def on_blur(self) -> None:
        """Take the typed text."""
        self.composed, self._is_begun = "", False
        self._before, self._after = [], []
        self.select(0, 0)
        self.finish()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Move the caret, delete, select, copy, undo, take; letters come as texts."""
        with_ctrl, with_shift = bool(event.mod & CTRL), bool(event.mod & pygame.KMOD_SHIFT)
        if self.composed and not with_ctrl:
            # The key is the input method's.
            return True
        if event.key in ENTER_KEYS:
            self._enter()
        elif event.key in (pygame.K_UP, pygame.K_DOWN):
            return self.step(1 if event.key == pygame.K_UP else -1)
        elif event.key in (pygame.K_BACKSPACE, pygame.K_DELETE):
            self._delete(-1 if event.key == pygame.K_BACKSPACE else 1, with_ctrl)
        elif (goal := self._goal(event.key, with_ctrl, with_shift)) is not None:
            self.select(self._line.mark if with_shift else goal, goal)
        elif with_ctrl:
            return self._edit(event.key, with_shift)
        else:
            return False
        return True

    def _enter(self) -> None:
        if self.enter is not None:
            self.enter(self.typed)
            return
        self.ui.blur()
        if self.is_there:
            # Tab goes on from here.
            self.ui.origin = self

    def _goal(self, key: int, with_ctrl: bool, with_shift: bool) -> int | None:
        """Where a key moves the caret."""
        here, (low, high) = self._line.caret, self.selected
        if key == pygame.K_HOME:
            return 0
        if key == pygame.K_END:
            return len(self.typed)
        if key not in (pygame.K_LEFT, pygame.K_RIGHT):
            return None
        way = -1 if key == pygame.K_LEFT else 1
        if with_ctrl:
            return self._word_end(here, way)
        if low != high and not with_shift:
            return low if way < 0 else high
        return min(max(here + way, 0), len(self.typed))

    def _word_end(self, at: int, way: int) -> int:
        """Where a word ends that begins at a place or after it, backwards or forwards."""
        text, end = self.typed, 0 if way < 0 else len(self.typed)
        for is_word in (False, True):
            while at != end and text[at - (way < 0)].isalnum() == is_word:
                at += way
        return at

    def _delete(self, way: int, word: bool) -> None:
        low, high = self.selected
        if low == high:
            other = self._word_end(low, way) if word else min(max(low + way, 0), len(self.typed))
            low, high = sorted((low, other))
        if low != high:
            self._change(_Line(self.typed[:low] + self.typed[high:], low, low))

    def _edit(self, key: int, with_shift: bool) -> bool:
        """Do what a key with Ctrl means for the text; whether it means anything."""
        low, high = self.selected
        if key == pygame.K_a:
            self.select(0, len(self.typed))
        elif key in (pygame.K_c, pygame.K_x):
            if low != high:
                copy_text(self.typed[low:high])
            if key == pygame.K_x:
                self._delete(0, False)
        elif key == pygame.K_v:
            self._joins = False
            self.insert(" ".join(copied_text().strip("\r\n").splitlines()))
            self._joins = False
        elif key == pygame.K_y or (key == pygame.K_z and with_shift):
            self._take_back(self._after, self._before)
        elif key == pygame.K_z:
            self._take_back(self._before, self._after)
        else:
            return False
        return True

    def _take_back(self, lines: list[_Line], others: list[_Line]) -> None:
        if lines:
            others.append(self._line)
            self._show(lines.pop())

    # The mouse.

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Put the caret under the mouse; twice selects a word, three times all."""
        if not self.focused:
            self.ui.focus_on(self, by_hand=True)
            self._is_begun = True
        here = self._place_at(at[0])
        if clicks == 1:
            self.select(here, here)
        elif clicks == 2:
            self._is_begun = False
            self.select(*self._word_around(here))
        else:
            self.select(0, len(self.typed))
        return True

    def on_drag(self, at: Pixel) -> None:
        """Select from the caret to the place under the mouse."""
        if self._place_at(at[0]) != self._line.caret:
            self.select(self._line.mark, self._place_at(at[0]))

    def on_release(self, at: Pixel) -> None:
        """After the click that began it, what is typed replaces a number."""
        if self._is_begun and self.is_number and self._line.caret == self._line.mark:
            self.select(0, len(self.typed))
        self._is_begun = False

    def on_wheel(self, notches: float) -> bool:
        """Step the value."""
        return self.step(1 if notches > 0.0 else -1)

    def _word_around(self, at: int) -> tuple[int, int]:
        text = self.typed
        if not text:
            return 0, 0
        is_word = text[min(at, len(text) - 1)].isalnum()
        low = high = min(at, len(text) - 1)
        while low > 0 and text[low - 1].isalnum() == is_word:
            low -= 1
        while high < len(text) and text[high].isalnum() == is_word:
            high += 1
        return low, high

    # Where letters are, and how they look.

    @property
    def font(self) -> pygame.font.Font:
        """The font of the field's text."""
        return self.ui.font(TEXT_SIZE)

    def _x_of(self, at: int) -> int:
        """How far right of its first letter a place in the text is [pixels]."""
        return self.font.size(self.typed[:at])[0]

    def _place_at(self, x: int) -> int:
        """The place between letters that is nearest to a column of the window [pixels]."""
        target = x - self.rect.left - self.ui.px(PADDING) + self._scrolled
        return min(range(len(self.typed) + 1), key=lambda at: abs(self._x_of(at) - target))

    def pass_time(self, seconds: float) -> None:
        """Blink the caret."""
        before, self._age = self._age, self._age + seconds
        if before // BLINK != self._age // BLINK:
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The box, the text with what is selected and composed, and the caret; or the hint."""
        ui, focused = self.ui, self.focused
        look = FOCUSED_FIELD if focused else HOVERED_FIELD if self.hovered else FIELD_LOOK
        surface = box(size, look, ui.px(CORNER), max(ui.px(1), 1)).copy()
        inside = surface.get_rect().inflate(-2 * ui.px(PADDING), -2 * ui.px(4))
        if inside.width <= 0 or inside.height <= 0:
            return surface
        text = surface.subsurface(inside)
        if focused:
            self._paint_edited(text)
            return surface
        self._scrolled = 0
        words, colour = (self.typed, look.text) if self.typed else (self.hint, MUTED)
        picture = self.font.render(words, True, colour)
        text.blit(picture, (0, (inside.height - picture.height + 1) // 2))
        return surface

    def _paint_edited(self, surface: pygame.Surface) -> None:
        """Draw the text under edit, shifted so far that the caret is seen."""
        (wide, high), thick = surface.get_size(), max(self.ui.px(1), 1)
        caret, text = self._line.caret, self.typed
        shown = text[:caret] + self.composed + text[caret:]
        low, high_end = self.selected
        at = self._x_of(caret) + self.font.size(self.composed)[0]
        whole = self.font.size(shown)[0] + thick
        self._scrolled = min(max(self._scrolled, at + thick - wide), at, max(whole - wide, 0))
        picture = self.font.render(shown, True, TEXT)
        y = (high - picture.height + 1) // 2
        surface.blit(picture, (-self._scrolled, y))
        if low != high_end and not self.composed:
            left, right = (self._x_of(each) - self._scrolled for each in (low, high_end))
            surface.fill(tuple(SELECTION), (left, y, right - left, picture.height))
            bright = self.font.render(text, True, BRIGHT)
            surface.blit(bright, (left, y), (left + self._scrolled, 0, right - left, picture.height))
        if self.composed:
            left = self._x_of(caret) - self._scrolled
            line = y + picture.height - thick
            surface.fill(tuple(ACCENT), (left, line, self.font.size(self.composed)[0], thick))
        if self._age // BLINK % 2 == 0:
            surface.fill(tuple(ACCENT), (at - self._scrolled, y, thick, picture.height))


def typed_number(
    say: Callable[[str], object], text: str, what: str, low: float, high: float, unit: str = ""
) -> float | None:
    """A typed number in low..high, its unit behind it or not; or None, and what is wrong said in one line."""
    try:
        value = float(text.strip().removesuffix(unit).replace(",", "."))
    except ValueError:
        say(f"{what}: {text.strip() or 'nothing'!r} is not a number.")
        return None
    if not low <= value <= high:
        say(f"{what}: {value:g} is outside {low:g} to {high:g}. The old value stays.")
        return None
    return value
