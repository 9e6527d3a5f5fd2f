"""The energy test of islands: bodies that touch never have more energy together than they had and have saved.

The norm is H = KE(v') + PE(x + h v') of bodies and free particles, less 1/2 sum m (v* - v).(v' - v*): then the work of
forces in the step is that of their impulses at the mean of the velocities v and v', as in free fall. What a step loses
is stored, up to a limit, in the energy budgets of bodies and particles, which pay for pushing apart what penetrates.

Springs and contacts act at v' alone. So where forces do work, an island may have less than it seems by what they do in
half a step, W = 1/2 sum m (v* - v).v': what begins to sink on springs seems to gain that, less its motion. W - KE(v')
is lent to the island, and the parting reserves of its members are overdrawn by it until it is lost. What begins to rise
may save -W - KE(v'); or that is lent, too, when it is stopped. What is faster than forces make it in a step is lent
nothing.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.surfaces import SURFACE_WEIGHT
from sandbox.physics.collision.tunnelling import STOPS, stop_at_terrain, stopped
from sandbox.physics.collision.types import Contacts, weight_of
from sandbox.physics.geometry.rigid import RigidMotion, WeightedSums, centre_of, velocity_at, with_point, with_turn
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.marks import BANK_UNOPENED, TERRAIN_GROUP
from sandbox.physics.solvers.contact.gauss_seidel import (
    CONTACT_SOFTNESS,
    FASTEST_PUSH,
    PENETRATION_SHARE,
    ContactConstraints,
)
from sandbox.physics.solvers.direct.energy_budget import (
    BUDGET_SHARE,
    ENERGY_ROUNDING,
    FALLING,
    ROUNDS,
    SETTLED,
    SLOWING_ROUNDS,
    UNDERDAMPED_BUDGET_SHARE,
    body_energy,
    budget_limit,
    first_ratio,
    is_deep,
    keeps_lengths,
    next_ratio,
    reserve,
    unreturnable,
    without_turn,
)
from sandbox.physics.solvers.direct.islands import (
    ALLOWED,
    BODIES,
    EXCESS,
    LENT,
    MEMBERS,
    TOTAL,
    BodyIslands,
    IslandWorkspace,
)
from sandbox.physics.solvers.direct.network import find_tension
from sandbox.physics.solvers.direct.response import work_of_joints
from sandbox.physics.solvers.direct.rigid_turn import chord_at, kinetic_beside, slow_beside
from sandbox.physics.solvers.direct.system import (
    END_INERTIA,
    END_INWARD,
    END_X,
    END_Y,
    INERTIA,
    INWARD,
    SPIN_X,
    SPIN_Y,
    Rows,
    Span,
    System,
    copy,
    hold_triangles,
    kinetic,
    span_of,
)
from sandbox.physics.state import State
from sandbox.physics.untangling.depenetration import DEPENETRATION_SPEED

# Normals of contacts are parallel where their cross product is at most this.
PARALLEL = 1e-6
# A joint whose gradient sums up to less than this share of its size acts within what it moves, as a motor does.
WITHIN = 1e-9
# What budgets save for pushing apart what penetrates lets a body have this speed [m/s] as a whole. More lets what a
# crash has lost come back, less leaves what lies deep in terrain there for longer.
PAID_PUSH = 0.4


@inner_kernel
def clamp_rows(span: Span, rows: Rows, state: State, h: float) -> bool:
    """Cut the velocities of one body's particles that would cross terrain; whether any does."""
    found = False
    for r in range(span.first_row, span.last_row):
        if state.collides[rows.particle[r]] & TERRAIN_GROUP != 0:
            found = stop_at_terrain(r, rows.position, rows.v, state.terrain, h) or found
    return found


@inner_kernel
def clamp_free(islands: BodyIslands, state: State, h: float) -> None:
    """Cut the velocities of free particles that would cross terrain."""
    for i in range(islands.counts[MEMBERS] - islands.counts[BODIES]):
        p = islands.free[i]
        if state.collides[p] & TERRAIN_GROUP == 0:
            continue
        wx = h * (islands.v0[p, 0] + islands.delta_v[p, 0])
        wy = h * (islands.v0[p, 1] + islands.delta_v[p, 1])
        stops, x, y = stopped(state.position[p, 0], state.position[p, 1], wx, wy, state.terrain)
        if stops > STOPS:
            islands.delta_v[p, 0] = -islands.v0[p, 0]
            islands.delta_v[p, 1] = -islands.v0[p, 1]
        elif stops > 0:
            islands.delta_v[p, 0] += (x - wx) / h
            islands.delta_v[p, 1] += (y - wy) / h


@inner_kernel
def _work_at_ends(body: int, span: Span, system: System, workspace: IslandWorkspace, driven: bool, h: float) -> float:
    # What forces and joints do beyond what they do at the velocities of chords [J]: forces at those of the ends of a
    # step, joints at those right before and right after their impulses.
    rows, bodies, push = system.rows, system.bodies, workspace.delassus.joints.push
    rate0, rate = bodies.spin[body, INWARD], bodies.spin[body, END_INWARD]
    spared = bodies.spared[body]
    if not bodies.spin[body, END_INERTIA] > 0.0 or (rate0 == 0.0 and rate == 0.0 and spared == 0.0):
        return 0.0
    turn, turned = spared / bodies.spin[body, INERTIA], spared / bodies.spin[body, END_INERTIA]
    pivots = bodies.pivot[body] >= 0
    total = 0.0
    for r in range(span.first_row, span.last_row):
        dx = rows.position[r, 0] - bodies.spin[body, SPIN_X]
        dy = rows.position[r, 1] - bodies.spin[body, SPIN_Y]
        ex = rows.position[r, 0] + h * rows.v[r, 0] - bodies.spin[body, END_X]
        ey = rows.position[r, 1] + h * rows.v[r, 1] - bodies.spin[body, END_Y]
        ux, uy = -rate0 * dx - turn * dy, -rate0 * dy + turn * dx
        vx, vy = -rate * ex - turned * ey, -rate * ey + turned * ex
        if pivots:
            total += rows.mass[r] * (rows.v_star[r, 0] - rows.start[r, 0]) * (vx - ux)
            total += rows.mass[r] * (rows.v_star[r, 1] - rows.start[r, 1]) * (vy - uy)
        if driven:
            # Their impulses act where the step begins, and what turns has the velocity of its arc there.
            p = rows.particle[r]
            total += push[p, 0] * (ux + rate * dx - turned * dy) + push[p, 1] * (uy + rate * dy + turned * dx)
    return 0.5 * total


@inner_kernel
def measure_body(k: int, span: Span, system: System, workspace: IslandWorkspace, energy: float, h: float) -> None:
    """Store the norm of one body after the step; its motion and springs then have this energy [J]."""
    islands, rows = workspace.islands, system.rows
    # By the work of forces the norm of a body is below its energy; it tops up underdamped ones.
    factor = 1.0 + UNDERDAMPED_BUDGET_SHARE if system.bodies.underdamped[islands.body[k]] else 1.0
    of_forces = ahead = 0.0
    for r in range(span.first_row, span.last_row):
        x, y = rows.v_star[r, 0] - rows.start[r, 0], rows.v_star[r, 1] - rows.start[r, 1]
        of_forces += rows.mass[r] * (x * (rows.v[r, 0] - rows.v_star[r, 0]) + y * (rows.v[r, 1] - rows.v_star[r, 1]))
        ahead += rows.mass[r] * (x * rows.v[r, 0] + y * rows.v[r, 1])
    islands.energy[k] = energy - 0.5 * of_forces * factor
    work = 0.0
    if islands.driven[k]:
        work = work_of_joints(span, rows, workspace.delassus.joints.push)
    work += _work_at_ends(islands.body[k], span, system, workspace, islands.driven[k], h)
    islands.energy[k] -= work * factor
    islands.ahead[k] = 0.5 * ahead * factor
    islands.moves[k] = kinetic(span, rows.mass, rows.v) * factor


@inner_kernel
def weigh_body(k: int, span: Span, rows: Rows, islands: BodyIslands) -> None:
    """Note what one body weighs, what it would seem to gain if it were stopped, and what it may owe."""
    islands.mass[k] = 0.0
    islands.rises[k] = 0.0
    islands.debt[k] = 0.0
    for r in range(span.first_row, span.last_row):
        islands.mass[k] += rows.mass[r]
        along = rows.start[r, 0] * rows.v_star[r, 0] + rows.start[r, 1] * rows.v_star[r, 1]
        islands.rises[k] -= 0.5 * rows.mass[r] * along
        x, y = rows.v_star[r, 0] - rows.start[r, 0], rows.v_star[r, 1] - rows.start[r, 1]
        islands.debt[k] += 0.25 * rows.mass[r] * (x * x + y * y)


@inner_kernel
def open_free(islands: BodyIslands, state: State, start: FloatRows) -> None:
    """The energies of free particles before the step, and what their budgets hold."""
    bodies = islands.counts[BODIES]
    for i in range(islands.counts[MEMBERS] - bodies):
        p = islands.free[i]
        k = bodies + i
        islands.mass[k] = state.mass[p]
        ux, uy = islands.v0[p, 0], islands.v0[p, 1]
        islands.rises[k] = -0.5 * state.mass[p] * (start[p, 0] * ux + start[p, 1] * uy)
        x, y = ux - start[p, 0], uy - start[p, 1]
        islands.debt[k] = 0.25 * state.mass[p] * (x * x + y * y)
        surface = state.spin[p] * state.radius[p]
        islands.energy0[k] = 0.5 * state.mass[p] * (ux * ux + uy * uy + surface * surface / SURFACE_WEIGHT)
        islands.budget[k] = max(0.0, state.energy_bank[p])
        islands.fresh[k] = state.energy_bank[p] == BANK_UNOPENED


@inner_kernel
def _stored(c: int, contacts: Contacts, terms: ContactConstraints, h: float) -> float:
    # What it costs to bring what penetrates to the velocity at which it is to part [J].
    if not (contacts.gap[c] < 0.0 and terms.normal[c] > 0.0):
        return 0.0
    speed = min(max(0.0, -PENETRATION_SHARE * contacts.gap[c] / h), FASTEST_PUSH)
    return 0.5 * speed * speed / terms.normal[c]


@inner_kernel
def credit_penetration(contacts: Contacts, workspace: IslandWorkspace, inverse_mass: Floats, h: float) -> None:
    """Where a new budget begins, count the energy that separates bodies which overlap at that moment as energy of the
    start.
    """
    islands = workspace.islands
    for c in range(contacts.particle.shape[0]):
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0 and inverse_mass[p] > 0.0 and islands.fresh[islands.member[p]]:
                islands.budget[islands.member[p]] += _stored(c, contacts, workspace.terms, h)
                break


@inner_kernel
def _draw(k: int, cost: float, workspace: IslandWorkspace, system: System, state: State) -> float:
    # Move up to so much [J] of what one member saved for parting into its budget; how much it was.
    islands = workspace.islands
    if k >= islands.counts[BODIES] or not cost > 0.0:
        return 0.0
    lowest = system.bodies.lowest[islands.body[k]]
    drawn = min(cost, max(0.0, state.parting_reserve[lowest]))
    state.parting_reserve[lowest] -= drawn
    islands.budget[k] += drawn
    return drawn


@inner_kernel
def draw_on_reserves(contacts: Contacts, workspace: IslandWorkspace, system: System, state: State) -> None:
    """Where two bodies overlap deeply, pay for pushing them apart from their parting reserves."""
    islands = workspace.islands
    for c in range(contacts.particle.shape[0]):
        if not is_deep(c, contacts, state):
            continue
        one = -1
        other = -1
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0 and state.inverse_mass[p] > 0.0:
                one = islands.member[p] if end == 0 else one
                other = islands.member[p] if end > 0 else other
        if one >= 0 and other >= 0 and one != other:
            reduced = 1.0 / (1.0 / islands.mass[one] + 1.0 / islands.mass[other])
            cost = (
                0.5 * reduced * DEPENETRATION_SPEED * DEPENETRATION_SPEED - islands.budget[one] - islands.budget[other]
            )
            cost -= _draw(one, cost, workspace, system, state)
            _draw(other, cost, workspace, system, state)


@inner_kernel
def limit_pushes(contacts: Contacts, workspace: IslandWorkspace) -> None:
    """Let what penetrates part no faster than budgets can pay for."""
    # A push at speed u beyond that at which its last impulse J rests costs u^2 / (2 R) + J u.
    islands, terms = workspace.islands, workspace.terms
    saved = square = linear = 0.0
    for k in range(islands.counts[MEMBERS]):
        saved += islands.budget[k]
    for c in range(contacts.particle.shape[0]):
        speed = _speed_beyond_rest(c, contacts, terms)
        if speed > 0.0:
            square += 0.5 * speed * speed / terms.normal[c]
            linear += contacts.impulse[c, 0] * speed
    if square + linear > saved:
        # square r^2 + linear r = saved
        ratio = 2.0 * saved / (linear + math.sqrt(linear * linear + 4.0 * square * saved)) if saved > 0.0 else 0.0
        for c in range(contacts.particle.shape[0]):
            speed = _speed_beyond_rest(c, contacts, terms)
            if speed > 0.0:
                terms.bias[c] += (1.0 - ratio) * speed


@inlined_kernel
def _speed_beyond_rest(c: int, contacts: Contacts, terms: ContactConstraints) -> float:
    if not (contacts.gap[c] < 0.0 and contacts.bounce[c] < 0.0 and terms.normal[c] > 0.0):
        return 0.0
    return -terms.bias[c] - CONTACT_SOFTNESS * terms.normal[c] * contacts.impulse[c, 0]


@inlined_kernel
def _slot_of(k: int, islands: BodyIslands, system: System) -> int:
    # The particle that has the budget and the parting reserve of a member.
    bodies = islands.counts[BODIES]
    return system.bodies.lowest[islands.body[k]] if k < bodies else islands.free[k - bodies]


@inner_kernel
def check_energy(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, start: FloatRows
) -> bool:  # fmt: skip
    """Tally the energy of an island and what is allowed; whether it passes the test."""
    islands, surface, push = workspace.islands, workspace.terms.surface, workspace.delassus.joints.push
    bodies = islands.counts[BODIES]
    for i in range(islands.counts[MEMBERS] - bodies):
        p = islands.free[i]
        ux, uy = state.velocity[p, 0], state.velocity[p, 1]
        vx, vy = islands.v0[p, 0] + islands.delta_v[p, 0], islands.v0[p, 1] + islands.delta_v[p, 1]
        work = (ux - start[p, 0]) * (vx - ux) + (uy - start[p, 1]) * (vy - uy)
        turning = surface[p] * surface[p] / SURFACE_WEIGHT
        islands.energy[bodies + i] = 0.5 * state.mass[p] * (vx * vx + vy * vy + turning - work)
        ahead = (ux - start[p, 0]) * vx + (uy - start[p, 1]) * vy
        islands.ahead[bodies + i] = 0.5 * state.mass[p] * ahead
        islands.moves[bodies + i] = 0.5 * state.mass[p] * (vx * vx + vy * vy)
        if push.shape[0] > 0:
            of_joints = push[p, 0] * (start[p, 0] + vx) + push[p, 1] * (start[p, 1] + vy)
            islands.energy[bodies + i] -= 0.5 * of_joints
    total = allowed = sinks = rises = borrows = 0.0
    for k in range(islands.counts[MEMBERS]):
        total += islands.energy[k]
        allowed += islands.energy0[k] * (1.0 + ENERGY_ROUNDING) + islands.budget[k]
        sinks += islands.ahead[k] - islands.moves[k]
        rises += islands.rises[k]
        borrows += islands.debt[k] + min(0.0, state.parting_reserve[_slot_of(k, islands, system)])
    # What runs a belt does the work of its friction at the speed of its surface.
    for c in range(contacts.particle.shape[0]):
        work = -contacts.belt[c] * contacts.impulse[c, 1]
        k = _member_of(c, contacts, islands, state.inverse_mass) if work > 0.0 else -1
        if k >= 0:
            if k < bodies and system.bodies.underdamped[islands.body[k]]:
                work *= 1.0 + UNDERDAMPED_BUDGET_SHARE
            allowed += work
    # What may be lent: to what begins to sink, and to what is stopped as it begins to rise.
    lent = max(0.0, min(max(0.0, sinks) + max(0.0, rises), borrows))  # (29)
    islands.tally[0, TOTAL] = total
    islands.tally[0, ALLOWED] = allowed + lent
    islands.tally[0, LENT] = lent
    return passes(islands)


@inlined_kernel
def passes(islands: BodyIslands) -> bool:
    """Whether an island passed its last energy test."""
    return islands.tally[0, TOTAL] <= islands.tally[0, ALLOWED]


@inner_kernel
def _member_of(c: int, contacts: Contacts, islands: BodyIslands, inverse_mass: Floats) -> int:
    # The first body or free particle of a contact that can move, by its place among the members; -1: none.
    for end in range(3):
        p, _ = weight_of(contacts, c, end)
        if p >= 0 and inverse_mass[p] > 0.0:
            return islands.member[p]
    return -1


@inner_kernel
def goes_on(islands: BodyIslands, system: System, h: float) -> bool:
    """Whether an island that fails is to be solved again: lengths come nearer, or what springs can give back is too
    much, too; if that is allowed, it passes.
    """
    tally = islands.tally
    excess, before = tally[0, TOTAL] - tally[0, ALLOWED], tally[0, EXCESS]
    tally[0, EXCESS] = excess
    if excess < FALLING * before:
        return True
    _take_off_unreturnable(islands, system, h)
    if passes(islands):
        return False
    for k in range(islands.counts[BODIES]):
        kept = system.bodies.unreturnable[islands.body[k]]
        islands.energy[k] += kept
        tally[0, TOTAL] += kept
        system.bodies.unreturnable[islands.body[k]] = 0.0
    return abs(excess - before) > SETTLED * excess


@inner_kernel
def _take_off_unreturnable(islands: BodyIslands, system: System, h: float) -> None:
    for k in range(islands.counts[BODIES]):
        body = islands.body[k]
        kept = unreturnable(body, span_of(system, body), system, False, h)
        islands.energy[k] -= kept
        islands.tally[0, TOTAL] -= kept


@inner_kernel
def slow_down(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, start: FloatRows, h: float
) -> None:  # fmt: skip
    """Take off what an island moves beside the motion that nothing outside holds, then what that turns, until it
    passes, by as little as that asks for.
    """
    islands, rows = workspace.islands, system.rows
    bodies = islands.counts[BODIES]
    motion, held = _motion_to_keep(contacts, workspace, system, state)
    _take_off_unreturnable(islands, system, h)
    ratio = left = 1.0
    for done in range(SLOWING_ROUNDS):
        if done % ROUNDS == 0:
            if done > 0:
                motion = without_turn(motion)
            for k in range(bodies):
                copy(span_of(system, islands.body[k]), rows.v, islands.v_free)
            moves = _kinetic_beside(motion, islands, system, state)
            ratio, left = first_ratio(islands.tally[0, TOTAL] - islands.tally[0, ALLOWED], moves), 1.0
        else:
            ratio = next_ratio(ratio, done)
        for k in range(bodies):
            body = islands.body[k]
            span = span_of(system, body)
            copy(span, islands.v_free, rows.v)
            slow_beside(span, rows, motion, ratio, h)
            clamp_rows(span, rows, state, h)
            hold_triangles(span, system, h)
            energy = body_energy(body, span, system, h) - unreturnable(body, span, system, keeps_lengths(done), h)
            measure_body(k, span, system, workspace, energy, h)
        # Free particles keep no copy: what is left of them follows from round to round.
        factor = ratio / left if left > 0.0 else 0.0
        for i in range(islands.counts[MEMBERS] - bodies):
            p = islands.free[i]
            u, v = chord_at(motion, state.position[p, 0], state.position[p, 1], h)
            vx, vy = islands.v0[p, 0] + islands.delta_v[p, 0], islands.v0[p, 1] + islands.delta_v[p, 1]
            islands.delta_v[p, 0] = u + factor * (vx - u) - islands.v0[p, 0]
            islands.delta_v[p, 1] = v + factor * (vy - v) - islands.v0[p, 1]
            if held:
                workspace.terms.surface[p] *= factor
        left = ratio
        if check_energy(contacts, workspace, system, state, start):
            break
    for k in range(bodies):
        find_tension(span_of(system, islands.body[k]), system, h)


@inner_kernel
def _motion_to_keep(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State
) -> tuple[RigidMotion, bool]:
    # The rigid motion of an island's momenta; of what smooth ground carries the velocity along that; rest, and True,
    # where something outside holds it.
    islands = workspace.islands
    rest = RigidMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    nx = ny = 0.0
    for k in range(islands.counts[BODIES]):
        if system.bodies.pivot[islands.body[k]] != -1:
            return rest, True
    for c in range(contacts.particle.shape[0]):
        inside, outside = False, contacts.end_a[c] < 0 and contacts.end_b[c] < 0
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            inside = inside or (p >= 0 and state.inverse_mass[p] > 0.0)
            outside = outside or (p >= 0 and not state.inverse_mass[p] > 0.0)
        if not (inside and outside and contacts.impulse[c, 0] > 0.0):
            continue
        cross = nx * contacts.normal[c, 1] - ny * contacts.normal[c, 0]
        if contacts.impulse[c, 1] != 0.0 or abs(cross) > PARALLEL:
            return rest, True
        nx, ny = contacts.normal[c, 0], contacts.normal[c, 1]
    # Hands and joints that push from outside: their gradient does not sum up to 0.
    joints, rows = workspace.delassus.joints, workspace.delassus.joints.rows
    for i in range(joints.listed.shape[0]):
        x = y = size = 0.0
        for e in range(rows.first[joints.listed[i]], rows.first[joints.listed[i] + 1]):
            x += rows.gradient[e, 0]
            y += rows.gradient[e, 1]
            size += abs(rows.gradient[e, 0]) + abs(rows.gradient[e, 1])
        if abs(x) + abs(y) > WITHIN * size:
            return rest, True
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(_points(islands, system)):
        p, u, v = _point(i, islands, system)
        sums = with_point(sums, state.mass[p], state.position[p, 0], state.position[p, 1], u, v)
    motion = centre_of(sums)
    if nx != 0.0 or ny != 0.0:
        along = motion.v * nx - motion.u * ny
        return RigidMotion(motion.x, motion.y, -along * ny, along * nx, 0.0, 0.0), False
    for i in range(_points(islands, system)):
        p, u, v = _point(i, islands, system)
        motion = with_turn(motion, state.mass[p], state.position[p, 0], state.position[p, 1], u, v)
    return motion, False


@inner_kernel
def _points(islands: BodyIslands, system: System) -> int:
    # How many points an island has: rows of its bodies, then free particles.
    count = islands.counts[MEMBERS] - islands.counts[BODIES]
    for k in range(islands.counts[BODIES]):
        span = span_of(system, islands.body[k])
        count += span.last_row - span.first_row
    return count


@inner_kernel
def _point(i: int, islands: BodyIslands, system: System) -> tuple[int, float, float]:
    # The particle of a point, and its velocity after the step.
    for k in range(islands.counts[BODIES]):
        span = span_of(system, islands.body[k])
        if i < span.last_row - span.first_row:
            r = span.first_row + i
            return system.rows.particle[r], system.rows.v[r, 0], system.rows.v[r, 1]
        i -= span.last_row - span.first_row
    p = islands.free[i]
    return p, islands.v0[p, 0] + islands.delta_v[p, 0], islands.v0[p, 1] + islands.delta_v[p, 1]


@inner_kernel
def _kinetic_beside(motion: RigidMotion, islands: BodyIslands, system: System, state: State) -> float:
    # T: the kinetic energy [J] of what an island moves beside a motion.
    bodies, total = islands.counts[BODIES], 0.0
    for k in range(bodies):
        total += kinetic_beside(span_of(system, islands.body[k]), system.rows, motion)
    for i in range(islands.counts[MEMBERS] - bodies):
        p = islands.free[i]
        u, v = velocity_at(motion, state.position[p, 0], state.position[p, 1])
        u, v = islands.v0[p, 0] + islands.delta_v[p, 0] - u, islands.v0[p, 1] + islands.delta_v[p, 1] - v
        total += 0.5 * state.mass[p] * (u * u + v * v)
    return total


@inner_kernel
def _held(c: int, contacts: Contacts, terms: ContactConstraints, h: float) -> float:
    # What the spring of a contact holds where the step ends [J]: 1/2 k x'^2, k = Cs / Cd K / h^2.
    normal = terms.normal[c]
    if not normal > 0.0 or not contacts.impulse[c, 0] > 0.0 or contacts.bounce[c] >= 0.0:
        return 0.0
    x = contacts.gap[c] - h * (terms.bias[c] + CONTACT_SOFTNESS * normal * contacts.impulse[c, 0])
    if not x < 0.0:
        return 0.0
    rate = min(-x / h, FASTEST_PUSH / PENETRATION_SHARE)
    return 0.5 * PENETRATION_SHARE / (CONTACT_SOFTNESS * normal) * rate * rate


@inner_kernel
def _settle_loans(workspace: IslandWorkspace, system: System, state: State, mass: float) -> float:
    # Overdraw reserves by what was lent and used, each by its mass, or pay back from what was lost; the rest of that.
    islands, reserves = workspace.islands, state.parting_reserve
    lost = islands.tally[0, ALLOWED] - islands.tally[0, LENT] - islands.tally[0, TOTAL]
    used = min(islands.tally[0, LENT], -lost)
    for k in range(islands.counts[MEMBERS]):
        slot = _slot_of(k, islands, system)
        if used > 0.0:
            reserves[slot] -= used * islands.mass[k] / mass
        else:
            paid = max(0.0, min(-reserves[slot], lost))
            reserves[slot] += paid
            lost -= paid
    return lost


@inner_kernel
def store_energies(contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, h: float) -> None:
    """Store the rest of an island's allowed energy, up to the limits of its budgets."""
    islands, bodies = workspace.islands, system.bodies
    held = mass = 0.0
    for c in range(contacts.particle.shape[0]):
        held += _held(c, contacts, workspace.terms, h)
    for k in range(islands.counts[MEMBERS]):
        mass += islands.mass[k]
    left = _settle_loans(workspace, system, state, mass)
    # The most that each budget may hold: a share of the member's energy; or by its mass what contacts hold, of what it
    # has itself lost: what a light body loses as it hits a heavy one would push that out of what it lies in. And of
    # that what forces take from it as it slowly rises.
    for k in range(islands.counts[MEMBERS]):
        is_body = k < islands.counts[BODIES]
        most = budget_limit(islands.body[k], system) if is_body else BUDGET_SHARE * islands.energy0[k]
        lost = islands.budget[k] + islands.energy0[k] - islands.energy[k]
        least = min(held / mass, 0.5 * PAID_PUSH * PAID_PUSH) * islands.mass[k]
        limit = max(most, min(least, lost)) + max(0.0, min(-islands.ahead[k] - islands.moves[k], lost))
        # As in step_body.py: an inverted body keeps all that it lost for the way back to its form.
        if is_body and bodies.inverted[islands.body[k]] and not bodies.anchored[islands.body[k]]:
            limit = max(limit, lost)
        stored = max(0.0, min(left, limit))
        left -= stored
        state.energy_bank[_slot_of(k, islands, system)] = stored
    for k in range(islands.counts[BODIES]):
        body = islands.body[k]
        state.unreturnable[bodies.lowest[body]] = bodies.unreturnable[body]
        left = reserve(body, span_of(system, body), system, state, left)
