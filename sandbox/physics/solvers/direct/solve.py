"""Direct: the article's spring solved for a whole network at once, with a test that bounds the energy.

spring_terms.py states what is solved. What contacts touch or joints act on is solved island by island, all else body by
body (step_body.py): such a body is an island without contacts.

A v' = b + J^T lambda is what the minimum of f becomes where contacts push. The factor of A gives the Delassus block
W = P A^-1 P^T of the particles P of a body that something touches (response.py); sweeps find lambda with it
(contact_solve.py), and one more substitution brings the impulses to the whole body. The energy test is that of
step_body.py for all bodies together that touch each other, so that one may take what another gives (island_energy.py).
"""

import math

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.surfaces import spin_of
from sandbox.physics.collision.types import ENDS, Contacts, couple_of, weight_of
from sandbox.physics.equation import implicit_spring_constant
from sandbox.physics.jit import inner_kernel, parallel
from sandbox.physics.joints.joint_rows import couple_joints, gather_push
from sandbox.physics.solvers.contact.contact_solve import (
    change_of_sweep,
    go_on,
    propagate_impacts,
    solve_contacts,
    start_sweeps,
    sweep_all,
)
from sandbox.physics.solvers.contact.gauss_seidel import (
    CALM,
    CALM_SETTLED,
    load_biases,
    load_responses,
    load_surfaces,
    mark_calm,
)
from sandbox.physics.solvers.direct.energy_budget import MORE_SOLVES, is_new
from sandbox.physics.solvers.direct.island_energy import (
    check_energy,
    clamp_free,
    clamp_rows,
    credit_penetration,
    draw_on_reserves,
    goes_on,
    limit_pushes,
    measure_body,
    open_free,
    passes,
    slow_down,
    store_energies,
    weigh_body,
)
from sandbox.physics.solvers.direct.islands import (
    ALLOWED,
    BODIES,
    EXCESS,
    ISLANDS,
    LANES,
    MEMBERS,
    TOTAL,
    BodyIslands,
    IslandWorkspace,
    alone,
    contacts_of,
    cost_of_answer,
    has_coarse,
)
from sandbox.physics.solvers.direct.network import (
    AHEAD,
    find_tension,
    keep_tension,
    linearise,
    load_rows,
    potential,
    respond,
    solve_linear,
    update,
)
from sandbox.physics.solvers.direct.response import hold_block, load_answers, load_block, load_velocities, open_joints
from sandbox.physics.solvers.direct.rigid_turn import (
    add_torque,
    hold_spin,
    kinetic_at_end,
    spin_of_body,
    torque_of,
    turn_to,
)
from sandbox.physics.solvers.direct.step_body import LINEAR_SOLVES, MISFIT_RATE, open_body, step_bodies
from sandbox.physics.solvers.direct.system import (
    SLOWED_DOWN,
    SOLVED_ON,
    Span,
    System,
    hold_triangles,
    span_of,
    store,
    worth_of_sharing,
)
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.state import State
from sandbox.physics.untangling.triangle_clamp import AS_IT_WAS

# Sweeps over the contacts for each linear solve. More costs time, fewer leaves piles soft and restless.
SWEEPS = 20
# What all sweeps of an island in a step of h [s] may cost: h WORK pushes of an impulse at a particle, some 10 ms of a
# tick at 60 Hz. Where it is spent the step ends, in its energy test; a solve has this many sweeps in any case. Less
# leaves crowds soft, more makes piles of inverted bodies slow.
WORK = 7.2e7
FEWEST_SWEEPS = 4
# Sweeps in which bodies without a block answer by mass. With 20 of them a jelly of 51 x 51 falls through a line.
SWEEPS_BY_MASS = 60
# What such a push costs, in units of DEAREST_BLOCK.
PUSH_COST = 8
# And of what is calm, but has not settled, at most: a tower of 10 boxes needs as many in its first ticks, 14 later.
CALM_SWEEPS = 200
# Bodies all of whose springs have such Cs and Cd are rigid. Softer ones settle by their springs, over many ticks; with
# as many sweeps a tick machines take three times as long.
RIGID = 0.9999
# And with such they are firm: what they carry is solved exactly. Softer heaps would come to rest later.
FIRM = 0.5
# Contacts that press a body by so many times what forces do in a step turn it by as much as it turns, as directions
# ahead have it: from 60 on it shakes.
PRESSED = 20.0
spring_constant = implicit_spring_constant


@inner_kernel
def solve(
    state: State, system: System, inputs: Inputs, contacts: Contacts, workspace: IslandWorkspace, has_islands: bool,
    auto_substeps: int, h: float,
) -> None:  # fmt: skip
    """Bring the velocities to the end of a substep of h [s]; slow_velocity, energy_bank and tension go with them.

    has_islands: contacts touch bodies, or joints act on them, and the islands are found. auto_substeps: how many the
    tick chose, 0: the settings give them.
    """
    load_rows(system, state, inputs, h)
    if has_islands:
        islands, joints = workspace.islands, workspace.delassus.joints
        for p in range(state.velocity.shape[0]):
            for axis in range(2):
                islands.v0[p, axis] = state.velocity[p, axis]
                islands.delta_v[p, axis] = 0.0
        for p in range(joints.push.shape[0]):
            joints.push[p, 0] = joints.push[p, 1] = 0.0
        open_joints(joints, islands.row, state.inverse_mass)
        load_surfaces(workspace.terms, state.spin, state.radius)
        for i in range(islands.counts[ISLANDS]):
            _solve_island(
                contacts_of(i, contacts, workspace), alone(i, workspace), system, state, inputs, auto_substeps, h
            )  # fmt: skip
    step_bodies(system, state, inputs, workspace.ways, has_islands, auto_substeps, h)


@inner_kernel
def _solve_island(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, inputs: Inputs, auto_substeps: int,
    h: float,
) -> None:  # fmt: skip
    # Bring one island to the end of a step: nothing here looks beyond it, so what does not touch changes nothing.
    islands, start = workspace.islands, inputs.start
    load_biases(contacts, workspace.terms, h)
    _open(workspace, system, state, inputs, auto_substeps, h)
    _find_pressed(contacts, system, islands)
    affordable = int(WORK * h) // max(1, _cost_of(contacts, workspace, system))
    _solve_linearly(contacts, workspace, system, state, start, affordable, h)
    if not passes(islands):
        islands.way[0] = SLOWED_DOWN
        slow_down(contacts, workspace, system, state, start, h)
    workspace.ways[islands.way[0]] += 1
    store_energies(contacts, workspace, system, state, h)
    _finish(islands, workspace.terms.surface, system, state)


@inner_kernel
def _open(
    workspace: IslandWorkspace, system: System, state: State, inputs: Inputs, auto_substeps: int, h: float
) -> None:
    # Load the families and energies of an island's bodies, and its free particles; no contact has acted.
    islands = workspace.islands
    for k in parallel(islands.counts[BODIES], _worth(islands, system)):
        _open_one(k, islands, system, state, inputs, auto_substeps, h)
    open_free(islands, state, inputs.start)


@inner_kernel
def _worth(islands: BodyIslands, system: System) -> int:
    # What a parallel loop over an island's bodies saves.
    return worth_of_sharing(islands.counts[BODIES], islands.body, system.bodies.work)


@inner_kernel
def _open_one(
    k: int, islands: BodyIslands, system: System, state: State, inputs: Inputs, auto_substeps: int, h: float
) -> None:
    bodies, body = system.bodies, islands.body[k]
    span = span_of(system, body)
    islands.fresh[k] = is_new(span, system, state.energy_bank)
    open_body(body, span, system, state, inputs, 0.0, auto_substeps, h)
    firmness = 1.0
    for i in range(system.bodies.spring_start[body], system.bodies.spring_start[body + 1]):
        slot = system.springs.slot[i]
        firmness = min(firmness, inputs.stiffness[slot], inputs.damping[slot])
    islands.rigid[k] = firmness >= RIGID
    islands.firm[k] = firmness >= FIRM
    weigh_body(k, span, system.rows, islands)
    islands.energy0[k] = bodies.energy0[body]
    islands.budget[k] = bodies.budget[body]
    islands.due[k] = True


@inner_kernel
def _find_pressed(contacts: Contacts, system: System, islands: BodyIslands) -> None:
    # Which bodies, on which no joint acts, contacts press by far more than forces do.
    rows = system.rows
    for k in range(islands.counts[BODIES]):
        islands.misfit[k] = 0.0
    for c in range(contacts.particle.shape[0]):
        for end in range(3):
            p, weight = weight_of(contacts, c, end)
            if p >= 0 and islands.row[p] >= 0:
                islands.misfit[islands.member[p]] += abs(weight) * contacts.impulse[c, 0]
    for k in range(islands.counts[BODIES]):
        span = span_of(system, islands.body[k])
        own = 0.0
        for r in range(span.first_row, span.last_row):
            x = rows.v_star[r, 0] - rows.start[r, 0]
            y = rows.v_star[r, 1] - rows.start[r, 1]
            own += rows.mass[r] * math.sqrt(x * x + y * y)
        islands.pressed[k] = islands.misfit[k] > PRESSED * own and not islands.driven[k]


@inner_kernel
def _cost_of(contacts: Contacts, workspace: IslandWorkspace, system: System) -> int:
    # What one sweep costs: the particles that answer to every impulse.
    islands, delassus = workspace.islands, workspace.delassus
    cost = 0
    for k in range(islands.counts[BODIES]):
        if islands.by_mass[k]:
            cost += cost_of_answer(span_of(system, islands.body[k]), system) // PUSH_COST
    for c in range(contacts.particle.shape[0]):
        for end in range(ENDS):
            p, _ = weight_of(contacts, c, end)
            if p >= 0:
                k = delassus.block[p]
                cost += 1 if k < 0 else delassus.start[k + 1] - delassus.start[k]
    joints = delassus.joints
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        cost += joints.actions.answers[joints.actions.first[k + 1]] - joints.actions.answers[joints.actions.first[k]]
    return cost


@inner_kernel
def _solve_linearly(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, start: FloatRows, affordable: int,
    h: float,
) -> None:  # fmt: skip
    # Linear solves while springs miss the lengths predicted, or the test fails and they are of use.
    islands = workspace.islands
    islands.tally[0, EXCESS] = 0.0
    for solve in range(LINEAR_SOLVES + MORE_SOLVES):
        for lane in parallel(min(LANES, islands.counts[BODIES]), _worth(islands, system)):
            _solve_lane(lane, workspace, system, h)
        affordable = _push_and_test(contacts, workspace, system, state, start, affordable, solve == 0, h)
        fails = not passes(islands)
        islands.way[0] = SOLVED_ON if fails else islands.way[0]
        if fails and solve >= LINEAR_SOLVES - 1:
            fails = goes_on(islands, system, h)
        elif fails:
            islands.tally[0, EXCESS] = islands.tally[0, TOTAL] - islands.tally[0, ALLOWED]
        if affordable <= 0 or not _find_due(islands, fails, solve < LINEAR_SOLVES - 1, h):
            break


@inner_kernel
def _solve_lane(lane: int, workspace: IslandWorkspace, system: System, h: float) -> None:
    # Linearise and factor those that are due of every so many bodies, which share the scratch of a lane: their
    # velocities without contacts, and their Delassus blocks.
    islands, count = workspace.islands, workspace.islands.counts[BODIES]
    lanes, room = min(LANES, count), workspace.delassus.columns.shape[0] // min(LANES, count)
    columns = workspace.delassus.columns[lane * room : (lane + 1) * room]
    for turn in range((count - lane + lanes - 1) // lanes):
        k = lane + turn * lanes
        if islands.due[k]:
            _solve_one(k, columns, workspace, system, h)


@inner_kernel
def _solve_one(k: int, columns: Floats, workspace: IslandWorkspace, system: System, h: float) -> None:
    islands, delassus, rows = workspace.islands, workspace.delassus, system.rows
    body = islands.body[k]
    span = span_of(system, body)
    islands.still[k] = not islands.by_mass[k] and _is_still(k, span, system, islands)
    linearise(span, system, h, AHEAD, AHEAD)
    solve_linear(span, system)
    # What the body does without contacts; `v` stays where it was linearised.
    for r in range(span.first_row, span.last_row):
        islands.v_free[r, 0] = rows.v[r, 0] + rows.delta_v[r, 0]
        islands.v_free[r, 1] = rows.v[r, 1] + rows.delta_v[r, 1]
    if not islands.by_mass[k]:
        load_block(k, span, system, delassus, columns, islands.row, islands.impulse)
    if islands.still[k]:
        spin = spin_of_body(body, system)
        turn_to(span, rows, spin, spin.momentum, islands.v_free)
        hold_block(k, span, system, spin, delassus, islands.row, islands.impulse)
    if islands.driven[k]:
        load_answers(span, system, delassus.joints, islands.row, islands.impulse)
    for i in range(delassus.start[k], delassus.start[k + 1]):
        p = delassus.point[i]
        islands.v0[p, 0] = islands.v_free[islands.row[p], 0]
        islands.v0[p, 1] = islands.v_free[islands.row[p], 1]


@inner_kernel
def _is_still(k: int, span: Span, system: System, islands: BodyIslands) -> bool:
    # Whether a body that turns as a whole and is pressed is slow where it is linearised.
    if not islands.pressed[k] or not spin_of_body(islands.body[k], system).inertia > 0.0:
        return False
    v = system.rows.v
    fastest = 0.0
    for r in range(span.first_row, span.last_row):
        fastest = max(fastest, v[r, 0] * v[r, 0] + v[r, 1] * v[r, 1])
    return fastest <= CALM * CALM


@inner_kernel
def _push_and_test(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, start: FloatRows, affordable: int,
    begins: bool, h: float,
) -> int:  # fmt: skip
    # Push what was linearised through its contacts and joints, and test it; how many sweeps the step may still have.
    sweeps = max(FEWEST_SWEEPS, min(SWEEPS, affordable))
    most = max(sweeps, min(CALM_SWEEPS, affordable))
    done = _push_all(contacts, workspace, system, state, sweeps, most, affordable, begins, h)
    _apply_impulses(workspace, system, state, h)
    check_energy(contacts, workspace, system, state, start)
    return affordable - done


@inner_kernel
def _push_all(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, sweeps: int, most: int,
    affordable: int, begins: bool, h: float,
) -> int:  # fmt: skip
    # Sweep an island's contacts and joints, and look for impacts before where the step begins; what it took, in sweeps.
    # The impulses J^T lambda of bodies are left in `impulse`.
    islands, terms, delassus = workspace.islands, workspace.terms, workspace.delassus
    inverse_mass, joints = state.inverse_mass, delassus.joints
    load_responses(contacts, terms, inverse_mass, delassus)
    couple_joints(joints)
    _clear(islands, system, terms.surface, state)
    if begins:
        credit_penetration(contacts, workspace, state.inverse_mass, h)
        draw_on_reserves(contacts, workspace, system, state)
        limit_pushes(contacts, workspace)
        mark_calm(contacts, terms, state.velocity, delassus.block, islands.rigid, islands.firm)
        propagate_impacts(contacts, terms, islands.v0, islands.delta_v, inverse_mass, delassus, h)
    # Passes only look ahead, but push joints as well.
    load_velocities(islands, joints)
    # Joints change what an exact solve has found.
    exactly = float(affordable) if joints.listed.shape[0] == 0 else 0.0
    if has_coarse(islands):
        done = _sweep_by_mass(contacts, workspace, system, state, min(SWEEPS_BY_MASS, most))
    else:
        done = solve_contacts(
            contacts, terms, islands.v0, islands.delta_v, inverse_mass, delassus, sweeps, most, exactly,
            float(_cost_of(contacts, workspace, system)),
        )  # fmt: skip
    gather_push(joints)
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        for e in range(joints.rows.first[k], joints.rows.first[k + 1]):
            p = joints.rows.particle[e]
            if islands.row[p] >= 0:
                islands.impulse[islands.row[p], 0] = joints.push[p, 0]
                islands.impulse[islands.row[p], 1] = joints.push[p, 1]
    _add_push(contacts, islands)
    return done


@inner_kernel
def _clear(islands: BodyIslands, system: System, surface: Floats, state: State) -> None:
    # Nothing has changed an island's velocities or pushed its bodies, and surfaces move as their particles turn.
    for k in range(islands.counts[BODIES]):
        span = span_of(system, islands.body[k])
        for r in range(span.first_row, span.last_row):
            for axis in range(2):
                islands.impulse[r, axis] = islands.delta_v[system.rows.particle[r], axis] = 0.0
    for i in range(islands.counts[MEMBERS] - islands.counts[BODIES]):
        p = islands.free[i]
        islands.delta_v[p, 0] = islands.delta_v[p, 1] = 0.0
        surface[p] = state.spin[p] * state.radius[p]


@inner_kernel
def _sweep_by_mass(
    contacts: Contacts, workspace: IslandWorkspace, system: System, state: State, sweeps: int
) -> int:  # fmt: skip
    # Sweeps of an island with bodies that have no block; how many. Between them all is as the springs answer to it.
    islands, terms, delassus = workspace.islands, workspace.terms, workspace.delassus
    previous = 0.0
    for done in range(1, sweeps + 1):
        start_sweeps(contacts, terms, islands.delta_v, state.inverse_mass, delassus)
        of_joints, swept, _ = sweep_all(
            contacts, terms, islands.v0, islands.delta_v, state.inverse_mass, delassus
        )  # fmt: skip
        if max(of_joints, swept) < CALM_SETTLED or done == sweeps:
            return done
        squared = change_of_sweep(contacts, terms, delassus.joints)
        ratio = squared / previous if squared < previous else 0.0
        go_on(contacts, terms, islands.delta_v, state.inverse_mass, delassus, ratio)
        previous = squared
        _clear(islands, system, terms.surface, state)
        _add_push(contacts, islands)
        # What bodies without a block are given is such that with the answers of their masses it is that of springs.
        for k in range(islands.counts[BODIES]):
            if not islands.by_mass[k]:
                continue
            for i in range(delassus.start[k], delassus.start[k + 1]):
                p = delassus.point[i]
                for axis in range(2):
                    r = islands.row[p]
                    islands.v0[p, axis] = islands.v_free[r, axis] - state.inverse_mass[p] * islands.impulse[r, axis]
            respond(span_of(system, islands.body[k]), system, islands.impulse)
            for i in range(delassus.start[k], delassus.start[k + 1]):
                p = delassus.point[i]
                for axis in range(2):
                    islands.v0[p, axis] += islands.impulse[islands.row[p], axis]
        _clear(islands, system, terms.surface, state)
        load_velocities(islands, delassus.joints)
    return sweeps


@inner_kernel
def _add_push(contacts: Contacts, islands: BodyIslands) -> None:
    # Add what contacts give the bodies of an island.
    for c in range(contacts.particle.shape[0]):
        jn = contacts.impulse[c, 0]
        jt = contacts.impulse[c, 1]
        jx = jn * contacts.normal[c, 0] - jt * contacts.normal[c, 1]
        jy = jn * contacts.normal[c, 1] + jt * contacts.normal[c, 0]
        for end in range(ENDS):
            p, weight = weight_of(contacts, c, end)
            if p >= 0 and islands.row[p] >= 0:
                cx, cy = couple_of(contacts, c, end)
                islands.impulse[islands.row[p], 0] += weight * jx + jt * cx
                islands.impulse[islands.row[p], 1] += weight * jy + jt * cy


@inner_kernel
def _apply_impulses(workspace: IslandWorkspace, system: System, state: State, h: float) -> None:
    # v' = v_free + A^-1 J^T lambda of every body, clamped; its energy and misfit.
    islands = workspace.islands
    for k in parallel(islands.counts[BODIES], _worth(islands, system)):
        _apply_to_one(k, workspace, system, state, h)
    clamp_free(islands, state, h)


@inner_kernel
def _apply_to_one(k: int, workspace: IslandWorkspace, system: System, state: State, h: float) -> None:
    islands, rows = workspace.islands, system.rows
    span = span_of(system, islands.body[k])
    spin = spin_of_body(islands.body[k], system)
    torque = torque_of(span, rows, spin, islands.impulse)
    still = islands.still[k]
    if still:
        add_torque(span, rows, spin, -torque, islands.impulse)
    respond(span, system, islands.impulse)
    if still:
        turn_to(span, rows, spin, 0.0, islands.impulse)
    for r in range(span.first_row, span.last_row):
        for axis in range(2):
            v = islands.v_free[r, axis] + islands.impulse[r, axis]
            rows.delta_v[r, axis] = v - rows.v[r, axis]
            rows.v[r, axis] = v
    hold_spin(span, rows, spin, system.bodies.pivot[islands.body[k]] >= 0, not still, spin.momentum + torque, h)
    elastic, misfit, _ = update(span, system, h)
    keep_tension(span, system)
    clamped = clamp_rows(span, rows, state, h)
    if hold_triangles(span, system, h) != AS_IT_WAS or clamped:
        elastic = potential(span, system, rows.position, rows.v, h, h)
        find_tension(span, system, h)
    measure_body(k, span, system, workspace, kinetic_at_end(islands.body[k], span, system, h) + elastic, h)
    islands.misfit[k] = misfit


@inner_kernel
def _find_due(islands: BodyIslands, fails: bool, misses: bool, h: float) -> bool:
    # All bodies are due if the test fails, and if it matters those whose springs miss the lengths predicted.
    found = fails
    for k in range(islands.counts[BODIES]):
        missed = misses and islands.misfit[k] > MISFIT_RATE * h * h
        islands.due[k] = missed or fails
        found = found or missed
    return found


@inner_kernel
def _finish(islands: BodyIslands, surface: Floats, system: System, state: State) -> None:
    for k in range(islands.counts[BODIES]):
        store(span_of(system, islands.body[k]), system, state)
    for i in range(islands.counts[MEMBERS] - islands.counts[BODIES]):
        p = islands.free[i]
        state.velocity[p, 0] = islands.v0[p, 0] + islands.delta_v[p, 0]
        state.velocity[p, 1] = islands.v0[p, 1] + islands.delta_v[p, 1]
        state.spin[p] = spin_of(surface[p], state.spin[p], state.radius[p])
