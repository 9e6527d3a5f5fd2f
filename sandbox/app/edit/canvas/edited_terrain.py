"""Painting of terrain and walls while they are edited."""

from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Box, Camera
from sandbox.app.draw.colours import BACKGROUND, TERRAIN, TERRAIN_FILL, Colour, mixed, packed
from sandbox.app.draw.lines import EDGE_WIDTH, Canvas, fill_solid
from sandbox.editor.scene import Scene

Mask = NDArray[np.bool_]

# What is only a preview is this much paler; the fill of what is tinted has this share of the tint.
GHOST_SHARE = 0.35
TINT_SHARE = 0.16
# Outside the walls it is this much as light as inside of ground.
OUTSIDE_SHARE = 0.55


@dataclass(frozen=True)
class Ground:
    """Pieces of terrain of a scene to draw, by a mask of its items; tint: in place of their own colour; ghost: pale."""

    scene: Scene
    items: Mask
    tint: Colour | None = None
    ghost: bool = False


def paint_ground(canvas: Canvas, camera: Camera, ground: Ground, scale: float) -> None:
    """Draw terrain; scale: pixels per layout unit."""
    scene = ground.scene
    edges = scene.edge[ground.items[scene.edge_item] & (scene.edge_item < scene.zone_start)]
    if not len(edges):
        return
    pixels = camera.project(scene.corner)
    line: Colour = ground.tint or TERRAIN
    fill: Colour = TERRAIN_FILL
    if ground.tint is not None:
        fill = mixed(fill, ground.tint, TINT_SHARE)
    if ground.ghost:
        line, fill = mixed(line, BACKGROUND, GHOST_SHARE), mixed(fill, BACKGROUND, GHOST_SHARE)
    for index, piece in enumerate(scene.level.terrain, scene.terrain_start):
        if ground.items[index] and piece.polygon is not None:
            fill_solid(canvas.surface, pixels[scene.corner_item == index], fill)
    ends = np.ascontiguousarray(np.concatenate([pixels[edges[:, 0]], pixels[edges[:, 1]]], axis=1))
    canvas.lines(ends, np.full(len(ends), packed(line)), EDGE_WIDTH * scale)


def paint_walls(canvas: Canvas, camera: Camera, box: Box, scale: float, colour: Colour = TERRAIN) -> None:
    """Draw walls, and what is outside as solid."""
    (x0, y1), (x1, y0) = camera.to_pixels((box[0], box[1])), camera.to_pixels((box[2], box[3]))
    view = pygame.Rect(camera.viewport)
    left, right = _within(x0, view.left, view.right), _within(x1, view.left, view.right)
    top, bottom = _within(y0, view.top, view.bottom), _within(y1, view.top, view.bottom)
    outside = mixed(BACKGROUND, TERRAIN_FILL, OUTSIDE_SHARE)
    for place in (
        (view.left, view.top, left - view.left, view.height),
        (right, view.top, view.right - right, view.height),
        (left, view.top, right - left, top - view.top),
        (left, bottom, right - left, view.bottom - bottom),
    ):
        canvas.surface.fill(outside, place)
    ends = np.array([(x0, y0, x1, y0), (x1, y0, x1, y1), (x1, y1, x0, y1), (x0, y1, x0, y0)])
    canvas.lines(ends, np.full(4, packed(colour)), EDGE_WIDTH * scale)


def _within(value: float, low: int, high: int) -> int:
    return round(min(max(value, low), high))
