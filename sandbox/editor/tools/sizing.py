"""Sizes that a drawn body gets where its maker names none: as many parts as fit how large it is drawn."""

import math

# A link of a rope and the step between two rings of a web are about this long [m]. Shorter: finer, and slower to play.
LINK_LENGTH = 0.25
# A cell of a truss and a piece of a wheel's rim are about this long [m].
CELL_LENGTH = 0.5
# Fewest and most of each, whatever the size: fewer are too coarse to bend, more are asked for by number.
LINKS = (4, 60)
CELLS = (2, 40)
RINGS = (2, 12)
SPOKES = (8, 32)
RING_PARTS = (8, 60)
# Cells across the shorter side of a jelly, and about how many cells the whole of one has at most.
CELLS_ACROSS = 8
JELLY_CELLS = 1_000
# Digits of a spacing that is found so; a person reads it.
SPACING_DIGITS = 3


def _fitting(length: float, part: float, least_and_most: tuple[int, int]) -> int:
    least, most = least_and_most
    return min(max(round(length / part), least), most)


def links(length: float) -> int:
    """Links of a rope of that length [m]."""
    return _fitting(length, LINK_LENGTH, LINKS)


def truss_cells(length: float) -> int:
    """Cells of a bridge or girder of that length [m]."""
    return _fitting(length, CELL_LENGTH, CELLS)


def rings(radius: float) -> int:
    """Rings of a web of that radius [m]."""
    return _fitting(radius, LINK_LENGTH, RINGS)


def wheel_spokes(radius: float) -> int:
    """Spokes of a wheel of that radius [m]: an even number, as the box around an odd one is crooked."""
    return 2 * _fitting(2.0 * math.pi * radius, 2.0 * CELL_LENGTH, (SPOKES[0] // 2, SPOKES[1] // 2))


def ring_parts(radius: float) -> int:
    """Parts of a ring of that radius [m]."""
    return _fitting(2.0 * math.pi * radius, LINK_LENGTH, RING_PARTS)


def jelly_spacing(width: float, height: float, cells: int | None) -> float:
    """Spacing [m] of a jelly of that size, of `cells` across its shorter side; None: 8, fewer where it is long."""
    shorter = min(width, height)
    if cells is not None:
        return shorter / cells
    # A long thin jelly is coarser, but one cell thick at least.
    spacing = min(max(shorter / CELLS_ACROSS, math.sqrt(width * height / JELLY_CELLS)), shorter)
    return float(f"{spacing:.{SPACING_DIGITS}g}") if spacing > 0.0 else 0.0
