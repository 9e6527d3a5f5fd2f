"""KeyRow: an action with its keys, which a press changes."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.base.shortcuts import Shortcut, combination_of
from sandbox.app.draw.colours import ACCENT, LINE, MUTED, SURFACE, TEXT, mixed
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pressable

TEXT_SIZE = 12.5


class KeyRow(Pressable):
    """An action and the caps of its keys; after a press it takes the next keys, Delete takes them away.

    take(keys) is called with the new ones.
    """

    is_lit = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, entry: Shortcut, take: Callable[[tuple[str, ...]], object], container: Any
    ) -> None:
        super().__init__(ui, rect, container)
        self.entry = entry
        self._take = take

    def press(self) -> None:
        """Wait for keys."""
        self.ui.focus_on(self)
        self._listen(True)

    def _listen(self, listening: bool) -> None:
        self.takes_all_keys = listening
        self.repaint()

    def on_blur(self) -> None:
        """Wait no longer."""
        self._listen(False)

    def press_key(self, event: pygame.event.Event) -> bool:
        """Take the keys that are pressed; Escape leaves them as they are."""
        if not self.takes_all_keys:
            return super().press_key(event)
        if event.key == pygame.K_ESCAPE and self.entry.keys != ("Escape",):
            self._listen(False)
        elif event.key in (pygame.K_DELETE, pygame.K_BACKSPACE) and not event.mod & pygame.KMOD_CTRL:
            self._listen(False)
            self._take(())
        else:
            keys = combination_of(event.key, event.mod)
            if keys is not None:
                self._listen(False)
                self._take((keys,))
        return True

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Label at the left, caps at the right."""
        ui, surface = self.ui, pygame.Surface(size, pygame.SRCALPHA)
        if self.hovered or self.takes_all_keys:
            pygame.draw.rect(surface, mixed(SURFACE, TEXT, 0.08), surface.get_rect(), border_radius=ui.px(6))
        font, bold = ui.font(TEXT_SIZE), ui.font(11.5, True)
        right = size[0] - ui.px(8)
        words = ("press the new keys",) if self.takes_all_keys else self.entry.keys or ("none",)
        is_key = bool(self.entry.keys) and not self.takes_all_keys
        for word in reversed(words):
            picture = bold.render(word, True, TEXT if is_key else ACCENT if self.takes_all_keys else MUTED)
            cap = picture.get_rect(midright=(right - ui.px(7), size[1] // 2)).inflate(ui.px(14), ui.px(4))
            if is_key:
                pygame.draw.rect(surface, mixed(SURFACE, TEXT, 0.14), cap, border_radius=ui.px(4))
                pygame.draw.rect(surface, LINE, cap, 1, border_radius=ui.px(4))
            surface.blit(picture, picture.get_rect(center=cap.center))
            right = cap.left - ui.px(6)
        label = wrapped(self.entry.label, font, max(right - ui.px(14), 1), 1)[0]
        picture = font.render(label, True, TEXT)
        surface.blit(picture, picture.get_rect(midleft=(ui.px(8), size[1] // 2)))
        return surface
