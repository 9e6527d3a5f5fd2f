"""Fonts for letters that ours lacks: the one that lies beside it, then those of the system."""

import functools
import unicodedata
from collections.abc import Iterator
from typing import Any, NamedTuple

import pygame

from sandbox.level.format.shipped import shipped_folder

_BROUGHT = {False: "NotoSans-Regular.ttf", True: "NotoSans-Bold.ttf"}
# Families of the systems that have most letters of their scripts, plain ones first; then whatever there is.
_PREFERRED = (
    "notosans", "dejavusans", "segoeui", "arial", "helvetica", "hiragino", "yugothic", "meiryo", "microsoft",
    "pingfang", "malgun", "applesdgothic", "nirmala", "leelawadee", "droidsans", "freesans", "sans", "gothic",
)  # fmt: skip
# Letters from here on are pictures, if they are symbols.
_PICTURES = 0x1F000
_NONE = "\uffff"
# Height of a line, in sizes of the font, to which pictures are scaled that a font has in one size alone.
_LINE = 1.3
_FACES_HELD = 32
# Scripts whose letters change with their neighbours, by the first word of their letters' names: codes of ISO 15924.
_SCRIPTS = {
    "ARABIC": "Arab", "HEBREW": "Hebr", "SYRIAC": "Syrc", "THAANA": "Thaa", "NKO": "Nkoo", "DEVANAGARI": "Deva",
    "BENGALI": "Beng", "GURMUKHI": "Guru", "GUJARATI": "Gujr", "ORIYA": "Orya", "TAMIL": "Taml", "TELUGU": "Telu",
    "KANNADA": "Knda", "MALAYALAM": "Mlym", "SINHALA": "Sinh", "THAI": "Thai", "LAO": "Laoo", "TIBETAN": "Tibt",
    "MYANMAR": "Mymr", "KHMER": "Khmr", "MONGOLIAN": "Mong",
}  # fmt: skip


class Face(NamedTuple):
    """A font and by how much what it draws is scaled."""

    font: pygame.font.Font
    share: float

    @property
    def ascent(self) -> int:
        """Height above the base line [pixels]."""
        return round(self.share * pygame.font.Font.get_ascent(self.font))

    def render(self, text: str, antialias: bool, colour: Any) -> pygame.Surface:
        """The picture of a text that the font has."""
        picture = pygame.font.Font.render(self.font, text, antialias, colour)
        if self.share == 1.0:
            return picture
        return pygame.transform.smoothscale(picture, self.size(text))

    def size(self, text: str) -> tuple[int, int]:
        """Width and height of such a text [pixels]."""
        width, height = pygame.font.Font.size(self.font, text)
        return round(self.share * width), round(self.share * height)

    def metrics(self, text: str) -> list[Any]:
        """Extents of each letter."""
        found = pygame.font.Font.metrics(self.font, text)
        if self.share == 1.0:
            return found
        return [each and tuple(round(self.share * part) for part in each) for each in found]


def face_with(letter: str, size: int, bold: bool, turned: bool) -> Face:
    """A font of a size [pixels] that has a letter; where none has, one that draws a box in its place.

    turned: it draws from right to left.
    """
    script = _SCRIPTS.get(unicodedata.name(letter, "").partition(" ")[0], "")
    return _face(_file_with(letter, bold), size, bold, turned, script)


@functools.lru_cache(_FACES_HELD)
def _face(file: str, size: int, bold: bool, turned: bool, script: str) -> Face:
    font = _open(file, size, bold)
    if script:
        font.set_script(script)
    if turned:
        font.set_direction(pygame.DIRECTION_RTL)
    height = font.get_height()
    is_scaled = bool(file) and pygame.font.Font(file, 2 * size).get_height() == height
    return Face(font, _LINE * size / height if is_scaled else 1.0)


def _open(file: str, size: int, bold: bool) -> pygame.font.Font:
    return pygame.font.Font(file or str(shipped_folder("assets") / "fonts" / _BROUGHT[bold]), size)


@functools.lru_cache(4_096)
def _file_with(letter: str, bold: bool) -> str:
    # "": the font that lies beside ours. Of what no font has, its neighbours are not looked for.
    if _has(_open("", 16, bold), letter):
        return ""
    block = ord(letter) >> 7
    if (block, bold) in _MISSED:
        return ""
    for file in _files_for(letter, bold):
        try:
            has = _has(pygame.font.Font(file, 16), letter)
        except (OSError, pygame.error):
            continue
        if has:
            _FOUND.insert(0, file)
            return file
    _MISSED.add((block, bold))
    return ""


_FOUND: list[str] = []
_MISSED: set[tuple[int, bool]] = set()


def _has(font: pygame.font.Font, letter: str) -> bool:
    return font.metrics(letter) != font.metrics(_NONE)


def _files_for(letter: str, bold: bool) -> Iterator[str]:
    # Those that had other letters first, but for pictures.
    pictured = ord(letter) >= _PICTURES and unicodedata.category(letter) == "So"
    if not pictured:
        yield from dict.fromkeys(_FOUND)
    for name in sorted(pygame.font.get_fonts(), key=lambda name: (("emoji" in name) != pictured, _rank(name), name)):
        file = pygame.font.match_font(name, bold)
        if file:
            yield str(file)


def _rank(name: str) -> int:
    return next((k for k, family in enumerate(_PREFERRED) if name.startswith(family)), len(_PREFERRED))
