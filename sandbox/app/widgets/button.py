"""Button: a button that shows words or a picture."""

from typing import Any

import pygame
from pygame_gui.elements import UIButton


class Button(UIButton):
    """The library's button, which is given its picture at once: it would be built a second time for that."""

    def __init__(self, *arguments: Any, icon: pygame.Surface | None, **options: Any) -> None:
        self._icon = icon
        super().__init__(*arguments, **options)

    def show_icon(self, icon: pygame.Surface) -> None:
        """Show another picture, with straight alpha."""
        if icon is not self._icon:
            self._icon = icon
            self._set_any_images_from_theme()
            self.rebuild()

    def _set_any_images_from_theme(self) -> bool:
        # In place of those of the theme, which has none. The library lays them on by straight alpha.
        images = [] if self._icon is None else [self._icon]
        self.normal_images = self.hovered_images = self.selected_images = self.disabled_images = images
        positions = [(0.5, 0.5)] * len(images)
        self.normal_image_positions = self.hovered_image_positions = positions
        self.selected_image_positions = self.disabled_image_positions = positions
        return True

    def _set_inactive(self) -> None:
        # The library shows what was let go of as if it were never selected.
        if self.drawable_shape is not None:
            self.drawable_shape.set_active_state(self._get_appropriate_state_name())
