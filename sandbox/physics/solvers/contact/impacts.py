"""Impacts among free particles: what meets faster than SLOWEST_BOUNCE in a small step, in passes that gain no energy.

A pass takes the contacts alone that approach and meet in the small step, the earliest of each particle, and is solved
at once (impact_solve.py). What it pushes may approach what it touches, which is the next pass: so a row of balls passes
an impulse on (generalised reflections, Smith and others 2012).
"""

import math

from sandbox.physics.collision.surfaces import SLOWEST_PASSED, bounce_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.free_constraints import (
    COMING,
    GAP,
    NX,
    NY,
    RESTITUTION,
    WAY,
    FreeContactScratch,
)
from sandbox.physics.solvers.contact.free_motion import approach, look_at, meet
from sandbox.physics.solvers.contact.impact_solve import solve_pass

# Passes of a small step at most; a row of n balls takes n - 1.
PASSES = 64
# What bounces with less restitution passes nothing on: the next sweep and small step stop what it pushes. Less costs
# sand, which meets many grains at once, a third of its time.
LEAST_PASSED = 0.2
# What all passes of a small step may cost: so many pushes, and so many for each contact. More makes crowds slow, less
# leaves more of their impacts to the sweep, which does not bounce.
LEAST_WORK = 100
WORK_EACH = 2
# Where there are no more contacts than these, so much.
FEW_CONTACTS = 32
FEW_WORK = 4000
# A pass looks at so many contacts for the cost of one push.
LOOKS = 16


@inner_kernel
def _find_hits(work: FreeContactScratch, rows: int, passed: int, small: float) -> int:
    # The contacts of what the last pass has pushed that approach now; how many.
    found = 0
    for i in range(rows):
        p, q = work.end[i, 0], work.end[i, 1]
        if work.stamp[p] != passed and work.stamp[q] != passed:
            continue
        late = max(work.since[p], work.since[q])
        if work.constraint[i, WAY] == COMING:
            met = meet(work, i, p, q, small)
            if met == math.inf:
                continue
            if met >= late:
                late = met
            else:
                look_at(work, i, late)
        else:
            look_at(work, i, late)
        u = approach(work, i)
        passes_on = work.constraint[i, RESTITUTION] >= LEAST_PASSED and u < -SLOWEST_PASSED
        if passes_on and work.constraint[i, GAP] + small * u <= 0.0:
            work.hit[found] = i
            work.met[found] = late
            found += 1
    return found


@inner_kernel
def _leaves_at(work: FreeContactScratch, i: int, u: float, late: float, small: float) -> float:
    # The velocity along the normal with which a hit is to end the small step.
    row = work.constraint
    p, q = work.end[i, 0], work.end[i, 1]
    e, gap = row[i, RESTITUTION], row[i, GAP]
    if e == 0.0:
        return 0.0 if late > 0.0 else -max(0.0, gap) / small
    if late > 0.0:
        return -e * u
    added = row[i, NX] * (work.added[p, 0] - work.added[q, 0]) + row[i, NY] * (work.added[p, 1] - work.added[q, 1])
    return bounce_of(e, added - u, -added / small, gap, small, small)


@inner_kernel
def _look_again(work: FreeContactScratch, hits: int, small: float) -> int:
    # Where hits are once what rests has been swept.
    kept = 0
    for k in range(hits):
        i, late = work.hit[k], work.met[k]
        if late > 0.0:
            late = meet(work, i, work.end[i, 0], work.end[i, 1], small)
        else:
            look_at(work, i, 0.0)
        if late < small and approach(work, i) < 0.0:
            work.hit[kept], work.met[kept] = i, late
            kept += 1
    return kept


@inner_kernel
def _earliest(work: FreeContactScratch, hits: int, passed: int) -> int:
    # Of hits that share a particle those that come first; the others are looked at again, as they lie by then.
    for k in range(hits):
        for end in range(2):
            work.first[work.end[work.hit[k], end]] = math.inf
    for k in range(hits):
        for end in range(2):
            p = work.end[work.hit[k], end]
            if work.weight[p] > 0.0:
                work.first[p] = min(work.first[p], work.met[k])
    kept = 0
    for k in range(hits):
        i, met = work.hit[k], work.met[k]
        p, q = work.end[i, 0], work.end[i, 1]
        if met > work.first[p] or met > work.first[q]:
            if work.weight[p] > 0.0:
                work.stamp[p] = passed
            if work.weight[q] > 0.0:
                work.stamp[q] = passed
            continue
        work.hit[kept], work.met[kept] = i, met
        kept += 1
    return kept


@inner_kernel
def _mark(work: FreeContactScratch, hits: int, passed: int) -> None:
    # What a pass has pushed, and when.
    for k in range(hits):
        i = work.hit[k]
        for end in range(2):
            p = work.end[i, end]
            if work.weight[p] > 0.0:
                work.stamp[p] = passed
                work.since[p] = work.met[k]


@inner_kernel
def collide_fast(work: FreeContactScratch, hits: int, rows: int, besides: int, small: float) -> bool:
    """Carry out the fast impacts of this small step, and those that they cause; True: all are done."""
    for b in range(besides):
        g = work.beside[b]
        for k in range(work.begin[g], work.begin[g + 1]):
            work.stamp[k] = 0
            work.since[k] = 0.0
    hits = _look_again(work, hits, small)
    left = FEW_WORK if rows <= FEW_CONTACTS else LEAST_WORK + WORK_EACH * rows
    for passed in range(1, PASSES + 1):
        if hits == 0:
            return True
        if hits > 1:
            hits = _earliest(work, hits, passed)
        for k in range(hits):
            i = work.hit[k]
            work.wanted[k] = _leaves_at(work, i, approach(work, i), work.met[k], small)
        left -= solve_pass(work, hits, left) + rows // LOOKS
        _mark(work, hits, passed)
        if left <= 0:
            return False
        hits = _find_hits(work, rows, passed, small)
    return hits == 0
