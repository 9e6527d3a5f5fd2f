"""Button: a button that shows words or a picture; and Choice: a row of them of which one is chosen."""

from collections.abc import Callable
from dataclasses import dataclass

import pygame

from sandbox.app.draw.colours import ACCENT, DISABLED, TEXT, Colour
from sandbox.app.widgets.icons import painted_icon
from sandbox.app.widgets.layout import WindowLayout
from sandbox.app.widgets.plate import box
from sandbox.app.widgets.styles import BUTTONS, State
from sandbox.app.widgets.texts import Written, shortened
from sandbox.app.widgets.widget import ENTER_KEYS, Pixel, Widget

# The name of an icon, or a picture with straight alpha.
Icon = str | pygame.Surface
# Middle of an icon with a text behind it [layout units].
ICON_MIDDLE = 16.0


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
    def font(self) -> pygame.font.Font:
        """The font of its text."""
        return self.ui.font(self._style.size)

    @property
    def is_selected(self) -> bool:
        """Whether it is shown as chosen, or as on."""
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
