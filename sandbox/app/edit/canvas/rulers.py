"""Rulers: metres along the top and the left edge of the canvas, with the place of the pointer marked."""

import math
from collections.abc import Callable

import pygame

from sandbox.app.draw.camera import GRID_STEP, Camera, Point, grid_spacing
from sandbox.app.draw.colours import ACCENT, LINE, MUTED, SURFACE
from sandbox.app.widgets.ui import Ui

# Thickness in layout units; lengths of marks as a part of it.
RULER = 20.0
SHORT, LONG = 0.25, 0.55
# Marks between two numbers.
PARTS = 5


class Rulers:
    """Both rulers, around a camera's viewport; their marks are kept until the view changes."""

    def __init__(self, ui: Ui) -> None:
        self._ui = ui
        self._key: tuple[object, ...] = ()
        self._pictures: list[pygame.Surface] = []

    def draw(self, surface: pygame.Surface, camera: Camera, pointer: Point | None) -> None:
        """Draw both rulers; pointer: where it is [pixels], if it is over the canvas."""
        size = self._ui.px(RULER)
        left, top, width, height = camera.viewport
        key = (camera.centre, camera.zoom, camera.viewport)
        if key != self._key:
            self._key = key
            spacing = grid_spacing(camera.zoom, GRID_STEP * self._ui.scale)
            self._pictures = [self._horizontal(camera, spacing), self._vertical(camera, spacing)]
        surface.blit(self._pictures[0], (left, top - size))
        surface.blit(self._pictures[1], (left - size, top))
        surface.fill(SURFACE, (left - size, top - size, size, size))
        unit = self._ui.font(9).render("m", True, MUTED)
        surface.blit(unit, unit.get_rect(center=(left - size / 2, top - size / 2)))
        surface.fill(LINE, (left - size, top - 1, width + size, 1))
        surface.fill(LINE, (left - 1, top - size, 1, height + size))
        if pointer is not None:
            surface.fill(ACCENT, (round(pointer[0]), top - size, 1, size))
            surface.fill(ACCENT, (left - size, round(pointer[1]), size, 1))

    def _horizontal(self, camera: Camera, spacing: float) -> pygame.Surface:
        left, _, width, _ = camera.viewport
        ruler = pygame.Surface((width, self._ui.px(RULER)))
        start = camera.to_world((left, 0.0))[0]
        self._mark(ruler, start, spacing, lambda x: camera.to_pixels((x, 0.0))[0] - left)
        return ruler

    def _vertical(self, camera: Camera, spacing: float) -> pygame.Surface:
        _, top, _, height = camera.viewport
        ruler = pygame.Surface((height, self._ui.px(RULER)))
        bottom = camera.to_world((0.0, top + height))[1]
        self._mark(ruler, bottom, spacing, lambda y: top + height - camera.to_pixels((0.0, y))[1])
        return pygame.transform.rotate(ruler, 90)

    def _mark(self, ruler: pygame.Surface, start: float, spacing: float, place: Callable[[float], float]) -> None:
        """Draw marks and numbers along a ruler that begins at `start` [m]."""
        ruler.fill(SURFACE)
        length, size = ruler.get_size()
        thick = self._ui.px(1)
        index = math.floor(start / spacing) * PARTS
        while (x := round(place(index * spacing / PARTS))) < length:
            is_numbered = index % PARTS == 0
            tall = round(size * (LONG if is_numbered else SHORT))
            ruler.fill(MUTED if is_numbered else LINE, (x, size - tall, thick, tall))
            if is_numbered:
                number = self._ui.font(9).render(f"{index // PARTS * spacing:.6g}", True, MUTED)
                if x + 3 * thick + number.get_width() <= length:
                    ruler.blit(number, (x + 3 * thick, 0))
            index += 1
