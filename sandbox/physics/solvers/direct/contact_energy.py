"""The energy test of bodies that touch each other: together they never have more than they had and have saved.

Measured is H = KE(v') + PE(x + h v') of bodies and loose particles, less 1/2 sum m (v* - v).(v' - v*): then the work of
forces in the step is that of their impulses at the mean of the velocities v and v', as in free fall. What a step loses
is saved, up to a limit, in the banks of bodies and particles; to push apart what overlaps is paid from there.
"""

from sandbox.physics.collision.outline import TERRAIN_GROUP
from sandbox.physics.collision.terrain_clamp import STOPS, stopped
from sandbox.physics.collision.types import weight_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.gauss_seidel import FASTEST_PUSH, OVERLAP_SHARE, SOFTNESS
from sandbox.physics.solvers.direct.energy_bank import BANK_SHARE, BOUNCY_BANK_SHARE, body_energy, body_hidden
from sandbox.physics.solvers.direct.newton import copy, keep_tension, scale
from sandbox.physics.solvers.direct.solve import ENERGY_ROUNDING, LAST_HALVINGS
from sandbox.physics.solvers.direct.spring_terms import kinetic

# Halvings of what moves within bodies that fail the test, before all that moves is slowed down.
INNER_HALVINGS = 3
# k x^2 / 2 of a contact is this, times (x / h)^2 over its response: what its overlap x may be paid back.
STORED = 0.5 * OVERLAP_SHARE / SOFTNESS


@inner_kernel
def stop_rows(first_row, last_row, rows, collides, terrain, h):  # type: ignore[no-untyped-def]
    """Cut the velocities of one body's particles that would cross terrain; whether any does."""
    found = False
    for r in range(first_row, last_row):
        if not collides[rows.particle[r]] & TERRAIN_GROUP:
            continue
        wx = h * rows.trial[r, 0]
        wy = h * rows.trial[r, 1]
        stops, x, y = stopped(rows.position[r, 0], rows.position[r, 1], wx, wy, terrain)
        if stops > 0:
            found = True
            rows.trial[r, 0] = 0.0 if stops > STOPS else rows.trial[r, 0] + (x - wx) / h
            rows.trial[r, 1] = 0.0 if stops > STOPS else rows.trial[r, 1] + (y - wy) / h
    return found


@inner_kernel
def stop_loose(touching, position, collides, terrain, h):  # type: ignore[no-untyped-def]
    """Cut the velocities of loose particles that would cross terrain."""
    for i in range(touching.loose.shape[0]):
        p = touching.loose[i]
        if not collides[p] & TERRAIN_GROUP:
            continue
        wx = h * (touching.given[p, 0] + touching.change[p, 0])
        wy = h * (touching.given[p, 1] + touching.change[p, 1])
        stops, x, y = stopped(position[p, 0], position[p, 1], wx, wy, terrain)
        if stops > STOPS:
            touching.change[p, 0] = -touching.given[p, 0]
            touching.change[p, 1] = -touching.given[p, 1]
        elif stops > 0:
            touching.change[p, 0] += (x - wx) / h
            touching.change[p, 1] += (y - wy) / h


@inner_kernel
def less_work(first_row, last_row, rows, bouncy):  # type: ignore[no-untyped-def]
    """What the measure of a body takes off its energy after the step [J]; bouncy ones are topped up by its work."""
    total = 0.0
    for r in range(first_row, last_row):
        total += rows.mass[r] * (
            (rows.target[r, 0] - rows.start[r, 0]) * (rows.trial[r, 0] - rows.target[r, 0])
            + (rows.target[r, 1] - rows.start[r, 1]) * (rows.trial[r, 1] - rows.target[r, 1])
        )
    return 0.5 * total * (1.0 + BOUNCY_BANK_SHARE if bouncy else 1.0)


@inner_kernel
def measure_body(touching, k, items, held):  # type: ignore[no-untyped-def]
    """Note the measure of one body after the step, whose springs then hold so much [J]."""
    bodies, rows, _, _, _, _ = items
    first_row, last_row = bodies.row_start[touching.body[k]], bodies.row_start[touching.body[k] + 1]
    touching.after[k] = (
        kinetic(first_row, last_row, rows.mass, rows.trial)
        + held
        - less_work(first_row, last_row, rows, touching.bouncy[k])
    )


@inner_kernel
def open_loose(touching, mass, energy_bank):  # type: ignore[no-untyped-def]
    """The energies of loose particles before the step, and what their banks hold."""
    for i in range(touching.loose.shape[0]):
        p = touching.loose[i]
        k = touching.body.shape[0] + i
        ux, uy = touching.given[p, 0], touching.given[p, 1]
        touching.before[k] = 0.5 * mass[p] * (ux * ux + uy * uy)
        touching.held[k] = max(0.0, energy_bank[p])
        touching.fresh[k] = energy_bank[p] < 0.0


@inner_kernel
def _stored(contacts, c, push, h):  # type: ignore[no-untyped-def]
    # What the overlap of a contact stores [J].
    if not (contacts.gap[c] < 0.0 and push.along[c] > 0.0):
        return 0.0
    depth = min(-contacts.gap[c] / h, FASTEST_PUSH)
    return STORED * depth * depth / push.along[c]


@inner_kernel
def grant(touching, contacts, push, inverse_mass, h):  # type: ignore[no-untyped-def]
    """Where a bank is begun, what overlaps then and there store counts as energy of the start."""
    for c in range(contacts.particle.shape[0]):
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0 and inverse_mass[p] > 0.0 and touching.fresh[touching.member[p]]:
                touching.held[touching.member[p]] += _stored(contacts, c, push, h)
                break


@inner_kernel
def judge(touching, mass, start):  # type: ignore[no-untyped-def]
    """Test the energy of every cluster; whether any fails."""
    for cluster in range(touching.total.shape[0]):
        touching.total[cluster] = 0.0
        touching.allowed[cluster] = 0.0
    for i in range(touching.loose.shape[0]):
        p = touching.loose[i]
        ux, uy = touching.given[p, 0], touching.given[p, 1]
        vx, vy = ux + touching.change[p, 0], uy + touching.change[p, 1]
        work = (ux - start[p, 0]) * touching.change[p, 0] + (uy - start[p, 1]) * touching.change[p, 1]
        touching.after[touching.body.shape[0] + i] = 0.5 * mass[p] * (vx * vx + vy * vy - work)
    for k in range(touching.cluster.shape[0]):
        touching.total[touching.cluster[k]] += touching.after[k]
        touching.allowed[touching.cluster[k]] += touching.before[k] * (1.0 + ENERGY_ROUNDING) + touching.held[k]
    failing = False
    for cluster in range(touching.total.shape[0]):
        touching.fails[cluster] = not touching.total[cluster] <= touching.allowed[cluster]
        failing = failing or touching.fails[cluster]
    return failing


@inner_kernel
def member_of(contacts, c, touching, inverse_mass):  # type: ignore[no-untyped-def]
    """The first body or loose particle of a contact that can move, by its place in a cluster's; -1: none."""
    for end in range(3):
        p, _ = weight_of(contacts, c, end)
        if p >= 0 and inverse_mass[p] > 0.0:
            return touching.member[p]
    return -1


@inner_kernel
def hold(touching, contacts, push, inverse_mass, h):  # type: ignore[no-untyped-def]
    """Let contacts of clusters that fail begin with no impulse, and neither push apart nor bounce."""
    # From there each sweep that is not hastened takes energy: it lowers 1/2 J.W J + J.u, which is what contacts add.
    for c in range(contacts.particle.shape[0]):
        k = member_of(contacts, c, touching, inverse_mass)
        if k >= 0 and touching.fails[touching.cluster[k]]:
            push.bias[c] = max(push.bias[c], max(0.0, contacts.gap[c]) / h)
            contacts.impulse[c, 0] = 0.0
            contacts.impulse[c, 1] = 0.0


@inner_kernel
def _calm(first_row, last_row, rows):  # type: ignore[no-untyped-def]
    # Halve the velocities within one body, v = mean + (v - mean) / 2.
    x = 0.0
    y = 0.0
    total = 0.0
    for r in range(first_row, last_row):
        total += rows.mass[r]
        x += rows.mass[r] * rows.trial[r, 0]
        y += rows.mass[r] * rows.trial[r, 1]
    if total > 0.0:
        x /= total
        y /= total
    for r in range(first_row, last_row):
        rows.trial[r, 0] = x + 0.5 * (rows.trial[r, 0] - x)
        rows.trial[r, 1] = y + 0.5 * (rows.trial[r, 1] - y)


@inner_kernel
def _slow(touching, items, halving, collides, terrain, rest_length, h):  # type: ignore[no-untyped-def]
    # One halving of every body of a cluster that fails.
    bodies, rows, springs, shapes, _, _ = items
    for k in range(touching.body.shape[0]):
        if not touching.fails[touching.cluster[k]]:
            continue
        body = touching.body[k]
        first_row, last_row = bodies.row_start[body], bodies.row_start[body + 1]
        first, last = bodies.spring_start[body], bodies.spring_start[body + 1]
        low, high = bodies.shape_start[body], bodies.shape_start[body + 1]
        if halving == 0:
            touching.due[k] = True
            copy(first_row, last_row, rows.trial, touching.free)
        if halving < INNER_HALVINGS:
            if not bodies.anchored[body]:
                _calm(first_row, last_row, rows)
        else:
            if halving == INNER_HALVINGS:
                copy(first_row, last_row, touching.free, rows.trial)
            scale(first_row, last_row, 0.5 if halving < LAST_HALVINGS else 0.0, rows.trial)
        stop_rows(first_row, last_row, rows, collides, terrain, h)
        held = body_energy(first_row, last_row, first, last, low, high, rows, springs, shapes, rest_length, h)
        touching.after[k] = held - less_work(first_row, last_row, rows, touching.bouncy[k])


@inner_kernel
def brake(touching, items, mass, start, collides, terrain, rest_length, h):  # type: ignore[no-untyped-def]
    """Slow down what moves within the bodies of clusters that fail, else all that moves, until they pass."""
    # All that moves slowly enough along what contacts and springs want loses energy, and at rest they pass.
    bodies, rows, springs, _, _, _ = items
    for k in range(touching.body.shape[0]):
        touching.due[k] = False
    for halving in range(LAST_HALVINGS + 1):
        _slow(touching, items, halving, collides, terrain, rest_length, h)
        for i in range(touching.loose.shape[0]):
            if halving >= INNER_HALVINGS and touching.fails[touching.cluster[touching.body.shape[0] + i]]:
                p = touching.loose[i]
                factor = 0.5 if halving < LAST_HALVINGS else 0.0
                for axis in range(2):
                    v = touching.given[p, axis] + touching.change[p, axis]
                    touching.change[p, axis] = factor * v - touching.given[p, axis]
        if not judge(touching, mass, start):
            break
    for k in range(touching.body.shape[0]):
        if touching.due[k]:
            first, last = bodies.spring_start[touching.body[k]], bodies.spring_start[touching.body[k] + 1]
            keep_tension(first, last, rows, springs, h)


@inner_kernel
def _limit(touching, items, contacts, push, inverse_mass, rest_length, h):  # type: ignore[no-untyped-def]
    # The most that the bank of each body and loose particle may hold: a share of its energy, and what overlaps store.
    bodies, rows, springs, shapes, _, _ = items
    for k in range(touching.cluster.shape[0]):
        touching.limit[k] = BANK_SHARE * touching.before[k]
        if k >= touching.body.shape[0]:
            continue
        if touching.bouncy[k]:
            touching.limit[k] = BOUNCY_BANK_SHARE * touching.before[k]
        if touching.spread[k]:
            body = touching.body[k]
            first, last = bodies.spring_start[body], bodies.spring_start[body + 1]
            low, high = bodies.shape_start[body], bodies.shape_start[body + 1]
            touching.limit[k] += body_hidden(
                first, last, low, high, rows.position, rows.trial, springs, shapes, rest_length, h, h
            )  # fmt: skip
    for c in range(contacts.particle.shape[0]):
        k = member_of(contacts, c, touching, inverse_mass)
        if k >= 0:
            touching.limit[k] += _stored(contacts, c, push, h)


@inner_kernel
def save(touching, items, contacts, push, inverse_mass, rest_length, energy_bank, h):  # type: ignore[no-untyped-def]
    """Save what each cluster has left of what it was allowed, up to the limits of its banks."""
    _limit(touching, items, contacts, push, inverse_mass, rest_length, h)
    for k in range(touching.cluster.shape[0]):
        cluster = touching.cluster[k]
        limit = touching.limit[k]
        # As in solve.py: a tangled body keeps all that it lost for the way back to its form.
        if k < touching.body.shape[0] and touching.tangled[k] and not items[0].anchored[touching.body[k]]:
            limit = max(limit, touching.held[k] + touching.before[k] - touching.after[k])
        saved = max(0.0, min(touching.allowed[cluster] - touching.total[cluster], limit))
        touching.allowed[cluster] -= saved
        if k < touching.body.shape[0]:
            energy_bank[items[0].lowest[touching.body[k]]] = saved
        else:
            energy_bank[touching.loose[k - touching.body.shape[0]]] = saved
