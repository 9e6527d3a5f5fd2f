"""Projected Gauss-Seidel: contacts as springs that only push, in sweeps with accumulated, clamped impulses.

Along the normal a contact is the spring of Cs and Cd below whose impulse cannot pull; across it is one that stops the
surfaces, whose impulse is at most friction times the push (Coulomb). Both answer to the effective mass of what they
push, 1 / (J W J^T): W of a loose particle is 1 / m, of a body that the direct solver has factored its response. What is
kept of the last step starts the next, so that what rests is at rest from the first sweep on.
"""

from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.types import weight_of
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.world import Floats, Slots

# Cs / Cd of a contact that overlaps: the part of the overlap that a step removes. Higher shakes what rests, lower
# leaves heaps soft.
OVERLAP_SHARE = 0.1
# What overlaps parts at this speed [m/s] at most: a body is not thrown out of another that it was put into.
FASTEST_PUSH = 3.0
# 1 - Cd of a contact. 0 would leave contacts that carry the same load without a definite share; a larger value lets
# heaps sink into each other.
SOFTNESS = 7e-4
# Sweeps end where no contact changed its velocity by more [m/s].
SETTLED = 1e-6


class Blocks(NamedTuple):
    """Responses of bodies: block and place in it of each particle (n,), -1: loose, it answers by its own mass.

    Points of block k: point[start[k]:start[k + 1]]; its response [1/kg], two rows of a square for each point, at
    base[k] in numbers.
    """

    block: Slots
    place: Slots
    start: Slots
    point: Slots
    base: Slots
    numbers: Floats


class Push(NamedTuple):
    """By contact: the velocity [m/s] that it adds to its own, and its response [1/kg] along, between and across.

    before, direction [N s] (k, 2): its impulse before a sweep, and where the sweeps so far have led.
    """

    bias: Floats
    along: Floats
    between: Floats
    across: Floats
    before: Floats
    direction: Floats


def loose_blocks(particle_count: int) -> Blocks:
    """The responses of particles that all answer by their own mass."""
    none = np.zeros(0, dtype=np.int64)
    return Blocks(np.full(particle_count, -1, dtype=np.int64), none, np.zeros(1, np.int64), none, none, np.zeros(0))


@inner_kernel
def relative_velocity(contacts, c, velocity, change):  # type: ignore[no-untyped-def]
    """Velocity of the particle against what it touches, from velocity + change."""
    p = contacts.particle[c]
    ux = velocity[p, 0] + change[p, 0]
    uy = velocity[p, 1] + change[p, 1]
    a = contacts.end_a[c]
    if a >= 0:
        b = contacts.end_b[c]
        share = contacts.share[c] if b >= 0 else 0.0
        ux -= (1.0 - share) * (velocity[a, 0] + change[a, 0])
        uy -= (1.0 - share) * (velocity[a, 1] + change[a, 1])
        if b >= 0:
            ux -= share * (velocity[b, 0] + change[b, 0])
            uy -= share * (velocity[b, 1] + change[b, 1])
    return ux, uy


@inner_kernel
def _push_particle(p, jx, jy, change, inverse_mass, blocks):  # type: ignore[no-untyped-def]
    # v += W J
    k = blocks.block[p]
    if k < 0:
        change[p, 0] += jx * inverse_mass[p]
        change[p, 1] += jy * inverse_mass[p]
        return
    first = blocks.start[k]
    points = blocks.start[k + 1] - first
    row = blocks.base[k] + blocks.place[p] * 4 * points
    lower = row + 2 * points
    for i in range(points):
        q = blocks.point[first + i]
        j = 2 * i
        change[q, 0] += blocks.numbers[row + j] * jx + blocks.numbers[lower + j] * jy
        change[q, 1] += blocks.numbers[row + j + 1] * jx + blocks.numbers[lower + j + 1] * jy


@inner_kernel
def _apply(contacts, c, jn, jt, change, inverse_mass, blocks):  # type: ignore[no-untyped-def]
    nx = contacts.normal[c, 0]
    ny = contacts.normal[c, 1]
    jx = jn * nx - jt * ny
    jy = jn * ny + jt * nx
    _push_particle(contacts.particle[c], jx, jy, change, inverse_mass, blocks)
    a = contacts.end_a[c]
    if a >= 0:
        b = contacts.end_b[c]
        share = contacts.share[c] if b >= 0 else 0.0
        _push_particle(a, -(1.0 - share) * jx, -(1.0 - share) * jy, change, inverse_mass, blocks)
        if b >= 0:
            _push_particle(b, -share * jx, -share * jy, change, inverse_mass, blocks)


@inner_kernel
def _response(p, q, inverse_mass, blocks):  # type: ignore[no-untyped-def]
    # The block xx, xy, yx, yy of W between two particles.
    if p < 0 or q < 0 or inverse_mass[p] == 0.0 or inverse_mass[q] == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    k = blocks.block[p]
    if k < 0:
        w = inverse_mass[p] if p == q else 0.0
        return w, 0.0, 0.0, w
    if blocks.block[q] != k:
        return 0.0, 0.0, 0.0, 0.0
    points = blocks.start[k + 1] - blocks.start[k]
    at = blocks.base[k] + blocks.place[p] * 4 * points + 2 * blocks.place[q]
    below = at + 2 * points
    return blocks.numbers[at], blocks.numbers[at + 1], blocks.numbers[below], blocks.numbers[below + 1]


@inner_kernel
def load_responses(contacts, push, inverse_mass, blocks):  # type: ignore[no-untyped-def]
    """Response of every contact: J W J^T along, between and across."""
    for c in range(contacts.particle.shape[0]):
        nx = contacts.normal[c, 0]
        ny = contacts.normal[c, 1]
        along = 0.0
        between = 0.0
        across = 0.0
        for end in range(3):
            p, weight = weight_of(contacts, c, end)
            for other in range(3):
                q, share = weight_of(contacts, c, other)
                xx, xy, yx, yy = _response(p, q, inverse_mass, blocks)
                both = weight * share
                ax = both * (xx * nx + xy * ny)
                ay = both * (yx * nx + yy * ny)
                along += nx * ax + ny * ay
                between += nx * ay - ny * ax
                across += both * (nx * (yy * nx - yx * ny) - ny * (xy * nx - xx * ny))
        push.along[c] = along
        push.between[c] = between
        push.across[c] = across


@kernel
def load_biases(contacts, push, h):  # type: ignore[no-untyped-def]
    """What each contact adds to its velocity: its gap, its overlap or its bounce."""
    for c in range(contacts.particle.shape[0]):
        gap = contacts.gap[c]
        push.bias[c] = gap / h if gap >= 0.0 else max(OVERLAP_SHARE * gap / h, -FASTEST_PUSH)
        if contacts.bounce[c] >= 0.0:
            push.bias[c] = -contacts.bounce[c]


@inner_kernel
def start_impulses(contacts, change, inverse_mass, blocks):  # type: ignore[no-untyped-def]
    """Apply the impulses that contacts bring along."""
    for c in range(contacts.particle.shape[0]):
        if contacts.impulse[c, 0] != 0.0 or contacts.impulse[c, 1] != 0.0:
            _apply(contacts, c, contacts.impulse[c, 0], contacts.impulse[c, 1], change, inverse_mass, blocks)


@inner_kernel
def sweep(contacts, push, velocity, change, inverse_mass, blocks):  # type: ignore[no-untyped-def]
    """One sweep over all contacts; the largest change of a contact's velocity [m/s]."""
    # J = max(0, J - (u + b + J / K) / (W + 1 / K)), 1 / K = W (1 - Cd) / Cd;  |J_t| <= friction J
    largest = 0.0
    for c in range(contacts.particle.shape[0]):
        along = push.along[c]
        if not along > 0.0:
            continue
        ux, uy = relative_velocity(contacts, c, velocity, change)
        nx = contacts.normal[c, 0]
        ny = contacts.normal[c, 1]
        soft = SOFTNESS * along
        old = contacts.impulse[c, 0]
        new = max(0.0, old - (nx * ux + ny * uy + push.bias[c] + soft * old) / (along + soft))
        jn = new - old
        contacts.impulse[c, 0] = new
        jt = 0.0
        if push.across[c] > 0.0:
            slip = nx * uy - ny * ux + push.between[c] * jn
            most = contacts.friction[c] * new
            held = contacts.impulse[c, 1]
            jt = min(most, max(-most, held - slip / push.across[c])) - held
            contacts.impulse[c, 1] = held + jt
        if jn != 0.0 or jt != 0.0:
            _apply(contacts, c, jn, jt, change, inverse_mass, blocks)
            largest = max(largest, max(abs(jn) * along, abs(jt) * push.across[c]))
    return largest


@inner_kernel
def solve_contacts(contacts, push, velocity, change, inverse_mass, blocks, sweeps, hasten):  # type: ignore[no-untyped-def]
    """Sweep until nothing changes, at most so many times; hasten: each goes on in the direction of those before it."""
    # Nonlinear conjugate gradients on the sweep as a fixed point (Silcowitz-Poulsen and others 2010).
    start_impulses(contacts, change, inverse_mass, blocks)
    previous = 0.0
    for k in range(sweeps):
        for c in range(contacts.particle.shape[0]):
            push.before[c, 0] = contacts.impulse[c, 0]
            push.before[c, 1] = contacts.impulse[c, 1]
        if sweep(contacts, push, velocity, change, inverse_mass, blocks) < SETTLED or k == sweeps - 1:
            break
        squared = 0.0
        for c in range(contacts.particle.shape[0]):
            jn = contacts.impulse[c, 0] - push.before[c, 0]
            jt = contacts.impulse[c, 1] - push.before[c, 1]
            squared += push.along[c] * jn * jn + push.across[c] * jt * jt
        ratio = squared / previous if hasten and previous > 0.0 else 0.0
        _go_on(contacts, push, change, inverse_mass, blocks, ratio if ratio < 1.0 else 0.0)
        previous = squared


@inner_kernel
def _go_on(contacts, push, change, inverse_mass, blocks, ratio):  # type: ignore[no-untyped-def]
    # J += ratio p, clamped;  p = ratio p + what the sweep has changed.
    for c in range(contacts.particle.shape[0]):
        old_n = contacts.impulse[c, 0]
        old_t = contacts.impulse[c, 1]
        more_n = ratio * push.direction[c, 0]
        more_t = ratio * push.direction[c, 1]
        push.direction[c, 0] = more_n + (old_n - push.before[c, 0])
        push.direction[c, 1] = more_t + (old_t - push.before[c, 1])
        new_n = max(0.0, old_n + more_n)
        most = contacts.friction[c] * new_n
        new_t = min(most, max(-most, old_t + more_t))
        if new_n != old_n or new_t != old_t:
            contacts.impulse[c, 0] = new_n
            contacts.impulse[c, 1] = new_t
            _apply(contacts, c, new_n - old_n, new_t - old_t, change, inverse_mass, blocks)


def new_push(count: int) -> Push:
    """What so many contacts need for a step."""
    return Push(*np.zeros((4, count)), *np.zeros((2, count, 2)))


@inner_kernel
def add_change(velocity, change, inverse_mass):  # type: ignore[no-untyped-def]
    """Add what a step changes to the velocities of particles that can move."""
    for p in range(inverse_mass.shape[0]):
        if inverse_mass[p] > 0.0:
            velocity[p, 0] += change[p, 0]
            velocity[p, 1] += change[p, 1]


@kernel
def sweep_masses(contacts, push, velocity, change, inverse_mass, blocks, sweeps):  # type: ignore[no-untyped-def]
    """Solve contacts of particles that answer by their own mass, and bring the velocities to the end of the step."""
    load_responses(contacts, push, inverse_mass, blocks)
    solve_contacts(contacts, push, velocity, change, inverse_mass, blocks, sweeps, True)
    add_change(velocity, change, inverse_mass)
