"""Buttons that show words or a picture, rows of which one is chosen, the icons on them, and the title in a bar."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, DISABLED, TEXT, Colour, tone
from sandbox.app.widgets.fonts import plain_font
from sandbox.app.widgets.styles import BUTTONS, State, box
from sandbox.app.widgets.texts import Written, line_height, shortened, wrapped
from sandbox.app.widgets.widget import ENTER_KEYS, Pixel, Widget, WindowLayout
from sandbox.level.format.shipped import shipped_folder
from sandbox.session.outcome import MOST_STARS

# The name of an icon, or a picture with straight alpha.
Icon = str | pygame.Surface
# Middle of an icon with a text behind it [layout units].
ICON_MIDDLE = 16.0
# Icons that are kept, in their sizes and colours; most have 2 kB.
MOST_ICONS = 500
# Stars that are won; from one star to the next, as a part of a star.
GOLD = tone("ffc94d", "e09a00")
STEP = 1.08
# Size of letters on one line, and on two [layout units].
LARGE, SMALL = 15.0, 12.0


class Button(Written):
    """A button in one of the styles; action() is called once a click on it ends, and by Enter and Space."""

    is_focusable = True
    is_lit = True

    def __init__(
        self, ui: WindowLayout, rect: pygame.Rect, text: str, action: Callable[[], object],
        parent: Widget | None = None, *, style: str = "", icon: Icon = "", icon_size: float = 18.0,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, parent)
        self.text, self.action = text, action
        self._style, self._icon, self._icon_size = BUTTONS[style], icon, icon_size
        self._tint: Colour | None = None
        self._is_selected = False

    @property
    def is_main(self) -> bool:
        """Whether it does what most people want on its page."""
        return self._style is BUTTONS["primary"]

    @property
    def font(self) -> pygame.font.Font:
        """The font of the button's text."""
        return self.ui.font(self._style.size)

    @property
    def is_selected(self) -> bool:
        """Whether the button is drawn as chosen, or as switched on."""
        return self._is_selected

    @is_selected.setter
    def is_selected(self, is_selected: bool) -> None:
        if is_selected != self._is_selected:
            self._is_selected = is_selected
            self.repaint()

    def show_icon(self, icon: Icon, tint: Colour | None = None) -> None:
        """Show another icon; tint: its colour, None = that of the button's state."""
        if (icon, tint) != (self._icon, self._tint):
            self._icon, self._tint = icon, tint
            self.repaint()

    @property
    def state(self) -> State:
        """The state that says how the button looks now."""
        if not self.is_enabled:
            return "disabled"
        if self.hovered and self.ui.held is self:
            return "active"
        return "selected" if self.is_selected else "hovered" if self.hovered else "normal"

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The box, with the icon or the text in its middle, or the icon and the text behind it."""
        ui, look = self.ui, self._style.looks[self.state]
        rim = max(ui.px(1), 1)
        surface = box(size, look, ui.px(self._style.radius), rim).copy()
        tint = self._tint or (DISABLED if not self.is_enabled else ACCENT if self.is_selected else TEXT)
        icon, left = self._icon, 0
        if isinstance(icon, str) and icon:
            icon = painted_icon(icon, ui.px(self._icon_size), tint)
        if isinstance(icon, pygame.Surface):
            middle = (ui.px(ICON_MIDDLE) if self.text else size[0] // 2, size[1] // 2)
            surface.blit(icon, icon.get_rect(center=middle))
            left = ui.px(2 * ICON_MIDDLE)
        if self.text:
            words = shortened(self.text, self.font, size[0] - 2 * rim - left)
            text = self.font.render(words, True, tint if left else look.text)
            surface.blit(text, (left or (size[0] - text.width) // 2, (size[1] - text.height) // 2))
        return surface

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Show the button pressed."""
        self.repaint()
        return True

    def on_release(self, at: Pixel) -> None:
        """Call action(), if the mouse is still on the button."""
        self.repaint()
        if self.seen.collidepoint(at):
            self.action()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Call action() by Enter or Space."""
        if event.key not in (*ENTER_KEYS, pygame.K_SPACE):
            return False
        self.action()
        return True


@dataclass
class Choice:
    """A row of buttons of which one is chosen."""

    buttons: dict[str, Button]
    chosen: str = ""

    def show(self, chosen: str) -> None:
        """Mark the chosen one."""
        self.chosen = chosen
        for value, button in self.buttons.items():
            button.is_selected = value == chosen


class BarTitle(Widget):
    """A name; lines: what is seen of it; what is not is in its tooltip."""

    def __init__(self, ui: WindowLayout, rect: pygame.Rect, container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self.text, self.lines = "", [""]
        self._size = LARGE

    def show_text(self, text: str) -> None:
        """Show a name."""
        if text == self.text:
            return
        self.text = text
        widest = self.rect.width
        self._size = LARGE if self.ui.font(LARGE, True).size(text)[0] <= widest else SMALL
        font = self.ui.font(self._size, True)
        self.lines = wrapped(text, font, widest, 1 if self._size == LARGE else 2)
        fits = max(font.size(line)[0] for line in self.lines) <= widest
        is_whole = fits and " ".join(self.lines) == " ".join(text.split())
        self.tip = "" if is_whole else text
        self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Paint the lines of the name, in the middle of the height."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        font = self.ui.font(self._size, True)
        high = line_height(font)
        y = (size[1] - high * len(self.lines)) // 2
        for line in self.lines:
            surface.blit(font.render(line, True, TEXT), (0, y))
            y += high
        return surface


def painted_icon(name: str, size: int, colour: Colour) -> pygame.Surface:
    """An icon of size [pixels] with straight alpha, by the name of its file; without a file, its first letter.

    Who asks for the same one again gets the same picture.
    """
    return _painted(name, size, tuple(colour))


@lru_cache(MOST_ICONS)
def _painted(name: str, size: int, colour: tuple[int, ...]) -> pygame.Surface:
    file = shipped_folder("assets") / "icons" / f"{name}.svg"
    flat = pygame.Surface((size, size), pygame.SRCALPHA)
    if not file.is_file():
        letter = plain_font(round(0.8 * size), True).render(name[:1].upper(), True, colour)
        flat.blit(letter, letter.get_rect(center=flat.get_rect().center))
        return flat
    # Of the file only its alpha counts.
    shape = pygame.image.load_sized_svg(file, (size, size))
    flat.fill((*colour, 0))
    alpha = pygame.surfarray.pixels_alpha(flat)
    alpha[:] = pygame.surfarray.array_alpha(shape)
    del alpha
    return flat


def painted_stars(won: int, size: int, grown: float = 1.0) -> pygame.Surface:
    """A row of stars of size [pixels] with straight alpha: those won in gold, the last of them so large (0..1)."""
    row = pygame.Surface((round(size * (1 + STEP * (MOST_STARS - 1))), size), pygame.SRCALPHA)
    for number in range(MOST_STARS):
        shape = painted_icon("star", size, GOLD if number < won else DISABLED)
        if number == won - 1 and grown != 1.0:
            shape = pygame.transform.smoothscale_by(shape, grown)
        row.blit(shape, shape.get_rect(center=(round(size * (0.5 + STEP * number)), size // 2)))
    return row
