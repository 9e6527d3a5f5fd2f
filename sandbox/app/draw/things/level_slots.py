"""What things are drawn from: the slots and looks of each body, ball and spring; a frame; borders of what is filled."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.colours import Theme, packed
from sandbox.app.draw.looks import GRAINS, Look, ball_look, body_looks, is_filled, spring_look
from sandbox.app.draw.textures import Tiles
from sandbox.level.assembly.build_world import levels_of
from sandbox.level.document.model import Level
from sandbox.level.format.picture import Picture
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.geometry import pair_keys
from sandbox.level.kinds.jelly import JellyDef
from sandbox.level.plan.plan import Plan, kept_plan
from sandbox.level.reading.pictures import pictures_of
from sandbox.physics.components import label_bodies
from sandbox.physics.constraints import AREA
from sandbox.physics.keeping.equipment import Joined
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Strain from which it shows as a flush, and how much more of it shows fully.
FLUSH_FROM, FLUSH_RANGE = 0.03, 0.22


class Seen(Protocol):
    """The arrays of a world's state that drawing reads."""

    position: Floats
    velocity: Floats
    mass: Floats
    inverse_mass: Floats
    radius: Floats
    particle_active: Mask
    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    stiffness: Floats
    spring_active: Mask


@dataclass(frozen=True, eq=False)
class Frame:
    """One picture of a state.

    at (n, 2) [pixels], angle (n,) [rad] by which particles have turned, strain (m,); zoom [pixels/m], scale [pixels a
    layout unit]; seconds: time of the picture; asleep: faces have their eyes shut; pointer [pixels]: what those look at
    that rest, None = straight ahead.
    """

    state: Seen
    at: Floats
    angle: Floats
    strain: Floats
    zoom: float
    scale: float
    theme: Theme
    tiles: Tiles
    seconds: float = 0.0
    asleep: bool = False
    pointer: tuple[float, float] | None = None

    def ends(self, pairs: NDArray[np.int64]) -> Floats:
        """Lines (m, 4) [pixels] between pairs of particles."""
        return self.at[pairs].reshape(-1, 4)

    def flush(self, springs: NDArray[np.int64]) -> tuple[NDArray[np.int64], Floats]:
        """Colours of strain of springs, and how much of them shows, 0..1."""
        strain = np.nan_to_num(self.strain[springs], nan=0.0, posinf=9.0, neginf=-9.0)
        squeezed, _, stretched = map(packed, self.theme.strain)
        opacity = np.clip((np.abs(strain) - FLUSH_FROM) / FLUSH_RANGE, 0.0, 1.0)
        return np.where(strain > 0.0, stretched, squeezed), 0.7 * opacity


def strain_of(state: Seen, position: Floats) -> Floats:
    """Signed strain (m,) of springs between particles at (n, 2) [m]; 0 where inactive or of rest length 0."""
    apart = position[state.particle_b] - position[state.particle_a]
    length = np.sqrt(apart[:, 0] * apart[:, 0] + apart[:, 1] * apart[:, 1])
    counted = state.spring_active & (state.rest_length > 0.0)
    return np.divide(length - state.rest_length, state.rest_length, out=np.zeros_like(length), where=counted)


Drawn = TypeVar("Drawn")

METALS = ("steel", "paint", "brass", "chain", "cable", "piston")


class Piece(NamedTuple):
    """A connected part of what is filled: triangles (t, 3) by index, loops of slots round them, springs (m,) inside."""

    left: Slots
    loops: list[Slots]
    inside: Mask


class Filling(NamedTuple):
    """The rest of a filled body: its pieces, the largest first, and the springs (m,) inside any of them.

    key: which springs and triangles were there, as bytes.
    """

    key: bytes
    pieces: list[Piece]
    inside: Mask


@dataclass(eq=False)
class Actor:
    """A body. slots (n,) of its particles; springs (m,) slots, pairs (m, 2) their ends by index, ends by slot.

    own: the body without what cuts have added, None: nothing; added (k, 2): places of that when the body was made [m].
    It keeps what takes long to find, since all bodies are gone through again where one is torn or another is added.
    """

    body: BodyDef
    look: Look
    made: Expansion[Any]
    slots: Slots
    springs: Slots
    pairs: Slots
    own: "Actor | None" = None
    added: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    _filling: Filling | None = field(default=None, init=False)
    _cached: tuple[bytes, Any] | None = field(default=None, init=False)
    _spot: tuple[Floats, float] | None = field(default=None, init=False)

    @property
    def ends(self) -> Slots:
        """Slots (m, 2) of the ends of the body's springs."""
        return self.slots[self.pairs]

    @property
    def is_filled(self) -> bool:
        """Whether the body is filled with triangles."""
        return is_filled(self.body)

    @property
    def keeps_areas(self) -> bool:
        """Whether these triangles keep their areas; a jelly may have none that do."""
        return self.is_filled and bool(self.body.__dict__.get("area", True))

    @cached_property
    def cell(self) -> float:
        """A usual length [m] of the body's springs."""
        return float(np.median(self.made.rest_length)) if len(self.pairs) else 1.0

    @cached_property
    def angle(self) -> float:
        """The angle [rad] that the body had when it was made."""
        return float(self.body.__dict__.get("angle", 0.0))

    @cached_property
    def form(self) -> Floats:
        """Places (n, 2) [m] of its particles about their middle, as it was made."""
        return np.concatenate([self.made.form, self.added]) - self.made.form.mean(axis=0)

    @property
    def local_form(self) -> Floats:
        """Places (n, 2) [m] of its particles as its description has them."""
        local = self.made.local_form[0]
        return np.concatenate([local, self.added - self.made.form[:1] + local[:1]])

    def grown(self, state: Snapshot, split: Slots) -> "Actor":
        """The body with what cuts have added: springs (k,) are those of them that are there, of any body."""
        ends = np.stack([state.particle_a[split], state.particle_b[split]], axis=1).astype(np.int64)
        is_own = np.isin(ends, np.r_[self.slots, np.flatnonzero(np.isin(state.split_from, self.slots))]).all(axis=1)
        if not is_own.any():
            return self
        ends, springs = ends[is_own], split[is_own]
        slots = np.r_[self.slots, np.setdiff1d(ends, self.slots)]
        order = np.argsort(slots, kind="stable")
        pairs = order[np.searchsorted(slots[order], ends)]
        added = state.origin[slots[len(self.slots) :]]
        springs, pairs = np.r_[self.springs, springs], np.concatenate([self.pairs, pairs])
        return replace(self, slots=slots, springs=springs, pairs=pairs, own=self, added=added)

    def filling(self, there: Mask, whole: Slots | None = None) -> Filling:
        """The rest of the body's filling, where these springs (m,) are there.

        whole: triangles (t, 3) of the world that keep their areas, by slot. A body that keeps no areas, or of a world
        that says nothing of them, has a triangle while the springs along all its sides are there.
        """
        filled = self._whole(there, whole)
        key = there.tobytes() + filled.tobytes()
        if self._filling is None or self._filling.key != key:
            pieces = [self._piece(part, there) for part in _parts(filled, self.pairs[there], len(self.slots))]
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

    def _piece(self, members: Slots, there: Mask) -> Piece:
        filled = np.zeros(len(self.slots), dtype=np.bool_)
        filled[members] = True
        loops = [self.slots[loop] for loop in trace_loops(members)]
        return Piece(members, loops, np.asarray(there & filled[self.pairs].all(axis=1)))

    def cached(self, key: bytes, make: Callable[[], Drawn]) -> Drawn:
        """The drawing that `make` makes of it, kept while the key of its filling stays the same."""
        if self._cached is None or self._cached[0] != key:
            self._cached = key, make()
        made: Drawn = self._cached[1]
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


def level_slots_of(
    level: Level, is_welded: bool = True, pictures: Mapping[str, Picture] | None = None
) -> LevelSlots:  # fmt: skip
    """The cast of a level; is_welded: particles that are one share a slot, as in a world, not as in the editor.

    pictures: see body_looks.
    """
    plan = kept_plan(level) or Plan(level)
    count = plan.layout.particle_count
    slots = np.arange(count, dtype=np.int64)
    if is_welded:
        stays = plan.first_of_weld == slots
        slots = (np.cumsum(stays) - 1)[plan.first_of_weld]
    actors, first, spring = [], 0, 0
    for body, look, made in zip(level.bodies, body_looks(level, pictures), plan.bodies, strict=True):
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
    particles, springs, pictures = [level_slots.particles], [level_slots.springs], pictures_of(level_slots.level)
    for each in levels_of(joined):
        own, first, spring = level_slots_of(each.level, pictures=pictures), each.first_particle, each.first_spring
        actors += [replace(actor, slots=actor.slots + first, springs=actor.springs + spring) for actor in own.actors]
        joins += [
            Join(join.spring + spring, (join.ends[0] + first, join.ends[1] + first), join.look) for join in own.joins
        ]
        particles.append(own.particles + first)
        springs.append(own.springs + spring)
    return replace(
        level_slots, actors=actors, joins=joins, particles=np.concatenate(particles), springs=np.concatenate(springs)
    )


def grown_slots(level_slots: LevelSlots, state: Snapshot) -> LevelSlots:
    """The cast of a level with what cuts have added to its bodies."""
    split = np.flatnonzero(state.is_split & state.spring_active)
    if not len(split):
        return level_slots
    actors = [actor.grown(state, split) if actor.is_filled else actor for actor in level_slots.actors]
    particles, springs = (
        np.unique(np.concatenate([getattr(level_slots, name), *(getattr(actor, each) for actor in actors)]))
        for name, each in (("particles", "slots"), ("springs", "springs"))
    )
    return replace(level_slots, actors=actors, particles=particles, springs=springs)


def sides_of(triangles: Slots, pairs: Slots) -> Slots:
    """Index (t, 3) into pairs of the spring along each side of triangles (t, 3), -1 where there is none."""
    sides = pair_keys(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1))
    known = pair_keys(pairs)
    order = np.argsort(known, kind="stable")
    place = np.minimum(np.searchsorted(known[order], sides), max(len(known) - 1, 0))
    if not len(known):
        return np.full(sides.shape, -1)
    found = order[place]
    return np.where(known[found] == sides, found, -1)


def trace_loops(triangles: Slots) -> list[Slots]:
    """Closed loops of particles around triangles (t, 3) of one winding, those around holes included."""
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    there, back = sides[:, 0] << 32 | sides[:, 1], sides[:, 1] << 32 | sides[:, 0]
    follow: dict[int, list[int]] = {}
    for a, b in sides[~np.isin(there, back)].tolist():
        follow.setdefault(a, []).append(b)
    loops = []
    while follow:
        first = next(iter(follow))
        loop, at = [], first
        while at in follow:
            loop.append(at)
            onward = follow[at]
            after = onward.pop()
            if not onward:
                del follow[at]
            at = after
            if at == first:
                break
        if len(loop) > 2:
            loops.append(np.array(loop, dtype=np.int64))
    return loops


def hull_of(form: Floats, pairs: Slots) -> Slots:
    """The loop around a net of springs (m, 2) between places (n, 2), walked along its outside; empty where it has none.

    From the lowest particle always the next spring to the right of where it came from.
    """
    joined: dict[int, list[int]] = {}
    for a, b in pairs.tolist():
        joined.setdefault(a, []).append(b)
        joined.setdefault(b, []).append(a)
    if not joined:
        return np.zeros(0, dtype=np.int64)
    first = min(joined, key=lambda k: (form[k, 1], form[k, 0]))
    loop, at, came = [first], first, -math.pi / 2
    for _ in range(2 * len(pairs) + 2):

        def turn(other: int, at: int = at, came: float = came) -> float:
            dx, dy = form[other] - form[at]
            return (math.atan2(dy, dx) - came - 1e-9) % math.tau

        onward = min(joined[at], key=turn)
        dx, dy = form[at] - form[onward]
        at, came = onward, math.atan2(dy, dx)
        if at == first:
            break
        loop.append(at)
    # A way there and back is no border.
    kept: list[int] = []
    for particle in loop:
        if len(kept) > 1 and kept[-2] == particle:
            kept.pop()
        else:
            kept.append(particle)
    return np.array(kept if len(kept) > 2 else [], dtype=np.int64)


def chains_of(ends: Slots) -> list[tuple[Slots, Slots]]:
    """Ways along springs (m, 2) through particles that just two of them meet in: particles (k + 1,), springs (k,)."""
    at: dict[int, list[int]] = {}
    for spring, (a, b) in enumerate(ends.tolist()):
        at.setdefault(a, []).append(spring)
        at.setdefault(b, []).append(spring)
    rows = ends.tolist()
    remaining = set(range(len(rows)))

    def walk(first: int, spring: int) -> tuple[Slots, Slots]:
        particles, springs = [first], []
        while spring in remaining:
            remaining.remove(spring)
            springs.append(spring)
            a, b = rows[spring]
            particles.append(b if particles[-1] == a else a)
            near = at[particles[-1]]
            if len(near) != 2:
                break
            spring = near[0] if near[1] == spring else near[1]
        return np.array(particles, dtype=np.int64), np.array(springs, dtype=np.int64)

    starts = [(particle, spring) for particle, near in at.items() if len(near) != 2 for spring in near]
    found = [walk(particle, spring) for particle, spring in starts if spring in remaining]
    while remaining:
        spring = min(remaining)
        found.append(walk(rows[spring][0], spring))
    return found


def starts_of(lengths: list[int]) -> Slots:
    """First row of each of several groups of rows, by their lengths, and the end of the last."""
    return np.array([0, *np.cumsum(lengths)], dtype=np.int64) if lengths else np.zeros(1, dtype=np.int64)


def spans(starts: Slots) -> list[tuple[int, int]]:
    """First row and one past the last of each group."""
    return list(pairwise(starts.tolist()))
