"""Contacts by name: who pushes whom after a tick, and which contacts begin and end between two ticks."""

import copy
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.things.names import ThingNames
from sandbox.physics.analysis.applied_forces import contact_points
from sandbox.physics.arrays import Slots
from sandbox.physics.keeping.arguments import of_kind
from sandbox.physics.marks import DISC, KINDS, TERRAIN, TIP, TIP_SHIFT

Point = tuple[float, float]
Pair = tuple[str, str]

# A contact of two things goes on while they are apart for so many ticks, unless who listens says otherwise: what lies
# still is not pushed in every tick.
PATIENCE = 6


@dataclass(frozen=True)
class Contact:
    """A point at which two things push each other after a tick.

    a, b: their ids; a stands before b in the level, and terrain and walls come last. A piece that was cut off has the
    id of its body, which then touches itself. point [m]. normal: of length 1, from a to b. impulse [N s]: along the
    normal in this tick.
    """

    a: str
    b: str
    point: Point
    normal: Point
    impulse: float

    @property
    def pair(self) -> Pair:
        """The ids of both things."""
        return self.a, self.b


@dataclass(frozen=True)
class ContactEvents:
    """Changes since the last update: contacts that began, the hardest point of each, and pairs that parted."""

    begin: tuple[Contact, ...] = ()
    end: tuple[Pair, ...] = ()


def contacts(world: LevelWorld) -> list[Contact]:
    """All points at which things push each other after the last tick, in the order in which a step finds them.

    What rules call `touches`. It reads the contacts that the tick leaves, and costs nothing where nobody asks.
    """
    return list(_contacts(of_kind("world", world, LevelWorld), None))


def touching_pairs(world: LevelWorld) -> set[Pair]:
    """The ids of things that push each other after the last tick, each pair once, as in Contact."""
    return _Pushing.of(world).pairs()


class ContactListener:
    """Tells which contacts began and ended, whenever it is asked after a tick.

    patience [ticks]: things that are apart for no longer than this are still in contact, so that what lies on the
    ground does not begin again and again.
    """

    def __init__(self, patience: int = PATIENCE) -> None:
        if patience < 0:
            raise ValueError(f"patience is a number of ticks, 0 or more, not {patience}")
        self._patience = patience
        # The tick in which each pair touched last.
        self._last: dict[Pair, int] = {}
        self._tick = -1

    def last_touch(self, tick: int) -> int:
        """The last tick in which pairs touched that an update at a tick tells to have parted."""
        return max(tick - self._patience - 1, 0)

    def update(self, world: LevelWorld) -> ContactEvents:
        """The changes since the last call. In a world that went back in time all contacts are over, and begin anew."""
        tick, now = world.tick, touching_pairs(world)
        ended = list(self._last) if tick < self._tick else []
        if ended:
            self._last.clear()
        self._tick = tick
        begun = {pair for pair in now if pair not in self._last}
        for pair in now:
            self._last[pair] = tick
        over = [pair for pair, last in self._last.items() if tick - last > self._patience]
        for pair in over:
            del self._last[pair]
        return ContactEvents(tuple(_hardest(world, begun) if begun else ()), tuple(sorted([*ended, *over])))


def _hardest(world: LevelWorld, pairs: set[Pair]) -> list[Contact]:
    """Of each of these pairs the contact with the largest impulse."""
    found: dict[Pair, Contact] = {}
    for each in _contacts(world, pairs):
        known = found.get(each.pair)
        if known is None or each.impulse > known.impulse:
            found[each.pair] = each
    return list(found.values())


def _contacts(world: LevelWorld, pairs: set[Pair] | None) -> Iterator[Contact]:
    """The contacts that push; pairs: only those of these things."""
    pushing = _Pushing.of(world)
    if pairs is not None:
        pushing = pushing.only(pairs)
    if not len(pushing.kept):
        return
    found = contact_points(_with_contacts(world, pushing.kept))
    impulse = np.sum(found.force * found.normal, axis=1) / world.settings.tick_rate
    names = pushing.names
    rows = zip(
        pushing.of_particle.tolist(), pushing.touched.tolist(), found.point.tolist(), found.normal.tolist(),
        impulse.tolist(), strict=True,
    )  # fmt: skip
    for one, other, (x, y), (nx, ny), size in rows:
        # The normal that is found points towards the particle.
        a, b, sign = (one, other, -1.0) if one <= other else (other, one, 1.0)
        yield Contact(names[a], names[b], (x, y), (sign * nx + 0.0, sign * ny + 0.0), size)


@dataclass(frozen=True, eq=False)
class _Pushing:
    """The kept contacts of a world that push, by their places, and the things of each: of its particle, and touched."""

    names: tuple[str, ...]
    kept: Slots
    of_particle: Slots
    touched: Slots

    @classmethod
    def of(cls, world: LevelWorld) -> "_Pushing":
        """Pushing contacts of a world; without those of things that are gone."""
        pushes = (world.contact_impulse[:, 0] > 0.0) | (world.contact_impact > 0.0)
        kept = np.flatnonzero(pushes & (world.contact_particle < world.particle_count))
        none = np.zeros(0, np.int64)
        if not len(kept):
            return cls((), none, none, none)
        things = ThingNames.of(world)
        touched = _touched(world, world.contact_feature[kept])
        there = touched >= 0
        kept = kept[there]
        return cls(things.names, kept, things.of_particle[world.contact_particle[kept]], touched[there])

    @property
    def keys(self) -> Slots:
        """A number for the pair of each, in either order."""
        both = self.of_particle, self.touched
        return np.asarray(np.minimum(*both) * len(self.names) + np.maximum(*both), dtype=np.int64)

    def pairs(self) -> set[Pair]:
        """The names of the things, each pair once."""
        return {self._pair(key) for key in set(self.keys.tolist())}

    def _pair(self, key: int) -> Pair:
        low, high = divmod(key, len(self.names))
        return self.names[low], self.names[high]

    def only(self, pairs: set[Pair]) -> "_Pushing":
        """The contacts of these pairs alone."""
        chosen = np.flatnonzero([self._pair(key) in pairs for key in self.keys.tolist()])
        return _Pushing(self.names, self.kept[chosen], self.of_particle[chosen], self.touched[chosen])


@dataclass(frozen=True, eq=False)
class _Features:
    """The things of all that a contact may be with: of particles, edges of terrain and springs, one after the other.

    first, count (KINDS,): where those that a kind of feature names begin, and how many they are.
    """

    thing: Slots
    first: Slots
    count: Slots

    @classmethod
    def of(cls, world: LevelWorld) -> "_Features":
        """The things of a world as it is now."""
        things = ThingNames.of(world)
        parts = {DISC: things.of_particle, TERRAIN: things.of_terrain}
        found = [parts.get(kind, things.of_spring) for kind in range(KINDS)]
        count = np.array([len(part) for part in found])
        return cls(np.concatenate(found), np.cumsum(count) - count, count)


def _touched(world: LevelWorld, feature: Slots) -> Slots:
    """The things that contacts are with, -1: with something that is gone."""
    features = world.derived(_Features.of, of_hands=False)
    number, kind = np.divmod(feature, KINDS)
    number = np.where(kind == TIP, number % TIP_SHIFT, number)
    known = number < features.count[kind]
    return np.where(known, features.thing[np.where(known, number + features.first[kind], 0)], -1)


def _with_contacts(world: LevelWorld, kept: Slots) -> LevelWorld:
    """The world with some of its contacts alone, to be read; it shares all other arrays."""
    view = copy.copy(world)
    names = ("contact_particle", "contact_feature", "contact_impulse", "contact_impact")
    vars(view).update({name: getattr(world, name)[kept] for name in names})
    return view
