"""Renderer: draws the world between two snapshots; it reads and never writes."""

from dataclasses import dataclass, field

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.areas import draw_areas
from sandbox.app.draw.camera import Camera, grid_spacing
from sandbox.app.draw.colours import ACCENT, BACKGROUND, DANGER, GRID, GRID_AXIS, PARTICLE, PINNED, packed
from sandbox.app.draw.lines import Canvas
from sandbox.app.draw.strain_colours import strain_colours
from sandbox.app.draw.terrain import draw_terrain
from sandbox.app.play.playback import interpolated
from sandbox.app.profile import Profile
from sandbox.level.format.limits import BODY_RADIUS
from sandbox.physics.query import shown_particles, shown_springs
from sandbox.physics.snapshot import Snapshot

# Sizes [pixels at scale 1]: springs, the smallest particle that can still be seen, pins, and the grid's wish.
SPRING_WIDTH = 2.2
SMALLEST_RADIUS = 2.6
PIN_RADIUS = 5.0
GRID_STEP = 64.0
# A dense mesh seen from afar would be a solid block with full-width springs: they go down to this width.
THINNEST_SPRING = 0.9
# Width of springs and radius of particles, at most, as a part of the distance between particles.
DENSITY = 0.14
CROWDED = 0.19
# Particles of bodies this many times heavier than most are drawn larger.
HEAVY = 8.0


@dataclass
class Overlay:
    """What a person is doing, drawn over the world: the particle under the pointer, a cut [m], a cursor [m]."""

    hovered: int | None = None
    trail: list[tuple[float, float]] = field(default_factory=list)
    cursor: tuple[float, float] | None = None


class Renderer:
    """Draws on a surface; scale: pixels per layout unit; non_finite: particles the last drawing had to leave out."""

    def __init__(self, scale: float = 1.0) -> None:
        self.scale = scale
        self.compiled = True
        self.non_finite = 0
        self._neighbours: tuple[tuple[int, int, int], NDArray[np.float64]] | None = None

    def draw(
        self,
        surface: pygame.Surface,
        camera: Camera,
        previous: Snapshot,
        current: Snapshot,
        alpha: float,
        overlay: Overlay | None = None,
        profile: Profile | None = None,
    ) -> None:
        """Draw the world at a part alpha (0..1) of the way from one snapshot to the next."""
        profile, overlay = profile or Profile(), overlay or Overlay()
        canvas = Canvas(surface, self.compiled)
        with np.errstate(over="ignore", invalid="ignore"):
            position = interpolated(previous, current, alpha)
            pixels = camera.project(position)
            surface.fill(BACKGROUND)
            self._draw_grid(canvas, camera)
            draw_terrain(canvas, camera, current.terrain, self.scale)
            with profile.part("springs"):
                draw_areas(canvas, camera, current, pixels)
                self._draw_springs(canvas, camera, current, position, pixels)
            with profile.part("particles"):
                self._draw_particles(canvas, camera, current, pixels)
                self._draw_hands(canvas, current, pixels, overlay)
        self._draw_overlay(canvas, camera, pixels, overlay)

    def _draw_grid(self, canvas: Canvas, camera: Camera) -> None:
        left, top, width, height = camera.viewport
        spacing = grid_spacing(camera.zoom, GRID_STEP * self.scale)
        (x0, y1), (x1, y0) = camera.to_world((left, top)), camera.to_world((left + width, top + height))
        for low, high, vertical in ((x0, x1, True), (y0, y1, False)):
            for index in range(int(np.ceil(low / spacing)), int(np.floor(high / spacing)) + 1):
                colour = GRID_AXIS if index == 0 else GRID
                at = camera.to_pixels((index * spacing, index * spacing))
                if vertical:
                    canvas.surface.fill(colour, (round(at[0]), top, 1, height))
                else:
                    canvas.surface.fill(colour, (left, round(at[1]), width, 1))

    def _draw_springs(
        self,
        canvas: Canvas,
        camera: Camera,
        current: Snapshot,
        position: NDArray[np.float64],
        pixels: NDArray[np.float64],
    ) -> None:
        shown = np.flatnonzero(shown_springs(current))
        a, b = current.particle_a[shown], current.particle_b[shown]
        separation = position[b] - position[a]
        length = np.sqrt(np.sum(separation * separation, axis=1))
        rest = current.rest_length[shown]
        strain = np.divide(length - rest, rest, out=np.zeros_like(length), where=rest > 0.0)
        ends = np.concatenate([pixels[a], pixels[b]], axis=1)
        canvas.lines(np.ascontiguousarray(ends), strain_colours(strain), self._spring_width(camera, rest))

    def _spring_width(self, camera: Camera, rest: NDArray[np.float64]) -> float:
        spacing = float(np.median(rest)) * camera.zoom if len(rest) else np.inf
        return float(np.clip(spacing * DENSITY, THINNEST_SPRING * self.scale, SPRING_WIDTH * self.scale))

    def _draw_particles(self, canvas: Canvas, camera: Camera, current: Snapshot, pixels: NDArray[np.float64]) -> None:
        shown = shown_particles(current)
        finite = np.isfinite(pixels).all(axis=1)
        self.non_finite = int(np.count_nonzero(shown & ~finite))
        visible = np.flatnonzero(shown & finite)
        pinned = current.inverse_mass[visible] == 0.0
        radii = current.radius[visible] * camera.zoom * self._weight(current, visible)
        # Particles of the usual radius shrink with the mesh that they belong to, or a cloth is a field of dots.
        crowded = self._nearest_neighbours(current)[visible] * camera.zoom * CROWDED
        usual = radii <= BODY_RADIUS * camera.zoom
        radii = np.where(usual, np.minimum(np.maximum(radii, SMALLEST_RADIUS * self.scale), crowded), radii)
        radii = np.maximum(radii, THINNEST_SPRING * self.scale)
        centres = np.ascontiguousarray(pixels[visible])
        rim = np.minimum(1.4 * self.scale, crowded * 0.4)
        canvas.discs(centres, radii + rim, np.full(len(visible), packed(BACKGROUND)))
        canvas.discs(centres, radii, np.where(pinned, packed(PINNED), packed(PARTICLE)))
        self._draw_pins(canvas, centres[pinned], radii[pinned])

    def _nearest_neighbours(self, current: Snapshot) -> NDArray[np.float64]:
        """Rest length [m] of the shortest spring of every particle (n,); infinite where it has none."""
        key = (len(current.mass), len(current.rest_length), int(np.count_nonzero(current.spring_active)))
        if self._neighbours is None or self._neighbours[0] != key:
            nearest = np.full(len(current.mass), np.inf)
            working = current.spring_active & (current.rest_length > 0.0)
            for ends in (current.particle_a, current.particle_b):
                np.minimum.at(nearest, ends[working], current.rest_length[working])
            self._neighbours = key, nearest
        return self._neighbours[1]

    @staticmethod
    def _weight(current: Snapshot, visible: NDArray[np.int64]) -> NDArray[np.float64]:
        """How much larger than usual particles of bodies are drawn (n,): the heavy end of a rope looks heavy."""
        mass, usual = current.mass[visible], current.radius[visible] == BODY_RADIUS
        if not usual.any():
            return np.ones(len(visible))
        ratio = mass / np.median(mass[usual])
        return np.where(usual & (ratio >= HEAVY), ratio**0.25, 1.0)

    def _draw_pins(self, canvas: Canvas, centres: NDArray[np.float64], radii: NDArray[np.float64]) -> None:
        size = np.maximum(radii + 2.0 * self.scale, PIN_RADIUS * self.scale)
        for extra, colour in ((0.0, PINNED), (-1.8 * self.scale, BACKGROUND), (-3.4 * self.scale, PINNED)):
            canvas.discs(centres, np.maximum(size + extra, 0.5), np.full(len(centres), packed(colour)))

    def _draw_hands(self, canvas: Canvas, current: Snapshot, pixels: NDArray[np.float64], overlay: Overlay) -> None:
        """A line from every held particle to the cursor that pulls it."""
        if current.grab_spring < 0:
            return
        hands = slice(current.grab_spring, current.grab_spring + 10)
        active = np.flatnonzero(current.spring_active[hands]) + current.grab_spring
        a, b = current.particle_a[active], current.particle_b[active]
        ends = np.ascontiguousarray(np.concatenate([pixels[a], pixels[b]], axis=1))
        canvas.lines(ends, np.full(len(active), packed(ACCENT)), 1.4 * self.scale)
        for radius, colour in ((8.0, ACCENT), (6.4, BACKGROUND), (4.2, ACCENT)):
            count = len(active)
            canvas.discs(
                np.ascontiguousarray(pixels[b]), np.full(count, radius * self.scale), np.full(count, packed(colour))
            )

    def _draw_overlay(self, canvas: Canvas, camera: Camera, pixels: NDArray[np.float64], overlay: Overlay) -> None:
        surface, scale = canvas.surface, self.scale
        if overlay.hovered is not None and np.isfinite(pixels[overlay.hovered]).all():
            pygame.draw.aacircle(
                surface, ACCENT, pixels[overlay.hovered].tolist(), round(9 * scale), max(1, round(1.5 * scale))
            )
        if len(overlay.trail) > 1:
            points = camera.project(np.array(overlay.trail))
            ends = np.concatenate([points[:-1], points[1:]], axis=1)
            canvas.lines(np.ascontiguousarray(ends), np.full(len(ends), packed(DANGER)), 2.4 * scale)
        if overlay.cursor is not None:
            self._draw_cursor(canvas, camera.to_pixels(overlay.cursor))

    def _draw_cursor(self, canvas: Canvas, at: tuple[float, float]) -> None:
        x, y = at
        near, far = 5 * self.scale, 14 * self.scale
        ends = np.array(
            [[x - far, y, x - near, y], [x + near, y, x + far, y], [x, y - far, x, y - near], [x, y + near, x, y + far]]
        )
        canvas.lines(ends, np.full(4, packed(ACCENT)), 2.0 * self.scale)
