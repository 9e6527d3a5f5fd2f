"""Colours of all that is drawn over the world, in the theme that is shown; those of widgets: `widgets/styles.py`."""

from collections.abc import Sequence
from typing import Literal, overload

ThemeName = Literal["dark", "light"]
THEME_NAMES: tuple[ThemeName, ...] = ("dark", "light")
# Red, green and blue, 0..255.
Colour = Sequence[int]


class Tone(Sequence[int]):
    """A colour that is another one in each theme: whatever is drawn with it next has that of the theme shown then."""

    def __init__(self, dark: Colour, light: Colour) -> None:
        self._colours: dict[ThemeName, Colour] = {"dark": dark, "light": light}

    def __len__(self) -> int:
        return len(self._colours[_shown[0]])

    @overload
    def __getitem__(self, index: int) -> int: ...
    @overload
    def __getitem__(self, index: slice) -> Colour: ...
    def __getitem__(self, index: int | slice) -> int | Colour:
        return self._colours[_shown[0]][index]


_shown: list[ThemeName] = ["dark"]


def tone(dark: str, light: str) -> Tone:
    """A colour as RRGGBB, or with an alpha as RRGGBBAA, in each theme."""
    return Tone(tuple(bytes.fromhex(dark)), tuple(bytes.fromhex(light)))


def show_theme(name: ThemeName) -> None:
    """Draw in the colours of a theme from now on; what is painted already stays until it is painted again."""
    _shown[0] = name


def shown_theme() -> ThemeName:
    """The theme that is shown."""
    return _shown[0]


BACKGROUND = Tone((17, 20, 26), (247, 243, 233))
GRID = Tone((42, 49, 63), (226, 218, 201))
GRID_FINE = Tone((28, 33, 43), (237, 230, 216))
GRID_AXIS = Tone((74, 85, 105), (196, 185, 164))
SURFACE = Tone((24, 28, 36), (255, 253, 248))
FIELD = Tone((18, 22, 28), (255, 255, 255))
MENU = Tone((29, 34, 43), (255, 253, 248))
CHOSEN = Tone((31, 74, 69), (205, 236, 226))
NOTICE = Tone((33, 39, 49), (255, 253, 248))
LINE = Tone((42, 49, 62), (221, 213, 198))
TEXT = Tone((226, 231, 239), (39, 48, 63))
MUTED = Tone((139, 149, 166), (94, 104, 119))
DISABLED = Tone((70, 78, 92), (178, 182, 188))
ACCENT = Tone((94, 208, 178), (14, 124, 105))
WARNING = Tone((255, 180, 84), (158, 88, 0))
DANGER = Tone((255, 107, 107), (196, 43, 43))
HOVERED = Tone((180, 190, 205), (96, 108, 126))
DECADE = Tone((72, 82, 100), (176, 168, 152))
PARTICLE = Tone((226, 231, 239), (58, 68, 84))
PINNED = Tone((94, 208, 178), (14, 124, 105))
WELD = Tone((240, 214, 104), (168, 128, 0))
DRIVE = Tone((255, 118, 186), (196, 32, 118))
# Zones, which are not solid.
ZONE = Tone((182, 148, 255), (106, 63, 192))
TERRAIN = Tone((150, 138, 118), (134, 106, 70))
TERRAIN_FILL = Tone((44, 42, 42), (226, 212, 188))

# Springs by material while a level is edited; the material `default` is grey, then they repeat.
MATERIAL_COLOURS: tuple[Colour, ...] = (
    Tone((122, 162, 247), (50, 96, 200)), Tone((255, 170, 96), (192, 98, 10)), Tone((122, 208, 130), (34, 132, 48)),
    Tone((232, 131, 183), (182, 48, 118)), Tone((240, 214, 104), (148, 116, 0)), Tone((96, 205, 224), (0, 124, 148)),
    Tone((190, 150, 255), (116, 70, 196)), Tone((255, 128, 116), (196, 58, 44)), Tone((176, 196, 116), (100, 120, 24)),
    Tone((128, 178, 178), (60, 116, 116)),
)  # fmt: skip

# Springs of the material that needs no definition.
RELAXED = Tone((150, 161, 180), (112, 122, 140))


def packed(colour: Colour) -> int:
    """A colour as 0xRRGGBB."""
    return (colour[0] << 16) | (colour[1] << 8) | colour[2]


def unpacked(colour: int) -> Colour:
    """A colour of 0xRRGGBB."""
    return colour >> 16, colour >> 8 & 255, colour & 255


def mixed(first: Colour, second: Colour, share: float) -> tuple[int, int, int]:
    """The colour that has `share` (0..1) of the second in it."""
    r, g, b = (round(a + (z - a) * share) for a, z in zip(first, second, strict=True))
    return r, g, b
