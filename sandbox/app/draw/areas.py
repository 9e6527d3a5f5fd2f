"""Areas as they are drawn: what a jelly or a ring holds is filled, tinted by how far it is from the area it wants."""

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import BACKGROUND
from sandbox.app.draw.lines import FARTHEST, Canvas
from sandbox.app.draw.strain_colours import strain_colours
from sandbox.physics.constraints import AREA
from sandbox.physics.snapshot import Snapshot

# How much of the colour of strain a fill has; more would hide the springs that are drawn over it.
TINT = 0.3


def draw_areas(canvas: Canvas, camera: Camera, current: Snapshot, pixels: NDArray[np.float64]) -> None:
    """Fill the areas of a snapshot, whose particles are at `pixels` (n, 2)."""
    areas = np.flatnonzero(current.constraint_active & (current.constraint_kind == AREA))
    for size in np.unique(current.constraint_corners[areas]).tolist():
        chosen = areas[current.constraint_corners[areas] == size]
        corners = pixels[current.corner_particle[current.constraint_first[chosen, None] + np.arange(size)]]
        seen = (np.abs(corners) < FARTHEST).all(axis=(1, 2))
        corners, wanted = corners[seen], current.constraint_rest[chosen[seen], 0]
        colours = _colours(corners, wanted * camera.zoom * camera.zoom)
        if size == 3:
            canvas.triangles(np.ascontiguousarray(corners), colours)
            continue
        for outline, colour in zip(corners, colours.tolist(), strict=True):
            pygame.draw.polygon(canvas.surface, pygame.Color(f"#{colour:06x}"), outline.tolist())


def _colours(corners: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.int64]:
    """Colours (t,) of areas with corners (t, k, 2) that want an area (t,) [pixels^2]; pixels count downwards."""
    x, y = corners[..., 0], corners[..., 1]
    area = 0.5 * np.sum(np.roll(x, -1, axis=1) * y - x * np.roll(y, -1, axis=1), axis=1)
    strain = np.divide(area - wanted, np.abs(wanted), out=np.zeros_like(area), where=wanted != 0.0)
    # One of area 1.2 is as far as a spring of length 1.1.
    full = strain_colours(0.5 * strain)
    mixed = np.zeros_like(full)
    for shift, under in zip((16, 8, 0), BACKGROUND, strict=True):
        mixed |= (under + TINT * (((full >> shift) & 255) - under)).astype(np.int64) << shift
    return mixed
