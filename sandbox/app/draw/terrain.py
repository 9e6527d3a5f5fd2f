"""Terrain as it is drawn: solid polygons are filled, every edge is a line."""

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import TERRAIN, TERRAIN_FILL, Colour, packed
from sandbox.app.draw.lines import FARTHEST, Canvas
from sandbox.physics.terrain import Terrain

# Width of an edge of terrain [pixels at scale 1].
EDGE_WIDTH = 2.4


def draw_terrain(canvas: Canvas, camera: Camera, terrain: Terrain, scale: float) -> None:
    """Draw terrain [m] on a canvas; scale: pixels per layout unit."""
    if not len(terrain.edge_a):
        return
    pixels = camera.project(terrain.vertex)
    for chain in np.unique(terrain.chain[terrain.solid != 0]).tolist():
        corners = pixels[terrain.edge_a[terrain.chain == chain]]
        x, y = corners[:, 0], corners[:, 1]
        # Pixels count downwards: what is solid inside runs clockwise there. Walls, solid outside, have edges alone.
        if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) < 0.0:
            fill_solid(canvas.surface, corners)
    ends = np.ascontiguousarray(np.concatenate([pixels[terrain.edge_a], pixels[terrain.edge_b]], axis=1))
    canvas.lines(ends, np.full(len(ends), packed(TERRAIN)), EDGE_WIDTH * scale)


def fill_solid(surface: pygame.Surface, corners: NDArray[np.float64], colour: Colour = TERRAIN_FILL) -> None:
    """Fill a solid shape, by its corners [pixels] (n, 2)."""
    # pygame turns coordinates into 32 bit integers.
    pygame.draw.polygon(surface, colour, np.clip(corners, -FARTHEST, FARTHEST).tolist())
