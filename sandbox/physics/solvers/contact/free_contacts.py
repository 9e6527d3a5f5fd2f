"""Contacts of free particles among themselves and with what cannot move: small steps, alike in every solver.

No spring joins a free particle, so a step of a heap can be taken in many small ones whose cost is an iteration over its
contacts: overlap falls with the square of their number. In each, a first iteration pushes apart what overlaps, the
particles move, and a second one, which leaves overlap alone, takes back the speed that pushing has given (soft contacts
that relax: Catto 2023, "Solver2D"; small steps: Macklin and others 2019). What touches nothing goes as far as it would
in small steps: where their number changed with what is near, a disc's energy would change in flight.
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.restitution import SLOWEST_BOUNCE
from sandbox.physics.collision.turning import SURFACE_WEIGHT, rolling_ratios, spin_of
from sandbox.physics.collision.types import Colliders, Contacts
from sandbox.physics.equation import SHORTEST
from sandbox.physics.jit import inlined_kernel, inner_kernel, unsigned
from sandbox.physics.solvers.contact.free_islands import Islands
from sandbox.physics.solvers.contact.gauss_seidel import FASTEST_PUSH
from sandbox.physics.solvers.contact.small_steps import MOST_SMALL_STEPS, small_steps
from sandbox.physics.state import Floats, Slots

# Part of an overlap that a small step removes, and 1 - Cd of a contact while it does. More of the first, or less of the
# second, shakes heaps; less of the first, or more of the second, lets them sink into each other.
OVERLAP_SHARE = 0.05
SOFTNESS = 0.013
# Share of the smaller radius to which contacts sink in under the load of the last step; less costs small steps.
DEEPEST = 0.04
# The normal of discs is that of their centres where these lie off it by more than this share of the radii. More costs
# angular momentum, less time.
ALONG_CENTRES = 1e-12

# Columns of a contact constraint, a row that lies together. What every iteration reads of it: normal; gap [m] by now;
# impulse [N s] of a small step along, bounce [m/s], and the way of its normal: FOLLOWS the centres of discs, is COMING
# where they are followed along their way and have not met yet, STANDS where one of those is pinned, or is no disc.
NX, NY, GAP, ALONG, BOUNCE, WAY = range(6)
FOLLOWS, COMING, STANDS = 0.0, 1.0, 2.0
# And where it pushes: impulse across, friction, effective mass [kg] along and across, weight [1/kg] of its particles
# and of their surfaces (0: it does not turn), the arm of friction as a share of the radii; rolling resistance, its
# effective mass [kg], the smaller radius over each one's, and that times its TURN.
ACROSS, FRICTION, MASS, MASS_ACROSS, WEIGHT_P, WEIGHT_Q, TURN_P, TURN_Q, ARM = range(6, 15)
ROLLING, ROLLING_MASS, RATIO_P, RATIO_Q, ROLL_P, ROLL_Q = range(15, 21)
# What the gap comes from: without what its particles are apart [m], of two discs minus their radii; how far two discs
# are apart at the start [m], else 0; 1 over the radii [1/m]. Restitution; the depth [m] as deep as it should sink.
REACH, APART_X, APART_Y, PER_REACH, RESTITUTION, DEPTH = range(21, 27)
COLUMNS = 27
# Columns of a place: velocity [m/s], way [m] so far, speed of its surface [m/s] = spin times radius; and what the
# impulses of a small step add to the first and the last.
VX, VY, WX, WY, SURFACE, PUSHED_X, PUSHED_Y, PUSHED_SURFACE = range(8)


class Work(NamedTuple):
    """Free contacts island by island, in the order in which they are solved; and their particles.

    Contacts that share no particle that can move are solved in any order with the same result. So those of an island
    are sorted by level, one above the highest before it at the same particles: what lies side by side in a level does
    not wait for each other's velocities, which makes an iteration twice as fast.

    By contact: constraint (k, COLUMNS); end (k, 2) = places of its particle and of what it pushes; contact. place
    (k, 2), level: the ends and the level before they are sorted; at (k + 1,): where each level begins. By place:
    particle, weight [1/kg], turning [1/kg] = the weight of its surface, motion (m, 8), see the columns, gain [m/s]
    (m, 2) = what forces add to the velocity in the step, highest = level so far; what cannot move has a place for each
    contact. local (n,): the place of a particle, -1: none. ahead [m] (n, 2): how much further than h v' each particle
    has gone in the step. There is room for more.
    """

    constraint: Floats
    end: Slots
    contact: Slots
    place: Slots
    level: Slots
    at: Slots
    particle: Slots
    weight: Floats
    turning: Floats
    motion: Floats
    gain: Floats
    highest: Slots
    local: Slots
    ahead: Floats


@inner_kernel
def _place_of(p: int, colliders: Colliders, start: Floats, spin: Floats, work: Work, count: int) -> tuple[int, int]:
    # The place of a particle, and the number of places then.
    if colliders.inverse_mass[p] > 0.0 and work.local[p] >= 0:
        return work.local[p], count
    work.local[p] = count
    work.particle[count] = p
    work.weight[count] = colliders.inverse_mass[p]
    work.turning[count] = colliders.turning[p]
    work.highest[count] = 0
    for axis in range(2):
        work.motion[count, VX + axis] = start[p, axis]
        work.motion[count, WX + axis] = 0.0
        work.motion[count, PUSHED_X + axis] = 0.0
        work.gain[count, axis] = colliders.velocity[p, axis] - start[p, axis]
    work.motion[count, SURFACE] = spin[p] * colliders.radius[p]
    work.motion[count, PUSHED_SURFACE] = 0.0
    return count, count + 1


@inner_kernel
def _place_of_edge(contacts: Contacts, c: int, start: Floats, work: Work, count: int) -> tuple[int, int]:
    # The place of an edge that cannot move, be it of terrain or of a body, and the number of places then.
    a = contacts.end_a[c]
    b = contacts.end_b[c]
    share = contacts.share[c]
    work.particle[count] = contacts.particle[c]
    work.weight[count] = 0.0
    work.turning[count] = 0.0
    work.highest[count] = 0
    for column in range(8):
        work.motion[count, column] = 0.0
    for axis in range(2):
        if b >= 0:
            work.motion[count, VX + axis] = (1.0 - share) * start[a, axis] + share * start[b, axis]
        work.gain[count, axis] = 0.0
    return count, count + 1


@inner_kernel
def _place_contacts(
    contacts: Contacts, islands: Islands, first: int, last: int, colliders: Colliders, start: Floats, spin: Floats,
    work: Work, count: int,
) -> int:  # fmt: skip
    # The places and levels of an island's contacts, and where each level begins; the number of places then.
    for level in range(last - first + 1):
        work.at[level] = 0
    for i in range(first, last):
        c = islands.contact[i]
        if contacts.end_b[c] < 0 and contacts.end_a[c] >= 0:
            q, count = _place_of(contacts.end_a[c], colliders, start, spin, work, count)
        else:
            q, count = _place_of_edge(contacts, c, start, work, count)
        level = work.highest[q]
        p, count = _place_of(contacts.particle[c], colliders, start, spin, work, count)
        level = max(level, work.highest[p])
        if work.weight[p] > 0.0:
            work.highest[p] = level + 1
        if work.weight[q] > 0.0:
            work.highest[q] = level + 1
        work.place[i, 0] = p
        work.place[i, 1] = q
        work.level[i] = level
        work.at[level + 1] += 1
    total = 0
    for level in range(last - first):
        total += work.at[level + 1]
        work.at[level + 1] = total
    return count


@inner_kernel
def _fill_constraints(
    contacts: Contacts, islands: Islands, first: int, last: int, colliders: Colliders, work: Work
) -> None:
    # The constraints of an island's contacts, level by level.
    radius = colliders.radius
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
        mass = work.weight[p] + work.weight[q]
        smaller = radius[contacts.particle[c]]
        row[k, WEIGHT_P], row[k, WEIGHT_Q] = work.weight[p], work.weight[q]
        row[k, APART_X], row[k, APART_Y] = 0.0, 0.0
        row[k, TURN_P], row[k, TURN_Q] = work.turning[p], work.turning[q]
        row[k, ARM], row[k, PER_REACH], row[k, WAY] = 1.0, 0.0, STANDS
        row[k, REACH] = contacts.gap[c]
        row[k, NX], row[k, NY] = contacts.normal[c, 0], contacts.normal[c, 1]
        row[k, ALONG], row[k, ACROSS] = contacts.impulse[c, 0], contacts.impulse[c, 1]
        disc = contacts.end_a[c] if contacts.end_b[c] < 0 else -1
        if disc >= 0:
            smaller = min(smaller, radius[disc])
        row[k, MASS] = 1.0 / mass
        row[k, MASS_ACROSS] = 1.0 / (mass + work.turning[p] + work.turning[q])
        row[k, DEPTH] = DEEPEST * smaller
        row[k, FRICTION], row[k, BOUNCE] = contacts.friction[c], contacts.bounce[c]
        row[k, RESTITUTION] = contacts.restitution[c]
        if disc >= 0:
            _fill_pair(contacts, c, k, colliders, work)
        ratio_p, ratio_q = rolling_ratios(contacts.particle[c], disc, colliders)
        row[k, RATIO_P], row[k, RATIO_Q] = ratio_p, ratio_q
        row[k, ROLL_P], row[k, ROLL_Q] = ratio_p * row[k, TURN_P], ratio_q * row[k, TURN_Q]
        answer = ratio_p * row[k, ROLL_P] + ratio_q * row[k, ROLL_Q]
        row[k, ROLLING] = contacts.rolling[c] if answer > 0.0 else 0.0
        row[k, ROLLING_MASS] = 1.0 / answer if answer > 0.0 else 0.0


@inner_kernel
def _fill_pair(contacts: Contacts, c: int, k: int, colliders: Colliders, work: Work) -> None:
    # What the constraint of two discs has of their places.
    row = work.constraint
    p = contacts.particle[c]
    q = contacts.end_a[c]
    nx = contacts.normal[c, 0]
    ny = contacts.normal[c, 1]
    dx = colliders.position[p, 0] - colliders.position[q, 0]
    dy = colliders.position[p, 1] - colliders.position[q, 1]
    reach = colliders.radius[p] + colliders.radius[q]
    row[k, APART_X], row[k, APART_Y] = dx, dy
    row[k, WAY] = FOLLOWS
    row[k, REACH] = -reach
    row[k, PER_REACH] = 1.0 / reach if reach > 0.0 else 0.0
    row[k, ARM] = (nx * dx + ny * dy) * row[k, PER_REACH]
    if abs(nx * dy - ny * dx) > ALONG_CENTRES * reach:
        # Discs that are followed along their way will meet with their centres along the normal, but do not lie so yet.
        row[k, ARM], row[k, WAY] = 1.0, STANDS
        if row[k, WEIGHT_P] > 0.0 and row[k, WEIGHT_Q] > 0.0:
            row[k, WAY] = COMING
            row[k, BOUNCE] = -1.0
            row[k, ALONG], row[k, ACROSS] = 0.0, 0.0


@inner_kernel
def _plan(work: Work, first: int, last: int, h: float) -> tuple[int, float]:
    # Small steps of one island, and its softness: so deep sinks a contact that carries J in each step,
    # SOFTNESS J h / (m OVERLAP_SHARE count^2).
    row = work.constraint
    count = small_steps(h)
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
def _bias(bounce: float, gap: float, rate: float, hardness: float, pushes: bool) -> tuple[float, float]:
    # The velocity b [m/s] by which a contact is to end apart from its surfaces staying together, and how hard it is,
    # 1 / (1 + soft); rate: small steps in a second.
    if bounce >= 0.0:
        return -bounce, 1.0
    if gap > 0.0:
        return gap * rate, 1.0
    if pushes:
        return max(OVERLAP_SHARE * gap * rate, -FASTEST_PUSH), hardness
    return 0.0, 1.0


@inlined_kernel
def _push(work: Work, i: int, nx: float, ny: float, jn: float, jt: float, arm: float) -> None:
    # Add what the impulses of a contact do to its particles to what the next small step starts with.
    row = work.constraint
    motion = work.motion
    jx = jn * nx - jt * ny
    jy = jn * ny + jt * nx
    jt *= arm
    p = unsigned(work.end[i, 0])
    motion[p, PUSHED_X] += jx * row[i, WEIGHT_P]
    motion[p, PUSHED_Y] += jy * row[i, WEIGHT_P]
    motion[p, PUSHED_SURFACE] -= jt * row[i, TURN_P]
    q = unsigned(work.end[i, 1])
    motion[q, PUSHED_X] -= jx * row[i, WEIGHT_Q]
    motion[q, PUSHED_Y] -= jy * row[i, WEIGHT_Q]
    motion[q, PUSHED_SURFACE] -= jt * row[i, TURN_Q]


@inner_kernel
def _begin(work: Work, first: int, last: int, scale: float) -> None:
    # The impulses that contacts bring along, as those of a small step.
    row = work.constraint
    for c in range(first, last):
        i = unsigned(c)
        row[i, ALONG] *= scale
        row[i, ACROSS] *= scale
        _push(work, i, row[i, NX], row[i, NY], row[i, ALONG], row[i, ACROSS], row[i, ARM])


@inner_kernel
def _time_until(dx: float, dy: float, ux: float, uy: float, reach: float) -> float:
    # When two discs meet that are d apart and move by u; infinite where they never do.
    # |d + t u| = reach
    squared = ux * ux + uy * uy
    along = dx * ux + dy * uy
    apart = dx * dx + dy * dy - reach * reach
    if apart <= 0.0:
        return 0.0
    inside = along * along - squared * apart
    if not (along < 0.0 and inside >= 0.0):
        return math.inf
    return apart / (math.sqrt(inside) - along)


@inner_kernel
def _meet(work: Work, i: int, p: int, q: int, small: float) -> float:
    # When two discs that are coming meet, if in this small step, else infinite: then the normal, and with what speed
    # they part.
    row, motion = work.constraint, work.motion
    ux, uy = motion[p, VX] - motion[q, VX], motion[p, VY] - motion[q, VY]
    wx = row[i, APART_X] + (motion[p, WX] - motion[q, WX])
    wy = row[i, APART_Y] + (motion[p, WY] - motion[q, WY])
    late = _time_until(wx, wy, ux, uy, -row[i, REACH])
    if not late < small:
        return math.inf
    dx, dy = wx + late * ux, wy + late * uy
    distance = math.sqrt(dx * dx + dy * dy)
    if distance > SHORTEST:
        row[i, NX] = dx / distance
        row[i, NY] = dy / distance
    row[i, GAP] = row[i, REACH] + row[i, NX] * wx + row[i, NY] * wy
    row[i, ARM] = distance * row[i, PER_REACH]
    row[i, WAY] = FOLLOWS
    speed = -(row[i, NX] * ux + row[i, NY] * uy)
    if speed > 0.0:
        row[i, BOUNCE] = row[i, RESTITUTION] * speed if speed > SLOWEST_BOUNCE else 0.0
    return late


@inner_kernel
def _look(work: Work, first: int, last: int) -> None:
    # Where contacts are by now: their gaps, and of discs the normals and arms, which follow the centres.
    row, end, motion = work.constraint, work.end, work.motion
    for c in range(first, last):
        i = unsigned(c)
        p = unsigned(end[i, 0])
        q = unsigned(end[i, 1])
        nx, ny = row[i, NX], row[i, NY]
        wx = row[i, APART_X] + (motion[p, WX] - motion[q, WX])
        wy = row[i, APART_Y] + (motion[p, WY] - motion[q, WY])
        gap = row[i, REACH] + nx * wx + ny * wy
        if row[i, WAY] == FOLLOWS:
            if abs(nx * wy - ny * wx) > -ALONG_CENTRES * row[i, REACH]:
                distance = math.sqrt(wx * wx + wy * wy)
                if distance > SHORTEST:
                    per_distance = 1.0 / distance
                    row[i, NX] = wx * per_distance
                    row[i, NY] = wy * per_distance
                gap = row[i, REACH] + distance
            row[i, ARM] = 1.0 + gap * row[i, PER_REACH]
        row[i, GAP] = gap


@inlined_kernel
def _apply(
    work: Work, i: int, nx: float, ny: float, jn: float, jt: float, arm: float, late: float, rolls: bool
) -> None:  # fmt: skip
    # v += J / m, and what it does to the surfaces. rolls: against their turn on each other acts a torque as well, as an
    # impulse at the smaller radius of at most ROLLING times that along the normal.
    row, motion = work.constraint, work.motion
    p, q = unsigned(work.end[i, 0]), unsigned(work.end[i, 1])
    jx, jy = jn * nx - jt * ny, jn * ny + jt * nx
    weight_p, weight_q = row[i, WEIGHT_P], row[i, WEIGHT_Q]
    surface_p, surface_q = motion[p, SURFACE], motion[q, SURFACE]
    roll_p, roll_q = row[i, ROLL_P], row[i, ROLL_Q]
    turn = row[i, RATIO_P] * surface_p - row[i, RATIO_Q] * surface_q
    surface_p -= jt * (arm * row[i, TURN_P])
    surface_q -= jt * (arm * row[i, TURN_Q])
    if rolls and row[i, ROLLING] > 0.0:
        most = row[i, ROLLING] * row[i, ALONG]
        turn -= jt * (arm * (roll_p - roll_q))
        j = min(most, max(-most, -turn * row[i, ROLLING_MASS]))
        surface_p += j * roll_p
        surface_q -= j * roll_q
    motion[p, VX] += jx * weight_p
    motion[p, VY] += jy * weight_p
    motion[q, VX] -= jx * weight_q
    motion[q, VY] -= jy * weight_q
    motion[p, SURFACE], motion[q, SURFACE] = surface_p, surface_q
    if late > 0.0:
        # It acts where discs meet that are coming: what it changes of their ways until then is taken off.
        motion[p, WX] -= late * jx * weight_p
        motion[p, WY] -= late * jy * weight_p
        motion[q, WX] += late * jx * weight_q
        motion[q, WY] += late * jy * weight_q


@inlined_kernel
def _iterate(work: Work, first: int, last: int, small: float, softness: float, pushes: bool, is_last: bool) -> None:
    # One Gauss-Seidel iteration over contacts as they were looked at. pushes: what overlaps is pushed apart, with that
    # softness; with the impulses of the other iteration of a small step the next one starts. is_last: whether the step
    # ends with it; what would meet in the first small step of the next one, and bounce there, is not slowed before.
    # J = max(0, (J - (u + b) m) / (1 + soft));  |J_t| <= friction J, against the slip of the surfaces
    row, end, motion = work.constraint, work.end, work.motion
    rate = 1.0 / small
    hardness = 1.0 / (1.0 + softness)
    displaced = False
    for c in range(first, last):
        if displaced:
            _look(work, c, c + 1)
        i = unsigned(c)
        p = unsigned(end[i, 0])
        q = unsigned(end[i, 1])
        ux, uy = motion[p, VX] - motion[q, VX], motion[p, VY] - motion[q, VY]
        late = 0.0
        if row[i, WAY] == COMING:
            late = _meet(work, i, p, q, small) if pushes else math.inf
            if late == math.inf:
                continue
            displaced = displaced or late > 0.0
        nx, ny, gap = row[i, NX], row[i, NY], row[i, GAP]
        along = nx * ux + ny * uy
        old = row[i, ALONG]
        bounce = row[i, BOUNCE]
        bias, hard = _bias(bounce, gap, rate, hardness, pushes)
        if old == 0.0 and along + bias >= 0.0:
            continue
        if is_last and not bounce >= 0.0 and gap > 0.0 and row[i, RESTITUTION] > 0.0 and along < -SLOWEST_BOUNCE:
            continue
        arm = row[i, ARM]
        mass = row[i, MASS] * hard
        new = max(0.0, (old * hard - bias * mass) - along * mass)
        most = row[i, FRICTION] * new
        held = row[i, ACROSS]
        slip = nx * uy - ny * ux - arm * (motion[p, SURFACE] + motion[q, SURFACE])
        across = min(most, max(-most, held - slip * row[i, MASS_ACROSS]))
        row[i, ALONG] = new
        row[i, ACROSS] = across
        _apply(work, i, nx, ny, new - old, across - held, arm, late, not pushes and new > 0.0)
        if not pushes and new > 0.0:
            _push(work, i, nx, ny, new, across, arm)


@inner_kernel
def _energy(work: Work, begin: int, end: int, gained: float) -> float:
    # Kinetic energy of what can move in an island [J]; gained: with what forces add in the step.
    total = 0.0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            vx = work.motion[k, VX] + gained * work.gain[k, 0]
            vy = work.motion[k, VY] + gained * work.gain[k, 1]
            squared = vx * vx + vy * vy
            if work.turning[k] > 0.0:
                squared += work.motion[k, SURFACE] * work.motion[k, SURFACE] / SURFACE_WEIGHT
            total += 0.5 * squared / work.weight[k]
    return total


@inner_kernel
def _restrain(work: Work, begin: int, end: int, colliders: Colliders, allowed: float) -> None:
    # Many bounces at once can gain energy: what moves is slowed down until it has no more than it had; beside its
    # common motion, where it touches nothing that cannot move. What is carried along gets energy from outside.
    motion = work.motion
    after = _energy(work, begin, end, 0.0)
    if not after > allowed:
        return
    apart = True
    for k in range(begin, end):
        if not work.weight[k] > 0.0:
            if motion[k, VX] != 0.0 or motion[k, VY] != 0.0:
                return
            apart = False
    common = Rigid(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if apart:
        common = _rigid_motion(work, begin, end, colliders)
    beside = after - common.energy
    factor = math.sqrt(max(0.0, allowed - common.energy) / beside) if beside > 0.0 else 0.0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            p = work.particle[k]
            vx = common.vx - common.spin * (colliders.position[p, 1] + motion[k, WY] - common.y)
            vy = common.vy + common.spin * (colliders.position[p, 0] + motion[k, WX] - common.x)
            motion[k, VX] = vx + factor * (motion[k, VX] - vx)
            motion[k, VY] = vy + factor * (motion[k, VY] - vy)
            if work.turning[k] > 0.0:
                surface = common.spin * colliders.radius[p]
                motion[k, SURFACE] = surface + factor * (motion[k, SURFACE] - surface)


class Rigid(NamedTuple):
    """The motion of an island as if it were rigid: centre of mass [m], its velocity [m/s], spin [rad/s], energy [J]."""

    x: float
    y: float
    vx: float
    vy: float
    spin: float
    energy: float


@inner_kernel
def _rigid_motion(work: Work, begin: int, end: int, colliders: Colliders) -> Rigid:
    # That of the same momentum and angular momentum, at the end of the step: spin = L / I, the discs' own included.
    motion = work.motion
    mass = 0.0
    x = 0.0
    y = 0.0
    vx = 0.0
    vy = 0.0
    for k in range(begin, end):
        p = work.particle[k]
        m = 1.0 / work.weight[k]
        mass += m
        x += m * (colliders.position[p, 0] + motion[k, WX])
        y += m * (colliders.position[p, 1] + motion[k, WY])
        vx += m * motion[k, VX]
        vy += m * motion[k, VY]
    x /= mass
    y /= mass
    vx /= mass
    vy /= mass
    inertia = 0.0
    turn = 0.0
    for k in range(begin, end):
        p = work.particle[k]
        m = 1.0 / work.weight[k]
        dx = colliders.position[p, 0] + motion[k, WX] - x
        dy = colliders.position[p, 1] + motion[k, WY] - y
        inertia += m * (dx * dx + dy * dy)
        turn += m * (dx * (motion[k, VY] - vy) - dy * (motion[k, VX] - vx))
        if work.turning[k] > 0.0:
            inertia += colliders.radius[p] * colliders.radius[p] / work.turning[k]
            turn += colliders.radius[p] * motion[k, SURFACE] / work.turning[k]
    spin = turn / inertia if inertia > 0.0 else 0.0
    return Rigid(x, y, vx, vy, spin, 0.5 * mass * (vx * vx + vy * vy) + 0.5 * inertia * spin * spin)


@inner_kernel
def _take_small_steps(work: Work, first: int, last: int, begin: int, end: int, h: float) -> int:
    # All small steps of one island; their number.
    motion = work.motion
    count, softness = _plan(work, first, last, h)
    small = h / count
    scale = 1.0 / count
    _begin(work, first, last, scale)
    _look(work, first, last)
    for step in range(count):
        # The impulses of the last small step start this one.
        for k in range(begin, end):
            if work.weight[k] > 0.0:
                for axis in range(2):
                    motion[k, VX + axis] += work.gain[k, axis] * scale + motion[k, PUSHED_X + axis]
                    motion[k, PUSHED_X + axis] = 0.0
                motion[k, SURFACE] += motion[k, PUSHED_SURFACE]
                motion[k, PUSHED_SURFACE] = 0.0
        _iterate(work, first, last, small, softness, True, False)
        for k in range(begin, end):
            motion[k, WX] += small * motion[k, VX]
            motion[k, WY] += small * motion[k, VY]
        _look(work, first, last)
        _iterate(work, first, last, small, 0.0, False, step == count - 1)
    return count


@inner_kernel
def solve_free_contacts(
    contacts: Contacts, islands: Islands, island_count: int, colliders: Colliders, start: Floats, velocity: Floats,
    spin: Floats, h: float, work: Work,
) -> None:  # fmt: skip
    """Solve the sorted free contacts over a step of h [s]; work.ahead goes with velocity and spin.

    start [m/s] (n, 2): the velocities before anything acted in this step.
    """
    # h v' is the way of one step in which v' acts from the start.
    early = 0.5 * (h - h / small_steps(h))
    for p in range(work.local.shape[0]):
        work.local[p] = -1
        work.ahead[p, 0] = 0.0
        work.ahead[p, 1] = 0.0
        if colliders.inverse_mass[p] > 0.0 and not islands.is_bound[islands.label[p]]:
            work.ahead[p, 0] = early * (start[p, 0] - velocity[p, 0])
            work.ahead[p, 1] = early * (start[p, 1] - velocity[p, 1])
    end = 0
    for g in range(island_count):
        first = islands.first[g]
        last = islands.first[g + 1]
        begin = end
        end = _place_contacts(contacts, islands, first, last, colliders, start, spin, work, end)
        _fill_constraints(contacts, islands, first, last, colliders, work)
        allowed = _energy(work, begin, end, 1.0)
        count = _take_small_steps(work, first, last, begin, end, h)
        _restrain(work, begin, end, colliders, allowed)
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
            spin[p] = spin_of(work.motion[k, SURFACE], spin[p], colliders.radius[p])


def new_work(particles: int, contacts: int) -> Work:
    """Work to be filled in, with room for so many contacts."""
    places = 2 * contacts
    return Work(
        np.zeros((contacts, COLUMNS)), np.zeros((contacts, 2), np.int64), np.zeros(contacts, np.int64),
        np.zeros((contacts, 2), np.int64), np.zeros(contacts, np.int64), np.zeros(contacts + 1, np.int64),
        np.zeros(places, np.int64), np.zeros(places), np.zeros(places), np.zeros((places, 8)), np.zeros((places, 2)),
        np.zeros(places, np.int64), np.zeros(particles, np.int64), np.zeros((particles, 2)),
    )  # fmt: skip
