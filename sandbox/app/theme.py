"""Theme: the look of the widgets in assets/theme.json, at a scale, and their font."""

import io
import json
from importlib.resources import files
from typing import Any

import pygame

from sandbox.level.files import shipped_folder

# Theme entries that are pixels at scale 1.
_SCALED = {
    "size", "shape_corner_radius", "border_width", "text_horiz_alignment_padding", "open_button_width",
    "list_item_height", "rect_width",
}  # fmt: skip
_FONTS: dict[tuple[int, bool], pygame.font.Font] = {}


def plain_font(size: int, bold: bool) -> pygame.font.Font:
    """The widgets' font in a size of pixels, for what is painted."""
    if (size, bold) not in _FONTS:
        name = "NotoSans-Bold.ttf" if bold else "NotoSans-Regular.ttf"
        data = files("pygame_gui").joinpath("data", name).read_bytes()
        _FONTS[size, bold] = pygame.font.Font(io.BytesIO(data), size)
    return _FONTS[size, bold]


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
