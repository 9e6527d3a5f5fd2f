"""Bodies that touch, in the direct solver: each is solved as ever, and pushed through the response of its factor.

A v' = b + J^T lambda is what the minimum of spring_terms.py's f becomes where contacts push. The factor of A gives the
response W = P A^-1 P^T of the particles P of a body that something touches; gauss_seidel.py finds lambda with it, and
one more substitution brings the impulses to the whole body. The energy test is that of solve.py for all bodies
together that touch each other, so that one may take what another gives.
"""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.collision.types import weight_of
from sandbox.physics.forces import Before
from sandbox.physics.jit import contents, inner_kernel, kernel
from sandbox.physics.solvers.contact.gauss_seidel import (
    load_biases,
    load_responses,
    new_push,
    solve_contacts,
)
from sandbox.physics.solvers.contact.islands import find_touching
from sandbox.physics.solvers.direct.constraint_terms import linearise_shapes, update_shapes
from sandbox.physics.solvers.direct.contact_energy import (
    brake,
    grant,
    hold,
    judge,
    measure_body,
    open_loose,
    save,
    stop_loose,
    stop_rows,
)
from sandbox.physics.solvers.direct.energy_bank import (
    body_potential,
    load_body,
    load_rows,
    open_bank,
)
from sandbox.physics.solvers.direct.newton import copy, keep_tension, scale
from sandbox.physics.solvers.direct.response import load_block, respond
from sandbox.physics.solvers.direct.shape_matching import aim_at_form, find_tangled, let_go
from sandbox.physics.solvers.direct.solve import AHEAD, LINEAR_SOLVES, MISFIT_RATE
from sandbox.physics.solvers.direct.solve import solve as solve_bodies
from sandbox.physics.solvers.direct.spring_terms import hold_spin, kinetic, linearise, solve_linear, update_impulses
from sandbox.physics.solvers.direct.system import Pattern
from sandbox.physics.solvers.single_pass import Pair
from sandbox.physics.world import Floats, World

# Sweeps over the contacts for each linear solve. More costs time, fewer leaves piles soft and restless.
SWEEPS = 20
# What all sweeps of a step of h [s] may cost: h WORK pushes of an impulse at a particle, some 10 ms of a tick at 60 Hz.
# Where it is spent the step ends, in its energy test; a solve has this many sweeps in any case. Less leaves crowds
# soft, more makes tangles slow.
WORK = 7.2e7
FEWEST_SWEEPS = 4
# Solves in which contacts only hold.
HOLDS = 2


@inner_kernel
def _begin(  # type: ignore[no-untyped-def]
    touching, items, energy_bank, inverse_mass, rest_length, rest_before, stiffness, damping, material, tension, least,
    most, parts, h,
):  # fmt: skip
    # Load the springs, elements and energies of every body that is touched, and join what is tangled to its form.
    bodies, rows, springs, shapes, matrix, goals = items
    free_count = matrix.diagonal.shape[0]
    for k in range(touching.body.shape[0]):
        body = touching.body[k]
        first_row, last_row = bodies.row_start[body], bodies.row_start[body + 1]
        first, last = bodies.spring_start[body], bodies.spring_start[body + 1]
        low, high = bodies.shape_start[body], bodies.shape_start[body + 1]
        free = not bodies.anchored[body]
        bouncy, spread, moved = load_body(
            first_row, last_row, first, last, low, high, free, inverse_mass, rest_length, stiffness, damping,
            material, tension, rows, springs, shapes, least, most, parts, h, free_count,
        )  # fmt: skip
        kinetic_after = kinetic(first_row, last_row, rows.mass, rows.target)
        touching.bouncy[k] = bouncy
        touching.spread[k] = spread
        touching.before[k] = kinetic_after + moved
        for r in range(first_row, last_row):
            if energy_bank[rows.particle[r]] < 0.0:
                touching.fresh[k] = True
        touching.held[k] = open_bank(
            first_row, last_row, first, last, low, high, rows, springs, shapes, energy_bank, bodies.lowest[body],
            bouncy, spread, kinetic_after, moved, rest_length, rest_before, h,
        )  # fmt: skip
        touching.tangled[k] = high > low and find_tangled(body, low, high, rows, shapes, goals)
        touching.aimed[k] = touching.tangled[k] and aim_at_form(
            body, last_row - first_row, not free, rows, shapes, goals, h, free_count
        )
        touching.due[k] = True


@inner_kernel
def _solve_due(touching, items, blocks, columns, h, ahead, behind):  # type: ignore[no-untyped-def]
    # Linearise and factor the bodies that are due: their velocities without contacts, and their responses.
    bodies, rows, springs, shapes, matrix, _ = items
    for k in range(touching.body.shape[0]):
        if not touching.due[k]:
            continue
        body = touching.body[k]
        first_row, last_row = bodies.row_start[body], bodies.row_start[body + 1]
        first, last = bodies.spring_start[body], bodies.spring_start[body + 1]
        low, high = bodies.shape_start[body], bodies.shape_start[body + 1]
        linearise(first, last, rows, springs, h, ahead, behind)
        if high > low:
            linearise_shapes(low, high, rows, shapes, h, ahead, behind)
        solve_linear(first_row, last_row, first, last, low, high, rows, springs, shapes, matrix)
        _leave_free(first_row, last_row, high > low and not bodies.anchored[body], rows, touching.free)
        load_block(
            k, first_row, last_row, low, high, touching.row, blocks, columns, rows, shapes, matrix, touching.pushed
        )
        for i in range(blocks.start[k], blocks.start[k + 1]):
            p = blocks.point[i]
            touching.given[p, 0] = touching.free[touching.row[p], 0]
            touching.given[p, 1] = touching.free[touching.row[p], 1]


@inner_kernel
def _leave_free(first_row, last_row, turns, rows, free):  # type: ignore[no-untyped-def]
    # What a body does without contacts, which gain it no spin; `trial` stays where the body was linearised.
    copy(first_row, last_row, rows.trial, rows.best)
    for r in range(first_row, last_row):
        rows.trial[r, 0] += rows.change[r, 0]
        rows.trial[r, 1] += rows.change[r, 1]
    if turns:
        hold_spin(first_row, last_row, rows)
    copy(first_row, last_row, rows.trial, free)
    copy(first_row, last_row, rows.best, rows.trial)


@inner_kernel
def _clear(vector):  # type: ignore[no-untyped-def]
    for r in range(vector.shape[0]):
        vector[r, 0] = 0.0
        vector[r, 1] = 0.0


@inner_kernel
def _cost_of(contacts, blocks):  # type: ignore[no-untyped-def]
    # What one sweep costs: the particles that answer to every impulse.
    cost = 0
    for c in range(contacts.particle.shape[0]):
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0:
                k = blocks.block[p]
                cost += 1 if k < 0 else blocks.start[k + 1] - blocks.start[k]
    return cost


@inner_kernel
def _push_all(touching, contacts, push, blocks, inverse_mass, sweeps, hasten):  # type: ignore[no-untyped-def]
    # Sweep all contacts; the impulses of bodies are left in `pushed`.
    load_responses(contacts, push, inverse_mass, blocks)
    _clear(touching.change)
    solve_contacts(contacts, push, touching.given, touching.change, inverse_mass, blocks, sweeps, hasten)
    _clear(touching.pushed)
    for c in range(contacts.particle.shape[0]):
        jn = contacts.impulse[c, 0]
        jt = contacts.impulse[c, 1]
        jx = jn * contacts.normal[c, 0] - jt * contacts.normal[c, 1]
        jy = jn * contacts.normal[c, 1] + jt * contacts.normal[c, 0]
        for end in range(3):
            p, weight = weight_of(contacts, c, end)
            if p >= 0 and touching.row[p] >= 0:
                touching.pushed[touching.row[p], 0] += weight * jx
                touching.pushed[touching.row[p], 1] += weight * jy


@inner_kernel
def _answer(touching, items, position, collides, terrain, rest_length, h):  # type: ignore[no-untyped-def]
    # v' = free + A^-1 J^T lambda of every body, stopped at terrain; its energy and misfit.
    bodies, rows, springs, shapes, matrix, _ = items
    free_count = matrix.diagonal.shape[0]
    for k in range(touching.body.shape[0]):
        body = touching.body[k]
        first_row, last_row = bodies.row_start[body], bodies.row_start[body + 1]
        first, last = bodies.spring_start[body], bodies.spring_start[body + 1]
        low, high = bodies.shape_start[body], bodies.shape_start[body + 1]
        respond(first_row, last_row, low, high, rows, shapes, matrix, touching.pushed)
        for r in range(first_row, last_row):
            for axis in range(2):
                v = touching.free[r, axis] + touching.pushed[r, axis]
                rows.change[r, axis] = v - rows.trial[r, axis]
                rows.trial[r, axis] = v
        held, misfit, _ = update_impulses(first, last, rows, springs, rest_length, h, free_count)
        if high > low:
            held_by_shapes, missed = update_shapes(low, high, rows, shapes, h, free_count)
            held += held_by_shapes
            misfit = max(misfit, missed)
        for s in range(first, last):
            springs.tension[s] = max(0.0, -springs.impulse[s])
        if stop_rows(first_row, last_row, rows, collides, terrain, h):
            held = body_potential(
                first, last, low, high, rows.position, rows.trial, springs, shapes, rest_length, h, h
            )  # fmt: skip
            keep_tension(first, last, rows, springs, h)
        measure_body(touching, k, items, held)
        touching.misfit[k] = misfit
    stop_loose(touching, position, collides, terrain, h)


@inner_kernel
def _finish(touching, items, velocity, tension):  # type: ignore[no-untyped-def]
    bodies, rows, springs, _, _, _ = items
    for k in range(touching.body.shape[0]):
        body = touching.body[k]
        for r in range(bodies.row_start[body], bodies.row_start[body + 1]):
            velocity[rows.particle[r], 0] = rows.trial[r, 0]
            velocity[rows.particle[r], 1] = rows.trial[r, 1]
        for s in range(bodies.spring_start[body], bodies.spring_start[body + 1]):
            tension[springs.slot[s]] = springs.tension[s]
    for i in range(touching.loose.shape[0]):
        p = touching.loose[i]
        velocity[p, 0] = touching.given[p, 0] + touching.change[p, 0]
        velocity[p, 1] = touching.given[p, 1] + touching.change[p, 1]


@inner_kernel
def _begin_again(touching, bodies, rows, share):  # type: ignore[no-untyped-def]
    # Bring what fails to this share of v*, without its goal.
    for k in range(touching.body.shape[0]):
        if touching.due[k]:
            first_row, last_row = bodies.row_start[touching.body[k]], bodies.row_start[touching.body[k] + 1]
            copy(first_row, last_row, rows.target, rows.trial)
            scale(first_row, last_row, share, rows.trial)
            if touching.aimed[k]:
                let_go(first_row, last_row, rows)
                touching.aimed[k] = False


@kernel
def _push_bodies(  # type: ignore[no-untyped-def]
    position, velocity, mass, inverse_mass, slow_velocity, energy_bank, rest_length, stiffness, damping, material,
    tension, collides, numbers, least, most, parts, before, rest_before, h, touching, blocks, columns, contacts, push,
    terrain,
):  # fmt: skip
    items = contents(numbers)
    bodies, rows, _, _, matrix, _ = items
    load_rows(position, velocity, mass, slow_velocity, before, h, matrix.diagonal.shape[0], rows)
    _begin(
        touching, items, energy_bank, inverse_mass, rest_length, rest_before, stiffness, damping, material, tension,
        least, most, parts, h,
    )  # fmt: skip
    open_loose(touching, mass, energy_bank)
    affordable = int(WORK * h) // max(1, _cost_of(contacts, blocks))
    failing = False
    # Linear solves while springs miss the lengths foreseen, a second where the test fails; then contacts only hold, at
    # Newton steps on f from v* and from rest: the last one takes energy if it is made short enough.
    stage = 0
    while stage < LINEAR_SOLVES + HOLDS:
        if stage < LINEAR_SOLVES:
            _solve_due(touching, items, blocks, columns, h, AHEAD, AHEAD)
        else:
            hold(touching, contacts, push, inverse_mass, h)
            _begin_again(touching, bodies, rows, 1.0 if stage == LINEAR_SOLVES else 0.0)
            _solve_due(touching, items, blocks, columns, h, 1.0, 0.0)
        sweeps = max(FEWEST_SWEEPS, min(SWEEPS, affordable))
        _push_all(touching, contacts, push, blocks, inverse_mass, sweeps, stage < LINEAR_SOLVES)
        affordable -= sweeps
        if stage == 0:
            grant(touching, contacts, push, inverse_mass, h)
        _answer(touching, items, position, collides, terrain, rest_length, h)
        failing = judge(touching, mass, before)
        inexact = False
        for k in range(touching.body.shape[0]):
            missed = stage < LINEAR_SOLVES - 1 and affordable > 0 and touching.misfit[k] > MISFIT_RATE * h * h
            inexact = inexact or missed
            touching.due[k] = missed or touching.fails[touching.cluster[k]]
        if not (inexact or failing):
            break
        stage += 1
        if failing and affordable <= 0:
            stage = max(stage, LINEAR_SOLVES + HOLDS - 1)
        elif failing and not inexact and stage > 1:
            stage = max(stage, LINEAR_SOLVES)
    if failing:
        brake(touching, items, mass, before, collides, terrain, rest_length, h)
    save(touching, items, contacts, push, inverse_mass, rest_length, energy_bank, h)
    _finish(touching, items, velocity, tension)


def _push(
    world: World,
    pattern: Pattern,
    stiffness: Floats,
    damping: Floats,
    least: Floats,
    most: Floats,
    parts: int,
    h: float,
    before: Before,
) -> NDArray[np.bool_]:
    """Solve the bodies and loose particles that touch something; which bodies those are."""
    contacts = world.contacts
    touched = np.zeros(len(pattern.bodies.lowest), dtype=np.bool_)
    if not len(contacts.particle):
        return touched
    touching, blocks = find_touching(world, pattern, contacts)
    push = new_push(len(contacts.particle))
    load_biases(contacts, push, h)
    touched[touching.body] = True
    sizes = np.diff(pattern.bodies.row_start)[touching.body] * np.diff(blocks.start)
    columns = np.zeros(4 * int(sizes.max(initial=0)))
    _push_bodies(
        world.position, world.velocity, world.mass, world.inverse_mass, world.slow_velocity, world.energy_bank,
        world.rest_length, stiffness, damping, world.material, world.tension, world.collides, pattern.numbers, least,
        most, parts, before.velocity, before.rest_length, h, touching, blocks, columns, contacts, push, world.terrain,
    )  # fmt: skip
    return touched


def solve(world: World, springs: Pair, elements: Pair, h: float, before: Before) -> None:
    """Bring the velocities to the end of a step of h [s], contacts included; what nothing touches goes its own way."""
    solve_bodies(world, springs, elements, h, before, None if world.contacts is None else _push)
