"""LevelSlots: the slots of a world of each body, ball and loose spring of a level, and how each looks; made once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.looks import GRAINS, Look, ball_look, body_looks, is_filled, spring_look
from sandbox.app.draw.things.borders import sides_of, trace_loops
from sandbox.level.assembly.level_world import levels_of
from sandbox.level.document.model import Level
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.jelly import JellyDef
from sandbox.level.plan.plan import Plan, kept_plan
from sandbox.physics.components import label_bodies
from sandbox.physics.constraints import AREA
from sandbox.physics.keeping.equipment import Joined
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
Mask = NDArray[np.bool_]

Drawn = TypeVar("Drawn")

METALS = ("steel", "paint", "brass", "chain", "cable", "piston")


class Piece(NamedTuple):
    """A connected part of what is filled: triangles (t, 3) by index, loops of slots round them, springs (m,) inside."""

    left: Slots
    loops: list[Slots]
    inside: Mask


class Filling(NamedTuple):
    """What of a filled body is left: its pieces, the largest first, and the springs (m,) inside any of them.

    key: which springs and triangles were there, as bytes.
    """

    key: bytes
    pieces: list[Piece]
    inside: Mask


@dataclass(eq=False)
class Actor:
    """A body. slots (n,) of its particles; springs (m,) slots, pairs (m, 2) their ends by index, ends by slot.

    It keeps what takes long to find, since all bodies are gone through again where one is torn or another is added.
    """

    body: BodyDef
    look: Look
    made: Expansion[Any]
    slots: Slots
    springs: Slots
    pairs: Slots
    _filling: Filling | None = field(default=None, init=False)
    _flesh: tuple[bytes, Any] | None = field(default=None, init=False)
    _spot: tuple[Floats, float] | None = field(default=None, init=False)

    @property
    def ends(self) -> Slots:
        """Slots (m, 2) of the ends of its springs."""
        return self.slots[self.pairs]

    @property
    def is_filled(self) -> bool:
        """Whether it is filled with triangles."""
        return is_filled(self.body)

    @property
    def keeps_areas(self) -> bool:
        """Whether these triangles keep their areas; a jelly may have none that do."""
        return self.is_filled and bool(self.body.__dict__.get("area", True))

    @cached_property
    def cell(self) -> float:
        """A usual length [m] of its springs."""
        return float(np.median(self.made.rest_length)) if len(self.pairs) else 1.0

    @cached_property
    def angle(self) -> float:
        """How far [rad] it was turned when it was made."""
        return float(self.body.__dict__.get("angle", 0.0))

    @cached_property
    def form(self) -> Floats:
        """Places (n, 2) [m] of its particles about their middle, as it was made."""
        return np.asarray(self.made.form - self.made.form.mean(axis=0))

    def filling(self, there: Mask, whole: Slots | None = None) -> Filling:
        """What is left of it, where these springs (m,) are there.

        whole: triangles (t, 3) of the world that keep their areas, by slot. A body that keeps no areas, or of a world
        that says nothing of them, has a triangle while the springs along all its sides are there.
        """
        left = self._whole(there, whole)
        key = there.tobytes() + left.tobytes()
        if self._filling is None or self._filling.key != key:
            pieces = [self._piece(part, there) for part in _parts(left, self.pairs[there], len(self.slots))]
            inside = np.any([piece.inside for piece in pieces], axis=0) if pieces else np.zeros_like(there)
            self._filling = Filling(key, pieces, inside)
        return self._filling

    def _whole(self, there: Mask, whole: Slots | None) -> Slots:
        triangles = self.triangles()
        if there.all() and not self.body.cut:
            return triangles
        if whole is None or not self.keeps_areas:
            sides = sides_of(triangles, self.pairs)
            return np.asarray(triangles[((sides >= 0) & np.append(there, False)[sides]).all(axis=1)])
        index = np.full(max(int(whole.max(initial=0)), int(self.slots.max(initial=0))) + 1, -1)
        index[self.slots] = np.arange(len(self.slots))
        own = index[whole]
        return np.asarray(own[(own >= 0).all(axis=1)])

    def _piece(self, left: Slots, there: Mask) -> Piece:
        filled = np.zeros(len(self.slots), dtype=np.bool_)
        filled[left] = True
        loops = [self.slots[loop] for loop in trace_loops(left)]
        return Piece(left, loops, np.asarray(there & filled[self.pairs].all(axis=1)))

    def flesh(self, key: bytes, make: Callable[[], Drawn]) -> Drawn:
        """The drawing that `make` makes of it, kept while the key of its filling stays the same."""
        if self._flesh is None or self._flesh[0] != key:
            self._flesh = key, make()
        made: Drawn = self._flesh[1]
        return made

    def spot(self, find: Callable[["Actor", Slots], tuple[Floats, float]]) -> tuple[Floats, float]:
        """The place that `find` finds inside the longest loop of slots around all of it."""
        if self._spot is None:
            self._spot = find(self, self.slots[max(trace_loops(self.triangles()), key=len)])
        return self._spot

    def triangles(self) -> Slots:
        """Triangles (t, 3) of particles by index, that a jelly is filled with, whether or not they keep their area."""
        body = self.body
        made = self.made
        if isinstance(body, JellyDef) and not body.area:
            made = type(self.made)(replaced(body, area=True))
        found = made.polygons()
        return found if found.shape[1] == 3 else np.zeros((0, 3), dtype=np.int64)


def _parts(triangles: Slots, links: Slots, count: int) -> list[Slots]:
    """Triangles (t, 3) of `count` particles by what links (m, 2) join, the part of most triangles first."""
    label = np.arange(count)
    label_bodies(np.ascontiguousarray(links[:, 0]), np.ascontiguousarray(links[:, 1]), label)
    part = label[triangles[:, 0]]
    found = [triangles[part == each] for each in np.unique(part)]
    return sorted(found, key=len, reverse=True)


def whole_triangles(state: World | Snapshot) -> Slots:
    """The triangles (t, 3) of a world that keep their areas, by slot, counter-clockwise in their form."""
    chosen = state.constraint_active & (state.constraint_kind == AREA) & (state.constraint_corners == 3)
    first, turned = state.constraint_first[chosen], state.constraint_rest[chosen, 1] < 0.0
    corners = state.corner_particle[first[:, None] + np.arange(3)].astype(np.int64)
    corners[turned] = corners[turned][:, ::-1]
    return corners


@dataclass(eq=False)
class Ball:
    """A loose particle: its slot, what ball it is, its colour or None, the colour's number."""

    slot: int
    kind: str
    colour: int | None


@dataclass(eq=False)
class Join:
    """A loose spring: its slot, slots of its ends, its look."""

    spring: int
    ends: tuple[int, int]
    look: Look


@dataclass(eq=False)
class LevelSlots:
    """Everything in a level that can be seen; particles and springs: the slots that belong to its bodies and parts.

    strikes: by the spring's slot, as far as there are any, those that spark when they tear.
    """

    level: Level
    actors: list[Actor]
    balls: list[Ball]
    joins: list[Join]
    particles: Slots
    springs: Slots
    strikes: Mask


def level_slots_of(level: Level, is_welded: bool = True) -> LevelSlots:
    """The cast of a level; is_welded: particles that are one share a slot, as in a world, not as in the editor."""
    plan = kept_plan(level) or Plan(level)
    count = plan.layout.particle_count
    slots = np.arange(count, dtype=np.int64)
    if is_welded:
        stays = plan.first_of_weld == slots
        slots = (np.cumsum(stays) - 1)[plan.first_of_weld]
    actors, first, spring = [], 0, 0
    for body, look, made in zip(level.bodies, body_looks(level), plan.bodies, strict=True):
        size, pairs = made.form_count[0], made.pairs
        own = np.arange(spring, spring + len(pairs), dtype=np.int64)
        actors.append(Actor(body, look, made, slots[first : first + size], own, pairs))
        first, spring = first + size, spring + len(pairs)
    many = sum(not particle.pinned for particle in level.particles) > GRAINS
    balls = []
    for k, particle in enumerate(level.particles):
        kind, colour = ball_look(level, particle, k, many)
        balls.append(Ball(int(slots[first + k]), kind, colour))
    ends = slots[plan.spring_ends]
    joins = [
        Join(spring + k, (int(ends[k, 0]), int(ends[k, 1])), spring_look(level, one))
        for k, one in enumerate(level.springs)
    ]
    kinds = [(actor.look, len(actor.springs)) for actor in actors] + [(join.look, 1) for join in joins]
    sparks = [look.line in METALS and look.skin in ("", "steel wheel") for look, _ in kinds]
    strikes = np.repeat(np.array(sparks, dtype=np.bool_), [count for _, count in kinds])
    return LevelSlots(level, actors, balls, joins, np.unique(slots), np.arange(spring + len(joins)), strikes)


def joined_slots(level_slots: LevelSlots, joined: Sequence[Joined]) -> LevelSlots:
    """The cast of a level, or of one that bodies have joined while it ran, once these bodies have joined it as well."""
    actors, joins = list(level_slots.actors), list(level_slots.joins)
    particles, springs = [level_slots.particles], [level_slots.springs]
    for each in levels_of(joined):
        own, first, spring = level_slots_of(each.level), each.first_particle, each.first_spring
        actors += [replace(actor, slots=actor.slots + first, springs=actor.springs + spring) for actor in own.actors]
        joins += [
            Join(join.spring + spring, (join.ends[0] + first, join.ends[1] + first), join.look) for join in own.joins
        ]
        particles.append(own.particles + first)
        springs.append(own.springs + spring)
    return replace(
        level_slots, actors=actors, joins=joins, particles=np.concatenate(particles), springs=np.concatenate(springs)
    )
