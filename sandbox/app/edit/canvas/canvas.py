"""Painter of the scene that is edited: a layer that is kept while nothing changes, and what moves drawn over it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import NamedTuple, cast

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import GRID_STEP, Box, Camera, grid_spacing
from sandbox.app.draw.colours import (
    ACCENT,
    BACKGROUND,
    GRID,
    GRID_AXIS,
    GRID_FINE,
    HOVERED,
    PARTICLE,
    PINNED,
    WELD,
    Colour,
    Theme,
    mixed,
    packed,
    theme_now,
)
from sandbox.app.draw.lines import Canvas
from sandbox.app.draw.looks import material_colours
from sandbox.app.draw.raster.painter import Painter
from sandbox.app.draw.renderer import (
    CROWDED,
    DENSITY,
    PIN_RADIUS,
    SMALLEST_RADIUS,
    SPRING_WIDTH,
    THINNEST_SPRING,
)
from sandbox.app.draw.textures import Tiles
from sandbox.app.draw.things.drawables import Drawables
from sandbox.app.draw.things.level_slots import Frame, LevelSlots, Seen, level_slots_of
from sandbox.app.edit.canvas.edited_shapes import Areas, Ground, paint_ground, paint_walls, paint_zones
from sandbox.editor.items import Selection
from sandbox.editor.scene import Scene
from sandbox.level.format.limits import BODY_RADIUS
from sandbox.level.format.slices import work_for

# Distance of the points that the pointer snaps to, at least [pixels at scale 1].
SNAP_STEP = 16.0
# More particles and springs than this are drawn plainly while they change, and smoothly afterwards.
PLAIN_FROM = 6_000
OPAQUE = 255
# Lines of a grid that a person has set are drawn where they are this far apart [pixels at scale 1].
CLOSEST_LINES = 6.0
# What is only a preview is this much paler.
GHOST_SHARE = 0.45
HIGHLIGHT_WIDTH = 2.4
# A preview of more particles and springs shows its springs alone: it is another one with every move of the pointer.
GHOST_FILL = 600
# Springs and particles over what they look like are so much thinner.
FINE = 0.55
# Discs that are larger than this [pixels at scale 1] are not painted over.
LARGE = 9.0
# The smooth picture is made of this many springs or particles at a time, for so long [s] in every frame.
CHUNK = 2_000
SLICE = 0.006
# Particles that would be smaller than this [pixels] are left out of the plain picture.
SMALLEST_PLAIN = 1.0
Mask = NDArray[np.bool_]
# Scenes of more particles and springs than this show their springs alone: each edit makes all of it again.
MOST_FILLED = 4_000
# How much of it shows, of 255.
FILL_ALPHA = 190


@dataclass(frozen=True)
class Part:
    """Particles and springs of a scene to draw; tint: in place of their own colours; ghost: pale.

    is_filled: what they look like is drawn below them; they are thin, or where they have a tint large discs are rings.
    """

    scene: Scene
    particles: Mask
    springs: Mask
    tint: Colour | None = None
    ghost: bool = False
    is_filled: bool = False

    @property
    def thinness(self) -> float:
        """How thin they are beside what is drawn without fill."""
        return FINE if self.is_filled and self.tint is None else 1.0


class SelectionMasks(NamedTuple):
    """Which particles (n,), springs (m,) and items (k,) of a scene are selected; hidden: which of each are not drawn.

    A spring is hidden with either of its ends, too.
    """

    particles: Mask
    springs: Mask
    items: Mask
    hidden_particles: Mask
    hidden_springs: Mask
    hidden_items: Mask

    @classmethod
    def of(cls, scene: Scene, selection: Selection, hidden: Selection = frozenset()) -> "SelectionMasks":
        """The masks of a selection, which takes time where that is large."""
        chosen, away = scene.chosen(selection), scene.chosen(hidden)
        particles, springs = away[scene.particle_item], away[scene.spring_item]
        springs = springs | particles[scene.particle_a] | particles[scene.particle_b] if hidden else springs
        return cls(chosen[scene.particle_item], chosen[scene.spring_item], chosen, particles, springs, away)


class ScenePainter:
    """Draws scenes on a surface; `compiled`: whether kernels may be used; scale: pixels per layout unit."""

    def __init__(self, scale: float) -> None:
        self.scale = scale
        self.compiled = True
        # Whether springs and particles are drawn over what they look like.
        self.lattice = True
        # The distance [m] of grid lines; None: it goes by the zoom.
        self.grid_step: float | None = None
        self._fill, self._ghost_fill = FillPreview(), FillPreview()
        self._layer: pygame.Surface | None = None
        self._scene: Scene | None = None
        self._key: tuple[object, ...] = ()
        self._finer: pygame.Surface | None = None
        self._work: Iterator[None] | None = None

    @property
    def moves(self) -> bool:
        """Whether a smooth picture is being made."""
        return self._work is not None

    def draw(self, surface: pygame.Surface, camera: Camera, scene: Scene, chosen: SelectionMasks, hidden: bool) -> None:
        """Draw grid, scene and selection, from the layer that is kept where it still holds.

        hidden: the selection is left out, because it is drawn elsewhere while it moves. Of a large scene the first
        picture is plain; a smooth one is made in the frames that follow, and takes its place.
        """
        key = (
            camera.centre, camera.zoom, camera.viewport, self.scale, id(chosen.particles), hidden, self.compiled,
            self.lattice, self.grid_step,
        )  # fmt: skip
        if self._layer is None or scene is not self._scene or key != self._key:
            self._key, self._scene, self._chosen = key, scene, chosen
            is_large = len(scene.particle_a) + len(scene.position) > PLAIN_FROM
            self._layer = pygame.Surface(surface.get_size(), 0, 32)
            for _ in self._layer_work(self._layer, camera, scene, chosen, hidden, is_large):
                pass
            self._work = None
            if is_large and not hidden:
                self._finer = pygame.Surface(surface.get_size(), 0, 32)
                self._work = self._layer_work(self._finer, camera, scene, chosen, hidden, False)
        elif self._work is not None:
            self._refine()
        surface.blit(self._layer, camera.viewport[:2], camera.viewport)

    def _refine(self) -> None:
        """Go on with the smooth picture for a moment."""
        assert self._work is not None
        if work_for(self._work, SLICE):
            self._work, self._layer = None, self._finer

    def _layer_work(
        self, layer: pygame.Surface, camera: Camera, scene: Scene, chosen: SelectionMasks, hidden: bool, plain: bool
    ) -> Iterator[None]:
        # The clip holds while a slice is drawn, and nobody else draws on the layer.
        layer.set_clip(camera.viewport)
        layer.fill(BACKGROUND)
        draw_grid(layer, camera, self.scale, self.grid_step)
        particles, springs, items = chosen[:3]
        canvas = Canvas(layer, self.compiled)
        if scene.level.walls is not None:
            paint_walls(canvas, camera, scene.level.walls.box, self.scale)
        paint_zones(canvas, camera, Areas(scene, ~(items | chosen.hidden_items)), self.scale)
        paint_ground(canvas, camera, Ground(scene, ~(items | chosen.hidden_items)), self.scale)
        if not hidden:
            paint_zones(canvas, camera, Areas(scene, items, ACCENT), self.scale)
            paint_ground(canvas, camera, Ground(scene, items, ACCENT), self.scale)
        away = springs | hanging_springs(scene, particles) if hidden else springs
        # What moves is drawn elsewhere.
        shown = ~((particles & hidden) | chosen.hidden_particles), ~((away & hidden) | chosen.hidden_springs)
        alpha = FILL_ALPHA if self.lattice else OPAQUE
        is_filled = self._fill.paint(layer, camera, scene, *shown, self.scale, self.compiled, alpha)
        if self.lattice or not is_filled:
            others = Part(scene, shown[0] & ~particles, shown[1] & ~away, is_filled=is_filled)
            yield from self._slices(layer, camera, others, plain)
        if not hidden:
            yield from self._slices(layer, camera, Part(scene, particles, springs, ACCENT, is_filled=is_filled), plain)

    def paint_ghost(self, surface: pygame.Surface, camera: Camera, part: Part) -> None:
        """Draw a preview, pale, and where it is small as what it will be."""
        is_small = int(np.count_nonzero(part.particles) + np.count_nonzero(part.springs)) <= GHOST_FILL
        is_filled = is_small and self._ghost_fill.paint(
            surface, camera, part.scene, part.particles, part.springs, self.scale, self.compiled
        )
        self.paint(surface, camera, replace(part, ghost=True, is_filled=is_filled))

    def paint_moved(self, surface: pygame.Surface, camera: Camera, moved: Scene, chosen: SelectionMasks) -> None:
        """Draw the selection in a scene where it has been moved, and the springs of others that hang on it."""
        particles, springs, items = chosen[:3]
        self.paint_zones(surface, camera, Areas(moved, items, ACCENT))
        self.paint_ground(surface, camera, Ground(moved, items, ACCENT))
        nobody = np.zeros(len(particles), dtype=np.bool_)
        hanging = hanging_springs(moved, particles) & ~(springs | chosen.hidden_springs)
        self.paint(surface, camera, Part(moved, nobody, hanging))
        self.paint(surface, camera, Part(moved, particles, springs, ACCENT))

    def paint_hovered(self, surface: pygame.Surface, camera: Camera, scene: Scene, pointed: Selection) -> None:
        """Draw what a click would select, brighter; of large bodies only the springs."""
        particles, springs, items = SelectionMasks.of(scene, pointed)[:3]
        self.paint_zones(surface, camera, Areas(scene, items, HOVERED))
        self.paint_ground(surface, camera, Ground(scene, items, HOVERED))
        if np.count_nonzero(springs) > PLAIN_FROM:
            particles = np.zeros(len(particles), dtype=np.bool_)
        self.paint(surface, camera, Part(scene, particles, springs, HOVERED))

    def paint_ground(self, surface: pygame.Surface, camera: Camera, ground: Ground) -> None:
        """Draw terrain."""
        paint_ground(Canvas(surface, self.compiled), camera, ground, self.scale)

    def paint_zones(self, surface: pygame.Surface, camera: Camera, areas: Areas) -> None:
        """Shade zones."""
        paint_zones(Canvas(surface, self.compiled), camera, areas, self.scale)

    def paint_walls(self, surface: pygame.Surface, camera: Camera, box: Box, colour: Colour) -> None:
        """Draw walls."""
        paint_walls(Canvas(surface, self.compiled), camera, box, self.scale, colour)

    def paint(self, surface: pygame.Surface, camera: Camera, part: Part) -> None:
        """Draw a part of a scene, plainly where it is large."""
        for _ in self._slices(surface, camera, part, bool(np.count_nonzero(part.springs) > PLAIN_FROM)):
            pass

    def _slices(self, surface: pygame.Surface, camera: Camera, part: Part, plain: bool) -> Iterator[None]:
        """Draw a part, a slice at each turn."""
        scene, springs, particles = part.scene, np.flatnonzero(part.springs), np.flatnonzero(part.particles)
        canvas = Canvas(surface, self.compiled)
        pixels = camera.project(scene.position)
        colours = self._colours(part)[scene.material[springs]]
        ends = np.concatenate([pixels[scene.particle_a[springs]], pixels[scene.particle_b[springs]]], axis=1)
        if plain:
            canvas.plain_lines(np.ascontiguousarray(ends), colours)
        else:
            width = self._width(camera, scene.rest_length[springs]) * part.thinness
            passes = [(colours, width)]
            if part.tint is not None:
                under = np.full(len(springs), packed(mixed(BACKGROUND, part.tint, 0.55)))
                passes.insert(0, (under, width + HIGHLIGHT_WIDTH * self.scale))
            for tones, wide in passes:
                for start in range(0, len(springs), CHUNK):
                    stop = start + CHUNK
                    canvas.lines(np.ascontiguousarray(ends[start:stop]), tones[start:stop], wide)
                    yield
        crowded = self._radius(camera, part)
        if plain and len(springs) > PLAIN_FROM and crowded < SMALLEST_PLAIN:
            return
        for start in range(0, len(particles), CHUNK):
            self._paint_particles(canvas, camera, part, particles[start : start + CHUNK], pixels, crowded, plain)
            yield

    def _colours(self, part: Part) -> NDArray[np.int64]:
        """Colours (materials,) of the springs."""
        by_name = material_colours(part.scene.level.materials)
        fade = GHOST_SHARE if part.ghost else 0.0
        return np.array([packed(mixed(by_name[name], BACKGROUND, fade)) for name in part.scene.materials])

    def _width(self, camera: Camera, rest: NDArray[np.float64]) -> float:
        spacing = float(np.median(rest)) * camera.zoom if len(rest) else np.inf
        return float(np.clip(spacing * DENSITY, THINNEST_SPRING * self.scale, SPRING_WIDTH * self.scale))

    def _radius(self, camera: Camera, part: Part) -> float:
        """About how large [pixels] particles may be to leave room between them."""
        rest = part.scene.rest_length[part.springs]
        return float(np.median(rest)) * camera.zoom * CROWDED if len(rest) else np.inf

    def _paint_particles(
        self, canvas: Canvas, camera: Camera, part: Part, shown: NDArray[np.int64], pixels: NDArray[np.float64],
        crowded: float, plain: bool,
    ) -> None:  # fmt: skip
        scene, own = part.scene, part.scene.radius[shown]
        smallest = max(min(SMALLEST_RADIUS * self.scale, crowded), THINNEST_SPRING * self.scale)
        radii = np.maximum(own * camera.zoom, smallest)
        # Particles of the usual radius shrink with the mesh that they belong to, or it is a field of dots.
        radii = np.where(own <= BODY_RADIUS, np.minimum(radii, max(smallest, crowded)), radii)
        radii = radii * part.thinness
        is_large = (own > BODY_RADIUS) & (own * camera.zoom > LARGE * self.scale)
        if part.is_filled and is_large.any():
            self._paint_large(canvas, part, pixels[shown[is_large]], own[is_large] * camera.zoom, shown[is_large])
            shown, radii = shown[~is_large], radii[~is_large]
        centres = np.ascontiguousarray(pixels[shown])
        colour = mixed(PARTICLE, BACKGROUND, GHOST_SHARE) if part.ghost else PARTICLE
        if plain:
            canvas.discs(centres, radii, np.full(len(shown), packed(part.tint or colour)))
            return
        rim = np.minimum(1.4 * self.scale, radii * 0.6)
        canvas.discs(centres, radii + rim, np.full(len(shown), packed(part.tint or BACKGROUND)))
        canvas.discs(centres, radii, np.full(len(shown), packed(colour)))
        held = scene.pinned[shown]
        fade = GHOST_SHARE if part.ghost else 0.0
        self._paint_rings(canvas, centres[held], radii[held], mixed(PINNED, BACKGROUND, fade))
        if len(scene.welds):
            welded = np.isin(shown, scene.welds) & ~held
            self._paint_rings(canvas, centres[welded], radii[welded], mixed(WELD, BACKGROUND, fade))

    def _paint_large(
        self, canvas: Canvas, part: Part, centres: NDArray[np.float64], radii: NDArray[np.float64],
        slots: NDArray[np.int64],
    ) -> None:  # fmt: skip
        """Draw discs that are seen below as they are: a ring where they have a tint, and a small mark where pinned."""
        if part.tint is not None:
            for (x, y), radius in zip(centres.tolist(), radii.tolist(), strict=True):
                pygame.draw.aacircle(
                    canvas.surface, part.tint, (x, y), radius + 2.0 * self.scale, round(2.4 * self.scale)
                )
        held = part.scene.pinned[slots]
        small = np.full(int(held.sum()), PIN_RADIUS * self.scale * 0.6)
        self._paint_rings(canvas, np.ascontiguousarray(centres[held]), small, part.tint or PINNED)

    def _paint_rings(
        self, canvas: Canvas, centres: NDArray[np.float64], radii: NDArray[np.float64], colour: Colour
    ) -> None:
        size = np.maximum(radii + 2.0 * self.scale, PIN_RADIUS * self.scale)
        for extra, ring in ((0.0, colour), (-1.8 * self.scale, BACKGROUND), (-3.4 * self.scale, colour)):
            canvas.discs(centres, np.maximum(size + extra, 0.5), np.full(len(centres), packed(ring)))


def draw_grid(surface: pygame.Surface, camera: Camera, scale: float, step: float | None) -> None:
    """Draw the lines that the pointer snaps to, and brighter ones that the rulers name.

    step [m]: of the former; None, or what would be a grey field: by the zoom.
    """
    left, top, width, height = camera.viewport
    thick = max(1, round(scale))
    (x0, y1), (x1, y0) = camera.to_world((left, top)), camera.to_world((left + width, top + height))
    for least, colour in ((SNAP_STEP, GRID_FINE), (GRID_STEP, GRID)):
        spacing = grid_spacing(camera.zoom, least * scale)
        if step is not None and colour is GRID_FINE and step * camera.zoom >= CLOSEST_LINES * scale:
            spacing = step
        for low, high, vertical in ((x0, x1, True), (y0, y1, False)):
            for index in range(int(np.ceil(low / spacing)), int(np.floor(high / spacing)) + 1):
                at = camera.to_pixels((index * spacing, index * spacing))
                tone = GRID_AXIS if index == 0 else colour
                if vertical:
                    surface.fill(tone, (round(at[0]), top, thick, height))
                else:
                    surface.fill(tone, (left, round(at[1]), width, thick))


def moved_by(scene: Scene, chosen: SelectionMasks, matrix: NDArray[np.float64]) -> Scene:
    """The scene with its chosen particles moved by a matrix (2, 3)."""
    position = scene.position.copy()
    position[chosen.particles] = position[chosen.particles] @ matrix[:, :2].T + matrix[:, 2]
    position = position[scene.first_of_weld] if len(scene.welds) else position
    corner, corners = scene.corner.copy(), chosen.items[scene.corner_item]
    corner[corners] = corner[corners] @ matrix[:, :2].T + matrix[:, 2]
    return replace(scene, position=position, corner=corner)


def hanging_springs(scene: Scene, particles: Mask) -> Mask:
    """Springs (m,) with an end at one of the particles (n,)."""
    held = particles | particles[scene.first_of_weld] if len(scene.welds) else particles
    return held[scene.particle_a] | held[scene.particle_b]


class FillPreview:
    """Draws the bodies of a scene as play will show them."""

    def __init__(self) -> None:
        self._painter = Painter()
        self._tiles: tuple[Theme, Tiles] | None = None
        self._level_slots: tuple[Scene, LevelSlots] | None = None

    def paint(
        self, layer: pygame.Surface, camera: Camera, scene: Scene, particles: Mask, springs: Mask, scale: float,
        compiled: bool, alpha: int = FILL_ALPHA,
    ) -> bool:  # fmt: skip
        """Draw those particles (n,) and springs (m,) of a scene on a layer; whether that would not take too long."""
        if not 0 < len(scene.position) + len(scene.particle_a) <= MOST_FILLED:
            return False
        if self._level_slots is None or self._level_slots[0] is not scene:
            self._level_slots = (scene, level_slots_of(scene.level, is_welded=False))
        if self._tiles is None or self._tiles[0] is not theme_now():
            self._tiles = theme_now(), Tiles(theme_now())
        state = _filled_of(scene, particles, springs)
        upright, still = np.zeros(len(scene.position)), np.zeros(len(scene.particle_a))
        frame = Frame(state, camera.project(scene.position), upright, still, camera.zoom, scale, *self._tiles)
        picture = layer.copy()
        picture.set_clip(layer.get_clip())
        self._painter.compiled = compiled
        self._painter.begin(picture)
        drawables = Drawables(self._level_slots[1], state, particles, springs)
        drawables.soft.trace(self._painter, frame)
        drawables.draw(self._painter, frame, False)
        picture.set_alpha(alpha)
        layer.blit(picture, (0, 0))
        return True


def _filled_of(scene: Scene, particles: Mask, springs: Mask) -> Seen:
    """A scene as drawing reads a world's state."""
    state = SimpleNamespace(
        position=scene.position,
        velocity=np.zeros_like(scene.position),
        mass=scene.mass,
        inverse_mass=np.where(scene.pinned, 0.0, 1.0),
        radius=scene.radius,
        particle_active=particles,
        particle_a=scene.particle_a.astype(np.int32),
        particle_b=scene.particle_b.astype(np.int32),
        rest_length=scene.rest_length,
        stiffness=np.zeros_like(scene.rest_length),
        spring_active=springs,
    )
    return cast(Seen, state)
