"""Iterative, warm-started: springs in order, N times, on a velocity change (Nissen's demo programs after the article).

No proven limit. Hooke springs are no constraints: they act once, explicitly, before the iterations.
"""

import numpy as np

from sandbox.physics.equation import direction, reduced_mass
from sandbox.physics.forces import Before
from sandbox.physics.jit import kernel
from sandbox.physics.shapes import NO_CONTACTS
from sandbox.physics.solvers.contact_sweep import (
    add_change,
    load_biases,
    load_responses,
    loose_blocks,
    new_push,
    start_impulses,
    sweep,
)
from sandbox.physics.solvers.single_pass import apply_explicit
from sandbox.physics.world import LAW_HOOKE, Floats, World


@kernel
def _iterate(  # type: ignore[no-untyped-def]
    position, velocity, inverse_mass, particle_a, particle_b, rest_length, stiffness, damping, law, spring_active, h,
    iterations, warm_start, accumulated, end_a, end_b, slot, normal, wanted, mass, change, contacts, push, blocks,
):  # fmt: skip
    # r = -(Cs x / h + Cd u), the wanted change of relative velocity.
    count = 0
    for s in range(spring_active.shape[0]):
        if not spring_active[s] or law[s] != 0:
            continue
        a = particle_a[s]
        b = particle_b[s]
        m = reduced_mass(inverse_mass[a], inverse_mass[b])
        # Warm start: p = n . acc; only a pull (p < 0) is used again, j = Cw p.
        warm_x = accumulated[s, 0]
        warm_y = accumulated[s, 1]
        accumulated[s, 0] = 0.0
        accumulated[s, 1] = 0.0
        if m == 0.0:
            continue
        du = velocity[b, 0] - velocity[a, 0]
        dv = velocity[b, 1] - velocity[a, 1]
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        end_a[count] = a
        end_b[count] = b
        slot[count] = s
        normal[count, 0] = nx
        normal[count, 1] = ny
        mass[count] = m
        wanted[count] = -(stiffness[s] * (length - rest_length[s]) / h + damping[s] * (nx * du + ny * dv))
        count += 1
        p = nx * warm_x + ny * warm_y
        if p < 0.0:
            j = warm_start * p
            change[a, 0] -= j * nx * inverse_mass[a]
            change[a, 1] -= j * ny * inverse_mass[a]
            change[b, 0] += j * nx * inverse_mass[b]
            change[b, 1] += j * ny * inverse_mass[b]
    load_responses(contacts, push, inverse_mass, blocks)
    start_impulses(contacts, change, inverse_mass, blocks)
    # j = -(n . (dv_b - dv_a) - r) m_r, applied at once to the velocity change dv.
    for _ in range(iterations):
        for c in range(count):
            a = end_a[c]
            b = end_b[c]
            nx = normal[c, 0]
            ny = normal[c, 1]
            du = change[b, 0] - change[a, 0]
            dv = change[b, 1] - change[a, 1]
            j = -(nx * du + ny * dv - wanted[c]) * mass[c]
            jx = j * nx
            jy = j * ny
            change[a, 0] -= jx * inverse_mass[a]
            change[a, 1] -= jy * inverse_mass[a]
            change[b, 0] += jx * inverse_mass[b]
            change[b, 1] += jy * inverse_mass[b]
            s = slot[c]
            accumulated[s, 0] += jx
            accumulated[s, 1] += jy
        sweep(contacts, push, velocity, change, inverse_mass, blocks)
    add_change(velocity, change, inverse_mass)


def solve(world: World, stiffness: Floats, damping: Floats, h: float, before: Before) -> None:
    """Bring the velocities to the end of a step of h [s]; world.impulse keeps the sums for the next warm start."""
    hooke = world.spring_active & (world.law == LAW_HOOKE)
    if hooke.any():
        apply_explicit(world, hooke, stiffness, damping, h)
    springs, contacts = world.spring_count, world.contacts or NO_CONTACTS
    blocks = loose_blocks(world.particle_count if world.contacts else 0)
    push = new_push(len(contacts.particle))
    load_biases(contacts, push, world.velocity, before.velocity, h)
    _iterate(
        world.position, world.velocity, world.inverse_mass, world.particle_a, world.particle_b, world.rest_length,
        stiffness, damping, world.law, world.spring_active, h, world.settings.iterations, world.settings.warm_start,
        world.impulse, np.zeros(springs, dtype=np.int64), np.zeros(springs, dtype=np.int64),
        np.zeros(springs, dtype=np.int64), np.zeros((springs, 2)), np.zeros(springs), np.zeros(springs),
        np.zeros((world.particle_count, 2)), contacts, push, blocks,
    )  # fmt: skip
