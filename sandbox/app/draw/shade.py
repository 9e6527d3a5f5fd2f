"""Shade: where the things of an earlier run were, in one pale colour behind those of the present one."""

from itertools import pairwise

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.raster.painter import Painter
from sandbox.app.draw.raster.pixels import FAR
from sandbox.app.draw.textures import Tiles
from sandbox.app.draw.themes import Theme
from sandbox.app.draw.things.drawables import Drawables
from sandbox.app.draw.things.frame import Frame
from sandbox.app.draw.things.level_slots import LevelSlots, joined_slots, level_slots_of, whole_triangles
from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.keeping.equipment import Joined
from sandbox.physics.snapshot import Snapshot

# How much of it is seen, 0..255.
OPACITY = 84
# Of lines and discs that would be thinner than this half width nothing would be seen [pixels].
LEAST_HALF = 1.0


class Shade:
    """Draws states of one run of a level, one after the other."""

    def __init__(self, level: Level) -> None:
        self._own = self._slots = level_slots_of(level)
        self._joined: tuple[Joined, ...] = ()
        self._drawables: Drawables | None = None
        self._key: tuple[NDArray[np.bool_], ...] = ()
        self._layer: pygame.Surface | None = None

    def draw(
        self, painter: Painter, state: Snapshot, camera: Camera, theme: Theme, tiles: Tiles, scale: float
    ) -> None:  # fmt: skip
        """Draw a state on the painter's surface; scale: pixels per layout unit."""
        at = camera.project(state.position)
        frame = Frame(state, at, state.angle, np.zeros(len(state.rest_length)), camera.zoom, scale, theme, tiles)
        drawables = self._drawables_of(state)
        drawables.soft.trace(painter, frame)
        thrown, outlines = drawables.thrown(frame)
        layer = self._cleared(painter.surface.get_size())
        colour = *theme.accent, 255
        starts = outlines.start.tolist()
        for first, last in pairwise(starts):
            points = outlines.point[first:last]
            if len(points) > 2 and (np.abs(points) < FAR).all():
                pygame.draw.polygon(layer, colour, points.tolist())
        for ax, ay, bx, by, half in thrown.lines[(np.abs(thrown.lines) < FAR).all(axis=1)].tolist():
            pygame.draw.line(layer, colour, (ax, ay), (bx, by), round(2 * max(half, LEAST_HALF)))
        for x, y, radius in thrown.discs[(np.abs(thrown.discs) < FAR).all(axis=1)].tolist():
            pygame.draw.aacircle(layer, colour, (x, y), max(radius, LEAST_HALF))
        layer.set_alpha(OPACITY)
        painter.surface.blit(layer, (0, 0))

    def _cleared(self, size: tuple[int, int]) -> pygame.Surface:
        if self._layer is None or self._layer.get_size() != size:
            self._layer = pygame.Surface(size, pygame.SRCALPHA)
        self._layer.fill((0, 0, 0, 0))
        return self._layer

    def _drawables_of(self, state: Snapshot) -> Drawables:
        slots = self._slots_of(state.equipment.joined)
        key = shown_particles(state), shown_springs(state), state.inverse_mass == 0.0
        is_same = len(self._key) == 3 and all(map(np.array_equal, key, self._key))
        if self._drawables is None or not is_same:
            self._drawables, self._key = Drawables(slots, state, *key[:2], whole_triangles(state)), key
        return self._drawables

    def _slots_of(self, joined: tuple[Joined, ...]) -> LevelSlots:
        if joined is not self._joined:
            self._joined, self._drawables = joined, None
            self._slots = joined_slots(self._own, joined)
        return self._slots
