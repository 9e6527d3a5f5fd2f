"""Theme: the look of the widgets in assets/theme.json, at a scale, and their font."""

import io
import json
from importlib.resources import files
from typing import Any

import pygame
import pygame_gui
from pygame_gui.core import gui_font_pygame
from pygame_gui.core.ui_appearance_theme import UIAppearanceTheme

from sandbox.app.draw.colours import shown_theme
from sandbox.level.format.files import shipped_folder

# Theme entries that are pixels at scale 1.
_SCALED = {
    "size", "shape_corner_radius", "border_width", "text_horiz_alignment_padding", "open_button_width",
    "list_item_height", "rect_width",
}  # fmt: skip


class _Font(pygame.font.Font):
    # pygame raises errors for texts that it cannot show, and names in files that people open may be such texts.
    def render(self, text: Any, *arguments: Any, **named: Any) -> pygame.Surface:
        try:
            return super().render(_clean(text), *arguments, **named)
        except pygame.error:  # nothing but characters without a width
            return super().render("", *arguments, **named)

    def size(self, text: Any) -> tuple[int, int]:
        return super().size(_clean(text))

    def metrics(self, text: Any) -> list[Any]:
        return super().metrics(_clean(text))


def _clean(text: Any) -> Any:
    """A text without halves of surrogate pairs and null characters."""
    if not isinstance(text, str) or text.isprintable():
        return text
    return text.encode("utf-8", "replace").decode().replace("\0", "?")


# The library has no way to be told which fonts it makes.
gui_font_pygame.Font = _Font  # type: ignore[misc]
_FONTS: dict[tuple[int, bool], _Font] = {}


def plain_font(size: int, bold: bool) -> pygame.font.Font:
    """The widgets' font in a size of pixels, for what is painted."""
    if (size, bold) not in _FONTS:
        name = "NotoSans-Bold.ttf" if bold else "NotoSans-Regular.ttf"
        data = files("pygame_gui").joinpath("data", name).read_bytes()
        _FONTS[size, bold] = _Font(io.BytesIO(data), size)
    return _FONTS[size, bold]


def _read(name: str) -> dict[str, Any]:
    theme: dict[str, Any] = json.loads((shipped_folder("assets") / name).read_text(encoding="utf-8"))
    return theme


def scaled_theme(scale: float) -> dict[str, Any]:
    """The theme of assets/theme.json with its sizes in pixels; the light one has other colours beside."""
    theme = _read("theme.json")
    if shown_theme() == "light":
        for name, block in _read("theme-light.json").items():
            theme.setdefault(name, {}).setdefault("colours", {}).update(block["colours"])
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
