"""Welds, the rigid joints: which particles of a level are one, and what that makes impossible."""

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from sandbox.level.build.expansion import expansion, masses
from sandbox.level.build.layout import Layout
from sandbox.level.faults.level_error import Fault
from sandbox.level.format.limits import MASS_RANGE
from sandbox.level.format.model import Level

Slots = NDArray[np.int64]


def united(count: int, pairs: Iterable[tuple[int, int]]) -> Slots:
    """The first of the particles that each particle is one with (count,), itself where it is welded to none.

    pairs: slots before welds, all below count. Chains and repetitions are one union.
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


def welded(level: Level, layout: Layout) -> Slots:
    """As `united`, of the particles of a level whose welds refer to particles that exist."""
    return united(layout.particle_count, ((layout.slot(a), layout.slot(b)) for a, b in level.welds))


def weld_faults(level: Level, layout: Layout) -> Iterator[Fault]:
    """Faults that the welds of an otherwise sound level make: springs without length, masses beyond the limit."""
    if not level.welds:
        return
    firsts = welded(level, layout)
    is_welded = firsts != np.arange(len(firsts))
    is_welded[firsts[is_welded]] = True
    weight = np.zeros(len(firsts))
    for index, body in enumerate(level.bodies):
        owner = layout.owners[body.id]
        mine = slice(owner.first, owner.first + owner.size)
        if not np.any(is_welded[mine]):
            continue
        weight[mine] = masses(body, owner.size)
        # A spring loses its length only where two particles of its own body are one.
        if len(np.unique(firsts[mine])) == owner.size:
            continue
        expanded = expansion(body)
        ends = firsts[owner.first + expanded.pairs]
        for number in expanded.numbers[ends[:, 0] == ends[:, 1]].tolist():
            fault = f'the welds make one particle of both ends of "{body.id}:{number}"; take a weld out or cut {number}'
            yield f"bodies.{index}", fault
    for particle in level.particles:
        weight[layout.slot(particle.id)] = particle.mass
    for index, spring in enumerate(level.springs):
        if firsts[layout.slot(spring.a)] == firsts[layout.slot(spring.b)]:
            yield f"springs.{index}", "the welds make one particle of both its ends; take a weld or the spring out"
    sums = np.bincount(firsts, weights=weight, minlength=len(firsts))
    for index, (a, _) in enumerate(level.welds):
        if sums[firsts[layout.slot(a)]] > MASS_RANGE[1]:
            yield (
                f"welds.{index}",
                f"makes a particle heavier than the limit {MASS_RANGE[1]:.15g}; make its parts lighter",
            )
