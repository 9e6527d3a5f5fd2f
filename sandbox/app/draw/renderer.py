"""Renderer: draws the world between two snapshots; it reads and never writes. What is still or late is drawn less."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.base.loop import Profile
from sandbox.app.draw.backdrop import Backdrop, stage_picture
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import ACCENT, DANGER, THEMES, WARNING, Theme, packed, theme_now
from sandbox.app.draw.effects import Effects
from sandbox.app.draw.lines import Canvas
from sandbox.app.draw.overlays import DASHES, ZONES, Overlays, mark_zones, part_of, strain_place, strain_tones
from sandbox.app.draw.raster.painter import MarkList, Painter
from sandbox.app.draw.textures import Tiles
from sandbox.app.draw.things.belt_marks import BeltSide, body_belts, ground_belts, mark_belts
from sandbox.app.draw.things.drawables import Drawables, KeptDrawables, Shade
from sandbox.app.draw.things.level_slots import (
    Frame,
    strain_of,
)
from sandbox.app.draw.water import Pools
from sandbox.app.run.playback import interpolated
from sandbox.level.document.model import Level
from sandbox.physics.analysis.applied_forces import Pull
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.terrain import Terrain

# Sizes [pixels at scale 1]: springs, the smallest particle that can still be seen, and pins; what the editor draws.
SPRING_WIDTH = 2.2
SMALLEST_RADIUS = 2.6
PIN_RADIUS = 5.0
# A dense mesh seen from afar would be a solid block with full-width springs: they go down to this width.
THINNEST_SPRING = 0.9
# Width of springs and radius of particles, at most, as a part of the distance between particles.
DENSITY = 0.14
CROWDED = 0.19
# Where shadows fall [pixels at scale 1].
SHADOW = (4.0, 8.0)
# The lattice: half widths at rest and strained [pixels at scale 1]; more springs are lines of a pixel, with steps.
LATTICE_HALF, LATTICE_MORE, MOST_SMOOTH = 0.65, 1.0, 6_000
NODE = 2.2
# What things fade behind, and by how much: springs that are drawn by their force would be lost on their colours.
VEILING, VEIL = frozenset({"forces", "stability"}), 0.55
# Width of springs that are pointed at in a panel [layout units].
LIT_WIDTH = 2.6
# Overlays that may change while nothing moves.
CHANGING = frozenset({"contacts", "forces", "velocities", "stability"})


@dataclass
class Overlay:
    """What a person is doing, drawn over the world: the particle under the pointer, a cut [m], a cursor [m], pulls.

    ghost: lines [m] of what a click would do; is_refused: it would do nothing, as there is no room.
    lit (m,): springs that are pointed at in a panel.
    stability (m,): how near springs are to the limit of what is proven stable, 1 = at it; None = not known.
    """

    hovered: int | None = None
    trail: list[tuple[float, float]] = field(default_factory=list)
    cursor: tuple[float, float] | None = None
    pulls: list[Pull] = field(default_factory=list)
    ghost: list[list[tuple[float, float]]] = field(default_factory=list)
    is_refused: bool = False
    # And a picture of it, with the place of its middle [m].
    ghost_picture: tuple[pygame.Surface, tuple[float, float]] | None = None
    stability: NDArray[np.float64] | None = None
    # An earlier run at this tick, which is seen behind this one.
    earlier: Snapshot | None = None
    lit: NDArray[np.bool_] | None = None


class Renderer:
    """Draws on a surface; scale: pixels per layout unit; level: what it shows, None = springs and discs alone.

    lattice: whether springs are shown by their strain, in front of the things that they are; overlays: what else is
    shown over them; detail: see detail.py; has_effects: whether dust and sparks are wanted at all. non_finite:
    particles the last drawing had to leave out. compiled: whether kernels may be used.
    """

    def __init__(self, scale: float = 1.0, level: Level | None = None) -> None:
        self.scale = scale
        self.compiled = True
        self.overlays = Overlays()
        self.detail = FULL
        self.has_effects = True
        # Whether what lies behind all things is drawn.
        self.has_stage = True
        # Whether faces sleep, and what they look at while they rest [pixels].
        self.asleep = False
        self.pointer: tuple[float, float] | None = None
        self.non_finite = 0
        self.level = level
        self.follow_theme()
        self.effects = Effects()
        self._painter = Painter()
        self._backdrop = Backdrop()
        self._still = Still()
        self._pools = Pools(level)
        self._shade: Shade | None = None
        # The terrain that was drawn last, and how many there have been: arrays cannot be compared as a key is.
        self._ground: Terrain | None = None
        self._grounds = 0
        # Belts of terrain, and of bodies as long as these speeds are theirs.
        self._ground_belts: list[BeltSide] = []
        self._body_belts: list[BeltSide] = []
        self._belts: NDArray[np.float64] | None = None
        self._things: KeptDrawables | None = None
        self._tiles: tuple[str, Tiles] | None = None

    def follow_theme(self) -> None:
        """Draw in the level's theme, or else in the one that is shown now."""
        said = None if self.level is None or self.level.look is None else self.level.look.theme
        self.theme: Theme = theme_now() if said is None else THEMES[said]

    def alike(self, scale: float) -> "Renderer":
        """Another renderer with the same look at another scale, which has drawn nothing yet."""
        other = Renderer(scale, self.level)
        other.compiled, other.theme, other.overlays.shown = self.compiled, self.theme, set(self.overlays.shown)
        return other

    @property
    def lattice(self) -> bool:
        """Whether springs are drawn as lines, coloured by strain."""
        return "lattice" in self.overlays.shown

    @lattice.setter
    def lattice(self, is_shown: bool) -> None:
        (self.overlays.shown.add if is_shown else self.overlays.shown.discard)("lattice")

    def expect(self, camera: Camera) -> None:
        """Make what takes longest of the first picture of a view of this size."""
        width, height = camera.viewport[2:]
        stage_picture((width, height), self.theme)

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
        profile, overlay, painter = profile or Profile(), overlay or Overlay(), self._painter
        painter.compiled = self.compiled
        painter.begin(surface)
        with np.errstate(over="ignore", invalid="ignore"):
            position = interpolated(previous, current, alpha)
            pixels = camera.project(position)
            behind = (1.0 - alpha) / current.settings.tick_rate
            frame = Frame(
                current, pixels, current.angle - behind * current.spin, strain_of(current, position), camera.zoom,
                self.scale, self.theme, self._tiles_now(), (current.tick + alpha) / current.settings.tick_rate,
                self.asleep, self.pointer,
            )  # fmt: skip
            particles, springs = shown_particles(current), shown_springs(current)
            self.non_finite = int(np.count_nonzero(particles & ~np.isfinite(pixels).all(axis=1)))
            if self.level is not None:
                things = self._things = self._things or KeptDrawables(self.level)
                strikes = things.slots_of(current.equipment.joined).strikes
                self.effects.see(current, frame.seconds, strikes, self._pools.boxes)
            place = pygame.Rect(camera.viewport)
            self._follow(frame, current, camera, overlay)
            if self._still.show(surface, place):
                return
            if self.has_stage:
                with profile.part("stage"):
                    ground = current.terrain, self.level, self.theme, frame.tiles, self.scale
                    self._backdrop.draw(painter, camera, *ground)
                    at = camera.project(current.terrain.vertex)
                    self._draw_belts(self._ground_belts, at, frame, camera, springs)
            with profile.part("things"):
                if self.level is not None and self._things is not None:
                    self._draw_shade(self.level, frame, camera, overlay)
                    self._draw_things(self._things.of(current), frame, camera)
                self._draw_belts(self._body_belts, pixels, frame, camera, springs)
            self._draw_water(frame, current, camera)
            with profile.part("marks"):
                if self.lattice or self.level is None:
                    self._draw_lattice(frame, current, particles, springs)
                self._draw_held(frame, current, camera, overlay)
                if self.overlays.shown & VEILING:
                    self._backdrop.veil(painter, camera, VEIL)
                layer = MarkList()
                if ZONES in self.overlays.shown and self.level is not None:
                    mark_zones(layer, self.level.zones, camera, self.theme, self.scale)
                self.overlays.mark(layer, frame, current, camera, particles, springs, overlay.stability)
                painter.marks(layer, frame.tiles.array)
        if overlay.lit is not None:
            self._draw_lit(Canvas(surface, self.compiled), pixels, current, overlay.lit)
        self._draw_overlay(Canvas(surface, self.compiled), camera, pixels, overlay)
        self._still.keep(surface, place)

    def _draw_shade(self, level: Level, frame: Frame, camera: Camera, overlay: Overlay) -> None:
        if overlay.earlier is not None:
            self._shade = self._shade or Shade(level)
            self._shade.draw(self._painter, overlay.earlier, camera, self.theme, frame.tiles, self.scale)

    def _follow(self, frame: Frame, current: Snapshot, camera: Camera, overlay: Overlay) -> None:
        """Note what this picture is drawn from, so that one of the same need not be drawn again."""
        if current.terrain is not self._ground:
            self._ground, self._grounds = current.terrain, self._grounds + 1
            self._ground_belts = ground_belts(current.terrain)
        if current.belt is not self._belts:
            self._belts, self._body_belts = current.belt, body_belts(current)
        shown, drawables = self.overlays.shown, None if self._things is None else self._things.drawables
        belts = self._ground_belts or self._body_belts
        moves = not self.effects.is_at_rest or bool(belts or self._pools.flow)
        key = (
            (camera.centre, camera.zoom, camera.viewport, self.scale, self.theme.name, self.compiled, self.detail,
             self.has_effects, self.asleep, self.pointer),
            (overlay.hovered, tuple(overlay.trail), overlay.cursor, tuple(map(tuple, overlay.ghost)),
             overlay.is_refused, None if overlay.earlier is None else overlay.earlier.tick,
             None if overlay.ghost_picture is None else (id(overlay.ghost_picture[0]), overlay.ghost_picture[1]),
             b"" if overlay.lit is None else overlay.lit.tobytes()),
            tuple(pull.cursor for pull in overlay.pulls if pull.at_limit), frozenset(shown),
            self._grounds, (frame.seconds if moves else 0.0), (current.tick if shown & CHANGING else 0),
            current.particle_active.tobytes(), current.spring_active.tobytes(), (current.inverse_mass == 0.0).tobytes(),
            b"" if drawables is None else drawables.faces.blinks(frame.seconds).tobytes(),
        )  # fmt: skip
        numbers = [(frame.at, UNSEEN), (frame.angle, UNSEEN_TURN)]
        self._still.follow(key, [*numbers, (frame.strain, UNSEEN_STRAIN)] if self.lattice else numbers)

    def _tiles_now(self) -> Tiles:
        if self._tiles is None or self._tiles[0] != self.theme.name:
            self._tiles = self.theme.name, Tiles(self.theme)
        return self._tiles[1]

    def _draw_things(self, drawables: Drawables, frame: Frame, camera: Camera) -> None:
        painter = self._painter
        drawables.soft.trace(painter, frame)
        thrown, shapes = drawables.thrown(frame)
        offset = (SHADOW[0] * self.scale, SHADOW[1] * self.scale)
        if self.detail < NO_SHADOWS:
            painter.shadows(thrown, shapes, offset, packed(self.theme.shadow), self.theme.shadow_strength)
        if not self.lattice and self.detail < NO_EFFECTS and self.has_effects:
            dust = MarkList()
            self.effects.mark_dust(dust, camera, self.theme, self.scale)
            painter.marks(dust, frame.tiles.array)
        drawables.draw(painter, frame, self.lattice)

    def _draw_belts(
        self, belts: list[BeltSide], at: NDArray[np.float64], frame: Frame, camera: Camera, springs: NDArray[np.bool_]
    ) -> None:
        if belts:
            layer = MarkList()
            mark_belts(layer, belts, at, springs, camera, self.scale, frame.seconds, self.theme)
            self._painter.marks(layer, frame.tiles.array)

    def _draw_water(self, frame: Frame, current: Snapshot, camera: Camera) -> None:
        layer = MarkList()
        self._pools.draw(self._painter.surface, layer, camera, frame, current.terrain)
        if self.detail < NO_EFFECTS and self.has_effects:
            self.effects.mark_drops(layer, camera, self.theme, self.scale)
        self._painter.marks(layer, frame.tiles.array)

    def _draw_lattice(
        self, frame: Frame, state: Snapshot, particles: NDArray[np.bool_], springs: NDArray[np.bool_]
    ) -> None:
        chosen = np.flatnonzero(springs)
        pairs = np.stack([state.particle_a[chosen], state.particle_b[chosen]], axis=1).astype(np.int64)
        strain = frame.strain[chosen]
        place = np.abs(strain_place(strain))
        # What is strained most lies on top.
        order = np.argsort(place, kind="stable")
        ends, tones = frame.ends(pairs)[order], strain_tones(strain, self.theme.strain)[order]
        if len(chosen) > MOST_SMOOTH:
            Canvas(self._painter.surface, self.compiled).plain_lines(np.ascontiguousarray(ends), tones)
        else:
            layer = MarkList()
            half = (LATTICE_HALF + LATTICE_MORE * place[order]) * self.scale
            layer.strokes(ends, half, tones)
            yielded = self._yielded(state, chosen[order])
            for k in range(1, DASHES, 2):
                gaps = part_of(ends[yielded], k / DASHES, (k + 0.6) / DASHES)
                layer.strokes(gaps, half[yielded] + 0.3 * self.scale, packed(self.theme.card))
            if self.level is None:
                self._mark_nodes(layer, frame, particles)
            self._painter.marks(layer, frame.tiles.array)

    def _yielded(self, state: Snapshot, springs: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Which springs have another rest length than they were made with because they yielded."""
        if self.level is None:
            return np.zeros(len(springs), dtype=np.bool_)
        # As in a world: the material that needs no definition comes first.
        yields = np.array([False, *(each.yield_strain is not None for each in self.level.materials.values())])
        changed = state.rest_length[springs] != state.natural_length[springs]
        return changed & yields[np.clip(state.material[springs], 0, len(yields) - 1)]

    def _mark_nodes(self, layer: MarkList, frame: Frame, particles: NDArray[np.bool_]) -> None:
        at = frame.at[particles]
        radius = np.maximum(frame.state.radius[particles] * frame.zoom, NODE * self.scale)
        layer.discs(at, radius, packed(self.theme.strain[1]))

    def _draw_held(self, frame: Frame, current: Snapshot, camera: Camera, overlay: Overlay) -> None:
        """Draw pins, sparks, and a line from what is held to the cursor, of another colour where it pulls its most."""
        layer = MarkList()
        if self.lattice:
            self.effects.mark_breaks(layer, camera, self.theme, self.scale)
        elif self.detail < NO_EFFECTS and self.has_effects:
            self.effects.mark_sparks(layer, camera, self.scale)
        if self._things is not None and self._things.drawables is not None:
            self._things.drawables.balls.mark_pins(layer, frame)
        if current.grab_spring >= 0:
            hands = slice(current.grab_spring, current.grab_spring + 10)
            active = np.flatnonzero(current.spring_active[hands]) + current.grab_spring
            pairs = np.stack([current.particle_a[active], current.particle_b[active]], axis=1).astype(np.int64)
            strained = np.isin(pairs[:, 0], [pull.cursor for pull in overlay.pulls if pull.at_limit])
            colours = np.where(strained, packed(WARNING), packed(self.theme.accent))
            layer.strokes(frame.ends(pairs), 0.8 * self.scale, colours)
            for radius, colour in ((8.0, colours), (6.4, packed(self.theme.card)), (4.2, colours)):
                layer.discs(frame.at[pairs[:, 1]], radius * self.scale, colour)
        self._painter.marks(layer, frame.tiles.array)

    def _draw_lit(self, canvas: Canvas, pixels: NDArray[np.float64], current: Snapshot, lit: NDArray[np.bool_]) -> None:
        springs = np.flatnonzero(lit & current.spring_active)
        ends = np.concatenate([pixels[current.particle_a[springs]], pixels[current.particle_b[springs]]], axis=1)
        canvas.lines(np.ascontiguousarray(ends), np.full(len(ends), packed(ACCENT)), LIT_WIDTH * self.scale)

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
        if overlay.ghost_picture is not None:
            picture, place = overlay.ghost_picture
            surface.blit(picture, picture.get_rect(center=camera.to_pixels(place)))
        for line in overlay.ghost:
            points = camera.project(np.array(line))
            ends = np.ascontiguousarray(np.concatenate([points[:-1], points[1:]], axis=1))
            canvas.lines(ends, np.full(len(ends), packed(DANGER if overlay.is_refused else ACCENT)), 2.0 * scale)
        if overlay.cursor is not None:
            self._draw_cursor(canvas, camera.to_pixels(overlay.cursor))

    def _draw_cursor(self, canvas: Canvas, at: tuple[float, float]) -> None:
        x, y = at
        near, far = 5 * self.scale, 14 * self.scale
        ends = np.array(
            [[x - far, y, x - near, y], [x + near, y, x + far, y], [x, y - far, x, y - near], [x, y + near, x, y + far]]
        )
        canvas.lines(ends, np.full(4, packed(ACCENT)), 2.0 * self.scale)


Floats = NDArray[np.float64]

# Movements below this [pixels] are not seen, nor turns [rad], nor strains that differ by less.
UNSEEN, UNSEEN_TURN, UNSEEN_STRAIN = 0.08, 0.01, 1e-3


class Still:
    """Keeps a picture once two in a row were drawn from the same values."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._numbers: list[tuple[Floats, float]] = []
        self._picture: pygame.Surface | None = None
        self._is_same = False

    def follow(self, key: tuple[object, ...], numbers: Sequence[tuple[Floats, float]]) -> None:
        """Take in what the next picture is drawn from.

        key: what must be equal; numbers: arrays, each with how far its values may go from those of the picture.
        """
        self._is_same = (
            key == self._key
            and len(numbers) == len(self._numbers)
            and all(_is_near(new, old, most) for (new, most), (old, _) in zip(numbers, self._numbers, strict=True))
        )
        if not self._is_same:
            self._key, self._numbers, self._picture = key, [(values.copy(), most) for values, most in numbers], None

    def show(self, surface: pygame.Surface, place: pygame.Rect) -> bool:
        """Show the kept picture, if there is one; whether it did."""
        if not self._is_same or self._picture is None:
            return False
        surface.blit(self._picture, place)
        return True

    def keep(self, surface: pygame.Surface, place: pygame.Rect) -> None:
        """Keep the picture that was drawn, if it and the one before were drawn from the same values."""
        if self._is_same:
            self._picture = pygame.Surface(place.size, 0, surface)
            self._picture.blit(surface, (0, 0), place)


def _is_near(new: Floats, old: Floats, most: float) -> bool:
    if len(new) != len(old):
        return False
    with np.errstate(invalid="ignore"):
        return bool(((np.abs(new - old) <= most) | (new == old) | (np.isnan(new) & np.isnan(old))).all())


# Frames that take longer than this [s] are late: 50 of them in a second.
LATE = 0.020
# Of this many frames in a row, this many must be late before less is drawn.
FRAMES, MOST_LATE = 30, 15
# After this many frames in time more is tried; where that is late at once, only after twice as many, up to the last.
TRY_AFTER, TRY_AT_LAST = 240, 3840
# What is left out, in this order.
FULL, NO_SHADOWS, NO_EFFECTS = range(3)


class Detail:
    """The level of detail of a screen: FULL, then without shadows, then without dust and sparks as well."""

    def __init__(self) -> None:
        self.level = FULL
        self._frames = self._late = self._in_time = 0
        self._wait = TRY_AFTER
        self._is_trial = False

    def note(self, frame_time: float) -> None:
        """Take into account that a frame came so long [s] after the one before."""
        is_late = frame_time > LATE
        self._frames += 1
        self._late += is_late
        self._in_time = 0 if is_late else self._in_time + 1
        if self._frames >= FRAMES:
            if self._late >= MOST_LATE:
                self._draw_less()
            elif self._is_trial and self.level == FULL:
                self._wait, self._is_trial = TRY_AFTER, False
            self._frames = self._late = 0
        if self.level > FULL and self._in_time >= self._wait:
            self.level -= 1
            self._is_trial = True
            self._frames = self._late = self._in_time = 0

    def _draw_less(self) -> None:
        if self._is_trial:
            self._wait, self._is_trial = min(2 * self._wait, TRY_AT_LAST), False
        self.level = min(self.level + 1, NO_EFFECTS)
        self._in_time = 0
