"""Plan: the expansion of a level, its joints and its slots, computed once for its check, its world and its picture."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import shown, suggestion
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.expansion import Expansion
from sandbox.physics.arrays import Slots

_INDEX = re.compile(r"0|[1-9][0-9]{0,8}")


class Owner(NamedTuple):
    """The slots of one body or loose particle: first slot, count, and the indices of particles with names."""

    first: int
    size: int
    named: Mapping[str, int] = MappingProxyType({})
    loose: bool = False


class Layout:
    """Slots by name, as they are before welds: particles of bodies in file order, then loose particles.

    bodies: expansions of the bodies, which have the first ids. A repeated name belongs to its first owner; `repeated`
    lists the others.
    """

    def __init__(self, body_ids: Sequence[str], bodies: Sequence[Expansion[Any]], particle_ids: Sequence[str]) -> None:
        self.owners: dict[str, Owner] = {}
        self.repeated: list[tuple[str, str]] = []
        first = 0
        for index, (name, body) in enumerate(zip(body_ids, bodies, strict=True)):
            count = body.form_count[0]
            self._add("bodies", index, name, Owner(first, count, body.named_particles))
            first += count
        for index, name in enumerate(particle_ids):
            self._add("particles", index, name, Owner(first, 1, loose=True))
            first += 1
        self.particle_count = first

    def _add(self, part: str, index: int, name: str, owner: Owner) -> None:
        if name in self.owners:
            self.repeated.append((f"{part}.{index}.id", name))
        else:
            self.owners[name] = owner

    def second_names(self) -> Iterator[tuple[str, int]]:
        """Names such as `id.start`, with their slots."""
        for name, owner in self.owners.items():
            for part, index in owner.named.items():
                yield f"{name}.{part}", owner.first + index

    def slot(self, reference: str) -> int:
        """Slot of the particle with a name: `id`, `id.k`, or one such as `id.start`. Raises LookupError."""
        owner = self.owners.get(reference)
        if owner is not None and owner.loose:
            return owner.first
        name, _, part = reference.partition(".")
        owner = self.owners.get(name)
        if owner is None:
            raise LookupError(f"there is no body or particle {shown(name)}" + suggestion(name, self.owners))
        if owner.loose:
            raise LookupError(f'"{name}" is a single particle; write "{name}"')
        if part in owner.named:
            return owner.first + owner.named[part]
        if _INDEX.fullmatch(part):
            if int(part) < owner.size:
                return owner.first + int(part)
            raise LookupError(f'"{name}" has the particles {name}.0 to {name}.{owner.size - 1}')
        choices = [f"{name}.0 to {name}.{owner.size - 1}", *(f"{name}.{part}" for part in owner.named)]
        listed = choices[0] if len(choices) == 1 else ", ".join(choices[:-1]) + " or " + choices[-1]
        raise LookupError(f'"{name}" is a body; name one of its particles: {listed}')


def united(count: int, pairs: Iterable[tuple[int, int]]) -> Slots:
    """The first particle (count,) of the union that each particle belongs to; itself without a weld.

    pairs: slots before welds, all below count. A chain of welds is one union.
    """
    parents: dict[int, int] = {}

    def root(slot: int) -> int:
        while (parent := parents.get(slot, slot)) != slot:
            parents[slot] = slot = parents.get(parent, parent)
        return slot

    for a, b in pairs:
        first, second = sorted((root(a), root(b)))
        parents[second] = first
    firsts = np.arange(count, dtype=np.int64)
    for slot in parents:
        firsts[slot] = root(slot)
    return firsts


class Plan:
    """The expanded bodies of a level, the slots and names of its particles, and its welds.

    Each attribute is computed at its first use. The check uses them first, in an order that computes nothing for a
    level that is too large. Only a sound level has attributes other than `layout`, and arrays of bodies.
    bodies: expansions of the level's bodies, if they are known already.
    """

    def __init__(self, level: Level, bodies: Sequence[Expansion[Any]] | None = None) -> None:
        self.bodies = [expansion(body) for body in level.bodies] if bodies is None else list(bodies)
        # Not the level itself, which keeps its plan: neither would be gone before the collector finds both.
        self._ids = [body.id for body in level.bodies], [particle.id for particle in level.particles]
        self._springs, self._welds = level.springs, level.welds

    @cached_property
    def layout(self) -> Layout:
        """Slots by name, before welds."""
        return Layout(self._ids[0], self.bodies, self._ids[1])

    @cached_property
    def spring_ends(self) -> Slots:
        """Particles (k, 2) that each loose spring joins, before welds."""
        slot = self.layout.slot
        return np.array([(slot(spring.a), slot(spring.b)) for spring in self._springs], dtype=np.int64).reshape(-1, 2)

    @cached_property
    def first_of_weld(self) -> Slots:
        """For each particle (n,) the first of those it is welded to; itself without a weld."""
        slot = self.layout.slot
        return united(self.layout.particle_count, ((slot(a), slot(b)) for a, b in self._welds))


def keep_plan(level: Level, plan: Plan) -> None:
    """Store the plan of a sound level in the level, for as long as the level lives."""
    object.__setattr__(level, "_plan", plan)


def kept_plan(level: Level) -> Plan | None:
    """The plan that a level keeps. A level that was read has one, a copy of another level has none."""
    return getattr(level, "_plan", None)
