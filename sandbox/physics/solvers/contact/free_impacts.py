"""Impacts among free particles: what meets faster than SLOWEST_BOUNCE in a small step, in passes that gain no energy.

A pass takes the contacts alone that approach and meet in the small step, the earliest of each particle, and is solved
at once. What it pushes may approach what it touches, which is the next pass: so a row of balls passes an impulse on
(generalised reflections, Smith and others 2012). A pass finds the impulses at which all its hits leave as fast as they
are to,

    0 <= J,   u' >= b,   J (u' - b) = 0

of all at once, so that what lies alike leaves alike: a disc straight out of a wedge. Their energy changes by the sum of
J (u + u')/2, and where J > 0 there is u < 0 and u' = b <= -u: never upwards, whatever the b of each is. Sweeps that are
cut short, and friction at several places, may not end there; they are scaled back along J.
"""

import math

from sandbox.physics.arrays import FloatRows
from sandbox.physics.collision.surfaces import SLOWEST_PASSED, bounce_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.free_constraints import (
    ARM,
    COMING,
    FRICTION,
    GAP,
    IMPACT,
    MASS,
    MASS_ACROSS,
    NX,
    NY,
    RATIO_P,
    RATIO_Q,
    RESTITUTION,
    ROLL_P,
    ROLL_Q,
    ROLLING,
    ROLLING_MASS,
    SURFACE,
    WAY,
    WEIGHT_P,
    WEIGHT_Q,
    FreeContactScratch,
    apply,
    approach,
    look_at,
    meet,
    slip,
)
from sandbox.physics.solvers.contact.free_ways import follow_pass
from sandbox.physics.ways import Ways

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
# Sweeps over the hits of a pass, where they are more than two: less leaves a symmetric hit of three askew. And over
# their friction, and at most over more than EXACT_HITS hits.
SWEEPS = 100
FRICTION_SWEEPS = 16
EXACT_HITS = 8
CROWD_SWEEPS = 20
# And at least, however little work is left.
LEAST_SWEEPS = 4
# Sweeps end where no hit changed its velocity by more [m/s]; of more than EXACT_HITS hits, where none did by more.
SETTLED = 1e-8
CROWD_SETTLED = 1e-3
# Two hits whose answers to each other come nearer than this to being the same are one.
ALIKE = 1e-12


@inner_kernel
def collide_fast(
    work: FreeContactScratch, hits: int, rows: int, besides: int, small: float, late: float, ways: Ways,
    position: FloatRows,
) -> bool:  # fmt: skip
    """Carry out the fast impacts of this small step, so late [s], and those that they cause; True: all are done."""
    for b in range(besides):
        g = work.beside[b]
        for k in range(work.begin[g], work.begin[g + 1]):
            work.stamp[k] = 0
            work.since[k] = 0.0
    hits = _look_again(work, hits, small)
    remaining = FEW_WORK if rows <= FEW_CONTACTS else LEAST_WORK + WORK_EACH * rows
    for passed in range(1, PASSES + 1):
        if hits == 0:
            return True
        if hits > 1:
            hits = _earliest(work, hits, passed)
        for k in range(hits):
            i = work.hit[k]
            work.target[k] = _leaves_at(work, i, approach(work, i), work.met[k], small)
        remaining -= solve_pass(work, hits, remaining) + rows // LOOKS
        if ways.particle.shape[0] > 0:
            follow_pass(work, hits, small, late, ways, position)
        # What a pass has pushed, and when.
        for k in range(hits):
            i = work.hit[k]
            for end in range(2):
                p = work.end[i, end]
                if work.weight[p] > 0.0:
                    work.stamp[p] = passed
                    work.since[p] = work.met[k]
        if remaining <= 0:
            return False
        hits = _find_hits(work, rows, passed, small)
    return hits == 0


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
def solve_pass(work: FreeContactScratch, hits: int, remaining: int) -> int:
    """Push the hits of a pass until each leaves as fast as wanted; how many pushes that took. remaining: how many are
    allowed.
    """
    row = work.constraint
    rubs = False
    for k in range(hits):
        i = work.hit[k]
        work.pushed[k], work.across[k] = 0.0, 0.0
        work.speed[k], work.slip[k] = approach(work, i), slip(work, i)
        rubs = rubs or row[i, FRICTION] > 0.0
    if hits == 1:
        i = work.hit[0]
        work.last[0] = max(0.0, (work.target[0] - work.speed[0]) * row[i, MASS])
        _push_hit(work, 0, work.last[0], 0.0)
        if rubs:
            _rub(work, 1)
        done = 1
    elif hits == 2 and not rubs:
        _solve_two(work)
        done = 2
    else:
        sweeps = max(LEAST_SWEEPS, min(SWEEPS if hits <= EXACT_HITS else CROWD_SWEEPS, remaining // hits))
        done = hits * (_solve_rubbing(work, hits, sweeps) if rubs else _solve_many(work, hits, sweeps))
    # Rolling resistance of the hits.
    motion = work.motion
    for k in range(hits):
        i = work.hit[k]
        most = row[i, ROLLING] * work.pushed[k]
        if not most > 0.0:
            continue
        p, q = work.end[i, 0], work.end[i, 1]
        turn = row[i, RATIO_P] * motion[p, SURFACE] - row[i, RATIO_Q] * motion[q, SURFACE]
        j = min(most, max(-most, -turn * row[i, ROLLING_MASS]))
        motion[p, SURFACE] += j * row[i, ROLL_P]
        motion[q, SURFACE] -= j * row[i, ROLL_Q]
    for k in range(hits):
        row[work.hit[k], IMPACT] += work.pushed[k]
    return done


@inner_kernel
def _push_hit(work: FreeContactScratch, k: int, jn: float, jt: float) -> None:
    i = work.hit[k]
    row = work.constraint
    apply(work, i, row[i, NX], row[i, NY], jn, jt, row[i, ARM], work.met[k], False)
    work.pushed[k] += jn
    work.across[k] += jt


@inner_kernel
def _rub(work: FreeContactScratch, hits: int) -> int:
    # Friction of what `last` of the hits pushes, beyond what there is: sweeps that only take energy.
    row = work.constraint
    settled = SETTLED if hits <= EXACT_HITS else CROWD_SETTLED
    for k in range(hits):
        work.last_across[k] = work.across[k]
    for sweep in range(FRICTION_SWEEPS):
        largest = 0.0
        for k in range(hits):
            i = work.hit[k]
            most = row[i, FRICTION] * work.last[k]
            if not most > 0.0:
                continue
            old = work.across[k]
            last = work.last_across[k]
            j = min(last + most, max(last - most, old - slip(work, i) * row[i, MASS_ACROSS])) - old
            if j != 0.0:
                _push_hit(work, k, 0.0, j)
                largest = max(largest, abs(j) / row[i, MASS_ACROSS])
        if hits == 1 or largest <= settled:
            return sweep + 1
    return FRICTION_SWEEPS


@inner_kernel
def _solve_two(work: FreeContactScratch) -> None:
    # 0 <= J, W J >= r, one of both; r: what each lacks.  (32)
    row = work.constraint
    i, j = work.hit[0], work.hit[1]
    one = max(0.0, work.target[0] - work.speed[0])
    two = max(0.0, work.target[1] - work.speed[1])
    a, b = 1.0 / row[i, MASS], 1.0 / row[j, MASS]
    # What an impulse of 1 along the normal of one contact does to the velocity of another.
    p, q = work.end[i, 0], work.end[i, 1]
    r, s = work.end[j, 0], work.end[j, 1]
    weight = 0.0
    if p == r:
        weight += row[i, WEIGHT_P]
    if q == s:
        weight += row[i, WEIGHT_Q]
    if p == s:
        weight -= row[i, WEIGHT_P]
    if q == r:
        weight -= row[i, WEIGHT_Q]
    c = weight * (row[i, NX] * row[j, NX] + row[i, NY] * row[j, NY])
    jn, jm = one / a, two / b
    if c != 0.0:
        inside = a * b - c * c
        x, y = 0.0, 0.0
        if inside > ALIKE * a * b:
            x, y = (b * one - c * two) / inside, (a * two - c * one) / inside
        if x > 0.0 and y > 0.0:
            jn, jm = x, y
        elif c * jn >= two:
            jm = 0.0
        else:
            jn = 0.0
    _push_hit(work, 0, jn, 0.0)
    _push_hit(work, 1, jm, 0.0)


@inner_kernel
def _solve_rubbing(work: FreeContactScratch, hits: int, sweeps: int) -> int:
    # Several hits with friction: first all that approaches is stopped, then what pushed it gives its share back
    # (Poisson), and rubs again. How many sweeps there were.
    row = work.constraint
    settled = SETTLED if hits <= EXACT_HITS else CROWD_SETTLED
    done = sweeps
    for sweep in range(sweeps):
        largest = 0.0
        for k in range(hits):
            i = work.hit[k]
            old = work.pushed[k]
            j = max(0.0, old + (min(0.0, work.target[k]) - approach(work, i)) * row[i, MASS]) - old
            if abs(j) > settled * row[i, MASS]:
                _push_hit(work, k, j, 0.0)
                largest = max(largest, abs(j) / row[i, MASS])
            most = row[i, FRICTION] * work.pushed[k]
            old = work.across[k]
            j = min(most, max(-most, old - slip(work, i) * row[i, MASS_ACROSS])) - old
            if abs(j) > settled * row[i, MASS_ACROSS]:
                _push_hit(work, k, 0.0, j)
                largest = max(largest, abs(j) / row[i, MASS_ACROSS])
        if largest <= settled:
            done = sweep + 1
            break
    for k in range(hits):
        work.last[k] = max(0.0, work.target[k]) / max(SLOWEST_PASSED, -work.speed[k]) * work.pushed[k]
    for k in range(hits):
        _push_hit(work, k, work.last[k], 0.0)
    done += _rub(work, hits)
    _restrain(work, hits)
    return done


@inner_kernel
def _restrain(work: FreeContactScratch, hits: int) -> None:
    # What sweeps have not finished, and friction at several places, gains no energy: dE = sum of J (u + u') / 2, at a
    # share s of all impulses s J u + s^2 J W J / 2.
    begun = 0.0
    gained = 0.0
    for k in range(hits):
        i = work.hit[k]
        begun += work.pushed[k] * work.speed[k] + work.across[k] * work.slip[k]
        gained += work.pushed[k] * (approach(work, i) - work.speed[k])
        gained += work.across[k] * (slip(work, i) - work.slip[k])
    if begun + 0.5 * gained > 0.0 and gained > 0.0:
        ratio = min(1.0, max(0.0, -2.0 * begun / gained))
        for k in range(hits):
            _push_hit(work, k, (ratio - 1.0) * work.pushed[k], (ratio - 1.0) * work.across[k])


@inner_kernel
def _solve_many(work: FreeContactScratch, hits: int, sweeps: int) -> int:
    # The same of many, in sweeps; how many there were.
    row = work.constraint
    settled = SETTLED if hits <= EXACT_HITS else CROWD_SETTLED
    done = sweeps
    largest = 0.0
    for sweep in range(sweeps):
        largest = 0.0
        for k in range(hits):
            i = work.hit[k]
            lacks = work.target[k] - approach(work, i)
            if abs(lacks) <= settled:
                continue
            old = work.pushed[k]
            j = max(0.0, old + lacks * row[i, MASS]) - old  # (32)
            if j != 0.0:
                _push_hit(work, k, j, 0.0)
                largest = max(largest, abs(j) / row[i, MASS])
        if largest <= settled:
            done = sweep + 1
            break
    if largest > SETTLED:
        _restrain(work, hits)
    return done


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
