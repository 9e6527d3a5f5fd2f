"""Faults of welds: springs without length, masses beyond the limit."""

from collections.abc import Iterator

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import Fault
from sandbox.level.format.limits import MASS_RANGE
from sandbox.level.plan.plan import Plan


def weld_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    """Faults of welds; the level has no other faults."""
    if not level.welds:
        return
    layout, firsts = plan.layout, plan.first_of_weld
    is_welded = firsts != np.arange(len(firsts))
    is_welded[firsts[is_welded]] = True
    weight = np.zeros(len(firsts))
    for index, (body, made) in enumerate(zip(level.bodies, plan.bodies, strict=True)):
        owner = layout.owners[body.id]
        mine = slice(owner.first, owner.first + owner.size)
        if not np.any(is_welded[mine]):
            continue
        weight[mine] = made.mass
        # A spring loses its length only where two particles of its own body are one.
        if len(np.unique(firsts[mine])) == owner.size:
            continue
        ends = firsts[owner.first + made.pairs]
        for number in made.numbers[ends[:, 0] == ends[:, 1]].tolist():
            fault = f'the welds make one particle of both ends of "{body.id}:{number}"; take a weld out or cut {number}'
            yield f"bodies.{index}", fault
    for particle in level.particles:
        weight[layout.slot(particle.id)] = particle.mass
    ends = firsts[plan.spring_ends]
    for index in np.flatnonzero(ends[:, 0] == ends[:, 1]).tolist():
        yield f"springs.{index}", "the welds make one particle of both its ends; take a weld or the spring out"
    sums = np.bincount(firsts, weights=weight, minlength=len(firsts))
    for index, (a, _) in enumerate(level.welds):
        if sums[firsts[layout.slot(a)]] > MASS_RANGE[1]:
            yield (
                f"welds.{index}",
                f"makes a particle heavier than the limit {MASS_RANGE[1]:.15g}; make its parts lighter",
            )
