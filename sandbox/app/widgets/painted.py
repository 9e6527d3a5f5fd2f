"""Painted: widgets that paint themselves, for what pygame_gui has not."""

from typing import Any, ClassVar

import pygame
from pygame_gui.core import UIElement

from sandbox.app.draw.colours import MUTED, Colour
from sandbox.app.widgets.layout import WindowLayout

ENTER_KEYS = (pygame.K_RETURN, pygame.K_KP_ENTER)


class Painted(UIElement):
    """A widget that paints itself; subclasses give `paint`, and what mouse and keys do.

    takes_all_keys: whether Tab and Escape too go to `press_key` while it is focused.
    """

    takes_all_keys = False

    def __init__(self, ui: WindowLayout, rect: pygame.Rect, container: Any = None) -> None:
        super().__init__(
            rect, ui.manager, container or ui.root, starting_height=1, layer_thickness=1, element_id=["painted"]
        )
        self.ui = ui

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The picture of the widget as it is now, with straight alpha."""
        raise NotImplementedError

    def repaint(self) -> None:
        """Show the widget as it is now; where there is no room for it, nothing."""
        width, height = self.rect.size
        self._set_image(self.paint((max(width, 0), max(height, 0))).premul_alpha())

    def press_key(self, event: pygame.event.Event) -> bool:
        """React to a key while focused; True where the key is used."""
        return False

    def turn(self, notches: float) -> bool:
        """React to the wheel after a click on the widget; True where it is used."""
        return False

    def is_press(self, event: pygame.event.Event) -> bool:
        """Whether an event is a press of the left button on the widget."""
        if event.type != pygame.MOUSEBUTTONDOWN or event.button != 1:
            return False
        return bool(self.hover_point(*self.ui.manager.calculate_scaled_mouse_position(event.pos)))


class Pressable(Painted):
    """A painted widget that a click presses, and while it is focused a key."""

    press_keys: ClassVar[tuple[int, ...]] = (*ENTER_KEYS, pygame.K_SPACE)

    def press(self) -> None:
        """What a press does."""
        raise NotImplementedError

    def process_event(self, event: pygame.event.Event) -> bool:
        """Press on a click."""
        if not self.is_press(event):
            return False
        self.press()
        return True

    def press_key(self, event: pygame.event.Event) -> bool:
        """Press by a key."""
        if event.key not in self.press_keys:
            return False
        self.press()
        return True


class Draggable(Painted):
    """A painted widget on which the mouse drags something."""

    dragging = False

    def can_drag(self) -> bool:
        """Whether the mouse may take it."""
        return True

    def follow(self, pos: tuple[int, int]) -> None:
        """The mouse drags to a place in the window."""
        raise NotImplementedError

    def end_drag(self) -> None:
        """The mouse has let go."""
        raise NotImplementedError

    def process_event(self, event: pygame.event.Event) -> bool:
        """Follow the mouse."""
        if self.can_drag() and self.is_press(event):
            self.dragging = True
            self.follow(event.pos)
            return True
        if event.type == pygame.MOUSEMOTION and self.dragging:
            self.follow(event.pos)
            return True
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self.dragging:
            self.dragging = False
            self.end_drag()
            return True
        return False


class Lit(Painted):
    """A painted widget that looks otherwise while it is `hovered`, under the mouse."""

    def on_hovered(self) -> None:
        """Show that it can be used."""
        self.repaint()

    def on_unhovered(self) -> None:
        """Back to how it was."""
        self.repaint()


def wrapped(text: str, font: pygame.font.Font, widest: int, most_lines: int) -> list[str]:
    """The words of a text in lines no wider than `widest` [pixels]; what does not fit ends in an ellipsis."""
    lines: list[str] = []
    for word in text.split():
        if lines and font.size(f"{lines[-1]} {word}")[0] <= widest:
            lines[-1] += f" {word}"
        elif len(lines) == most_lines:
            while lines[-1] and font.size(f"{lines[-1]}…")[0] > widest:
                lines[-1] = lines[-1][:-1]
            lines[-1] += "…"
            break
        else:
            lines.append(word)
    return lines or [""]


def line_height(font: pygame.font.Font) -> int:
    """From one line of a text that wraps to the next [pixels]."""
    return round(font.get_linesize() * 0.95)


def text_height(text: str, font: pygame.font.Font, widest: int) -> int:
    """How high a text is [pixels] whose lines are no wider than `widest`."""
    return sum(len(wrapped(each, font, widest, len(each) + 1)) for each in text.split("\n")) * line_height(font)


class TextBlock(Painted):
    """Text that wraps; colour and size in layout units."""

    def __init__(
        self,
        ui: WindowLayout,
        rect: pygame.Rect,
        text: str,
        container: Any = None,
        size: float = 11.0,
        colour: Colour = MUTED,
        *,
        is_bold: bool = False,
    ) -> None:
        super().__init__(ui, rect, container)
        self.text, self.text_size, self.colour, self.is_bold = text, size, colour, is_bold
        self.repaint()

    def show_text(self, text: str) -> None:
        """Show another text."""
        if text != self.text:
            self.text = text
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """As many lines as fit."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        font = self.ui.font(self.text_size, self.is_bold)
        height = line_height(font)
        y = 0
        for paragraph in self.text.split("\n"):
            if y and y + height > size[1]:
                break
            for line in wrapped(paragraph, font, size[0], max(1, (size[1] - y) // height)):
                surface.blit(font.render(line, True, self.colour), (0, y))
                y += height
        return surface
