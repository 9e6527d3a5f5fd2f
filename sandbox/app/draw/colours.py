"""Colours: of the world in each theme, and of all that is drawn over it; those of widgets: `widgets/styles.py`."""

from collections.abc import Sequence
from dataclasses import dataclass
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
    return colour >> 16 & 255, colour >> 8 & 255, colour & 255


def mixed(first: Colour, second: Colour, weight: float) -> tuple[int, int, int]:
    """The colour that has `weight` (0..1) of the second in it."""
    r, g, b = (round(a + (z - a) * weight) for a, z in zip(first, second, strict=True))
    return r, g, b


@dataclass(frozen=True)
class Theme:
    """Colours of a theme; a pair is what lies above or near, and below or deep; strengths are 0..1."""

    name: str
    stage: tuple[Colour, Colour]
    lamp: Colour
    vignette: float
    shadow: Colour
    shadow_strength: float
    soil: tuple[Colour, Colour]
    turf: tuple[Colour, Colour]
    rock: tuple[Colour, Colour]
    metal: tuple[Colour, Colour]
    text: Colour
    accent: Colour
    card: Colour
    line: Colour
    tyre: Colour
    dust: Colour
    water: tuple[Colour, Colour]
    foam: Colour
    # Strain: squeezed, at rest, stretched.
    strain: tuple[Colour, Colour, Colour]
    # Overlays: contact points, forces of contacts, velocities, and springs past what is proven stable.
    contact: Colour
    force: Colour
    velocity: Colour
    past: Colour


def _pair(first: int, second: int) -> tuple[Colour, Colour]:
    return unpacked(first), unpacked(second)


DARK = Theme(
    "dark", stage=_pair(0x202A3E, 0x10141D), lamp=(34, 40, 52), vignette=0.42,
    shadow=unpacked(0x04060A), shadow_strength=0.50, soil=_pair(0x463C42, 0x2A262E), turf=_pair(0x6CC58B, 0x2F7A5C),
    rock=_pair(0x59627A, 0x2A2F3D), metal=_pair(0x7D8AA5, 0x39425A), text=unpacked(0xE8ECF4), accent=unpacked(0x5ED0B2),
    card=unpacked(0x1A202C), line=unpacked(0x2E384A), tyre=unpacked(0x4C5362), dust=unpacked(0xCDBFA6),
    water=_pair(0x3C9FD0, 0x163E74), foam=unpacked(0xCFF1FF),
    strain=(unpacked(0x4D8DFF), unpacked(0xC9CFDA), unpacked(0xFFB03A)),
    contact=unpacked(0xFF6AD5), force=unpacked(0xFFE45C), velocity=unpacked(0x6FF2E0), past=unpacked(0xFF4D8B),
)  # fmt: skip
LIGHT = Theme(
    "light", stage=_pair(0xCFE4F1, 0xFBF3E3), lamp=(14, 12, 6), vignette=0.14,
    shadow=unpacked(0x4A4030), shadow_strength=0.26, soil=_pair(0xB08459, 0xBF966A), turf=_pair(0x93CF63, 0x5C9C44),
    rock=_pair(0xA3A9B5, 0x7F8794), metal=_pair(0xAEB8C8, 0x78859A), text=unpacked(0x27303F), accent=unpacked(0x12907A),
    card=unpacked(0xFFFDF8), line=unpacked(0xDDD5C6), tyre=unpacked(0x42444C), dust=unpacked(0xE9DCC2),
    water=_pair(0x46B2E4, 0x1F6FB4), foam=unpacked(0xFFFFFF),
    strain=(unpacked(0x1446C0), unpacked(0x8A8F98), unpacked(0xD9730B)),
    contact=unpacked(0x9C1FB0), force=unpacked(0x7A4B00), velocity=unpacked(0x006E75), past=unpacked(0xC2004F),
)  # fmt: skip
THEMES = {theme.name: theme for theme in (DARK, LIGHT)}


def theme_now() -> Theme:
    """The theme that is shown, where a level asks for no other."""
    return THEMES[shown_theme()]


# Stuffs that look alike in both.
STEEL, BRASS, WOOD, STONE, BRICK = 0x96A3BA, 0xE2B04E, 0xC8935A, 0x9AA2B0, 0xC4624A
CLOTH, CLOTH_STRIPE, GLASS = 0xD8574F, 0xF3E6CD, 0xBFE3F5
PAINTS = {"bridge": 0xE2543E, "girder": 0xF6B83E, "mesh": 0x3C96C8}
INK, CHEEK, EYE = 0x2A1030, 0xFF5A86, 0xFFFFFF
SQUEEZED_FLUSH, STRETCHED_FLUSH = 0x4A3FD8, 0xFFF0B0
SANDS = (0xF2C879, 0xE3AE58, 0xF7DA9A, 0xD99A4A)
SPARK, SPARK_GLOW = 0xFFE9A8, 0xFF9A2E


def outline_of(colour: int) -> int:
    """The line around something of a colour: its own hue, darker."""
    return packed(mixed(unpacked(colour), (40, 0, 60), 0.46))


def dark_edge(colour: int) -> int:
    """The line around something of wood or stone: its own hue, nearly black."""
    return packed(mixed(unpacked(colour), (24, 10, 0), 0.66))
