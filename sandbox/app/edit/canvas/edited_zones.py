"""Painting of zones while a level is edited: shaded areas, those with water in its colour."""

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Box, Camera
from sandbox.app.draw.colours import ACCENT, Colour, packed, tone
from sandbox.app.draw.lines import FARTHEST, Canvas
from sandbox.app.draw.themes import rgb_of
from sandbox.level.document.model import ZoneDef
from sandbox.level.format.look import colour_of

Floats = NDArray[np.float64]

WATER = tone("3C9FD0", "1F7FC0")
# How much of a zone's colour there is inside, 0..255, and the width of its line [pixels at scale 1].
SHADE, LINE = 46, 1.4
# Sides by which a circle is drawn.
ROUND = 72


def corners_of(zone: ZoneDef) -> Floats:
    """Corners [m] (k, 2) of a zone; of a circle many."""
    if zone.box is not None:
        left, bottom, right, top = zone.box
        return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
    if zone.circle is not None:
        x, y, radius = zone.circle
        turn = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
        return np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])
    return np.array(zone.polygon, dtype=np.float64)


def box_of(zone: ZoneDef) -> Box:
    """The box [m] around a zone."""
    low, high = corners_of(zone).min(axis=0).tolist(), corners_of(zone).max(axis=0).tolist()
    return low[0], low[1], high[0], high[1]


def paint_zone(canvas: Canvas, camera: Camera, zone: ZoneDef, scale: float) -> None:
    """Shade a zone; scale: pixels per layout unit."""
    colour: Colour = WATER if zone.water is not None else ACCENT
    if zone.look is not None and zone.look.colour is not None:
        colour = rgb_of(colour_of(zone.look.colour))
    pixels = np.clip(camera.project(corners_of(zone)), -FARTHEST, FARTHEST)
    around = pygame.Rect(*pixels.min(axis=0), *(np.ptp(pixels, axis=0) + 1.0)).clip(camera.viewport)
    if around.width and around.height:
        shade = pygame.Surface(around.size, pygame.SRCALPHA, 32)
        pygame.draw.polygon(shade, (*colour, SHADE), (pixels - around.topleft).tolist())
        canvas.surface.blit(shade, around)
    ends = np.concatenate([pixels, np.roll(pixels, -1, axis=0)], axis=1)
    canvas.lines(np.ascontiguousarray(ends), np.full(len(ends), packed(colour)), LINE * scale)
