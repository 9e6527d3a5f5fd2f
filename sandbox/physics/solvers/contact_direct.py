"""Bodies that touch, in the direct solver: each is solved as ever, and pushed through the response of its factor.

A v' = b + J^T lambda is what the minimum of network.py's f becomes where contacts push. The factor of A gives the
response W = P A^-1 P^T of the particles P of a body that something touches; contact_sweep.py finds lambda with it, and
one more substitution brings the impulses to the whole body. The energy test is that of direct.py for all bodies
together that touch each other, so that one may take what another gives.
"""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.forces import Before
from sandbox.physics.jit import contents, inner_kernel, kernel
from sandbox.physics.shapes import weight_of
from sandbox.physics.solvers import direct
from sandbox.physics.solvers.body import (
    BANK_SHARE,
    BOUNCY_BANK_SHARE,
    body_energy,
    body_hidden,
    load_body,
    load_rows,
    open_bank,
)
from sandbox.physics.solvers.contact_clusters import find_touching
from sandbox.physics.solvers.contact_sweep import (
    load_biases,
    load_responses,
    new_push,
    solve_contacts,
)
from sandbox.physics.solvers.direct import AHEAD, ENERGY_ROUNDING, LAST_HALVINGS, LINEAR_SOLVES, MISFIT_RATE
from sandbox.physics.solvers.goal import aim_at_form, find_tangled, let_go
from sandbox.physics.solvers.minimise import copy, keep_tension
from sandbox.physics.solvers.network import hold_spin, kinetic, linearise, solve_linear, update_impulses
from sandbox.physics.solvers.pattern import Pattern
from sandbox.physics.solvers.response import load_block, respond
from sandbox.physics.solvers.shapes import linearise_shapes, update_shapes
from sandbox.physics.solvers.single_pass import Pair
from sandbox.physics.world import Floats, World

# Sweeps over the contacts for each linear solve, where bodies touch, and where loose particles alone do. More costs
# time, fewer leaves piles soft and restless.
SWEEPS = 20
LOOSE_SWEEPS = 10
# Newton rounds on f for bodies whose energy the linear solves leave too high; after them they are braked.
NEWTON_ROUNDS = 4


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
def _push_all(touching, contacts, push, blocks, inverse_mass):  # type: ignore[no-untyped-def]
    # Sweep all contacts; the impulses of bodies are left in `pushed`.
    sweeps = SWEEPS if touching.body.shape[0] > 0 else LOOSE_SWEEPS
    load_responses(contacts, push, inverse_mass, blocks)
    _clear(touching.change)
    solve_contacts(contacts, push, touching.given, touching.change, inverse_mass, blocks, sweeps)
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
def _answer(touching, items, rest_length, h):  # type: ignore[no-untyped-def]
    # v' = free + A^-1 J^T lambda of every body; its energy and misfit.
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
        touching.after[k] = kinetic(first_row, last_row, rows.mass, rows.trial) + held
        touching.misfit[k] = misfit


@inner_kernel
def _judge(touching, contacts, push, blocks, mass, inverse_mass):  # type: ignore[no-untyped-def]
    # Energy test of every cluster; whether any fails.
    for cluster in range(touching.total.shape[0]):
        touching.total[cluster] = 0.0
        touching.allowed[cluster] = 0.0
    for k in range(touching.body.shape[0]):
        touching.total[touching.cluster[k]] += touching.after[k]
        touching.allowed[touching.cluster[k]] += touching.before[k] * (1.0 + ENERGY_ROUNDING) + touching.held[k]
    for i in range(touching.loose.shape[0]):
        p = touching.loose[i]
        ux, uy = touching.given[p, 0], touching.given[p, 1]
        vx, vy = ux + touching.change[p, 0], uy + touching.change[p, 1]
        touching.total[touching.loose_cluster[i]] += 0.5 * mass[p] * (vx * vx + vy * vy)
        touching.allowed[touching.loose_cluster[i]] += 0.5 * mass[p] * (ux * ux + uy * uy) * (1.0 + ENERGY_ROUNDING)
    # What overlaps is pushed apart by work that a contact does.
    for c in range(contacts.particle.shape[0]):
        if push.bias[c] < 0.0 and contacts.gap[c] < 0.0:
            cluster = _cluster_of(contacts, c, touching, blocks, inverse_mass)
            if cluster >= 0:
                touching.allowed[cluster] -= contacts.impulse[c, 0] * push.bias[c]
    failing = False
    for cluster in range(touching.total.shape[0]):
        touching.fails[cluster] = not touching.total[cluster] <= touching.allowed[cluster]
        failing = failing or touching.fails[cluster]
    return failing


@inner_kernel
def _cluster_of(contacts, c, touching, blocks, inverse_mass):  # type: ignore[no-untyped-def]
    for end in range(3):
        p, _ = weight_of(contacts, c, end)
        if p >= 0 and inverse_mass[p] > 0.0:
            if blocks.block[p] >= 0:
                return touching.cluster[blocks.block[p]]
            low = 0
            high = touching.loose.shape[0] - 1
            while low < high:
                middle = (low + high) // 2
                if touching.loose[middle] < p:
                    low = middle + 1
                else:
                    high = middle
            return touching.loose_cluster[low]
    return -1


@inner_kernel
def _brake(touching, items, contacts, push, blocks, mass, inverse_mass, rest_length, h):  # type: ignore[no-untyped-def]
    # Halve the velocities of clusters that fail until they pass; at rest they do.
    bodies, rows, springs, shapes, _, _ = items
    for halving in range(LAST_HALVINGS + 1):
        factor = 0.5 if halving < LAST_HALVINGS else 0.0
        for k in range(touching.body.shape[0]):
            if touching.fails[touching.cluster[k]]:
                body = touching.body[k]
                first_row, last_row = bodies.row_start[body], bodies.row_start[body + 1]
                first, last = bodies.spring_start[body], bodies.spring_start[body + 1]
                low, high = bodies.shape_start[body], bodies.shape_start[body + 1]
                for r in range(first_row, last_row):
                    rows.trial[r, 0] *= factor
                    rows.trial[r, 1] *= factor
                touching.after[k] = body_energy(
                    first_row, last_row, first, last, low, high, rows, springs, shapes, rest_length, h
                )
                keep_tension(first, last, rows, springs, h)
        for i in range(touching.loose.shape[0]):
            if touching.fails[touching.loose_cluster[i]]:
                p = touching.loose[i]
                for axis in range(2):
                    v = touching.given[p, axis] + touching.change[p, axis]
                    touching.change[p, axis] = factor * v - touching.given[p, axis]
        if not _judge(touching, contacts, push, blocks, mass, inverse_mass):
            break


@inner_kernel
def _finish(touching, items, velocity, energy_bank, tension, rest_length, h):  # type: ignore[no-untyped-def]
    # Velocities, tensions, and banks, which together hold no more than the cluster has lost.
    bodies, rows, springs, shapes, _, _ = items
    for k in range(touching.body.shape[0]):
        body = touching.body[k]
        first_row, last_row = bodies.row_start[body], bodies.row_start[body + 1]
        first, last = bodies.spring_start[body], bodies.spring_start[body + 1]
        low, high = bodies.shape_start[body], bodies.shape_start[body + 1]
        saved = touching.held[k] + touching.before[k] - touching.after[k]
        # As in direct.py: a tangled body keeps all that it lost for the way back to its form.
        if bodies.anchored[body] or not touching.tangled[k]:
            limit = (BOUNCY_BANK_SHARE if touching.bouncy[k] else BANK_SHARE) * touching.before[k]
            if touching.spread[k]:
                limit += body_hidden(
                    first, last, low, high, rows.position, rows.trial, springs, shapes, rest_length, h, h
                )  # fmt: skip
            saved = min(saved, limit)
        saved = min(saved, max(0.0, touching.allowed[touching.cluster[k]] - touching.total[touching.cluster[k]]))
        energy_bank[bodies.lowest[body]] = saved if saved > 0.0 else 0.0
        touching.allowed[touching.cluster[k]] -= max(0.0, saved)
        for r in range(first_row, last_row):
            velocity[rows.particle[r], 0] = rows.trial[r, 0]
            velocity[rows.particle[r], 1] = rows.trial[r, 1]
        for s in range(first, last):
            tension[springs.slot[s]] = springs.tension[s]
    for i in range(touching.loose.shape[0]):
        p = touching.loose[i]
        velocity[p, 0] = touching.given[p, 0] + touching.change[p, 0]
        velocity[p, 1] = touching.given[p, 1] + touching.change[p, 1]


@inner_kernel
def _let_go(touching, bodies, rows):  # type: ignore[no-untyped-def]
    # What is tangled and fails goes on without its goal.
    for k in range(touching.body.shape[0]):
        if touching.due[k] and touching.aimed[k]:
            body = touching.body[k]
            let_go(bodies.row_start[body], bodies.row_start[body + 1], rows)
            touching.aimed[k] = False


@kernel
def _push_bodies(  # type: ignore[no-untyped-def]
    position, velocity, mass, inverse_mass, slow_velocity, energy_bank, rest_length, stiffness, damping, material,
    tension, numbers, least, most, parts, before, rest_before, h, touching, blocks, columns, contacts, push,
):  # fmt: skip
    items = contents(numbers)
    bodies, rows, _, _, matrix, _ = items
    load_rows(position, velocity, mass, slow_velocity, before, h, matrix.diagonal.shape[0], rows)
    _begin(
        touching, items, energy_bank, inverse_mass, rest_length, rest_before, stiffness, damping, material, tension,
        least, most, parts, h,
    )  # fmt: skip
    failing = False
    for solve in range(LINEAR_SOLVES + NEWTON_ROUNDS):
        if solve < LINEAR_SOLVES:
            _solve_due(touching, items, blocks, columns, h, AHEAD, AHEAD)
        else:
            _let_go(touching, bodies, rows)
            _solve_due(touching, items, blocks, columns, h, 1.0, 0.0)
        _push_all(touching, contacts, push, blocks, inverse_mass)
        _answer(touching, items, rest_length, h)
        failing = _judge(touching, contacts, push, blocks, mass, inverse_mass)
        again = False
        for k in range(touching.body.shape[0]):
            inexact = solve < LINEAR_SOLVES - 1 and touching.misfit[k] > MISFIT_RATE * h * h
            touching.due[k] = inexact or touching.fails[touching.cluster[k]]
            again = again or touching.due[k]
        if not again:
            break
    if failing:
        _brake(touching, items, contacts, push, blocks, mass, inverse_mass, rest_length, h)
    _finish(touching, items, velocity, energy_bank, tension, rest_length, h)


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
        world.rest_length, stiffness, damping, world.material, world.tension, pattern.numbers, least, most, parts,
        before.velocity, before.rest_length, h, touching, blocks, columns, contacts, push,
    )  # fmt: skip
    return touched


def solve(world: World, springs: Pair, elements: Pair, h: float, before: Before) -> None:
    """Bring the velocities to the end of a step of h [s], contacts included; what nothing touches goes its own way."""
    direct.solve(world, springs, elements, h, before, None if world.contacts is None else _push)
