"""Fonts: the one that everything is written in, and another for letters that it does not have."""

import functools
import io
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pygame

from sandbox.level.format.shipped import shipped_folder

# The font in assets/fonts with its licence, by the name that the theme of the widgets calls it.
FONT = "atkinson"
_FILES = {False: "AtkinsonHyperlegible-Regular.ttf", True: "AtkinsonHyperlegible-Bold.ttf"}
# What the library of the widgets brings along knows more alphabets.
_OTHERS = {False: "NotoSans-Regular.ttf", True: "NotoSans-Bold.ttf"}
# All letters below are in the font; a character that no font has, as which it draws others that it lacks.
_LATIN, _NONE = "\u017f", "\uffff"
# What is painted uses a dozen sizes at one scale of the window; each takes 0.1 to 0.3 MB with its letters.
FONTS_HELD = 24
# Marks of Unicode Standard Annex 9 that turn text, their own name's and any after it.
_TURNING = dict.fromkeys([0x061C, 0x200E, 0x200F, *range(0x202A, 0x202F), *range(0x2066, 0x206A)])


def font_file(bold: bool) -> Path:
    """The file of the font."""
    return shipped_folder("assets") / "fonts" / _FILES[bold]


class SafeFont(pygame.font.Font):
    """A font that shows any text: by another one where it lacks a letter, and never with an error."""

    def __init__(self, file: Any, size: int) -> None:
        super().__init__(file, size)
        self._size, self._is_bold = size, str(file).endswith(_FILES[True])
        self._other: pygame.font.Font | None = None
        self._lacks: dict[str, bool] = {}

    # pygame raises errors for texts that it cannot show, and names in files that people open may be such texts.
    def render(self, text: Any, *arguments: Any, **named: Any) -> pygame.Surface:
        """The picture of a text."""
        text = _clean(text)
        try:
            return pygame.font.Font.render(self._font_for(text), text, *arguments, **named)
        except pygame.error:  # nothing but characters without a width
            return super().render("", *arguments, **named)

    def size(self, text: Any) -> tuple[int, int]:
        """Width and height of a text [pixels]."""
        text = _clean(text)
        return pygame.font.Font.size(self._font_for(text), text)

    def metrics(self, text: Any) -> list[Any]:
        """Extents of each letter."""
        text = _clean(text)
        return pygame.font.Font.metrics(self._font_for(text), text)

    def _font_for(self, text: Any) -> pygame.font.Font:
        if not isinstance(text, str) or text.isascii() or not any(map(self._lacks_letter, text)):
            return self
        if self._other is None:
            self._other = _other_font(self._is_bold, self._size)
        return self._other

    def _lacks_letter(self, letter: str) -> bool:
        if letter <= _LATIN:
            return False
        if letter not in self._lacks:
            if len(self._lacks) > 5_000:
                self._lacks.clear()
            nothing = super().metrics(_NONE)
            self._lacks[letter] = super().metrics(letter) == nothing
        return self._lacks[letter]


def _other_font(bold: bool, size: int) -> pygame.font.Font:
    # Found without importing the library, which takes long.
    library = find_spec("pygame_gui")
    if library is None or library.origin is None:
        return pygame.font.Font(None, size)
    data = Path(library.origin).parent / "data" / _OTHERS[bold]
    return pygame.font.Font(io.BytesIO(data.read_bytes()), size)


@functools.lru_cache(FONTS_HELD)
def plain_font(size: int, bold: bool) -> SafeFont:
    """The font in a size of pixels, for what is painted."""
    return SafeFont(str(font_file(bold)), size)


def _clean(text: Any) -> Any:
    """A text without halves of surrogate pairs, null characters, and marks that turn the order of what is shown."""
    if not isinstance(text, str) or text.isprintable():
        return text
    text = text.translate(_TURNING)
    return text.encode("utf-8", "replace").decode().replace("\0", "?")
