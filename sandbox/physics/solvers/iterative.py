"""Iterative, warm-started: springs and elements in order, N times, on a velocity change.

No proven limit. Only springs are warm-started. Hooke springs are no constraints: they act once, explicitly, before the
iterations. Source: Nissen's demo programs after the article.
"""

from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.types import NO_CONTACTS
from sandbox.physics.constraints import AREA, BEND, element_rate, evaluate, explicit_mass, look
from sandbox.physics.equation import direction, reduced_mass
from sandbox.physics.forces import Before
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.solvers.contact.gauss_seidel import (
    add_change,
    load_biases,
    load_responses,
    loose_blocks,
    new_push,
    start_impulses,
    sweep,
)
from sandbox.physics.solvers.single_pass import Pair, apply_explicit
from sandbox.physics.world import LAW_HOOKE, Floats, World

# The share of what an area still wants that it gets in an iteration after the first. With all of it jellies and rings,
# which have more constraints than ways to move, gain energy several times over; with 0.3 or less a crushed jelly stays
# crushed.
AREA_SHARE = 0.5


class Wanted(NamedTuple):
    """Scratch of the elements: corners' places and gradients (q, 2), and of each (t,) what `_iterate_elements` says.

    wanted = -(Cs C / h + Cd dC/dt) m; impulse = the sum of its j. Of a bend, damped = Cd m, kept = 1 - Cd and whole =
    kept + Cd m / present mass. Of an area, as of a spring, damped = m, kept = 0 and whole = 1, then 1 / AREA_SHARE.
    """

    place: Floats
    slope: Floats
    wanted: Floats
    damped: Floats
    kept: Floats
    whole: Floats
    impulse: Floats


@inner_kernel
def _prepare_elements(position, velocity, inverse_mass, elements, stiffness, damping, h, wanted):  # type: ignore[no-untyped-def]
    for k in range(elements.kind.shape[0]):
        wanted.whole[k] = 0.0
        if not elements.active[k]:
            continue
        first = elements.first[k]
        last = first + elements.corners[k]
        look(first, last, position, elements.particle, wanted.place)
        error = evaluate(
            elements.kind[k], wanted.place, first, last, elements.rest, k, elements.weight, wanted.slope
        )  # fmt: skip
        mass, share = explicit_mass(first, last, inverse_mass, elements.particle, elements.weight, wanted.slope)
        rate = element_rate(first, last, velocity, elements.particle, wanted.slope)
        wanted.wanted[k] = -(stiffness[k] * error / h + damping[k] * rate) * mass
        if elements.kind[k] == BEND:
            wanted.damped[k] = damping[k] * mass
            wanted.kept[k] = 1.0 - damping[k]
            wanted.whole[k] = wanted.kept[k] + damping[k] * share
        else:
            wanted.damped[k] = mass
            wanted.kept[k] = 0.0
            wanted.whole[k] = 1.0
        wanted.impulse[k] = 0.0


@inner_kernel
def _iterate_elements(inverse_mass, elements, wanted, change):  # type: ignore[no-untyped-def]
    # A bend obeys (1 - Cd) j = -(Cs C / h + Cd (dC/dt + g . dv)) m, the equation with the velocity after the step
    # (see direct/solve.py): so can all of more bends than there are ways to bend. Both go at once into the velocity
    # change dv.
    for k in range(elements.kind.shape[0]):
        if wanted.whole[k] == 0.0:
            continue
        first = elements.first[k]
        last = first + elements.corners[k]
        rate = element_rate(first, last, change, elements.particle, wanted.slope)
        j = (wanted.wanted[k] - wanted.damped[k] * rate - wanted.kept[k] * wanted.impulse[k]) / wanted.whole[k]
        wanted.impulse[k] += j
        if elements.kind[k] == AREA:
            wanted.whole[k] = 1.0 / AREA_SHARE
        for c in range(first, last):
            p = elements.particle[c]
            change[p, 0] += j * wanted.slope[c, 0] * inverse_mass[p]
            change[p, 1] += j * wanted.slope[c, 1] * inverse_mass[p]


@inner_kernel
def _iterate_springs(count, inverse_mass, end_a, end_b, slot, normal, wanted, mass, change, accumulated):  # type: ignore[no-untyped-def]
    # j = -(n . (dv_b - dv_a) - r) m_r, applied at once to the velocity change dv.
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


@kernel
def _iterate(  # type: ignore[no-untyped-def]
    position, velocity, inverse_mass, particle_a, particle_b, rest_length, stiffness, damping, law, spring_active, h,
    iterations, warm_start, accumulated, end_a, end_b, slot, normal, wanted, mass, change, elements,
    element_stiffness, element_damping, element_wanted, contacts, push, blocks,
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
    _prepare_elements(
        position, velocity, inverse_mass, elements, element_stiffness, element_damping, h, element_wanted
    )  # fmt: skip
    load_responses(contacts, push, inverse_mass, blocks)
    start_impulses(contacts, change, inverse_mass, blocks)
    for _ in range(iterations):
        _iterate_springs(count, inverse_mass, end_a, end_b, slot, normal, wanted, mass, change, accumulated)
        _iterate_elements(inverse_mass, elements, element_wanted, change)
        sweep(contacts, push, velocity, change, inverse_mass, blocks)
    add_change(velocity, change, inverse_mass)


def solve(world: World, springs: Pair, elements: Pair, h: float, before: Before) -> None:
    """Bring the velocities to the end of a step of h [s]; world.impulse keeps the sums for the next warm start."""
    hooke = world.spring_active & (world.law == LAW_HOOKE)
    if hooke.any():
        apply_explicit(world, hooke, springs, h)
    count, contacts = world.spring_count, world.contacts or NO_CONTACTS
    blocks = loose_blocks(world.particle_count if world.contacts else 0)
    push = new_push(len(contacts.particle))
    load_biases(contacts, push, h)
    end_a, end_b, slot = np.zeros((3, count), dtype=np.int64)
    place, slope = np.zeros((2, len(world.corner_particle), 2))
    wanted = Wanted(place, slope, *np.zeros((5, world.element_count)))
    _iterate(
        world.position, world.velocity, world.inverse_mass, world.particle_a, world.particle_b, world.rest_length,
        springs[0], springs[1], world.law, world.spring_active, h, world.settings.iterations,
        world.settings.warm_start, world.impulse, end_a, end_b, slot, np.zeros((count, 2)), np.zeros(count),
        np.zeros(count), np.zeros((world.particle_count, 2)), world.elements, elements[0], elements[1], wanted,
        contacts, push, blocks,
    )  # fmt: skip
