"""Colours and sizes of everything that is drawn over the world; the widgets' are in assets/theme.json."""

from collections.abc import Iterable
from itertools import cycle

from sandbox.level.format.limits import DEFAULT_MATERIAL

Colour = tuple[int, int, int]

BACKGROUND: Colour = (17, 20, 26)
GRID: Colour = (24, 28, 36)
GRID_FINE: Colour = (20, 24, 30)
GRID_AXIS: Colour = (38, 44, 56)
SURFACE: Colour = (24, 28, 36)
LINE: Colour = (42, 49, 62)
TEXT: Colour = (226, 231, 239)
MUTED: Colour = (139, 149, 166)
DISABLED: Colour = (70, 78, 92)
ACCENT: Colour = (94, 208, 178)
WARNING: Colour = (255, 180, 84)
DANGER: Colour = (255, 107, 107)
PARTICLE: Colour = (226, 231, 239)
PINNED: Colour = (94, 208, 178)
WELD: Colour = (240, 214, 104)
DRIVE: Colour = (255, 118, 186)
TERRAIN: Colour = (150, 138, 118)
TERRAIN_FILL: Colour = (44, 42, 42)

# Springs by material while a level is edited; the material `default` is grey, then they repeat.
MATERIAL_COLOURS: tuple[Colour, ...] = (
    (122, 162, 247), (255, 170, 96), (122, 208, 130), (232, 131, 183), (240, 214, 104), (96, 205, 224), (190, 150, 255),
    (255, 128, 116), (176, 196, 116), (128, 178, 178),
)  # fmt: skip

# Springs of the material that needs no definition.
RELAXED: Colour = (150, 161, 180)


def material_colours(names: Iterable[str]) -> dict[str, Colour]:
    """Colours of the materials of a level, in its order, and of the one that needs no definition."""
    own = (name for name in names if name != DEFAULT_MATERIAL)
    return {DEFAULT_MATERIAL: RELAXED, **dict(zip(own, cycle(MATERIAL_COLOURS), strict=False))}


def packed(colour: Colour) -> int:
    """A colour as 0xRRGGBB."""
    return (colour[0] << 16) | (colour[1] << 8) | colour[2]


def mixed(first: Colour, second: Colour, share: float) -> Colour:
    """The colour that has `share` (0..1) of the second in it."""
    r, g, b = (round(a + (z - a) * share) for a, z in zip(first, second, strict=True))
    return r, g, b
