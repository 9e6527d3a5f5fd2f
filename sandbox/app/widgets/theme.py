"""Theme: the look of the widgets in assets/theme.json, at a scale."""

import json
from typing import Any

import i18n
import pygame
import pygame_gui
from pygame_gui.core import gui_font_pygame
from pygame_gui.core.resource_loaders import IResourceLoader
from pygame_gui.core.ui_appearance_theme import UIAppearanceTheme
from pygame_gui.core.utility import set_default_manager

from sandbox.app.draw.colours import shown_theme
from sandbox.app.widgets.fonts import FONT, SafeFont, font_file
from sandbox.app.widgets.shapes import Shapes
from sandbox.level.format.shipped import shipped_folder

# Theme entries that are pixels at scale 1.
_SCALED = {
    "size", "shape_corner_radius", "border_width", "text_horiz_alignment_padding", "open_button_width",
    "list_item_height", "rect_width",
}  # fmt: skip


# The library has no way to be told which fonts it makes.
gui_font_pygame.Font = SafeFont  # type: ignore[assignment, misc]
# The theme of the last window, by scale and colours: it takes 30 ms to read, and the next window has mostly the same.
_THEMES: dict[tuple[float, str], UIAppearanceTheme] = {}
# A tip beside a panel is this far from it [pixels].
TIP_GAP = 8


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


class _AtOnce(IResourceLoader):
    """Has each font loaded where it is first asked for; the library's own loader starts five threads a window."""

    def add_resource(self, resource: Any) -> None:
        resource.load()

    def start(self) -> None:
        pass

    def update(self) -> tuple[bool, float]:
        return True, 1.0

    def started(self) -> bool:
        return True


class Manager(pygame_gui.UIManager):
    """The library's manager of widgets in a window of a size [pixels] and at a scale, whose theme answers at once."""

    def __init__(self, size: tuple[int, int], scale: float) -> None:
        self._scale = scale
        self._tip: Any = None
        super().__init__(size, enable_live_theme_updates=False, resource_loader=_AtOnce())
        # For widgets that are given none; the library would keep the first one, and all pictures of its window.
        set_default_manager(self)
        # Each manager adds the library's folder of translations, and every text with a full stop is looked up in all.
        i18n.load_path.clear()

    def create_tool_tip(self, *arguments: Any, **options: Any) -> Any:
        """The only tip; that of a widget in a panel at a side lies beside the panel, not over the next widget."""
        if self._tip is not None and self._tip.alive():
            self._tip.kill()
        self._tip = tip = super().create_tool_tip(*arguments, **options)
        owner = options.get("parent_element", arguments[3] if len(arguments) > 3 else None)
        holder: Any = owner
        while holder is not None and holder.ui_container not in (None, self.get_root_container()):
            holder = holder.ui_container
        if tip is not None and owner is not None and holder is not owner:
            self._lay_beside(tip, owner.rect, holder.rect)
        return tip

    def _lay_beside(self, tip: Any, owner: pygame.Rect, holder: pygame.Rect) -> None:
        """Move a tip to the side of a panel that takes less than half of the window's width, where there is room."""
        window = pygame.Rect((0, 0), self.window_resolution)
        place = tip.rect.copy()
        place.top = max(min(owner.top, window.bottom - place.height), 0)
        if holder.centerx > window.centerx:
            place.right = holder.left - TIP_GAP
        else:
            place.left = holder.right + TIP_GAP
        if 2 * holder.width < window.width and window.contains(place):
            tip.set_position(place.topleft)
            if tip.text_block is not None:
                tip.text_block.set_position(place.topleft)

    def create_new_theme(self, theme_path: Any = None) -> UIAppearanceTheme:
        """The theme that the manager looks widgets up in: that of the window before, if it is the same."""
        key = self._scale, shown_theme()
        theme = _THEMES.get(key)
        if theme is None:
            theme = _Theme(self.resource_loader, self._locale)
            theme.get_font_dictionary().add_font_path(FONT, str(font_file(False)), str(font_file(True)))
            theme.load_theme(scaled_theme(self._scale))
            _THEMES.clear()
            _THEMES[key] = theme
        return theme


class _Ids(list[Any]):
    """The ids of a widget and of what it lies in, as the library takes them."""

    def __str__(self) -> str:
        return ""


class _Theme(UIAppearanceTheme):
    # The library keeps these lists under keys of its own, in which it puts the text of one list between any two
    # letters of another: 4 MB for a widget that lies five deep, and 20 MB for all of a window. Here texts of lists are
    # empty, and so are its keys, under which nothing may be found.
    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._combined: dict[tuple[tuple[str | None, ...] | None, ...], list[str]] = {}
        self._shape_cache = Shapes()

    def build_all_combined_ids(self, *ids: Any) -> list[str]:
        key = tuple(None if each is None else tuple(each) for each in ids)
        if key not in self._combined:
            given = (None if each is None else _Ids(each) for each in ids)
            self._combined[key] = super().build_all_combined_ids(*given)
            self.unique_theming_ids.clear()
        return self._combined[key]
