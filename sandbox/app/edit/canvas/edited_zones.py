"""Painting of zones while a level is edited: shaded areas, those with water in its colour, and their names."""

from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import BACKGROUND, TEXT, ZONE, Colour, mixed, packed, tone, unpacked
from sandbox.app.draw.lines import FARTHEST, Canvas
from sandbox.app.widgets.ui import Ui
from sandbox.editor.scene import Scene
from sandbox.level.document.model import ZoneDef
from sandbox.level.format.look import colour_of

Mask = NDArray[np.bool_]

WATER = tone("3C9FD0", "1F7FC0")
# How much of a zone's colour there is inside, 0..255, and the width of its line [pixels at scale 1].
SHADE, LINE = 46, 1.4
# A chosen zone has a line so much wider.
CHOSEN = 1.7
# Size of a name, and how far it stands from the upper left corner [layout units]; smaller zones have none.
NAME, INSET, SMALLEST = 11.0, 5.0, 26.0


@dataclass(frozen=True)
class Areas:
    """Zones of a scene to draw, by a mask of its items; tint: in place of their own colour."""

    scene: Scene
    items: Mask
    tint: Colour | None = None


def paint_zones(canvas: Canvas, camera: Camera, areas: Areas, scale: float) -> None:
    """Shade zones; scale: pixels per layout unit."""
    scene = areas.scene
    pixels = np.clip(camera.project(scene.corner), -FARTHEST, FARTHEST)
    for index, zone in enumerate(scene.level.zones, scene.zone_start):
        if areas.items[index]:
            colour = areas.tint or _colour(zone)
            width = LINE * scale * (CHOSEN if areas.tint is not None else 1.0)
            _paint(canvas, camera, pixels[scene.corner_item == index], colour, width)


def _colour(zone: ZoneDef) -> Colour:
    if zone.look is not None and zone.look.colour is not None:
        return unpacked(colour_of(zone.look.colour))
    return WATER if zone.water is not None else ZONE


def _paint(canvas: Canvas, camera: Camera, pixels: NDArray[np.float64], colour: Colour, width: float) -> None:
    around = pygame.Rect(*pixels.min(axis=0), *(np.ptp(pixels, axis=0) + 1.0)).clip(camera.viewport)
    if around.width and around.height:
        shade = pygame.Surface(around.size, pygame.SRCALPHA, 32)
        pygame.draw.polygon(shade, (*colour, SHADE), (pixels - around.topleft).tolist())
        canvas.surface.blit(shade, around)
    ends = np.concatenate([pixels, np.roll(pixels, -1, axis=0)], axis=1)
    canvas.lines(np.ascontiguousarray(ends), np.full(len(ends), packed(colour)), width)


def draw_zone_names(surface: pygame.Surface, ui: Ui, camera: Camera, areas: Areas) -> None:
    """Write the name of each zone into its upper left corner, where it has room."""
    scene, font = areas.scene, ui.font(NAME, True)
    for index, zone in enumerate(scene.level.zones, scene.zone_start):
        if not areas.items[index]:
            continue
        pixels = camera.project(scene.corner[scene.corner_item == index])
        (left, top), (right, bottom) = pixels.min(axis=0).tolist(), pixels.max(axis=0).tolist()
        if min(right - left, bottom - top) < ui.px(SMALLEST) or right < 0 or bottom < 0:
            continue
        picture = font.render(zone.id, True, mixed(_colour(zone), TEXT, 0.35))
        if zone.box is not None:
            at = picture.get_rect(topleft=(round(left + ui.px(INSET)), round(top + ui.px(INSET) / 2)))
        else:
            at = picture.get_rect(center=(round((left + right) / 2), round((top + bottom) / 2)))
        halo = font.render(zone.id, True, BACKGROUND)
        halo.set_alpha(150)
        surface.blit(halo, at.move(1, 1))
        surface.blit(picture, at)
