"""Terrain as it is drawn plainly: solid polygons are filled, every edge is a line."""

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.colours import TERRAIN_FILL, Colour
from sandbox.app.draw.lines import FARTHEST

# Width of an edge of terrain [pixels at scale 1].
EDGE_WIDTH = 2.4


def fill_solid(surface: pygame.Surface, corners: NDArray[np.float64], colour: Colour = TERRAIN_FILL) -> None:
    """Fill a solid shape, by its corners [pixels] (n, 2)."""
    # pygame turns coordinates into 32 bit integers.
    pygame.draw.polygon(surface, colour, np.clip(corners, -FARTHEST, FARTHEST).tolist())
