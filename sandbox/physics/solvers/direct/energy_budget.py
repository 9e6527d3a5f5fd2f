"""The energy budget of bodies, what their earlier losses still allow them (passivity), and target relaxation.

A step whose energy stays within what a body or an island had plus its budget is taken. Where an island gains by a hair,
its target is relaxed, and it is solved again: what the step gains is taken off the motion of the island, v* of all that
is in it loses a share s of what it is beside the motion that has to stay,

    v* -= s (v* - V),      s = MARGIN (H' - H* - B) / (2 T),      T = 1/2 |v' - V|^2_M

V is rest where something outside holds the island, else the rigid motion of its momenta. Springs, contacts, joints and
friction are solved for that target, so no length and no contact is missed, and only what was gained is given up. The
test stays as it is: it knows v* as forces left it.
"""

import math

from sandbox.physics.arrays import Floats
from sandbox.physics.collision.types import Contacts, weight_of
from sandbox.physics.geometry.rigid import (
    RigidMotion,
    WeightedSums,
    centre_of,
    turn_rate,
    velocity_at,
    with_point,
    with_turn,
)
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.solvers.direct.islands import BODIES, ISLANDS, MEMBERS, BodyIslands, IslandWorkspace
from sandbox.physics.solvers.direct.network import potential, start_potential
from sandbox.physics.solvers.direct.rigid_turn import kinetic_at_end, spin_of_body
from sandbox.physics.solvers.direct.system import MOMENTUM, RELAXED_TARGET, STAR_MOMENTUM, Span, System, kinetic
from sandbox.physics.state import State
from sandbox.physics.untangling.overlaps import DEEP

# A body's budget holds at most this share of its energy: where every spring has Cs <= Cd, and where one has not (its
# energy in this norm swings by up to 3 within a period). 0 would reject most steps at Cs = Cd = 1.
BUDGET_SHARE = 0.05
UNDERDAMPED_BUDGET_SHARE = 3.0
# Relative error of an energy summed over a large body; less rejects steps for rounding alone.
ENERGY_ROUNDING = 1e-12
# What a body loses beyond what its budget may hold is kept for its depenetration (depenetration.py), at most so much a
# mass [J/kg]: enough to be lifted by a metre. Less leaves heavy bodies in each other, more is never spent.
LARGEST_RESERVE = 10.0
# Halvings of the velocities before a body is stopped.
LAST_HALVINGS = 60
# An island solves on while a solve leaves at most this share of what is too much: lengths still come right.
FALLING = 0.5
# So much of what is too much is given up at once: with 1 a step would fail again by what is of second order.
MARGIN = 1.25
# What is too much is at most this share of T; more is no error of a step, but a push or a bounce, which is to be left
# out. With 0.3 stacks of jellies do not come to rest, with 0.03 chains stop at a corner.
LARGEST_SHARE = 0.1
# Solves of what solves on or is relaxed, at most. With none a pendulum under a cart loses half of its energy at once.
MORE_SOLVES = 12
# A joint whose gradient sums up to less than this share of its size acts within what it moves, as a motor does.
WITHIN = 1e-9


@inner_kernel
def body_energy(body: int, span: Span, system: System, h: float) -> float:
    """Energy of one body after the step [J]: kinetic at `v`, and that of its springs and constraints."""
    # H = KE(v') + PE(x + h v')
    rows = system.rows
    return kinetic_at_end(body, span, system, h) + potential(span, system, rows.position, rows.v, h, h)


@inner_kernel
def open_budget(body: int, span: Span, system: System, budget: Floats, moved: float, h: float) -> float:
    """The energy in a body's budget before the step [J]; moved: energy of its springs after pins and drives have
    moved.
    """
    rows, bodies = system.rows, system.bodies
    lowest = bodies.lowest[body]
    # After any change from outside.
    begun = True
    for r in range(span.first_row, span.last_row):
        if budget[system.rows.particle[r]] < 0.0:
            begun = False
    # A body that broke off begins with none: what is saved stays with the particle that was the lowest, once.
    for r in range(span.first_row, span.last_row):
        p = rows.particle[r]
        if p != lowest:
            budget[p] = 0.0
    saved = budget[lowest] if begun else 0.0
    if not bodies.underdamped[body]:
        return saved
    kinetic_after = kinetic(span, rows.mass, rows.v_star)
    kinetic0 = kinetic(span, rows.mass, rows.start)
    present = start_potential(span, system, h)
    if not begun:
        saved += UNDERDAMPED_BUDGET_SHARE * (kinetic0 + present)
    # Work done by forces, grabs and drives since then counts as energy of the start.
    return max(0.0, saved + UNDERDAMPED_BUDGET_SHARE * (kinetic_after - kinetic0 + moved - present))


@inner_kernel
def is_new(span: Span, system: System, budget: Floats) -> bool:
    """Whether every particle of a body asks for a new budget (-1): at the start of a run, not after a hand let go
    (-2).
    """
    new = True
    for r in range(span.first_row, span.last_row):
        new = new and budget[system.rows.particle[r]] == BANK_UNOPENED
    return new


@inner_kernel
def budget_limit(body: int, system: System) -> float:
    """The most that a body's budget may hold after the step [J]."""
    ratio = UNDERDAMPED_BUDGET_SHARE if system.bodies.underdamped[body] else BUDGET_SHARE
    return ratio * system.bodies.energy0[body]


@inner_kernel
def reserve(body: int, span: Span, system: System, state: State, excess: float) -> float:
    """Put an excess [J], which a body has lost, into its parting reserve up to its limit; the rest of the excess."""
    # Where some Cs is above its Cd, energy in this norm comes and goes, and is no loss.
    lowest = system.bodies.lowest[body]
    if not excess > 0.0 or system.bodies.underdamped[body] or state.collides[lowest] == 0:
        return excess
    mass = 0.0
    for r in range(span.first_row, span.last_row):
        mass += system.rows.mass[r]
    kept = min(excess, max(0.0, LARGEST_RESERVE * mass - state.parting_reserve[lowest]))
    state.parting_reserve[lowest] += kept
    return excess - kept


@inner_kernel
def begin_relaxation(contacts: Contacts, workspace: IslandWorkspace, system: System, state: State) -> None:
    """Find which islands something outside holds, or have something to part, and keep the spin of their targets."""
    islands, bodies = workspace.islands, system.bodies
    for island in range(islands.counts[ISLANDS]):
        islands.held[island] = False
        islands.parts[island] = False
    for k in range(islands.counts[BODIES]):
        body = islands.body[k]
        bodies.spin[body, STAR_MOMENTUM] = bodies.spin[body, MOMENTUM]
        if bodies.pivot[body] != -1:
            islands.held[islands.island[k]] = True
    # Mark the islands that touch terrain or something pinned, and those in which something overlaps deeply.
    for c in range(contacts.particle.shape[0]):
        inside = -1
        outside = contacts.end_a[c] < 0 and contacts.end_b[c] < 0
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0 and state.inverse_mass[p] > 0.0:
                inside = islands.island[islands.member[p]]
            elif p >= 0:
                outside = True
        if inside >= 0:
            islands.held[inside] = islands.held[inside] or outside
            islands.parts[inside] = islands.parts[inside] or is_deep(c, contacts, state)
    # Mark the island if hands or other joints push it from outside.
    joints, rows = workspace.delassus.joints, workspace.delassus.joints.rows
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        x = 0.0
        y = 0.0
        size = 0.0
        for e in range(rows.first[k], rows.first[k + 1]):
            x += rows.gradient[e, 0]
            y += rows.gradient[e, 1]
            size += abs(rows.gradient[e, 0]) + abs(rows.gradient[e, 1])
        if abs(x) + abs(y) > WITHIN * size:
            workspace.islands.held[0] = True


@inner_kernel
def relax_targets(workspace: IslandWorkspace, system: System, state: State) -> bool:
    """Lower the targets of islands that fail by what they gain, unless solving on helps; whether any can go on."""
    islands = workspace.islands
    goes_on = False
    for island in range(islands.counts[ISLANDS]):
        if not islands.fails[island]:
            continue
        excess = islands.total[island] - islands.allowed[island]
        if excess < FALLING * islands.excess[island]:
            islands.excess[island] = excess
            goes_on = True
            continue
        motion = _motion_to_keep(island, islands, system, state)
        ratio = relaxation_ratio(excess, _energy_beside(island, motion, islands, system, state))
        # What is pushed apart has to pay for that, and stays where it is if its motion does.
        if ratio > 0.0 and not islands.parts[island]:
            _relax_island(island, ratio, motion, islands, system, state)
            islands.excess[island] = math.inf
            islands.way[island] = RELAXED_TARGET
            goes_on = True
    return goes_on


@inner_kernel
def _motion_to_keep(island: int, islands: BodyIslands, system: System, state: State) -> RigidMotion:
    # V: rest, or the rigid motion that has the momenta of v*, which chords have too.
    x, v = state.position, state.velocity
    if islands.held[island]:
        return RigidMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(islands.counts[MEMBERS]):
        if islands.island[k] == island:
            first, last = _points_of(k, islands, system)
            for i in range(first, last):
                p = _particle_of(k, i, islands, system)
                sums = with_point(sums, state.mass[p], x[p, 0], x[p, 1], v[p, 0], v[p, 1])
    motion = centre_of(sums)
    for k in range(islands.counts[MEMBERS]):
        if islands.island[k] == island:
            first, last = _points_of(k, islands, system)
            for i in range(first, last):
                p = _particle_of(k, i, islands, system)
                motion = with_turn(motion, state.mass[p], x[p, 0], x[p, 1], v[p, 0], v[p, 1])
    return motion


@inlined_kernel
def _points_of(k: int, islands: BodyIslands, system: System) -> tuple[int, int]:
    # The points of a member: rows of a body, or its own place among the free particles.
    bodies = islands.counts[BODIES]
    if k < bodies:
        return system.bodies.row_start[islands.body[k]], system.bodies.row_start[islands.body[k] + 1]
    return k - bodies, k - bodies + 1


@inlined_kernel
def _particle_of(k: int, i: int, islands: BodyIslands, system: System) -> int:
    return system.rows.particle[i] if k < islands.counts[BODIES] else islands.free[i]


@inner_kernel
def _energy_beside(island: int, motion: RigidMotion, islands: BodyIslands, system: System, state: State) -> float:
    # T of an island: the kinetic energy [J] of what it moves beside V.
    total = 0.0
    for k in range(islands.counts[MEMBERS]):
        if islands.island[k] == island:
            first, last = _points_of(k, islands, system)
            for i in range(first, last):
                p = _particle_of(k, i, islands, system)
                u, v = velocity_at(motion, state.position[p, 0], state.position[p, 1])
                if k < islands.counts[BODIES]:
                    u = system.rows.v[i, 0] - u
                    v = system.rows.v[i, 1] - v
                else:
                    u = islands.v0[p, 0] + islands.delta_v[p, 0] - u
                    v = islands.v0[p, 1] + islands.delta_v[p, 1] - v
                total += 0.5 * state.mass[p] * (u * u + v * v)
    return total


@inner_kernel
def _relax_island(
    island: int, ratio: float, motion: RigidMotion, islands: BodyIslands, system: System, state: State
) -> None:
    # v* -= ratio (v* - V), and the spin that bodies are to keep with it.  (30)
    target, spins = system.rows.v_star_matched, system.bodies.spin
    for k in range(islands.counts[MEMBERS]):
        if islands.island[k] != island:
            continue
        first, last = _points_of(k, islands, system)
        for i in range(first, last):
            p = _particle_of(k, i, islands, system)
            u, v = velocity_at(motion, state.position[p, 0], state.position[p, 1])
            if k < islands.counts[BODIES]:
                target[i, 0] -= ratio * (target[i, 0] - u)
                target[i, 1] -= ratio * (target[i, 1] - v)
            else:
                islands.v0[p, 0] -= ratio * (islands.v0[p, 0] - u)
                islands.v0[p, 1] -= ratio * (islands.v0[p, 1] - v)
        if k < islands.counts[BODIES]:
            spin = spin_of_body(islands.body[k], system)
            spins[islands.body[k], MOMENTUM] -= ratio * (spin.momentum - turn_rate(motion) * spin.inertia)


@inner_kernel
def note_excess(islands: BodyIslands) -> None:
    """Note what each island has too much [J], for the next solve to be compared with."""
    for island in range(islands.counts[ISLANDS]):
        islands.excess[island] = islands.total[island] - islands.allowed[island]


@inner_kernel
def restore_targets(workspace: IslandWorkspace, system: System, state: State) -> None:
    """Raise the targets of islands that fail to what they were."""
    islands = workspace.islands
    bodies = islands.counts[BODIES]
    for k in range(islands.counts[MEMBERS]):
        if not islands.fails[islands.island[k]]:
            continue
        if k < bodies:
            body = islands.body[k]
            system.bodies.spin[body, MOMENTUM] = system.bodies.spin[body, STAR_MOMENTUM]
        else:
            p = islands.free[k - bodies]
            islands.v0[p, 0] = state.velocity[p, 0]
            islands.v0[p, 1] = state.velocity[p, 1]


@inlined_kernel
def relaxation_ratio(excess: float, moves: float) -> float:
    """What share of its motion, of the energy `moves` [J], is to be given up for what is too much [J]; 0: it cannot."""
    return 0.5 * MARGIN * excess / moves if MARGIN * excess < LARGEST_SHARE * moves else 0.0  # (30)


@inner_kernel
def is_deep(c: int, contacts: Contacts, state: State) -> bool:
    """Whether what touches at a contact overlaps deeply."""
    return contacts.gap[c] < -DEEP * state.radius[contacts.particle[c]]
