"""Colours and sizes of everything that is drawn over the world; the widgets' are in assets/theme.json."""

from collections.abc import Iterable
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

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

# Springs by signed strain: compressed, at rest, stretched, torn at.
COMPRESSED: Colour = (77, 155, 255)
RELAXED: Colour = (150, 161, 180)
STRETCHED: Colour = (255, 170, 70)
OVERSTRETCHED: Colour = (255, 82, 82)
# The colour goes with the logarithm of the strain: from this strain on it shows, at FULL_STRAIN it is at its end.
# Larger: the load in stiff bodies stays grey.
SLIGHT_STRAIN = 0.004
FULL_STRAIN = 1.0

_STOPS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
_RAMP = np.array([(40, 110, 255), COMPRESSED, RELAXED, STRETCHED, OVERSTRETCHED], dtype=np.float64)


def strain_colours(strain: NDArray[np.float64]) -> NDArray[np.int64]:
    """Colours (m,) as 0xRRGGBB of signed strains (m,): blue = compressed, grey = at rest, warm = stretched."""
    finite = np.nan_to_num(strain, nan=0.0, posinf=1e9, neginf=-1e9)
    full = np.log1p(FULL_STRAIN / SLIGHT_STRAIN)
    place = np.sign(finite) * np.log1p(np.abs(finite) / SLIGHT_STRAIN) / full
    channels = [np.interp(place, _STOPS, _RAMP[:, k]).astype(np.int64) for k in range(3)]
    return (channels[0] << 16) | (channels[1] << 8) | channels[2]


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
