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

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.collision.surfaces import SURFACE_WEIGHT
from sandbox.physics.collision.tunnelling import STOPS, stop_at_terrain, stopped
from sandbox.physics.collision.types import Contacts, weight_of
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
    LAST_HALVINGS,
    UNDERDAMPED_BUDGET_SHARE,
    body_energy,
    budget_limit,
    is_deep,
    reserve,
)
from sandbox.physics.solvers.direct.islands import BODIES, ISLANDS, MEMBERS, BodyIslands, IslandWorkspace
from sandbox.physics.solvers.direct.network import find_tension
from sandbox.physics.solvers.direct.response import work_of_joints
from sandbox.physics.solvers.direct.rigid_turn import damp_within
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
    scale,
    span_of,
)
from sandbox.physics.state import State
from sandbox.physics.untangling.depenetration import DEPENETRATION_SPEED

# Halvings of what moves within bodies that fail the test, before all that moves is slowed down.
INNER_HALVINGS = 3
# The same of a body that joints alone drive.
DRIVEN_HALVINGS = 12
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
    """Note what one body weighs, and what it would seem to gain if it were stopped."""
    islands.mass[k] = 0.0
    islands.rises[k] = 0.0
    for r in range(span.first_row, span.last_row):
        islands.mass[k] += rows.mass[r]
        along = rows.start[r, 0] * rows.v_star[r, 0] + rows.start[r, 1] * rows.v_star[r, 1]
        islands.rises[k] -= 0.5 * rows.mass[r] * along


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
        surface = state.spin[p] * state.radius[p]
        islands.energy0[k] = 0.5 * state.mass[p] * (ux * ux + uy * uy + surface * surface / SURFACE_WEIGHT)
        islands.budget[k] = max(0.0, state.energy_bank[p])
        islands.fresh[k] = state.energy_bank[p] == BANK_UNOPENED


@inner_kernel
def _part_speed(gap: float, h: float) -> float:
    # At what speed what penetrates is to part [m/s].
    return min(max(0.0, -PENETRATION_SHARE * gap / h), FASTEST_PUSH)


@inner_kernel
def _stored(c: int, contacts: Contacts, terms: ContactConstraints, h: float) -> float:
    # What it costs to bring what penetrates to the velocity at which it is to part [J].
    if not (contacts.gap[c] < 0.0 and terms.normal[c] > 0.0):
        return 0.0
    speed = _part_speed(contacts.gap[c], h)
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
def any_fails(islands: BodyIslands) -> bool:
    """Whether any island failed its last energy test."""
    found = False
    for island in range(islands.counts[ISLANDS]):
        found = found or islands.fails[island]
    return found


@inner_kernel
def note_way(way: int, islands: BodyIslands) -> None:
    """Note that the islands which fail go on this way, see PASSED."""
    for island in range(islands.counts[ISLANDS]):
        if islands.fails[island]:
            islands.way[island] = way


@inner_kernel
def count_ways(islands: BodyIslands, ways: Slots) -> None:
    """Count the last way of each island; ways (WAYS,)."""
    for island in range(islands.counts[ISLANDS]):
        ways[islands.way[island]] += 1


@inlined_kernel
def _slot_of(k: int, islands: BodyIslands, system: System) -> int:
    # The particle that has the budget and the parting reserve of a member.
    bodies = islands.counts[BODIES]
    return system.bodies.lowest[islands.body[k]] if k < bodies else islands.free[k - bodies]


@inner_kernel
def _lendable(island: int, islands: BodyIslands, system: System, state: State) -> float:
    # What may be lent to an island [J]: to what begins to sink, and to what is stopped as it begins to rise.
    sinks = 0.0
    rises = 0.0
    owes = 0.0
    for k in range(islands.counts[MEMBERS]):
        if islands.island[k] == island:
            sinks += islands.ahead[k] - islands.moves[k]
            rises += islands.rises[k]
            owes -= min(0.0, state.parting_reserve[_slot_of(k, islands, system)])
    return max(0.0, max(0.0, sinks) + max(0.0, rises) - owes)  # (29)


@inner_kernel
def check_energies(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, start: FloatRows
) -> bool:  # fmt: skip
    """Check the energy of every island; whether any fails."""
    # Where the target of a free particle was relaxed, `v0` is below what forces left it.
    islands, surface, push = workspace.islands, workspace.terms.surface, workspace.delassus.joints.push
    bodies = islands.counts[BODIES]
    for island in range(islands.counts[ISLANDS]):
        islands.total[island] = 0.0
        islands.allowed[island] = 0.0
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
    for k in range(islands.counts[MEMBERS]):
        islands.total[islands.island[k]] += islands.energy[k]
        islands.allowed[islands.island[k]] += islands.energy0[k] * (1.0 + ENERGY_ROUNDING) + islands.budget[k]
    # What runs a belt does the work of its friction at the speed of its surface.
    for c in range(contacts.particle.shape[0]):
        work = -contacts.belt[c] * contacts.impulse[c, 1]
        k = _member_of(c, contacts, islands, state.inverse_mass) if work > 0.0 else -1
        if k >= 0:
            if k < islands.counts[BODIES] and system.bodies.underdamped[islands.body[k]]:
                work *= 1.0 + UNDERDAMPED_BUDGET_SHARE
            islands.allowed[islands.island[k]] += work
    for island in range(islands.counts[ISLANDS]):
        islands.lent[island] = _lendable(island, islands, system, state)
        islands.allowed[island] += islands.lent[island]
        islands.fails[island] = not islands.total[island] <= islands.allowed[island]
    return any_fails(islands)


@inner_kernel
def _member_of(c: int, contacts: Contacts, islands: BodyIslands, inverse_mass: Floats) -> int:
    # The first body or free particle of a contact that can move, by its place among the members; -1: none.
    for end in range(3):
        p, _ = weight_of(contacts, c, end)
        if p >= 0 and inverse_mass[p] > 0.0:
            return islands.member[p]
    return -1


@inner_kernel
def drop_biases(
    contacts: Contacts, workspace: IslandWorkspace, inverse_mass: Floats, separates: bool, h: float
) -> None:
    """Restart contacts of islands that fail without impulse or bounce; they push apart only as far as budgets can pay.

    separates: whether they push apart at all.
    """
    # From there each sweep that is not hastened takes energy: it lowers 1/2 J.W J + J.u, which is what contacts add.
    islands = workspace.islands
    for island in range(islands.counts[ISLANDS]):
        islands.total[island] = 0.0
        islands.allowed[island] = 0.0
    for k in range(islands.counts[MEMBERS]):
        islands.allowed[islands.island[k]] += islands.budget[k]
    for c in range(contacts.particle.shape[0]):
        k = _member_of(c, contacts, islands, inverse_mass)
        if k >= 0:
            islands.total[islands.island[k]] += _stored(c, contacts, workspace.terms, h)
    for c in range(contacts.particle.shape[0]):
        k = _member_of(c, contacts, islands, inverse_mass)
        if k >= 0 and islands.fails[islands.island[k]]:
            cost, saved = islands.total[islands.island[k]], islands.allowed[islands.island[k]]
            pushed = 0.0
            if separates and cost > 0.0:
                pushed = _part_speed(contacts.gap[c], h) * math.sqrt(min(1.0, saved / cost))
            workspace.terms.bias[c] = max(0.0, contacts.gap[c]) / h - pushed
            contacts.impulse[c, 0] = 0.0
            contacts.impulse[c, 1] = 0.0


@inner_kernel
def _slower(halving: int) -> float:
    # What of all that moves a round of slowing down leaves of what joints alone drive: most fail by a hair.
    if halving < DRIVEN_HALVINGS + 3:
        return 0.999 if halving == DRIVEN_HALVINGS else 0.99 if halving == DRIVEN_HALVINGS + 1 else 0.9
    return 0.5


@inner_kernel
def _damp_bodies(workspace: IslandWorkspace, system: System, state: State, halving: int, h: float) -> None:
    # One halving of every body of an island that fails.
    islands, bodies, rows = workspace.islands, system.bodies, system.rows
    for k in range(islands.counts[BODIES]):
        if not islands.fails[islands.island[k]]:
            continue
        body = islands.body[k]
        span = span_of(system, body)
        if halving == 0:
            islands.due[k] = True
            # As it was found, not what terrain and triangles have left of it, which may lead nowhere.
            for r in range(span.first_row, span.last_row):
                islands.v_free[r, 0] += islands.impulse[r, 0]
                islands.v_free[r, 1] += islands.impulse[r, 1]
        turns = bodies.spin[body, INERTIA] > 0.0
        # Contacts hold what is to stop, and springs what is to come back; joints alone drive what goes round.
        fine = turns and islands.driven[k] and workspace.delassus.start[k] == workspace.delassus.start[k + 1]
        if halving < INNER_HALVINGS or (fine and halving < DRIVEN_HALVINGS):
            if turns:
                damp_within(body, span, system, islands.v_free, 0.5, h)
        elif fine and halving < DRIVEN_HALVINGS + 8:
            # As one that is rigid, no length of which changes however fast it turns.
            scale(span, _slower(halving), islands.v_free)
            damp_within(body, span, system, islands.v_free, 0.0, h)
        else:
            scale(span, 0.5 if halving < LAST_HALVINGS else 0.0, islands.v_free)
            copy(span, islands.v_free, rows.v)
        clamp_rows(span, rows, state, h)
        hold_triangles(span, system, h)
        measure_body(k, span, system, workspace, body_energy(body, span, system, h), h)


@inner_kernel
def damp_islands(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, start: FloatRows, h: float
) -> None:  # fmt: skip
    """Slow down what moves within the bodies of islands that fail, else all that moves, until they pass."""
    # All that moves slowly enough along what contacts and springs want loses energy, and at rest they pass.
    islands, surface = workspace.islands, workspace.terms.surface
    bodies = islands.counts[BODIES]
    for k in range(bodies):
        islands.due[k] = False
    for halving in range(LAST_HALVINGS + 1):
        _damp_bodies(workspace, system, state, halving, h)
        for i in range(islands.counts[MEMBERS] - bodies):
            if halving >= INNER_HALVINGS and islands.fails[islands.island[bodies + i]]:
                p = islands.free[i]
                factor = 0.5 if halving < LAST_HALVINGS else 0.0
                for axis in range(2):
                    v = islands.v0[p, axis] + islands.delta_v[p, axis]
                    islands.delta_v[p, axis] = factor * v - islands.v0[p, axis]
                surface[p] *= factor
        if not check_energies(contacts, workspace, system, state, start):
            break
    for k in range(bodies):
        if islands.due[k]:
            find_tension(span_of(system, islands.body[k]), system, h)


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
def _settle_loans(workspace: IslandWorkspace, system: System, state: State) -> None:
    # Overdraw reserves by what was lent and used, each by its mass; and pay back from what was lost.
    islands, reserves = workspace.islands, state.parting_reserve
    for island in range(islands.counts[ISLANDS]):
        mass = 0.0
        for k in range(islands.counts[MEMBERS]):
            mass += islands.mass[k] if islands.island[k] == island else 0.0
        islands.allowed[island] -= islands.lent[island]
        used = min(islands.lent[island], islands.total[island] - islands.allowed[island])
        for k in range(islands.counts[MEMBERS]):
            if islands.island[k] != island:
                continue
            slot = _slot_of(k, islands, system)
            if used > 0.0:
                reserves[slot] -= used * islands.mass[k] / mass
            else:
                paid = max(0.0, min(-reserves[slot], islands.allowed[island] - islands.total[island]))
                reserves[slot] += paid
                islands.allowed[island] -= paid


@inner_kernel
def store_energies(contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, h: float) -> None:
    """Store the rest of each island's allowed energy, up to the limits of its budgets."""
    islands, bodies = workspace.islands, system.bodies
    _settle_loans(workspace, system, state)
    # The most that each budget may hold: a share of the member's energy; or by its mass what contacts hold, of what it
    # has itself lost: what a light body loses as it hits a heavy one would push that out of what it lies in. And of
    # that what forces take from it as it slowly rises.
    held = mass = 0.0
    for c in range(contacts.particle.shape[0]):
        held += _held(c, contacts, workspace.terms, h)
    for k in range(islands.counts[MEMBERS]):
        mass += islands.mass[k]
    for k in range(islands.counts[MEMBERS]):
        most = (
            budget_limit(islands.body[k], system) if k < islands.counts[BODIES] else BUDGET_SHARE * islands.energy0[k]
        )
        lost = islands.budget[k] + islands.energy0[k] - islands.energy[k]
        least = min(held / mass, 0.5 * PAID_PUSH * PAID_PUSH) * islands.mass[k]
        islands.limit[k] = max(most, min(least, lost))
        islands.limit[k] += max(0.0, min(-islands.ahead[k] - islands.moves[k], lost))
    for k in range(islands.counts[MEMBERS]):
        island = islands.island[k]
        limit = islands.limit[k]
        is_body = k < islands.counts[BODIES]
        # As in solve.py: an inverted body keeps all that it lost for the way back to its form.
        if is_body and bodies.inverted[islands.body[k]] and not bodies.anchored[islands.body[k]]:
            limit = max(limit, islands.budget[k] + islands.energy0[k] - islands.energy[k])
        stored = max(0.0, min(islands.allowed[island] - islands.total[island], limit))
        islands.allowed[island] -= stored
        if is_body:
            state.energy_bank[bodies.lowest[islands.body[k]]] = stored
        else:
            state.energy_bank[islands.free[k - islands.counts[BODIES]]] = stored
    for k in range(islands.counts[BODIES]):
        island = islands.island[k]
        body = islands.body[k]
        excess = islands.allowed[island] - islands.total[island]
        islands.allowed[island] = islands.total[island] + reserve(body, span_of(system, body), system, state, excess)
