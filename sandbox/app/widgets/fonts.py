"""Fonts: the one that everything is written in, and others for letters that it does not have."""

import functools
import unicodedata
from itertools import groupby
from pathlib import Path
from typing import Any

import pygame

from sandbox.app.widgets.other_fonts import Face, face_with
from sandbox.app.widgets.text_runs import runs
from sandbox.level.format.shipped import shipped_folder

# The font in assets/fonts with its licence.
_FILES = {False: "AtkinsonHyperlegible-Regular.ttf", True: "AtkinsonHyperlegible-Bold.ttf"}
# Its sister for code, whose letters are all of one width.
_MONO = "AtkinsonHyperlegibleMono-Regular.ttf"
# All letters up to these are in the font, and in its sister; a character that no font has, as which they draw others.
_LATIN, _ASCII, _NONE = "\u017f", "\u007f", "\uffff"
# What is painted uses a dozen sizes at one scale of the window; each takes 0.1 to 0.3 MB with its letters.
FONTS_HELD = 24
# Marks of Unicode Standard Annex 9 that turn text, their own name's and any after it.
_TURNING = dict.fromkeys([0x061C, 0x200E, 0x200F, *range(0x202A, 0x202F), *range(0x2066, 0x206A)])
# Kinds of characters that are drawn with the letter before.
_JOINED = ("Mn", "Mc", "Me", "Cf")


def font_file(bold: bool) -> Path:
    """The file of the font."""
    return shipped_folder("assets") / "fonts" / _FILES[bold]


class SafeFont(pygame.font.Font):
    """A font that shows any text: by others where it lacks a letter, and never with an error."""

    def __init__(self, file: Any, size: int) -> None:
        super().__init__(file, size)
        self._size, self._is_bold = size, str(file).endswith(_FILES[True])
        self._last_known = _ASCII if str(file).endswith(_MONO) else _LATIN
        self._lacks: dict[str, bool] = {}

    # pygame raises errors for texts that it cannot show, and names in files that people open may be such texts.
    def render(self, text: Any, *arguments: Any, **named: Any) -> pygame.Surface:
        """The picture of a text."""
        text = _clean(text)
        try:
            if self._has_all(text):
                return super().render(text, *arguments, **named)
            pieces = self._pieces(text)
            if len(pieces) == 1 and pieces[0][1].share == 1.0:
                return pygame.font.Font.render(pieces[0][1].font, pieces[0][0], *arguments, **named)
            return _side_by_side(pieces, *arguments[:2])
        except pygame.error:  # nothing but characters without a width
            return super().render("", *arguments, **named)

    def size(self, text: Any) -> tuple[int, int]:
        """Width and height of a text [pixels]."""
        text = _clean(text)
        if self._has_all(text):
            return super().size(text)
        sizes = [face.size(piece) for piece, face in self._pieces(text)]
        return sum(width for width, _ in sizes), max(height for _, height in sizes)

    def metrics(self, text: Any) -> list[Any]:
        """Extents of each letter."""
        text = _clean(text)
        if self._has_all(text):
            return super().metrics(text)
        return [each for piece, face in self._pieces(text) for each in face.metrics(piece)]

    def _has_all(self, text: Any) -> bool:
        return not isinstance(text, str) or text.isascii() or not any(map(self._lacks_letter, text))

    def _lacks_letter(self, letter: str) -> bool:
        if letter <= self._last_known:
            return False
        if letter not in self._lacks:
            if len(self._lacks) > 5_000:
                self._lacks.clear()
            nothing = super().metrics(_NONE)
            self._lacks[letter] = super().metrics(letter) == nothing
        return self._lacks[letter]

    def _pieces(self, text: str) -> list[tuple[str, Face]]:
        # What is seen from left to right, each in a font that has its letters; marks go with the letter before.
        found: list[tuple[str, Face]] = []
        for run in runs(text):
            faces = self._faces(run.text, run.turned)
            pieces = [
                ("".join(run.text[k] for k in places), face)
                for face, places in groupby(range(len(run.text)), faces.__getitem__)
            ]
            found += reversed(pieces) if run.turned else pieces
        return found

    def _faces(self, text: str, turned: bool) -> list[Face]:
        own = Face(self, 1.0)
        faces: list[Face] = []
        for letter in text:
            last = faces[-1] if faces else None
            if last is not None and (unicodedata.category(letter) in _JOINED or (turned and letter == " ")):
                faces.append(last)
            elif not turned and not self._lacks_letter(letter):
                faces.append(own)
            else:
                faces.append(face_with(letter, self._size, self._is_bold, turned))
        return faces


def _side_by_side(
    pieces: list[tuple[str, Face]], antialias: bool = True, colour: Any = (255, 255, 255)
) -> pygame.Surface:
    pictures = [face.render(text, antialias, colour) for text, face in pieces]
    ascents = [face.ascent for _, face in pieces]
    base = max(ascents)
    height = max(base - up + picture.get_height() for up, picture in zip(ascents, pictures, strict=True))
    whole = pygame.Surface((sum(picture.get_width() for picture in pictures), height), pygame.SRCALPHA)
    x = 0
    for up, picture in zip(ascents, pictures, strict=True):
        whole.blit(picture, (x, base - up))
        x += picture.get_width()
    return whole


@functools.lru_cache(FONTS_HELD)
def plain_font(size: int, bold: bool) -> SafeFont:
    """The font in a size of pixels, for what is painted."""
    return SafeFont(str(font_file(bold)), size)


@functools.lru_cache(FONTS_HELD)
def code_font(size: int) -> SafeFont:
    """The font for code in a size of pixels."""
    return SafeFont(str(shipped_folder("assets") / "fonts" / _MONO), size)


def _clean(text: Any) -> Any:
    """A text without halves of surrogate pairs, null characters, and marks that turn the order of what is shown."""
    if not isinstance(text, str) or text.isprintable():
        return text
    text = text.translate(_TURNING)
    return text.encode("utf-8", "replace").decode().replace("\0", "?")
