"""Drawables: groups the slots of a world into what is drawn; made again where something breaks or joins."""

from itertools import pairwise

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import Theme, dark_edge, outline_of
from sandbox.app.draw.looks import SOFT_SKINS, STRANDS, added_spring_look
from sandbox.app.draw.raster.bodies import Outlines
from sandbox.app.draw.raster.painter import MarkList, Painter
from sandbox.app.draw.raster.pixels import FAR
from sandbox.app.draw.raster.shadows import Thrown
from sandbox.app.draw.textures import Tiles
from sandbox.app.draw.things.faces import DrawnFace, Faces, faces_of
from sandbox.app.draw.things.level_slots import (
    Actor,
    Frame,
    Join,
    LevelSlots,
    Piece,
    Seen,
    grown_slots,
    hull_of,
    joined_slots,
    level_slots_of,
    whole_triangles,
)
from sandbox.app.draw.things.members import Members, Strands, Working
from sandbox.app.draw.things.soft import Shape, Sheets, Soft, shape_of, shapes_of
from sandbox.app.draw.things.wheels import Balls, DrawnWheel
from sandbox.app.draw.things.worn import WORN, Worn, round_of, worn_shape
from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.keeping.equipment import Joined
from sandbox.physics.snapshot import Snapshot

Mask = NDArray[np.bool_]
Slots = NDArray[np.int64]


class Drawables:
    """All things of a world whose particles (n,) and springs (m,) are there; whole: see Actor.filling."""

    def __init__(
        self, level_slots: LevelSlots, state: Seen, particles: Mask, springs: Mask, whole: Slots | None = None
    ) -> None:  # fmt: skip
        self._state, self._whole = state, whole
        self._triangles: dict[int, tuple[Slots, Slots]] = {}
        self.members, self.strands, self.sheets = Members(), Strands(), Sheets()
        self.wheels: list[DrawnWheel] = []
        self._balloons: list[tuple[int, Actor]] = []
        # Pictures that are worn, and by which shapes.
        self._worn: list[tuple[int, Worn]] = []
        self._shapes: list[Shape] = []
        self._faces: list[DrawnFace] = []
        self._ends = np.stack([state.particle_a, state.particle_b], axis=1).astype(np.int64)
        # Springs that commands added, as far as they do not go on with a strand.
        self._added = _strangers(springs, level_slots.springs)
        joins = [join for join in level_slots.joins if springs[join.spring]]
        for actor in level_slots.actors:
            there = springs[actor.springs]
            joins += self._add(actor, there)
        ends = self._ends
        self._add_joins(joins + self._added_joins(), ends)
        self.balls = Balls(level_slots, state, _strangers(particles, level_slots.particles))
        self.faces = Faces(self._faces)
        self._hems = [Shape([loop], CLOTH, 0, -1, rounds=0, line=False) for loop in self.sheets.outlines()]
        self.soft = Soft(self._shapes + self._hems)
        self._tied = np.bincount(ends[springs].reshape(-1), minlength=len(particles))

    def _radius(self, actor: Actor) -> float:
        return float(np.median(self._state.radius[actor.slots]))

    def _add(self, actor: Actor, there: Mask) -> list[Join]:
        """Make a thing of a body whose springs are there (m,); its springs that are drawn one by one are given back."""
        look, kind = actor.look, actor.body.type
        if look.skin != "lattice":
            if actor.is_filled:
                return self._add_filled(actor, there)
            if look.picture is not None and self._wear_round(actor, there):
                return []
            if kind == "ring" and there.all() and len(there) == len(actor.slots):
                self._balloons += [(len(self._shapes), actor)] if look.skin == "balloon" else []
                self._shapes.append(shape_of(actor, [actor.slots], there, self._radius(actor)))
                return []
            if kind == "wheel" and look.skin and DrawnWheel.is_whole(actor, there):
                self.wheels.append(DrawnWheel(actor, there, self._radius(actor)))
                self._shapes.append(self.wheels[-1].shape)
                return []
            if look.panel is not None:
                hull = hull_of(actor.made.form, actor.pairs[there])
                if len(hull):
                    self._add_panel(actor, hull)
                    return []
        return self._add_lines(actor, there)

    def _wear_round(self, actor: Actor, there: Mask) -> bool:
        """Let a ring or a wheel wear its picture; whether it is one, and whole."""
        around = round_of(actor, there)
        if around is None:
            return False
        radius, (triangles, loops) = self._radius(actor), around
        self._worn.append((len(self._shapes), Worn.on(actor, triangles, loops, radius)))
        self._shapes.append(worn_shape(actor, loops, radius))
        return True

    def _add_panel(self, actor: Actor, hull: Slots) -> None:
        look = actor.look
        assert look.panel is not None
        self._shapes.append(Shape([actor.slots[hull]], "rubber", look.panel, 0, extra=PANEL_OUT, keep=0.2))
        window = [k for k in look.window if k < len(actor.slots)]
        if len(window) > 2:
            loop = actor.slots[np.array(window)]
            self._shapes.append(Shape([loop], "window", WINDOW, 0, extra=WINDOW_IN, keep=0.2))

    def _add_lines(self, actor: Actor, there: Mask) -> list[Join]:
        look = actor.look
        if look.line in STRANDS:
            tails = self._tails(actor, there)
            ends, springs = np.r_[actor.ends[there], self._ends[tails]], np.r_[actor.springs[there], tails]
            rest = np.r_[actor.made.rest_length[there], self._state.rest_length[tails]]
            self.strands.add(look, ends, springs, rest)
        elif look.line in WORKING:
            rows = zip(actor.springs[there].tolist(), actor.ends[there].tolist(), strict=True)
            return [Join(spring, (a, b), look) for spring, (a, b) in rows]
        else:
            self.members.add_actor(actor, there)
        return []

    def _tails(self, actor: Actor, there: Mask) -> Slots:
        """Springs that commands tied a strand by: they go on from its tips, and are as long as its own."""
        own, count = np.unique(actor.ends[there], return_counts=True)
        added, rest = self._added, self._state.rest_length[self._added]
        goes_on = np.isin(self._ends[added], own[count == 1]).any(axis=1)
        is_tail = goes_on & (np.abs(rest - actor.cell) <= AS_LONG * actor.cell)
        self._added = added[~is_tail]
        return np.asarray(added[is_tail])

    def _added_joins(self) -> list[Join]:
        stiffness = self._state.stiffness[self._added].tolist()
        rows = zip(self._added.tolist(), self._ends[self._added].tolist(), stiffness, strict=True)
        return [Join(spring, (a, b), added_spring_look(firm)) for spring, (a, b), firm in rows]

    def _add_filled(self, actor: Actor, there: Mask) -> list[Join]:
        look, filling = actor.look, actor.filling(there, self._whole)
        shapes, faces, worn = actor.cached(filling.key, lambda: self._skin(actor, filling.pieces))
        self._worn += enumerate(worn, len(self._shapes))
        self._shapes += shapes
        self._faces += faces
        if not worn and (look.skin == CLOTH or look.skin in CRATES):
            for piece in filling.pieces:
                self.sheets.add(actor, piece.left, piece.loops, there)
        own = actor.own or actor
        bare = (there & ~filling.inside)[: len(own.springs)]
        return self._add_lines(own, bare) if bare.any() else []

    def _skin(self, actor: Actor, pieces: list[Piece]) -> tuple[list[Shape], list[DrawnFace], list[Worn]]:
        look, radius = actor.look, self._radius(actor)
        faces = faces_of(actor, pieces) if look.face and look.skin in SOFT_SKINS and pieces else []
        if look.picture is None:
            return shapes_of(actor, pieces, radius) if look.skin != CLOTH else [], faces, []
        shapes = [worn_shape(actor, piece.loops, radius) for piece in pieces]
        state = self._state
        origin = state.origin[actor.slots] if isinstance(state, Snapshot) else None
        return shapes, faces, [Worn.on(actor, piece.left, piece.loops, radius, origin) for piece in pieces]

    def _add_joins(self, joins: list[Join], ends: Slots) -> None:
        self.working = Working([join for join in joins if join.look.line in WORKING])
        rest = self._state.rest_length
        groups: dict[object, list[Join]] = {}
        for join in joins:
            groups.setdefault(join.look, []).append(join)
        for own in groups.values():
            look, springs = own[0].look, np.array([join.spring for join in own], dtype=np.int64)
            pairs = np.array([join.ends for join in own], dtype=np.int64)
            if look.line in STRANDS:
                self.strands.add(look, pairs, springs, rest[springs])
            elif look.line not in (*WORKING, "hidden"):
                self.members.add_joins(look, pairs, springs, rest[springs])

    # What is drawn of them, layer by layer.

    def thrown(self, frame: Frame) -> tuple[Thrown, Outlines]:
        """Shapes that throw shadows, once outlines are traced."""
        lines = np.concatenate([part.thrown(frame) for part in (self.members, self.strands, self.working)])
        return Thrown(np.ascontiguousarray(lines), np.ascontiguousarray(self.balls.thrown(frame))), self.soft.outlines

    def draw(self, painter: Painter, frame: Frame, is_lattice: bool) -> None:
        """Draw everything but balls and pins, from the back to the front; outlines are traced."""
        back = MarkList()
        self.working.mark(back, frame)
        self.strands.mark(back, frame)
        self.members.mark(back, frame)
        for wheel in self.wheels:
            wheel.mark_lugs(back, frame)
        painter.marks(back, frame.tiles.array)
        self._draw_layer(painter, frame, 0, is_lattice)
        if self.sheets:
            painter.cells(self.sheets.arrays(frame), self.sheets.pictures)
        middle = MarkList()
        self.sheets.mark_hems(middle, frame)
        self._mark_crates(middle, frame)
        for wheel in self.wheels:
            wheel.mark(middle, frame)
        painter.marks(middle, frame.tiles.array)
        self._draw_worn(painter, frame, is_lattice)
        self._draw_layer(painter, frame, 1, is_lattice)
        front = MarkList()
        if not is_lattice:
            self._mark_balloons(front, frame)
            self.faces.mark(front, frame)
        self.balls.mark(front, frame)
        painter.marks(front, frame.tiles.array)

    def _draw_worn(self, painter: Painter, frame: Frame, is_lattice: bool) -> None:
        if is_lattice or not painter.exact:
            self._draw_layer(painter, frame, WORN, is_lattice)
            return
        for k, worn in self._worn:
            painter.cut_out(self.soft.outlines_of(k), worn.colour, *worn.cells(frame))

    def _draw_layer(self, painter: Painter, frame: Frame, number: int, is_lattice: bool) -> None:
        layer = self.soft.layer(number, frame, is_lattice)
        if layer is not None:
            painter.bodies(layer)

    def _mark_crates(self, marks: MarkList, frame: Frame) -> None:
        for k, shape in enumerate(self.soft.shapes):
            if shape.skin in CRATES:
                marks.strokes(self.soft.lines_of(k), CRATE_LINE * frame.scale, dark_edge(shape.colour))

    def _mark_balloons(self, marks: MarkList, frame: Frame) -> None:
        """Gleams that stay where the light is, and a knot where something is tied."""
        for k, actor in self._balloons:
            points = self.soft.lines_of(k)[:, :2]
            centre, radius = points.mean(axis=0), 0.5 * self.soft.size_of(k)
            if not np.isfinite(radius) or radius > 1e5:
                continue
            gleams = centre + radius * np.array([[-0.34, -0.42], [-0.42, -0.44], [-0.20, -0.56], [0.34, 0.5]])
            sizes = radius * np.array([0.46, 0.17, 0.09, 0.4])
            marks.discs(gleams, sizes, 0xFFFFFF, np.array([0.45, 0.85, 0.8, 0.16]), glow=True)
            for slot in actor.slots[self._tied[actor.slots] > 2].tolist():
                out = frame.at[slot] - centre
                out = out / max(float(np.hypot(*out)), 1e-9)
                side = np.array([-out[1], out[0]])
                tips = [frame.at[slot] + radius * (0.15 * out + by * side) for by in (-0.07, 0.0, 0.07)]
                ends = np.array([[*frame.at[slot], *tip] for tip in tips])
                marks.strokes(ends, max(1.2, 0.03 * radius), outline_of(actor.look.colour))


Floats = NDArray[np.float64]

WORKING = ("coil", "muscle", "piston")
CLOTH = "cloth"
CRATES = ("wood", "stone", "brick")
WINDOW = 0xBFE6FF
# How far a panel stands out beyond its bars, and a window back from its corners [pixels at scale 1].
PANEL_OUT, WINDOW_IN = 4.0, -3.0
CRATE_LINE = 1.6
# Lengths that differ by this part are the same.
AS_LONG = 1e-3


def _strangers(there: Mask, own: Slots) -> Slots:
    """Slots that are there and belong to none of the level's things."""
    strangers = there.copy()
    strangers[own[own < len(strangers)]] = False
    return np.flatnonzero(strangers)


class KeptDrawables:
    """What is drawn of states of a level; drawables: of the last one, as long as nothing breaks or joins."""

    def __init__(self, level: Level) -> None:
        self._own = self._level_slots = level_slots_of(level)
        self._joined: tuple[Joined, ...] = ()
        self._key: tuple[Mask, ...] = ()
        self.drawables: Drawables | None = None

    def slots_of(self, joined: tuple[Joined, ...]) -> LevelSlots:
        """Slots of the level's things and of those that joined it."""
        if joined is not self._joined:
            # Bodies that were there go on as they are.
            goes_on = joined[: len(self._joined)] == self._joined
            present = self._level_slots if goes_on else self._own
            self._level_slots = joined_slots(present, joined[len(self._joined) if goes_on else 0 :])
            self._joined, self.drawables = joined, None
        return self._level_slots

    def of(self, state: Snapshot) -> Drawables:
        """The drawables of a state."""
        slots = self.slots_of(state.equipment.joined)
        key = shown_particles(state), shown_springs(state), state.inverse_mass == 0.0
        is_same = len(self._key) == 3 and all(map(np.array_equal, key, self._key))
        if self.drawables is None or not is_same:
            slots = grown_slots(slots, state)
            self.drawables, self._key = Drawables(slots, state, *key[:2], whole_triangles(state)), key
        return self.drawables


# How much of it is seen, 0..255.
OPACITY = 84
# Of lines and discs that would be thinner than this half width nothing would be seen [pixels].
LEAST_HALF = 1.0


class Shade:
    """Draws states of one run of a level, one after the other."""

    def __init__(self, level: Level) -> None:
        self._things = KeptDrawables(level)
        self._layer: pygame.Surface | None = None

    def draw(
        self, painter: Painter, state: Snapshot, camera: Camera, theme: Theme, tiles: Tiles, scale: float
    ) -> None:  # fmt: skip
        """Draw a state on the painter's surface; scale: pixels per layout unit."""
        at = camera.project(state.position)
        frame = Frame(state, at, state.angle, np.zeros(len(state.rest_length)), camera.zoom, scale, theme, tiles)
        drawables = self._things.of(state)
        drawables.soft.trace(painter, frame)
        thrown, outlines = drawables.thrown(frame)
        layer, size = self._layer, painter.surface.get_size()
        if layer is None or layer.get_size() != size:
            layer = self._layer = pygame.Surface(size, pygame.SRCALPHA)
        layer.fill((0, 0, 0, 0))
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
