"""Contacts of free particles among themselves and with what cannot move: small steps, alike in every solver.

No spring joins a free particle, so a step of a heap can be taken in many small ones whose cost is an iteration over its
contacts: overlap falls with the square of their number. In each, a first iteration pushes apart what overlaps, the
particles move, and a second one, which leaves overlap alone, takes back the speed that pushing has given (soft contacts
that relax: Catto 2023, "Solver2D"; small steps: Macklin and others 2019).
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.restitution import SLOWEST_BOUNCE
from sandbox.physics.collision.types import Contacts
from sandbox.physics.jit import inlined_kernel, inner_kernel, unsigned
from sandbox.physics.solvers.contact.free_islands import Islands
from sandbox.physics.solvers.contact.gauss_seidel import FASTEST_PUSH
from sandbox.physics.state import Floats, Slots

# A small step is no longer than this [s]: 8 of them at 60 Hz. With a quarter of them, heaps of 50 layers sink into each
# other by a seventh of a radius; twice as many double the time.
SMALL_STEP = 1.0 / 480.0
# Small steps of a step at most, where an island would sink too deep.
MOST_SMALL_STEPS = 64
# Part of an overlap that a small step removes, and 1 - Cd of a contact while it does. More of the first, or less of the
# second, shakes heaps; less of the first, or more of the second, lets them sink into each other.
OVERLAP_SHARE = 0.05
SOFTNESS = 0.013
# Share of the smaller radius to which contacts sink in under the load of the last step; less costs small steps.
DEEPEST = 0.04

# Columns of a contact constraint: normal, gap [m], friction, bounce [m/s], restitution, effective mass [kg], weight
# [1/kg] of its two particles, velocity [m/s] of what cannot move, impulse [N s] of a small step along and across, depth
# [m] = as deep as it should sink. A row is what an iteration reads of a contact, and lies together.
NX, NY, GAP, FRICTION, BOUNCE, RESTITUTION, MASS, WEIGHT_P, WEIGHT_Q, DRIFT_X, DRIFT_Y, ALONG, ACROSS, DEPTH = range(14)
COLUMNS = 16
# Columns of a place: velocity [m/s], way [m] so far; and what forces add to the velocity [m/s] in the step, what the
# impulses of a small step add to it.
VX, VY, WX, WY = range(4)
GAIN_X, GAIN_Y, PUSHED_X, PUSHED_Y = range(4)


class Work(NamedTuple):
    """Free contacts island by island, in the order in which they are solved; and their particles.

    Contacts that share no particle that can move are solved in any order with the same result. So those of an island
    are sorted by level, one above the highest before it at the same particles: what lies side by side in a level does
    not wait for each other's velocities, which makes an iteration twice as fast.

    By contact: constraint (k, COLUMNS); end (k, 2) = places of its particles (-1: none); contact. place (k, 2), level:
    the ends and the level before they are sorted; at (k + 1,): where each level begins. By place of a particle:
    particle, weight [1/kg], motion (m, 4) and push (m, 4), see the columns, highest = level so far; what cannot move
    has a place for each contact. local (n,): the place of a particle, -1: none. ahead [m] (n, 2): how much further than
    h v' each particle has gone in the step. There is room for more.
    """

    constraint: Floats
    end: Slots
    contact: Slots
    place: Slots
    level: Slots
    at: Slots
    particle: Slots
    weight: Floats
    motion: Floats
    push: Floats
    highest: Slots
    local: Slots
    ahead: Floats


@inner_kernel
def _place_of(p: int, inverse_mass: Floats, start: Floats, velocity: Floats, work: Work, count: int) -> tuple[int, int]:
    # The place of a particle, and the number of places then.
    if inverse_mass[p] > 0.0 and work.local[p] >= 0:
        return work.local[p], count
    work.local[p] = count
    work.particle[count] = p
    work.weight[count] = inverse_mass[p]
    work.highest[count] = 0
    for axis in range(2):
        work.motion[count, VX + axis] = start[p, axis]
        work.motion[count, WX + axis] = 0.0
        work.push[count, GAIN_X + axis] = velocity[p, axis] - start[p, axis]
        work.push[count, PUSHED_X + axis] = 0.0
    return count, count + 1


@inner_kernel
def _place_contacts(
    contacts: Contacts, islands: Islands, first: int, last: int, inverse_mass: Floats, start: Floats, velocity: Floats,
    work: Work, count: int,
) -> int:  # fmt: skip
    # The places and levels of an island's contacts, and where each level begins; the number of places then.
    for level in range(last - first + 1):
        work.at[level] = 0
    for i in range(first, last):
        c = islands.contact[i]
        q = -1
        level = 0
        if contacts.end_b[c] < 0 and contacts.end_a[c] >= 0:
            q, count = _place_of(contacts.end_a[c], inverse_mass, start, velocity, work, count)
            level = work.highest[q]
        p, count = _place_of(contacts.particle[c], inverse_mass, start, velocity, work, count)
        level = max(level, work.highest[p])
        if work.weight[p] > 0.0:
            work.highest[p] = level + 1
        if q >= 0 and work.weight[q] > 0.0:
            work.highest[q] = level + 1
        work.place[i, 0] = p
        work.place[i, 1] = q
        work.level[i] = level
        work.at[level + 1] += 1
    for level in range(last - first):
        work.at[level + 1] += work.at[level]
    return count


@inner_kernel
def _fill_constraints(
    contacts: Contacts, islands: Islands, first: int, last: int, radius: Floats, start: Floats, work: Work
) -> None:
    # The constraints of an island's contacts, level by level.
    row = work.constraint
    for i in range(first, last):
        level = work.level[i]
        k = first + work.at[level]
        work.at[level] += 1
        c = islands.contact[i]
        p = work.place[i, 0]
        q = work.place[i, 1]
        work.contact[k] = c
        work.end[k, 0] = p
        work.end[k, 1] = q
        weight = work.weight[p]
        mass = weight
        smaller = radius[contacts.particle[c]]
        row[k, WEIGHT_P] = weight
        row[k, WEIGHT_Q] = 0.0
        row[k, DRIFT_X] = 0.0
        row[k, DRIFT_Y] = 0.0
        a = contacts.end_a[c]
        b = contacts.end_b[c]
        if b >= 0:
            share = contacts.share[c]
            for axis in range(2):
                row[k, DRIFT_X + axis] = (1.0 - share) * start[a, axis] + share * start[b, axis]
        elif a >= 0:
            mass += work.weight[q]
            smaller = min(smaller, radius[a])
            row[k, WEIGHT_Q] = work.weight[q]
        row[k, MASS] = 1.0 / mass
        row[k, DEPTH] = DEEPEST * smaller
        row[k, NX] = contacts.normal[c, 0]
        row[k, NY] = contacts.normal[c, 1]
        row[k, GAP] = contacts.gap[c]
        row[k, FRICTION] = contacts.friction[c]
        row[k, BOUNCE] = contacts.bounce[c]
        row[k, RESTITUTION] = contacts.restitution[c]
        row[k, ALONG] = contacts.impulse[c, 0]
        row[k, ACROSS] = contacts.impulse[c, 1]


@inner_kernel
def _plan(work: Work, first: int, last: int, h: float) -> tuple[int, float]:
    # Small steps of one island, and its softness: so deep sinks a contact that carries J in each step,
    # SOFTNESS J h / (m OVERLAP_SHARE count^2).
    row = work.constraint
    count = 1
    while count < MOST_SMALL_STEPS and h > SMALL_STEP * count * (1.0 + 1e-9):
        count *= 2
    deep = SOFTNESS * h / (OVERLAP_SHARE * count * count)
    most = 1.0
    for i in range(first, last):
        if row[i, DEPTH] > 0.0:
            most = max(most, row[i, ALONG] * deep / (row[i, MASS] * row[i, DEPTH]))
    stiffer = 1.0
    while count < MOST_SMALL_STEPS and stiffer < most:
        count *= 2
        stiffer *= 4.0
    return count, SOFTNESS * (stiffer / most if stiffer > most else 1.0)


@inner_kernel
def _bias(bounce: float, gap: float, small: float, softness: float, pushes: bool) -> tuple[float, float]:
    # The velocity b [m/s] by which a contact is to end apart from its surfaces staying together, and how soft it is.
    if bounce >= 0.0:
        return -bounce, 0.0
    if gap > 0.0:
        return gap / small, 0.0
    if pushes:
        return max(OVERLAP_SHARE * gap / small, -FASTEST_PUSH), softness
    return 0.0, 0.0


@inner_kernel
def _begin(work: Work, first: int, last: int, scale: float) -> None:
    # The impulses that contacts bring along, as those of a small step; pushed: what they add to the velocities.
    row = work.constraint
    push = work.push
    for i in range(first, last):
        jn = row[i, ALONG] * scale
        jt = row[i, ACROSS] * scale
        row[i, ALONG] = jn
        row[i, ACROSS] = jt
        jx = jn * row[i, NX] - jt * row[i, NY]
        jy = jn * row[i, NY] + jt * row[i, NX]
        p = work.end[i, 0]
        push[p, PUSHED_X] += jx * row[i, WEIGHT_P]
        push[p, PUSHED_Y] += jy * row[i, WEIGHT_P]
        q = work.end[i, 1]
        if q >= 0:
            push[q, PUSHED_X] -= jx * row[i, WEIGHT_Q]
            push[q, PUSHED_Y] -= jy * row[i, WEIGHT_Q]


@inlined_kernel
def _iterate(
    work: Work, first: int, last: int, small: float, passed: float, softness: float, pushes: bool, is_last: bool
) -> None:
    # One Gauss-Seidel iteration, after the time `passed`. pushes: what overlaps is pushed apart, with that softness.
    # is_last: whether the step ends with it; what would meet in the first small step of the next one, and bounce there,
    # is not slowed before.
    # J = max(0, J - ((u + b) m + soft J) / (1 + soft));  |J_t| <= friction J
    row, end, motion = work.constraint, work.end, work.motion
    for c in range(first, last):
        i = unsigned(c)
        p = unsigned(end[i, 0])
        nx, ny = row[i, NX], row[i, NY]
        ux, uy = motion[p, VX], motion[p, VY]
        wx, wy = motion[p, WX], motion[p, WY]
        moves = end[i, 1] >= 0
        if moves:
            q = unsigned(end[i, 1])
            ux -= motion[q, VX]
            uy -= motion[q, VY]
            wx -= motion[q, WX]
            wy -= motion[q, WY]
        else:
            ux -= row[i, DRIFT_X]
            uy -= row[i, DRIFT_Y]
            wx -= passed * row[i, DRIFT_X]
            wy -= passed * row[i, DRIFT_Y]
        gap = row[i, GAP] + nx * wx + ny * wy
        along = nx * ux + ny * uy
        mass = row[i, MASS]
        old = row[i, ALONG]
        bounce = row[i, BOUNCE]
        if is_last and not bounce >= 0.0 and gap > 0.0 and row[i, RESTITUTION] > 0.0 and along < -SLOWEST_BOUNCE:
            continue
        bias, soft = _bias(bounce, gap, small, softness, pushes)
        change = (along + bias) * mass
        if pushes:
            change = (change + soft * old) / (1.0 + soft)
        new = max(0.0, old - change)
        most = row[i, FRICTION] * new
        held = row[i, ACROSS]
        across = min(most, max(-most, held - (nx * uy - ny * ux) * mass))
        row[i, ALONG] = new
        row[i, ACROSS] = across
        jx = (new - old) * nx - (across - held) * ny
        jy = (new - old) * ny + (across - held) * nx
        motion[p, VX] += jx * row[i, WEIGHT_P]
        motion[p, VY] += jy * row[i, WEIGHT_P]
        if moves:
            q = unsigned(end[i, 1])
            motion[q, VX] -= jx * row[i, WEIGHT_Q]
            motion[q, VY] -= jy * row[i, WEIGHT_Q]


@inner_kernel
def _energy(work: Work, begin: int, end: int, gained: float) -> float:
    # Kinetic energy of what can move in an island [J]; gained: with what forces add in the step.
    total = 0.0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            vx = work.motion[k, VX] + gained * work.push[k, GAIN_X]
            vy = work.motion[k, VY] + gained * work.push[k, GAIN_Y]
            total += 0.5 * (vx * vx + vy * vy) / work.weight[k]
    return total


@inner_kernel
def _restrain(work: Work, first: int, last: int, begin: int, end: int, allowed: float) -> None:
    # Many bounces at once can gain energy: what moves is slowed down until it has no more than it had; beside its
    # common motion, where it touches nothing that cannot move. What is carried along gets energy from outside.
    motion = work.motion
    after = _energy(work, begin, end, 0.0)
    if not after > allowed:
        return
    mass = 0.0
    px = 0.0
    py = 0.0
    apart = True
    for i in range(first, last):
        if work.constraint[i, DRIFT_X] != 0.0 or work.constraint[i, DRIFT_Y] != 0.0:
            return
        apart = apart and work.end[i, 1] >= 0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            mass += 1.0 / work.weight[k]
            px += motion[k, VX] / work.weight[k]
            py += motion[k, VY] / work.weight[k]
        elif motion[k, VX] != 0.0 or motion[k, VY] != 0.0:
            return
        else:
            apart = False
    vx = px / mass if apart else 0.0
    vy = py / mass if apart else 0.0
    common = 0.5 * mass * (vx * vx + vy * vy)
    factor = math.sqrt(max(0.0, allowed - common) / (after - common)) if after > common else 0.0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            motion[k, VX] = vx + factor * (motion[k, VX] - vx)
            motion[k, VY] = vy + factor * (motion[k, VY] - vy)


@inner_kernel
def _take_small_steps(work: Work, first: int, last: int, begin: int, end: int, h: float) -> int:
    # All small steps of one island; their number.
    motion = work.motion
    push = work.push
    count, softness = _plan(work, first, last, h)
    small = h / count
    scale = 1.0 / count
    _begin(work, first, last, scale)
    for step in range(count):
        # The impulses of the last small step start this one; `pushed`: the velocities without them meanwhile.
        for k in range(begin, end):
            for axis in range(2):
                free = motion[k, VX + axis] + push[k, GAIN_X + axis] * scale
                motion[k, VX + axis] = free + push[k, PUSHED_X + axis]
                push[k, PUSHED_X + axis] = free
        _iterate(work, first, last, small, small * step, softness, True, False)
        for k in range(begin, end):
            motion[k, WX] += small * motion[k, VX]
            motion[k, WY] += small * motion[k, VY]
        _iterate(work, first, last, small, small * (step + 1), 0.0, False, step == count - 1)
        for k in range(begin, end):
            push[k, PUSHED_X] = motion[k, VX] - push[k, PUSHED_X]
            push[k, PUSHED_Y] = motion[k, VY] - push[k, PUSHED_Y]
    return count


@inner_kernel
def solve_free_contacts(
    contacts: Contacts, islands: Islands, island_count: int, inverse_mass: Floats, radius: Floats, start: Floats,
    velocity: Floats, h: float, work: Work,
) -> None:  # fmt: skip
    """Solve the sorted free contacts over a step of h [s]; work.ahead goes with velocity.

    start [m/s] (n, 2): the velocities before anything acted in this step.
    """
    for p in range(work.local.shape[0]):
        work.local[p] = -1
        work.ahead[p, 0] = 0.0
        work.ahead[p, 1] = 0.0
    end = 0
    for g in range(island_count):
        first = islands.first[g]
        last = islands.first[g + 1]
        begin = end
        end = _place_contacts(contacts, islands, first, last, inverse_mass, start, velocity, work, end)
        _fill_constraints(contacts, islands, first, last, radius, start, work)
        allowed = _energy(work, begin, end, 1.0)
        count = _take_small_steps(work, first, last, begin, end, h)
        _restrain(work, first, last, begin, end, allowed)
        for i in range(first, last):
            c = work.contact[i]
            contacts.impulse[c, 0] = work.constraint[i, ALONG] * count
            contacts.impulse[c, 1] = work.constraint[i, ACROSS] * count
    for k in range(end):
        if work.weight[k] > 0.0:
            p = work.particle[k]
            for axis in range(2):
                velocity[p, axis] = work.motion[k, VX + axis]
                work.ahead[p, axis] = work.motion[k, WX + axis] - h * work.motion[k, VX + axis]


def new_work(particles: int, contacts: int) -> Work:
    """Work to be filled in, with room for so many contacts."""
    places = 2 * contacts
    return Work(
        np.zeros((contacts, COLUMNS)), np.zeros((contacts, 2), np.int64), np.zeros(contacts, np.int64),
        np.zeros((contacts, 2), np.int64), np.zeros(contacts, np.int64), np.zeros(contacts + 1, np.int64),
        np.zeros(places, np.int64), np.zeros(places), np.zeros((places, 4)), np.zeros((places, 4)),
        np.zeros(places, np.int64), np.zeros(particles, np.int64), np.zeros((particles, 2)),
    )  # fmt: skip
