"""Painting of terrain, walls and zones while they are edited."""

from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Box, Camera
from sandbox.app.draw.colours import (
    BACKGROUND,
    TERRAIN,
    TERRAIN_FILL,
    TEXT,
    ZONE,
    Colour,
    mixed,
    packed,
    theme_now,
    tone,
    unpacked,
)
from sandbox.app.draw.lines import EDGE_WIDTH, FARTHEST, Canvas, fill_solid
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.things.belt_marks import ground_belts, mark_belts
from sandbox.app.widgets.ui import Ui
from sandbox.editor.scene import Scene
from sandbox.level.document.model import ZoneDef
from sandbox.level.format.look import colour_of
from sandbox.level.format.quantities import replaced
from sandbox.level.plan.surfaces import terrain_of

Mask = NDArray[np.bool_]
# What is only a preview is this much paler; the fill of what is tinted has this share of the tint.
GHOST_SHARE = 0.35
TINT_SHARE = 0.16
# Outside the walls it is this much as light as inside of ground.
OUTSIDE_SHARE = 0.55
WATER = tone("3C9FD0", "1F7FC0")
# How much of a zone's colour there is inside, 0..255, and the width of its line [pixels at scale 1].
SHADE, LINE = 46, 1.4
# A chosen zone has a line so much wider.
CHOSEN = 1.7
# Size of a name, and how far it stands from the upper left corner [layout units]; smaller zones have none.
NAME, INSET, SMALLEST = 11.0, 5.0, 26.0


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
    if not ground.ghost:
        _paint_belts(canvas, camera, ground, scale)


def _paint_belts(canvas: Canvas, camera: Camera, ground: Ground, scale: float) -> None:
    """Mark belts as play does at its beginning."""
    scene = ground.scene
    for index, piece in enumerate(scene.level.terrain, scene.terrain_start):
        if piece.belt and ground.items[index]:
            form = "polygon" if piece.polygon is not None else "polyline"
            corners = tuple(map(tuple, scene.corner[scene.corner_item == index].tolist()))
            terrain = terrain_of(replaced(scene.level, terrain=(replaced(piece, **{form: corners}),), walls=None))
            layer, at, nobody = MarkList(), camera.project(terrain.vertex), np.zeros(0, dtype=np.bool_)
            mark_belts(layer, ground_belts(terrain), at, nobody, camera, scale, 0.0, theme_now())
            canvas.draw(layer)


def paint_walls(canvas: Canvas, camera: Camera, box: Box, scale: float, colour: Colour = TERRAIN) -> None:
    """Draw walls, solid on their outer side."""
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
    """Write the name of each zone into its upper left corner, or above that where it has no room."""
    scene, font = areas.scene, ui.font(NAME, True)
    for index, zone in enumerate(scene.level.zones, scene.zone_start):
        if not areas.items[index]:
            continue
        pixels = camera.project(scene.corner[scene.corner_item == index])
        (left, top), (right, bottom) = pixels.min(axis=0).tolist(), pixels.max(axis=0).tolist()
        if max(right - left, bottom - top) < ui.px(SMALLEST) or right < 0 or bottom < 0:
            continue
        picture = font.render(zone.id, True, mixed(_colour(zone), TEXT, 0.35))
        if bottom - top < ui.px(SMALLEST) or right - left < picture.get_width() + ui.px(INSET):
            at = picture.get_rect(bottomleft=(round(left), round(top)))
        elif zone.box is not None:
            at = picture.get_rect(topleft=(round(left + ui.px(INSET)), round(top + ui.px(INSET) / 2)))
        else:
            at = picture.get_rect(center=(round((left + right) / 2), round((top + bottom) / 2)))
        halo = font.render(zone.id, True, BACKGROUND)
        halo.set_alpha(150)
        surface.blit(halo, at.move(1, 1))
        surface.blit(picture, at)
