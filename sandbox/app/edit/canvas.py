"""Painter of the scene that is edited: a layer that is kept while nothing changes, and what moves drawn over it."""

from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.camera import Camera, grid_spacing
from sandbox.app.colours import (
    ACCENT,
    BACKGROUND,
    GRID,
    GRID_AXIS,
    GRID_FINE,
    PARTICLE,
    PINNED,
    WELD,
    Colour,
    material_colours,
    mixed,
    packed,
)
from sandbox.app.lines import Canvas
from sandbox.app.renderer import CROWDED, DENSITY, GRID_STEP, PIN_RADIUS, SMALLEST_RADIUS, SPRING_WIDTH, THINNEST_SPRING
from sandbox.editor.items import Selection
from sandbox.editor.scene import Scene

# Distance of the points that the pointer snaps to, at least [pixels at scale 1].
SNAP_STEP = 16.0
# More springs than this are drawn plainly while they change, and smoothly in the first frame that nothing does.
PLAIN_FROM = 6_000
# What is only a preview is this much paler.
GHOST_SHARE = 0.45
HIGHLIGHT_WIDTH = 2.4
HOVERED: Colour = (180, 190, 205)

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Part:
    """Particles and springs of a scene to draw; tint: in place of their own colours; ghost: pale."""

    scene: Scene
    particles: Mask
    springs: Mask
    tint: Colour | None = None
    ghost: bool = False


class ScenePainter:
    """Draws scenes on a surface; `compiled`: whether the kernels are ready; scale: pixels per layout unit."""

    def __init__(self, scale: float) -> None:
        self.scale = scale
        self.compiled = True
        self._layer: pygame.Surface | None = None
        self._key: tuple[object, ...] = ()
        self._is_plain = False

    def draw(self, surface: pygame.Surface, camera: Camera, scene: Scene, selection: Selection, hidden: bool) -> None:
        """Draw grid, scene and selection, from the layer that is kept where it still holds.

        hidden: the selection is left out, because it is drawn elsewhere while it moves.
        """
        key = (id(scene), camera.centre, camera.zoom, camera.viewport, self.scale, selection, hidden, self.compiled)
        is_new = key != self._key
        if self._layer is None or self._layer.get_size() != surface.get_size():
            self._layer = pygame.Surface(surface.get_size(), 0, 32)
            is_new = True
        if is_new or self._is_plain:
            self._is_plain = is_new and len(scene.particle_a) > PLAIN_FROM
            self._key, self._scene = key, scene
            self._paint_layer(self._layer, camera, scene, selection, hidden)
        surface.blit(self._layer, camera.viewport[:2], camera.viewport)

    def _paint_layer(
        self, layer: pygame.Surface, camera: Camera, scene: Scene, selection: Selection, hidden: bool
    ) -> None:
        layer.set_clip(camera.viewport)
        layer.fill(BACKGROUND)
        draw_grid(layer, camera, self.scale)
        particles, springs = scene.particles_of(selection), scene.springs_of(selection)
        if hidden:
            springs |= hanging_springs(scene, particles)
        self.paint(layer, camera, Part(scene, ~particles, ~springs), self._is_plain)
        if not hidden:
            self.paint(layer, camera, Part(scene, particles, springs, ACCENT), self._is_plain)
        layer.set_clip(None)

    def paint_moved(self, surface: pygame.Surface, camera: Camera, scene: Scene, selection: Selection) -> None:
        """Draw the selection in a scene where it has moved, and the springs of others that hang on it."""
        particles, springs = scene.particles_of(selection), scene.springs_of(selection)
        nobody = np.zeros(len(particles), dtype=np.bool_)
        self.paint(surface, camera, Part(scene, nobody, hanging_springs(scene, particles) & ~springs))
        self.paint(surface, camera, Part(scene, particles, springs, ACCENT))

    def paint_hovered(self, surface: pygame.Surface, camera: Camera, scene: Scene, items: Selection) -> None:
        """Draw what a click would select, brighter; of large bodies only the springs."""
        particles, springs = scene.particles_of(items), scene.springs_of(items)
        if np.count_nonzero(springs) > PLAIN_FROM:
            particles = np.zeros(len(particles), dtype=np.bool_)
        self.paint(surface, camera, Part(scene, particles, springs, HOVERED))

    def paint(self, surface: pygame.Surface, camera: Camera, part: Part, plain: bool | None = None) -> None:
        """Draw a part of a scene; plain: with quick lines, None = where there are many."""
        scene = part.scene
        springs = np.flatnonzero(part.springs)
        canvas = Canvas(surface, self.compiled)
        pixels = camera.project(scene.position)
        plain = len(springs) > PLAIN_FROM if plain is None else plain
        self._paint_springs(canvas, camera, part, springs, pixels, plain)
        if not (plain and len(springs) > PLAIN_FROM and self._radius(camera, part) < 1.0):
            self._paint_particles(canvas, camera, part, pixels)

    def _paint_springs(
        self, canvas: Canvas, camera: Camera, part: Part, springs: NDArray[np.int64], pixels: NDArray[np.float64],
        plain: bool,
    ) -> None:  # fmt: skip
        scene = part.scene
        ends = np.concatenate([pixels[scene.particle_a[springs]], pixels[scene.particle_b[springs]]], axis=1)
        ends = np.ascontiguousarray(ends)
        colours = self._colours(part)[scene.material[springs]]
        if plain:
            canvas.plain_lines(ends, colours)
            return
        width = self._width(camera, scene.rest_length[springs])
        if part.tint is not None:
            under = np.full(len(springs), packed(mixed(BACKGROUND, part.tint, 0.55)))
            canvas.lines(ends, under, width + HIGHLIGHT_WIDTH * self.scale)
        canvas.lines(ends, colours, width)

    def _colours(self, part: Part) -> NDArray[np.int64]:
        """Colours (materials,) of the springs."""
        by_name = material_colours(part.scene.materials)
        share = GHOST_SHARE if part.ghost else 0.0
        return np.array([packed(mixed(by_name[name], BACKGROUND, share)) for name in part.scene.materials])

    def _width(self, camera: Camera, rest: NDArray[np.float64]) -> float:
        spacing = float(np.median(rest)) * camera.zoom if len(rest) else np.inf
        return float(np.clip(spacing * DENSITY, THINNEST_SPRING * self.scale, SPRING_WIDTH * self.scale))

    def _radius(self, camera: Camera, part: Part) -> float:
        """About how large [pixels] the particles of a part are."""
        rest = part.scene.rest_length[part.springs]
        return float(np.median(rest)) * camera.zoom * CROWDED if len(rest) else np.inf

    def _paint_particles(self, canvas: Canvas, camera: Camera, part: Part, pixels: NDArray[np.float64]) -> None:
        scene, shown = part.scene, np.flatnonzero(part.particles)
        if not len(shown):
            return
        fewest, rim = THINNEST_SPRING * self.scale, 1.4 * self.scale
        usual = np.minimum(SMALLEST_RADIUS * self.scale, max(self._radius(camera, part), fewest))
        radii = np.maximum(scene.radius[shown] * camera.zoom, usual)
        if self._radius(camera, part) < SMALLEST_RADIUS * self.scale:
            radii = np.where(scene.radius[shown] <= scene.radius.min(), np.minimum(radii, usual), radii)
        centres = np.ascontiguousarray(pixels[shown])
        under = part.tint or BACKGROUND
        colour = mixed(PARTICLE, BACKGROUND, GHOST_SHARE) if part.ghost else PARTICLE
        canvas.discs(centres, radii + np.minimum(rim, radii * 0.6), np.full(len(shown), packed(under)))
        canvas.discs(centres, radii, np.full(len(shown), packed(colour)))
        held = scene.pinned[shown]
        self._paint_rings(canvas, centres[held], radii[held], mixed(PINNED, BACKGROUND, 0.4) if part.ghost else PINNED)
        welded = np.isin(shown, scene.welds.ravel())
        self._paint_rings(canvas, centres[welded & ~held], radii[welded & ~held], WELD)

    def _paint_rings(
        self, canvas: Canvas, centres: NDArray[np.float64], radii: NDArray[np.float64], colour: Colour
    ) -> None:
        size = np.maximum(radii + 2.0 * self.scale, PIN_RADIUS * self.scale)
        for extra, ring in ((0.0, colour), (-1.8 * self.scale, BACKGROUND), (-3.4 * self.scale, colour)):
            canvas.discs(centres, np.maximum(size + extra, 0.5), np.full(len(centres), packed(ring)))


def draw_grid(surface: pygame.Surface, camera: Camera, scale: float) -> None:
    """Draw the lines that the pointer snaps to, and brighter ones that the rulers name."""
    left, top, width, height = camera.viewport
    (x0, y1), (x1, y0) = camera.to_world((left, top)), camera.to_world((left + width, top + height))
    for wanted, colour in ((SNAP_STEP, GRID_FINE), (GRID_STEP, GRID)):
        spacing = grid_spacing(camera.zoom, wanted * scale)
        for low, high, vertical in ((x0, x1, True), (y0, y1, False)):
            for index in range(int(np.ceil(low / spacing)), int(np.floor(high / spacing)) + 1):
                at = camera.to_pixels((index * spacing, index * spacing))
                tone = GRID_AXIS if index == 0 else colour
                if vertical:
                    surface.fill(tone, (round(at[0]), top, 1, height))
                else:
                    surface.fill(tone, (left, round(at[1]), width, 1))


def hanging_springs(scene: Scene, particles: Mask) -> Mask:
    """Springs (m,) with an end at one of the particles (n,)."""
    held = particles | particles[scene.first_of_weld] if len(scene.welds) else particles
    return held[scene.particle_a] | held[scene.particle_b]
