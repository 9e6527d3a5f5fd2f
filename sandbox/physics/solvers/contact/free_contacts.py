"""Contacts of free particles among themselves and with what cannot move: small steps, alike in every solver.

No spring joins a free particle, so a step of a heap can be taken in many small ones whose cost is an iteration over its
contacts: overlap falls with the square of their number. In each, a first iteration pushes apart what overlaps, the
particles move, and a second one, which leaves overlap alone, takes back the speed that pushing has given (soft contacts
that relax: Catto 2023, "Solver2D"; small steps: Macklin and others 2019). What touches nothing goes as far as it would
in small steps: where their number changed with what is near, a disc's energy would change in flight.
"""

import math
from typing import NamedTuple

from sandbox.physics.collision.restitution import SLOWEST_BOUNCE
from sandbox.physics.collision.turning import SURFACE_WEIGHT, spin_of
from sandbox.physics.collision.types import Colliders, Contacts
from sandbox.physics.equation import SHORTEST
from sandbox.physics.jit import inlined_kernel, inner_kernel, unsigned
from sandbox.physics.solvers.contact.free_constraints import (
    ACROSS,
    ALONG,
    ALONG_CENTRES,
    APART_X,
    APART_Y,
    ARM,
    BOUNCE,
    COMING,
    FOLLOWS,
    FRICTION,
    GAP,
    HARDNESS,
    MASS,
    MASS_ACROSS,
    NX,
    NY,
    OVERLAP_SHARE,
    PER_REACH,
    PUSHED_SURFACE,
    PUSHED_X,
    PUSHED_Y,
    RATIO_P,
    RATIO_Q,
    REACH,
    RESTITUTION,
    ROLL_P,
    ROLL_Q,
    ROLLING,
    ROLLING_MASS,
    SURFACE,
    TURN_P,
    TURN_Q,
    VX,
    VY,
    WAY,
    WEIGHT_P,
    WEIGHT_Q,
    WX,
    WY,
    Work,
    fill_constraints,
    plan_islands,
)
from sandbox.physics.solvers.contact.free_islands import Islands
from sandbox.physics.solvers.contact.gauss_seidel import FASTEST_PUSH
from sandbox.physics.solvers.contact.small_steps import small_steps
from sandbox.physics.state import Floats

# In place of a number of small steps.
SOLVED = 0


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
def _begin(work: Work, count: int, scale: float) -> None:
    # The impulses that contacts bring along, as those of a small step.
    row = work.constraint
    for c in range(count):
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
def _iterate(work: Work, count: int, small: float, pushes: bool, is_last: bool) -> None:
    # One Gauss-Seidel iteration over contacts as they were looked at. pushes: what overlaps is pushed apart, softly;
    # with the impulses of the other iteration of a small step the next one starts. is_last: whether the step ends with
    # it; what would meet in the first small step of the next one, and bounce there, is not slowed before.
    # J = max(0, (J - (u + b) m) / (1 + soft));  |J_t| <= friction J, against the slip of the surfaces
    row, end, motion = work.constraint, work.end, work.motion
    rate = 1.0 / small
    displaced = False
    for c in range(count):
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
        bias, hard = _bias(bounce, gap, rate, row[i, HARDNESS], pushes)
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
def _begin_small_step(work: Work, begin: int, end: int, scale: float) -> None:
    # What forces add in a small step, and what the impulses of the last one do.
    motion = work.motion
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            for axis in range(2):
                motion[k, VX + axis] += work.gain[k, axis] * scale + motion[k, PUSHED_X + axis]
                motion[k, PUSHED_X + axis] = 0.0
            motion[k, SURFACE] += motion[k, PUSHED_SURFACE]
            motion[k, PUSHED_SURFACE] = 0.0


@inner_kernel
def _move(work: Work, begin: int, end: int, small: float) -> None:
    for k in range(begin, end):
        work.motion[k, WX] += small * work.motion[k, VX]
        work.motion[k, WY] += small * work.motion[k, VY]


@inner_kernel
def _take_small_steps(work: Work, rows: int, besides: int, count: int, h: float) -> None:
    # All small steps, so many, of islands side by side, whose contacts are the first rows.
    small = h / count
    scale = 1.0 / count
    _begin(work, rows, scale)
    _look(work, 0, rows)
    for step in range(count):
        for b in range(besides):
            _begin_small_step(work, work.begin[work.beside[b]], work.begin[work.beside[b] + 1], scale)
        _iterate(work, rows, small, True, False)
        for b in range(besides):
            _move(work, work.begin[work.beside[b]], work.begin[work.beside[b] + 1], small)
        _look(work, 0, rows)
        _iterate(work, rows, small, False, step == count - 1)


@inner_kernel
def _put_beside(work: Work, first: int, island_count: int) -> int:
    # The islands from the first one on that are solved side by side with it, marked as solved; how many.
    count = work.steps[first]
    work.beside[0] = first
    work.steps[first] = SOLVED
    if work.alone[first]:
        return 1
    besides = 1
    for g in range(first + 1, island_count):
        if work.steps[g] == count and not work.alone[g]:
            work.beside[besides] = g
            work.steps[g] = SOLVED
            besides += 1
    return besides


@inner_kernel
def _solve_beside(
    contacts: Contacts, islands: Islands, colliders: Colliders, besides: int, count: int, h: float, work: Work
) -> None:
    # Solve islands side by side, in so many small steps.
    rows = fill_constraints(contacts, islands, colliders, besides, work)
    for b in range(besides):
        g = work.beside[b]
        work.allowed[g] = _energy(work, work.begin[g], work.begin[g + 1], 1.0)
    _take_small_steps(work, rows, besides, count, h)
    for b in range(besides):
        g = work.beside[b]
        _restrain(work, work.begin[g], work.begin[g + 1], colliders, work.allowed[g])
    for i in range(rows):
        c = work.contact[i]
        contacts.impulse[c, 0] = work.constraint[i, ALONG] * count
        contacts.impulse[c, 1] = work.constraint[i, ACROSS] * count


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
    plan_islands(contacts, islands, island_count, colliders, start, spin, h, work)
    for g in range(island_count):
        count = work.steps[g]
        if count != SOLVED:
            _solve_beside(contacts, islands, colliders, _put_beside(work, g, island_count), count, h, work)
    for k in range(work.begin[island_count]):
        if work.weight[k] > 0.0:
            p = work.particle[k]
            for axis in range(2):
                velocity[p, axis] = work.motion[k, VX + axis]
                work.ahead[p, axis] = work.motion[k, WX + axis] - h * work.motion[k, VX + axis]
            spin[p] = spin_of(work.motion[k, SURFACE], spin[p], colliders.radius[p])
