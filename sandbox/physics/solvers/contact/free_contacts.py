"""Contacts of free particles among themselves and with what cannot move: small steps, alike in every solver.

No spring joins a free particle, so a step of a heap can be taken in many small ones whose cost is an iteration over its
contacts: overlap falls with the square of their number. In each, a first iteration pushes apart what overlaps, the
particles move, and a second one, which leaves overlap alone, takes back the speed that pushing has given (soft contacts
that relax: Catto 2023, "Solver2D"; small steps: Macklin and others 2019). What touches nothing goes as far as it would
in small steps: where their number changed with what is near, a disc's energy would change in flight.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.surfaces import SLOWEST_BOUNCE, SURFACE_WEIGHT, spin_of
from sandbox.physics.collision.types import Colliders, Contacts
from sandbox.physics.geometry.rigid import (
    RigidMotion,
    WeightedSums,
    centre_of,
    turn_rate,
    velocity_at,
    with_point,
    with_spin,
    with_turn,
)
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.solvers.contact.free_constraints import (
    ACROSS,
    ALONG,
    ARM,
    BOUNCE,
    COMING,
    FOLLOWS,
    FRICTION,
    GAP,
    HARDNESS,
    IMPACT,
    MASS,
    MASS_ACROSS,
    NX,
    NY,
    OVERLAP_SHARE,
    PUSHED_SURFACE,
    PUSHED_X,
    PUSHED_Y,
    RISES,
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
    FreeContactScratch,
    Islands,
    apply,
    fill_constraints,
    look,
    meet,
    plan_islands,
    small_steps,
)
from sandbox.physics.solvers.contact.free_impacts import collide_fast
from sandbox.physics.solvers.contact.free_ways import lead
from sandbox.physics.solvers.contact.gauss_seidel import FASTEST_PUSH
from sandbox.physics.ways import Ways, is_followed

# In place of a number of small steps.
SOLVED = 0


@inner_kernel
def solve_free_contacts(
    contacts: Contacts, islands: Islands, island_count: int, colliders: Colliders, start: FloatRows,
    velocity: FloatRows, spin: Floats, h: float, work: FreeContactScratch, ways: Ways,
) -> None:  # fmt: skip
    """Solve the free contacts, as sorted, over a step of h [s]; work.ahead and ways go with velocity and spin.

    start [m/s] (n, 2): the velocities before anything acted in this step.
    """
    # h v' is the way of one step in which v' acts from the start.
    early = 0.5 * (h - h / small_steps(h))
    for p in range(work.local.shape[0]):
        work.local[p] = -1
        work.ahead[p, 0] = 0.0
        work.ahead[p, 1] = 0.0
        if colliders.inverse_mass[p] > 0.0 and not islands.is_coupled[islands.label[p]]:
            work.ahead[p, 0] = early * (start[p, 0] - velocity[p, 0])
            work.ahead[p, 1] = early * (start[p, 1] - velocity[p, 1])
    plan_islands(contacts, islands, island_count, colliders, start, spin, h, work)
    for g in range(island_count):
        count = work.steps[g]
        if count != SOLVED:
            _solve_beside(contacts, islands, colliders, _put_beside(work, g, island_count), count, h, work, ways)
    for k in range(work.begin[island_count]):
        if work.weight[k] > 0.0:
            p = work.particle[k]
            for axis in range(2):
                velocity[p, axis] = work.motion[k, VX + axis]
                work.ahead[p, axis] = work.motion[k, WX + axis] - h * work.motion[k, VX + axis]
            spin[p] = spin_of(work.motion[k, SURFACE], spin[p], colliders.radius[p])


@inner_kernel
def _solve_beside(
    contacts: Contacts,
    islands: Islands,
    colliders: Colliders,
    besides: int,
    count: int,
    h: float,
    work: FreeContactScratch,
    ways: Ways,
) -> None:
    # Solve islands side by side, in so many small steps.
    rows = fill_constraints(contacts, islands, colliders, besides, work)
    for b in range(besides):
        g = work.beside[b]
        work.allowed[g] = _energy(work, work.begin[g], work.begin[g + 1], 1.0)
    _take_small_steps(work, rows, besides, count, h, ways, colliders.position)
    for b in range(besides):
        g = work.beside[b]
        _restrain(work, work.begin[g], work.begin[g + 1], colliders, work.allowed[g])
    for i in range(rows):
        c = work.contact[i]
        contacts.impulse[c, 0] = work.constraint[i, ALONG] * count
        contacts.impulse[c, 1] = work.constraint[i, ACROSS] * count
        contacts.impact[c] += work.constraint[i, IMPACT]


@inner_kernel
def _energy(work: FreeContactScratch, begin: int, end: int, gained: float) -> float:
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
def _take_small_steps(
    work: FreeContactScratch, rows: int, besides: int, count: int, h: float, ways: Ways, position: FloatRows
) -> None:  # fmt: skip
    # All small steps, so many, of islands side by side, whose contacts are the first rows.
    small = h / count
    scale = 1.0 / count
    # The impulses that contacts bring along, as those of a small step.
    row = work.constraint
    for i in range(rows):
        row[i, ALONG] *= scale
        row[i, ACROSS] *= scale
        _push(work, i, row[i, NX], row[i, NY], row[i, ALONG], row[i, ACROSS], row[i, ARM])
    look(work, 0, rows)
    for done in range(count):
        late = small * done
        for b in range(besides):
            # What forces add in a small step, and what the impulses of the last one do.
            begin = work.begin[work.beside[b]]
            end = work.begin[work.beside[b] + 1]
            motion = work.motion
            for k in range(begin, end):
                if work.weight[k] > 0.0:
                    for axis in range(2):
                        more = work.gain[k, axis] * scale + motion[k, PUSHED_X + axis]
                        work.added[k, axis] = more
                        motion[k, VX + axis] += more
                        motion[k, PUSHED_X + axis] = 0.0
                    motion[k, SURFACE] += motion[k, PUSHED_SURFACE]
                    motion[k, PUSHED_SURFACE] = 0.0
                    work.turned[k] = 0.0
        hits = _iterate(work, rows, small, True, True)
        if hits > 0 and not collide_fast(work, hits, rows, besides, small, late, ways, position):
            look(work, 0, rows)
            _iterate(work, rows, small, True, False)
        for b in range(besides):
            begin = work.begin[work.beside[b]]
            end = work.begin[work.beside[b] + 1]
            for k in range(begin, end):
                work.motion[k, WX] += small * work.motion[k, VX]
                work.motion[k, WY] += small * work.motion[k, VY]
                if work.weight[k] > 0.0 and is_followed(ways, work.particle[k]):
                    lead(work, k, small + late, ways, position)
        look(work, 0, rows)
        _iterate(work, rows, small, False, True)


@inlined_kernel
def _push(work: FreeContactScratch, i: int, nx: float, ny: float, jn: float, jt: float, arm: float) -> None:
    # Add what the impulses of a contact do to its particles to what the next small step starts with.
    row = work.constraint
    motion = work.motion
    jx = jn * nx - jt * ny
    jy = jn * ny + jt * nx
    jt *= arm
    p = work.end[i, 0]
    motion[p, PUSHED_X] += jx * row[i, WEIGHT_P]
    motion[p, PUSHED_Y] += jy * row[i, WEIGHT_P]
    motion[p, PUSHED_SURFACE] -= jt * row[i, TURN_P]
    q = work.end[i, 1]
    motion[q, PUSHED_X] -= jx * row[i, WEIGHT_Q]
    motion[q, PUSHED_Y] -= jy * row[i, WEIGHT_Q]
    motion[q, PUSHED_SURFACE] -= jt * row[i, TURN_Q]


@inlined_kernel
def _iterate(work: FreeContactScratch, count: int, small: float, pushes: bool, skips: bool) -> int:
    # One Gauss-Seidel iteration over contacts as they were looked at. pushes: what overlaps is pushed apart, softly;
    # with the impulses of the other iteration of a small step the next one starts. skips: what meets fast is an impact,
    # which is left out and noted in `hit`, or one of the next small step. How many impacts there are.
    # J = max(0, (J - (u + b) m) / (1 + soft));  |J_t| <= friction J, against the slip of the surfaces
    row, end, motion = work.constraint, work.end, work.motion
    rate = 1.0 / small
    displaced = False
    hits = 0
    for i in range(count):
        p = end[i, 0]
        q = end[i, 1]
        if displaced or work.turned[p] + work.turned[q] > 0.0:
            look(work, i, i + 1)
        ux, uy = motion[p, VX] - motion[q, VX], motion[p, VY] - motion[q, VY]
        late = 0.0
        if row[i, WAY] == COMING:
            late = meet(work, i, p, q, small) if pushes else math.inf
            if late == math.inf:
                continue
            displaced = displaced or late > 0.0
        nx, ny, gap = row[i, NX], row[i, NY], row[i, GAP]
        along = nx * ux + ny * uy
        old = row[i, ALONG]
        bounce = row[i, BOUNCE]
        bias, hard = _bias(bounce, gap, rate, row[i, HARDNESS], pushes)
        if row[i, WAY] == RISES and gap > 0.0 and old == 0.0 and along >= -SLOWEST_BOUNCE:
            if not pushes or -small * along <= gap:
                continue
            late, bias = -gap / along, 0.0
            work.turned[p] = late if work.turned[p] == 0.0 else min(late, work.turned[p])
            work.onto[p] = i
        if old == 0.0 and along + bias >= 0.0:
            continue
        if skips and along < -SLOWEST_BOUNCE:
            if not pushes:
                continue
            if gap + small * along <= 0.0:
                work.hit[hits], work.met[hits] = i, late
                hits += 1
                continue
        arm = row[i, ARM]
        mass = row[i, MASS] * hard
        borne = _borne(work, i, p, along, rate, pushes)
        new = max(old * borne, (old * hard - bias * mass) - along * mass)
        most = row[i, FRICTION] * new
        last = row[i, ACROSS]
        slip = nx * uy - ny * ux - arm * (motion[p, SURFACE] + motion[q, SURFACE])
        across = min(most, max(-most, last - slip * row[i, MASS_ACROSS]))  # (28)
        row[i, ALONG] = new
        row[i, ACROSS] = across
        apply(work, i, nx, ny, new - old, across - last, arm, late, not pushes and new > 0.0)
        if borne > 0.0 and not pushes:
            row[i, ALONG], row[i, ACROSS] = 0.0, 0.0
        elif not pushes and new > 0.0:
            _push(work, i, nx, ny, new, across, arm)
    return hits


@inner_kernel
def _bias(bounce: float, gap: float, rate: float, hardness: float, pushes: bool) -> tuple[float, float]:
    # The velocity b [m/s] with which the surfaces of a contact are to separate (0: they stay together), and its
    # hardness, 1 / (1 + soft); rate: small steps in a second.
    if bounce >= 0.0:
        return -bounce, 1.0
    if gap > 0.0:
        return gap * rate, 1.0
    if pushes:
        return max(OVERLAP_SHARE * gap * rate, -FASTEST_PUSH), hardness
    return 0.0, 1.0


@inlined_kernel
def _borne(work: FreeContactScratch, i: int, p: int, along: float, rate: float, pushes: bool) -> float:
    # The share of its impulse that a contact keeps which a particle has left for an edge that rises; 0: it has not. It
    # has borne the particle until then, and velocities stand half a step behind.
    if not along > 0.0 or work.turned[p] == 0.0 or work.onto[p] == i or work.constraint[i, WAY] == FOLLOWS:
        return 0.0
    return 1.0 if pushes else min(1.0, work.turned[p] * rate + 0.5)


@inner_kernel
def _restrain(work: FreeContactScratch, begin: int, end: int, colliders: Colliders, allowed: float) -> None:
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
    common = RigidMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    kept = 0.0
    if apart:
        common, kept = _rigid_motion(work, begin, end, colliders)
    beside = after - kept
    factor = math.sqrt(max(0.0, allowed - kept) / beside) if beside > 0.0 else 0.0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            p = work.particle[k]
            x, y = _place_now(work, k, colliders)
            vx, vy = velocity_at(common, x, y)
            motion[k, VX] = vx + factor * (motion[k, VX] - vx)
            motion[k, VY] = vy + factor * (motion[k, VY] - vy)
            if work.turning[k] > 0.0:
                surface = turn_rate(common) * colliders.radius[p]
                motion[k, SURFACE] = surface + factor * (motion[k, SURFACE] - surface)


@inner_kernel
def _rigid_motion(work: FreeContactScratch, begin: int, end: int, colliders: Colliders) -> tuple[RigidMotion, float]:
    # That of an island at the end of the step, the discs' own turning included; its energy [J].
    motion = work.motion
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(begin, end):
        x, y = _place_now(work, k, colliders)
        sums = with_point(sums, 1.0 / work.weight[k], x, y, motion[k, VX], motion[k, VY])
    common = centre_of(sums)
    for k in range(begin, end):
        x, y = _place_now(work, k, colliders)
        common = with_turn(common, 1.0 / work.weight[k], x, y, motion[k, VX], motion[k, VY])
        if work.turning[k] > 0.0:
            radius = colliders.radius[work.particle[k]]
            common = with_spin(common, radius * radius / work.turning[k], radius * motion[k, SURFACE] / work.turning[k])
    turn = turn_rate(common)
    squared = common.u * common.u + common.v * common.v
    return common, 0.5 * sums.weight * squared + 0.5 * common.inertia * turn * turn


@inlined_kernel
def _place_now(work: FreeContactScratch, k: int, colliders: Colliders) -> tuple[float, float]:
    position, p = colliders.position, work.particle[k]
    return position[p, 0] + work.motion[k, WX], position[p, 1] + work.motion[k, WY]


@inner_kernel
def _put_beside(work: FreeContactScratch, first: int, island_count: int) -> int:
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
