"""Theme: the look of the widgets in assets/theme.json, at a scale."""

import json
from typing import Any

import pygame_gui
from pygame_gui.core import gui_font_pygame
from pygame_gui.core.ui_appearance_theme import UIAppearanceTheme

from sandbox.app.widgets.fonts import FONT, SafeFont, font_file
from sandbox.level.format.shipped import shipped_folder

# Theme entries that are pixels at scale 1.
_SCALED = {
    "size", "shape_corner_radius", "border_width", "text_horiz_alignment_padding", "open_button_width",
    "list_item_height", "rect_width",
}  # fmt: skip


# The library has no way to be told which fonts it makes.
gui_font_pygame.Font = SafeFont  # type: ignore[assignment, misc]


def scaled_theme(scale: float) -> dict[str, Any]:
    """The theme of assets/theme.json with its sizes in pixels."""
    theme: dict[str, Any] = json.loads((shipped_folder("assets") / "theme.json").read_text(encoding="utf-8"))
    for block in theme.values():
        for name, entries in block.items():
            for key, value in entries.items():
                if name in ("font", "misc") and key in _SCALED:
                    entries[key] = str(max(int(value != "0"), round(int(value) * scale)))
                if key == "padding":
                    entries[key] = ",".join(str(round(int(part) * scale)) for part in value.split(","))
    return theme


class Manager(pygame_gui.UIManager):
    """The library's manager of widgets, with a theme that answers at once."""

    def create_new_theme(self, theme_path: Any = None) -> UIAppearanceTheme:
        """A theme that the manager looks widgets up in."""
        theme = _Theme(self.resource_loader, self._locale)
        theme.get_font_dictionary().add_font_path(FONT, str(font_file(False)), str(font_file(True)))
        if theme_path is not None:
            theme.load_theme(theme_path)
        return theme


class _Theme(UIAppearanceTheme):
    # The library keeps these lists under keys that take it 1 ms to join, of widgets that lie five deep: most of the
    # time that a page of the panel takes.
    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._combined: dict[tuple[tuple[str | None, ...] | None, ...], list[str]] = {}

    def build_all_combined_ids(self, *ids: Any) -> list[str]:
        key = tuple(None if each is None else tuple(each) for each in ids)
        if key not in self._combined:
            self._combined[key] = super().build_all_combined_ids(*ids)
        return self._combined[key]
