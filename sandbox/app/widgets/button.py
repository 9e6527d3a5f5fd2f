"""Button: a button that shows words or a picture; and Choice: a row of them of which one is chosen."""

from collections.abc import Callable
from dataclasses import dataclass

import pygame

from sandbox.app.widgets.layout import WindowLayout
from sandbox.app.widgets.plate import box
from sandbox.app.widgets.styles import BUTTONS, State
from sandbox.app.widgets.texts import shortened
from sandbox.app.widgets.widget import ENTER_KEYS, Pixel, Widget


class Button(Widget):
    """A button in one of the styles; action() is called once a click on it ends, and by Enter and Space."""

    is_focusable = True
    is_lit = True

    def __init__(
        self, ui: WindowLayout, rect: pygame.Rect, text: str, action: Callable[[], object],
        parent: Widget | None = None, *, style: str = "", icon: pygame.Surface | None = None,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, parent)
        self.text, self.action = text, action
        self._style, self._icon = BUTTONS[style], icon
        self._is_selected = False

    @property
    def font(self) -> pygame.font.Font:
        """What it is written in."""
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

    def show_text(self, text: str) -> None:
        """Show another text."""
        if text != self.text:
            self.text = text
            self.repaint()

    def show_icon(self, icon: pygame.Surface) -> None:
        """Show another picture, with straight alpha."""
        if icon is not self._icon:
            self._icon = icon
            self.repaint()

    @property
    def state(self) -> State:
        """How it looks now."""
        if not self.is_enabled:
            return "disabled"
        if self.hovered and self.ui.held is self:
            return "active"
        return "selected" if self.is_selected else "hovered" if self.hovered else "normal"

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The box, and the picture or the text in its middle."""
        ui, look = self.ui, self._style.looks[self.state]
        rim = max(ui.px(1), 1)
        surface = box(size, look, ui.px(self._style.radius), rim).copy()
        if self._icon is not None:
            surface.blit(self._icon, self._icon.get_rect(center=surface.get_rect().center))
        if self.text:
            text = self.font.render(shortened(self.text, self.font, size[0] - 2 * rim), True, look.text)
            surface.blit(text, ((size[0] - text.width) // 2, (size[1] - text.height) // 2))
        return surface

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """BoxLook pressed."""
        self.repaint()
        return True

    def on_release(self, at: Pixel) -> None:
        """Act, if the mouse is still on it."""
        self.repaint()
        if self.seen.collidepoint(at):
            self.action()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Act by Enter and Space."""
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
