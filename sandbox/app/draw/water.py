"""Water: pools drawn in front of what is in them, with waves where something crosses the surface. Looks alone."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Box, Camera
from sandbox.app.draw.colours import Colour, Theme, mixed, packed, unpacked
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.things.level_slots import Frame
from sandbox.level.document.model import Level, ZoneDef
from sandbox.level.format.look import colour_of
from sandbox.physics.geometry.segment import signed_area
from sandbox.physics.terrain import Terrain

Floats = NDArray[np.float64]
# At the surface, deep down, and of foam.
Tones = tuple[Colour, Colour, Colour]

# How much water hides at its surface and deep down, and where [m] it is as deep as that.
CLEAR, MURKY, DEEP = 0.36, 0.66, 3.0
# A particle makes waves from this far [m] off the surface on, and faster than this [m/s]; how high [m] they are at
# 1 m/s and at most; their length [m], period [s], and the way [m] on which they fall to 1/e.
NEAR, SLOWEST, PER_SPEED, HIGHEST, LENGTH, PERIOD, FADE = 0.3, 0.06, 0.03, 0.1, 0.7, 0.75, 0.9
# At most so many make waves: the fastest. From one point of the surface to the next [pixels at scale 1].
MOST, STEP = 24, 4
# The line of the surface and the light under it [pixels at scale 1].
LINE_HALF, LIGHT = 1.1, 9.0
# Steps of its profile to a row of pixels.
FINE = 4
# Streaks that show how water flows: so many a pool, their length [m].
STREAKS, STREAK = 18, 0.5


@dataclass(frozen=True, eq=False)
class DrawnPool:
    """Water of a zone: its box and flow, and its own colour, if it has one."""

    box: Box
    flow: tuple[float, float]
    colour: Colour | None

    def tones(self, theme: Theme) -> Tones:
        """Its colours at the surface and deep down, and that of its foam."""
        if self.colour is None:
            return *theme.water, theme.foam
        return self.colour, mixed(self.colour, theme.water[1], 0.6), mixed(self.colour, theme.foam, 0.8)


@dataclass(frozen=True, eq=False)
class _Kept:
    """The picture of a pool while the view stays: the part without waves, and the profile of that with waves."""

    key: tuple[object, ...]
    terrain: Terrain
    below: pygame.Surface
    profile: NDArray[np.uint32]


def _pool_of(zone: ZoneDef) -> DrawnPool:
    assert zone.box is not None and zone.water is not None
    colour = None if zone.look is None or zone.look.colour is None else unpacked(colour_of(zone.look.colour))
    return DrawnPool(zone.box, zone.water.flow, colour)


class Pools:
    """The water of a level."""

    def __init__(self, level: Level | None) -> None:
        zones = () if level is None else level.zones
        self._pools = [_pool_of(zone) for zone in zones if zone.water is not None]
        self._walls = None if level is None or level.walls is None else level.walls.box
        self._kept: dict[int, _Kept] = {}

    @property
    def boxes(self) -> Floats:
        """Left, bottom, right and top [m] of each (k, 4)."""
        return np.array([pool.box for pool in self._pools], np.float64).reshape(-1, 4)

    def seen(self) -> Iterator[tuple[Box, DrawnPool]]:
        """All water, with the part of each box that lies within the walls of the level."""
        for pool in self._pools:
            left, bottom, right, top = pool.box
            if self._walls is not None:
                left, bottom, right = max(left, self._walls[0]), max(bottom, self._walls[1]), min(right, self._walls[2])
            yield (left, bottom, right, top), pool

    @property
    def flow(self) -> bool:
        """Whether any water flows, so that its picture changes all the time."""
        return any(any(pool.flow) for pool in self._pools)

    def draw(self, surface: pygame.Surface, marks: MarkList, camera: Camera, frame: Frame, terrain: Terrain) -> None:
        """Draw all of it over what is on a surface, but not over solid ground; marks: of what is drawn last."""
        for number, (box, pool) in enumerate(self.seen()):
            place = _place(box, camera)
            if place.width > 0 and place.height > 0:
                below = self._draw_pool(number, surface, camera, frame, terrain, place)
                if any(pool.flow):
                    corner = (place.left, place.bottom - below.get_height())
                    _mark_streaks(marks, pool, camera, frame, (below, corner))

    def _draw_pool(
        self, number: int, surface: pygame.Surface, camera: Camera, frame: Frame, terrain: Terrain, place: pygame.Rect
    ) -> pygame.Surface:
        # And give back what lies below the waves.
        pool = self._pools[number]
        top = camera.to_pixels((0.0, pool.box[3]))[1]
        # The part whose upper edge may move is made each time, what is below it only where the view has changed.
        waves = max(0, min(place.height, round(top + HIGHEST * camera.zoom + LIGHT * frame.scale * 3.0) - place.top))
        tones = pool.tones(frame.theme)
        key = (camera.centre, camera.zoom, camera.viewport, frame.theme.name, frame.scale)
        kept = self._kept.get(number)
        if kept is None or kept.key != key or kept.terrain is not terrain:
            below = _made(place.width, place.height - waves)
            _fill_deep(below, tones, place.top + waves - top, camera.zoom)
            _cut_out(below, (place.left, place.top + waves), camera, terrain)
            profile = _profile(tones, frame.scale, camera.zoom, waves, 2 * waves)
            self._kept[number] = kept = _Kept(key, terrain, below, profile)
        surface.blit(kept.below, (place.left, place.top + waves))
        if waves:
            columns = np.arange(place.width, dtype=np.float64) + (place.left + 0.5)
            heights = surface_of(pool.box, camera, frame, columns)
            above = _made(place.width, waves)
            _fill_surface(above, heights - place.top, kept.profile, waves)
            _cut_out(above, place.topleft, camera, terrain)
            surface.blit(above, place.topleft)
        return kept.below


def _place(box: Box, camera: Camera) -> pygame.Rect:
    """The pixels of what is seen of water in a box, the highest waves over it included."""
    left, bottom, right, top = box
    (x0, y0), (x1, y1) = camera.to_pixels((left, top + HIGHEST)), camera.to_pixels((right, bottom))
    view = pygame.Rect(camera.viewport)
    low, high = (min(max(round(x), view.left), view.right) for x in (x0, x1))
    upper, lower = (min(max(round(y), view.top), view.bottom) for y in (y0 - 2.0, y1))
    return pygame.Rect(low, upper, high - low, lower - upper)


def surface_of(box: Box, camera: Camera, frame: Frame, columns: Floats) -> Floats:
    """Where the surface of water in a box is (k,) [pixels] at columns (k,) [pixels]."""
    left, _, right, top = box
    x, y = camera.to_world((0.0, 0.0))[0] + frame.at[:, 0] / camera.zoom, frame.at[:, 1] / camera.zoom
    level = camera.to_pixels((0.0, top))[1]
    off = np.abs(y - level / camera.zoom) - frame.state.radius
    velocity = frame.state.velocity
    speed = np.abs(velocity[:, 1]) + 0.5 * np.abs(velocity[:, 0])
    with np.errstate(invalid="ignore"):
        makes = (off < NEAR) & (speed > SLOWEST) & (x > left) & (x < right) & (frame.state.inverse_mass > 0.0)
    found = np.flatnonzero(makes & frame.state.particle_active)
    if not len(found):
        return np.full(len(columns), level)
    high = np.minimum(PER_SPEED * speed[found], HIGHEST) * (1.0 - np.maximum(off[found], 0.0) / NEAR)
    strongest = np.argsort(-high, kind="stable")[:MOST]
    found, high = found[strongest], high[strongest]
    every = max(1, round(STEP * frame.scale))
    places = columns[::every] if len(columns) > every else columns
    away = np.abs(places[:, None] / camera.zoom + camera.to_world((0.0, 0.0))[0] - x[found])
    waves = high * np.exp(-away / FADE) * np.sin(2.0 * np.pi * (away / LENGTH - frame.seconds / PERIOD))
    # Many together are hardly higher than one.
    height = HIGHEST * np.tanh(waves.sum(axis=1) / HIGHEST)
    return level - camera.zoom * np.interp(columns, places, height)


def _made(width: int, height: int) -> pygame.Surface:
    return pygame.Surface((width, max(height, 0)), pygame.SRCALPHA, 32)


def _fill_deep(surface: pygame.Surface, tones: Tones, depth: float, zoom: float) -> None:
    """Water from a depth [pixels] on: the deeper the darker."""
    width, height = surface.get_size()
    if width and height:
        column = pygame.Surface((1, height), pygame.SRCALPHA, 32)
        colour, hidden = _at_depth(tones, (np.arange(height, dtype=np.float64) + (0.5 + depth)) / zoom)
        pygame.surfarray.pixels3d(column)[0], pygame.surfarray.pixels_alpha(column)[0] = colour, 255.0 * hidden
        surface.blit(pygame.transform.scale(column, (width, height)), (0, 0), special_flags=pygame.BLEND_RGBA_ADD)


def _at_depth(tones: Tones, depth: Floats) -> tuple[Floats, Floats]:
    """Colour (..., 3) and opacity (...) of water at depths [m] (...)."""
    fraction = np.clip(depth / DEEP, 0.0, 1.0)
    near, deep = np.array(tones[0], float), np.array(tones[1], float)
    return near + (deep - near) * fraction[..., None], CLEAR + (MURKY - CLEAR) * fraction


def _profile(tones: Tones, scale: float, zoom: float, above: int, rows: int) -> NDArray[np.uint32]:
    """Pixels 0xAARRGGBB of water from `above` rows over its surface on, FINE to a row."""
    under = np.arange(-above * FINE, rows * FINE, dtype=np.float64) / FINE
    colour, hidden = _at_depth(tones, under / zoom)
    line = np.clip(LINE_HALF * scale + 0.5 - np.abs(under), 0.0, 1.0)
    light = np.exp(-np.maximum(under, 0.0) / (LIGHT * scale))
    foam = np.maximum(0.9 * line, 0.3 * light)
    colour = colour + (np.array(tones[2], float) - colour) * foam[:, None]
    wet = np.clip(under + 0.5, 0.0, 1.0)
    opacity = np.maximum(wet * (hidden + 0.12 * light), 0.85 * line)
    channels = np.column_stack([255.0 * opacity, colour]).astype(np.uint32)
    return np.asarray(channels @ np.array([1 << 24, 1 << 16, 1 << 8, 1], dtype=np.uint32))


def _fill_surface(surface: pygame.Surface, heights: Floats, profile: NDArray[np.uint32], above: int) -> None:
    """Water under a surface (width,) [pixels], by the profile of its columns."""
    first = np.round(FINE * (above + 0.5 - heights)).astype(np.int64)
    rows = FINE * np.arange(surface.get_height(), dtype=np.int64)
    pygame.surfarray.pixels2d(surface)[:] = profile[np.clip(first[:, None] + rows, 0, len(profile) - 1)]


def _cut_out(surface: pygame.Surface, corner: tuple[int, int], camera: Camera, terrain: Terrain) -> None:
    """Take solid ground out of a surface whose corner lies there [pixels]."""
    for chain in np.unique(terrain.chain).tolist():
        edges = np.flatnonzero(terrain.chain == chain)
        corners = terrain.vertex[terrain.edge_a[edges]]
        if terrain.solid[edges[0]] and signed_area(corners, np.roll(corners, -1, axis=0)) > 0.0:
            places = camera.project(corners) - corner
            pygame.draw.polygon(surface, (0, 0, 0, 0), np.clip(places, -1e4, 1e4).tolist())


def _mark_streaks(
    marks: MarkList, pool: DrawnPool, camera: Camera, frame: Frame, seen: tuple[pygame.Surface, tuple[int, int]]
) -> None:
    """Mark how water flows, where it is seen: the pixels of it, and where those lie."""
    left, bottom, right, top = pool.box
    k = np.arange(STREAKS)
    # Places that look thrown about, by the golden ratio and the root of 2.
    width, height = right - left, min(top - bottom, DEEP)
    x = left + (width * (0.618034 * k % 1.0) + pool.flow[0] * frame.seconds) % width
    y = top - 0.15 * height - 0.8 * ((height * (0.414214 * k % 1.0) - pool.flow[1] * frame.seconds) % height)
    way = np.array(pool.flow) / max(float(np.hypot(*pool.flow)), 1e-9)
    half = 0.5 * STREAK * (0.5 + 0.5 * (0.7548776 * k % 1.0))[:, None] * way
    ends = np.concatenate([camera.project(np.stack([x, y], 1) - half), camera.project(np.stack([x, y], 1) + half)], 1)
    opaque = pygame.surfarray.array_alpha(seen[0])
    inside = np.ones(STREAKS, dtype=np.bool_)
    for column in (0, 2):
        across, down = (ends[:, column : column + 2] - seen[1]).astype(np.int64).T
        inside &= (across >= 0) & (across < opaque.shape[0]) & (down >= 0) & (down < opaque.shape[1])
        inside[inside] = opaque[across[inside], down[inside]] > 0
    # They come and go at the sides.
    alpha = 0.3 * np.clip(4.0 * np.minimum(x - left, right - x) / width, 0.0, 1.0)
    marks.strokes(ends[inside], 1.2 * frame.scale, packed(pool.tones(frame.theme)[2]), alpha[inside])
