"""Fonts: the one that everything is written in, and others, of the system too, for letters that it does not have.

Of Unicode Standard Annex 9, in a line that begins at the left: letters of right-to-left scripts with what lies between
them are one stretch, whose pieces are seen last to first; numbers within it stay as they are.
"""

import functools
import unicodedata
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import pygame

from sandbox.level.format.shipped import shipped_folder

# The font in assets/fonts with its licence: Atkinson Hyperlegible with zeros that are not slashed.
_FILES = {False: "SpringSandboxSans-Regular.ttf", True: "SpringSandboxSans-Bold.ttf"}
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
_RIGHT_TO_LEFT = ("R", "AL")
_NUMBERS = ("EN", "AN")
_BROUGHT = {False: "NotoSans-Regular.ttf", True: "NotoSans-Bold.ttf"}
# Families of the systems that have most letters of their scripts, plain ones first; then whatever there is.
_PREFERRED = (
    "notosans", "dejavusans", "segoeui", "arial", "helvetica", "hiragino", "yugothic", "meiryo", "microsoft",
    "pingfang", "malgun", "applesdgothic", "nirmala", "leelawadee", "droidsans", "freesans", "sans", "gothic",
)  # fmt: skip
# Letters from here on are pictures, if they are symbols.
_PICTURES = 0x1F000
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
_FOUND: list[str] = []
_MISSED: set[tuple[int, bool]] = set()


def font_file(bold: bool) -> Path:
    """The file of the font."""
    return shipped_folder("assets") / "fonts" / _FILES[bold]


class Face(NamedTuple):
    """A font, with the scale at which its letters are drawn."""

    font: pygame.font.Font
    scale: float

    @property
    def ascent(self) -> int:
        """Height above the base line [pixels]."""
        return round(self.scale * pygame.font.Font.get_ascent(self.font))

    def render(self, text: str, antialias: bool, colour: Any) -> pygame.Surface:
        """The picture of a text that the font has."""
        picture = pygame.font.Font.render(self.font, text, antialias, colour)
        if self.scale == 1.0:
            return picture
        return pygame.transform.smoothscale(picture, self.size(text))

    def size(self, text: str) -> tuple[int, int]:
        """Width and height of a text [pixels]."""
        width, height = pygame.font.Font.size(self.font, text)
        return round(self.scale * width), round(self.scale * height)

    def metrics(self, text: str) -> list[Any]:
        """Extents of each letter."""
        found = pygame.font.Font.metrics(self.font, text)
        if self.scale == 1.0:
            return found
        return [each and tuple(round(self.scale * part) for part in each) for each in found]


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
            if len(pieces) == 1 and pieces[0][1].scale == 1.0:
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


@functools.lru_cache(FONTS_HELD)
def plain_font(size: int, bold: bool) -> SafeFont:
    """The font in a size of pixels, for what is painted."""
    return SafeFont(str(font_file(bold)), size)


@functools.lru_cache(FONTS_HELD)
def code_font(size: int) -> SafeFont:
    """The font for code in a size of pixels."""
    return SafeFont(str(shipped_folder("assets") / "fonts" / _MONO), size)


class TextRun(NamedTuple):
    """A piece of a text; turned: its letters go from right to left."""

    text: str
    turned: bool


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


def _clean(text: Any) -> Any:
    """A text without halves of surrogate pairs, null characters, and marks that turn the order of what is shown."""
    if not isinstance(text, str) or text.isprintable():
        return text
    text = text.translate(_TURNING)
    return text.encode("utf-8", "replace").decode().replace("\0", "?")


def runs(text: str) -> list[TextRun]:
    """The runs of a text without line breaks."""
    kinds = [unicodedata.bidirectional(char) for char in text]
    turned = [k for k, kind in enumerate(kinds) if kind in _RIGHT_TO_LEFT]
    if not turned:
        return [TextRun(text, False)]
    result: list[TextRun] = []
    done = 0
    for first, last in _stretches(kinds, turned):
        if first > done:
            result.append(TextRun(text[done:first], False))
        pieces = groupby(range(first, last), lambda k: kinds[k] not in _NUMBERS)
        found = [TextRun("".join(text[k] for k in places), is_turned) for is_turned, places in pieces]
        result += reversed(found)
        done = last
    if done < len(text):
        result.append(TextRun(text[done:], False))
    return result


def _stretches(kinds: list[str], turned: list[int]) -> list[tuple[int, int]]:
    # From a right-to-left letter to the last before one that goes from left to right, with the marks upon that.
    found = [(turned[0], turned[0] + 1)]
    for k in turned[1:]:
        first, last = found[-1]
        if "L" in kinds[last:k]:
            found.append((k, k + 1))
        else:
            found[-1] = first, k + 1
    return [(first, _with_marks(kinds, last)) for first, last in found]


def _with_marks(kinds: list[str], last: int) -> int:
    while last < len(kinds) and kinds[last] == "NSM":
        last += 1
    return last


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
