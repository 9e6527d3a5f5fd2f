"""Themes: colours of the stage, the ground, shadows and strain, dark and light."""

from dataclasses import dataclass

from sandbox.app.draw.colours import Colour, mixed, shown_theme, unpacked


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
    r, g, b = mixed(unpacked(colour), (40, 0, 60), 0.46)
    return (r << 16) | (g << 8) | b


def dark_edge(colour: int) -> int:
    """The line around something of wood or stone: its own hue, nearly black."""
    r, g, b = mixed(unpacked(colour), (24, 10, 0), 0.66)
    return (r << 16) | (g << 8) | b


def rgb_of(colour: int) -> Colour:
    """A colour 0xRRGGBB as its channels."""
    return unpacked(colour)
