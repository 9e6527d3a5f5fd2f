"""Pixels 0xAARRGGBB in rows, and the part of them that may be drawn on."""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import ArrayKind, Slots
from sandbox.physics.jit import scalar_kernel

# Pixels of a picture, of a row of one, and of several pictures of one size.
Pixels = Annotated[NDArray[np.uint32], ArrayKind(np.uint32, 2)]
PixelRow = Annotated[NDArray[np.uint32], ArrayKind(np.uint32)]
Sheets = Annotated[NDArray[np.uint32], ArrayKind(np.uint32, 3)]
Singles = Annotated[NDArray[np.float32], ArrayKind(np.float32)]
SlotTables = Annotated[NDArray[np.int64], ArrayKind(np.int64, 3)]

# Coordinates beyond this [pixels] are not drawn: no screen is that large.
FAR = 1e6


class Clip(NamedTuple):
    """Left, top, right, bottom (4,) of what may be drawn on, right and bottom exclusive."""

    edges: Slots


@scalar_kernel
def laid_over(under: int, over: int, share: int) -> int:
    """A pixel with share / 256 of another colour over it; red and blue in one multiplication."""
    keep = 256 - share
    both = (((over & 0xFF00FF) * share + (under & 0xFF00FF) * keep) >> 8) & 0xFF00FF
    green = (((over & 0x00FF00) * share + (under & 0x00FF00) * keep) >> 8) & 0x00FF00
    return 0xFF000000 | both | green
