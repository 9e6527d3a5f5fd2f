"""Contacts of free particles among themselves and with what cannot move: small steps, alike in every solver.

No spring joins a free particle, so a step of a heap can be taken in many small ones whose cost is a sweep over its
contacts: overlap falls with the square of their number. In each, a first sweep pushes apart what overlaps, the
particles move, and a second sweep, which leaves overlap alone, takes back the speed that pushing has given
(soft contacts that relax: Catto 2023, "Solver2D"; small steps: Macklin and others 2019).
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.restitution import SLOWEST_BOUNCE
from sandbox.physics.collision.types import Contacts
from sandbox.physics.jit import inlined_kernel, inner_kernel, kernel
from sandbox.physics.solvers.contact.gauss_seidel import FASTEST_PUSH
from sandbox.physics.world import Floats, Slots, World

# A small step is no longer than this [s]: 8 of them at 60 Hz. With a quarter of them, heaps of 50 layers sink into each
# other by a seventh of a radius; twice as many double the time.
SMALL_STEP = 1.0 / 480.0
# Small steps of a step at most, where a cluster would sink too deep.
MOST_PARTS = 64
# Part of an overlap that a small step removes, and 1 - Cd of a contact while it does. More of the first, or less of the
# second, shakes heaps; less of the first, or more of the second, lets them sink into each other.
OVERLAP_SHARE = 0.05
SOFTNESS = 0.013
# Share of the smaller radius to which contacts sink in under the load of the last step; less costs small steps.
DEEPEST = 0.04


class Work(NamedTuple):
    """Contacts in the order of their clusters, and their particles; what cannot move has a place for each contact.

    By cluster: the first contact, the first place (g + 1,). By contact: contact, first, second = places of particles
    (-1: none), mass [kg], drift [m/s] (k, 2) = velocity of what cannot move, depth [m] = as deep as it should sink.
    By place: particle, weight [1/kg], gain [m/s] (m, 2) = what forces add in the step; velocity [m/s], pushed [m/s] =
    what the impulses of a small step add, way [m] so far.
    """

    first_contact: Slots
    first_particle: Slots
    contact: Slots
    first: Slots
    second: Slots
    mass: Floats
    drift: Floats
    depth: Floats
    particle: Slots
    weight: Floats
    gain: Floats
    velocity: Floats
    pushed: Floats
    way: Floats


@inner_kernel
def _place_of(p, inverse_mass, start, velocity, local, work, count):  # type: ignore[no-untyped-def]
    # The place of a particle, and the number of places then.
    if inverse_mass[p] > 0.0 and local[p] >= 0:
        return local[p], count
    local[p] = count
    work.particle[count] = p
    work.weight[count] = inverse_mass[p]
    for axis in range(2):
        work.velocity[count, axis] = start[p, axis]
        work.gain[count, axis] = velocity[p, axis] - start[p, axis]
    return count, count + 1


@kernel
def _gather(contacts, inverse_mass, radius, start, velocity, local, work):  # type: ignore[no-untyped-def]
    # Fill in what a step works on, cluster by cluster; the number of places.
    count = 0
    for g in range(work.first_contact.shape[0] - 1):
        work.first_particle[g] = count
        for i in range(work.first_contact[g], work.first_contact[g + 1]):
            c = work.contact[i]
            p = contacts.particle[c]
            a = contacts.end_a[c]
            b = contacts.end_b[c]
            mass = inverse_mass[p]
            smaller = radius[p]
            work.second[i] = -1
            if b >= 0:
                share = contacts.share[c]
                for axis in range(2):
                    work.drift[i, axis] = (1.0 - share) * start[a, axis] + share * start[b, axis]
            elif a >= 0:
                mass += inverse_mass[a]
                smaller = min(smaller, radius[a])
                work.second[i], count = _place_of(a, inverse_mass, start, velocity, local, work, count)
            work.first[i], count = _place_of(p, inverse_mass, start, velocity, local, work, count)
            work.mass[i] = 1.0 / mass
            work.depth[i] = DEEPEST * smaller
    work.first_particle[work.first_contact.shape[0] - 1] = count
    return count


@inner_kernel
def _plan(contacts, work, first, last, h):  # type: ignore[no-untyped-def]
    # Small steps of one cluster, and its softness: so deep sinks a contact that carries J in each step,
    # SOFTNESS J h / (m OVERLAP_SHARE parts^2).
    parts = 1
    while parts < MOST_PARTS and h > SMALL_STEP * parts * (1.0 + 1e-9):
        parts *= 2
    deep = SOFTNESS * h / (OVERLAP_SHARE * parts * parts)
    most = 1.0
    for i in range(first, last):
        if work.depth[i] > 0.0:
            most = max(most, contacts.impulse[work.contact[i], 0] * deep / (work.mass[i] * work.depth[i]))
    stiffer = 1.0
    while parts < MOST_PARTS and stiffer < most:
        parts *= 2
        stiffer *= 4.0
    return parts, SOFTNESS * (stiffer / most if stiffer > most else 1.0)


@inner_kernel
def _begin(contacts, work, first, last, scale):  # type: ignore[no-untyped-def]
    # The impulses that contacts bring along, as those of a small step; pushed: what they add to the velocities.
    for i in range(first, last):
        c = work.contact[i]
        jn = contacts.impulse[c, 0] * scale
        jt = contacts.impulse[c, 1] * scale
        contacts.impulse[c, 0] = jn
        contacts.impulse[c, 1] = jt
        jx = jn * contacts.normal[c, 0] - jt * contacts.normal[c, 1]
        jy = jn * contacts.normal[c, 1] + jt * contacts.normal[c, 0]
        p = work.first[i]
        work.pushed[p, 0] += jx * work.weight[p]
        work.pushed[p, 1] += jy * work.weight[p]
        q = work.second[i]
        if q >= 0:
            work.pushed[q, 0] -= jx * work.weight[q]
            work.pushed[q, 1] -= jy * work.weight[q]


@inlined_kernel
def _sweep(contacts, work, first, last, small, passed, softness, ends):  # type: ignore[no-untyped-def]
    # One sweep in order, after the time `passed`; softness 0: what overlaps is not pushed apart. ends: whether the step
    # does with it; what would meet in the first small step of the next one, and bounce there, is not slowed before.
    for i in range(first, last):
        c = work.contact[i]
        p = work.first[i]
        q = work.second[i]
        nx = contacts.normal[c, 0]
        ny = contacts.normal[c, 1]
        ux = work.velocity[p, 0] - work.drift[i, 0]
        uy = work.velocity[p, 1] - work.drift[i, 1]
        wx = work.way[p, 0] - passed * work.drift[i, 0]
        wy = work.way[p, 1] - passed * work.drift[i, 1]
        if q >= 0:
            ux -= work.velocity[q, 0]
            uy -= work.velocity[q, 1]
            wx -= work.way[q, 0]
            wy -= work.way[q, 1]
        gap = contacts.gap[c] + nx * wx + ny * wy
        # J = max(0, J - ((u + b) m + soft J) / (1 + soft));  |J_t| <= friction J
        soft = 0.0
        bias = 0.0
        if contacts.bounce[c] >= 0.0:
            bias = -contacts.bounce[c]
        elif gap > 0.0:
            if ends and contacts.restitution[c] > 0.0 and nx * ux + ny * uy < -SLOWEST_BOUNCE:
                continue
            bias = gap / small
        elif softness > 0.0:
            bias = max(OVERLAP_SHARE * gap / small, -FASTEST_PUSH)
            soft = softness
        old = contacts.impulse[c, 0]
        new = max(0.0, old - ((nx * ux + ny * uy + bias) * work.mass[i] + soft * old) / (1.0 + soft))
        most = contacts.friction[c] * new
        held = contacts.impulse[c, 1]
        across = min(most, max(-most, held - (nx * uy - ny * ux) * work.mass[i]))
        contacts.impulse[c, 0] = new
        contacts.impulse[c, 1] = across
        jx = (new - old) * nx - (across - held) * ny
        jy = (new - old) * ny + (across - held) * nx
        work.velocity[p, 0] += jx * work.weight[p]
        work.velocity[p, 1] += jy * work.weight[p]
        if q >= 0:
            work.velocity[q, 0] -= jx * work.weight[q]
            work.velocity[q, 1] -= jy * work.weight[q]


@inner_kernel
def _energy(work, begin, end, gained):  # type: ignore[no-untyped-def]
    # Kinetic energy of what can move in a cluster [J]; gained: with what forces add in the step.
    total = 0.0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            vx = work.velocity[k, 0] + gained * work.gain[k, 0]
            vy = work.velocity[k, 1] + gained * work.gain[k, 1]
            total += 0.5 * (vx * vx + vy * vy) / work.weight[k]
    return total


@inner_kernel
def _restrain(work, first, last, begin, end, allowed):  # type: ignore[no-untyped-def]
    # Many bounces at once can gain energy: what moves is slowed down until it has no more than it had; beside its
    # common motion, where it touches nothing that cannot move. What is carried along gets energy from outside.
    after = _energy(work, begin, end, 0.0)
    if not after > allowed:
        return
    mass = 0.0
    px = 0.0
    py = 0.0
    apart = True
    for i in range(first, last):
        if work.drift[i, 0] != 0.0 or work.drift[i, 1] != 0.0:
            return
        apart = apart and work.second[i] >= 0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            mass += 1.0 / work.weight[k]
            px += work.velocity[k, 0] / work.weight[k]
            py += work.velocity[k, 1] / work.weight[k]
        elif work.velocity[k, 0] != 0.0 or work.velocity[k, 1] != 0.0:
            return
        else:
            apart = False
    vx = px / mass if apart else 0.0
    vy = py / mass if apart else 0.0
    common = 0.5 * mass * (vx * vx + vy * vy)
    factor = math.sqrt(max(0.0, allowed - common) / (after - common)) if after > common else 0.0
    for k in range(begin, end):
        if work.weight[k] > 0.0:
            work.velocity[k, 0] = vx + factor * (work.velocity[k, 0] - vx)
            work.velocity[k, 1] = vy + factor * (work.velocity[k, 1] - vy)


@kernel
def _settle(contacts, work, h):  # type: ignore[no-untyped-def]
    # Every cluster's small steps.
    for g in range(work.first_contact.shape[0] - 1):
        first = work.first_contact[g]
        last = work.first_contact[g + 1]
        begin = work.first_particle[g]
        end = work.first_particle[g + 1]
        parts, softness = _plan(contacts, work, first, last, h)
        allowed = _energy(work, begin, end, 1.0)
        small = h / parts
        scale = 1.0 / parts
        _begin(contacts, work, first, last, scale)
        for part in range(parts):
            # The impulses of the last small step start this one; `pushed`: the velocities without them meanwhile.
            for k in range(begin, end):
                for axis in range(2):
                    free = work.velocity[k, axis] + work.gain[k, axis] * scale
                    work.velocity[k, axis] = free + work.pushed[k, axis]
                    work.pushed[k, axis] = free
            for turn in range(2):
                relaxes = turn == 1
                _sweep(
                    contacts, work, first, last, small, small * (part + turn), 0.0 if relaxes else softness,
                    relaxes and part == parts - 1,
                )  # fmt: skip
                if turn == 0:
                    for k in range(begin, end):
                        work.way[k, 0] += small * work.velocity[k, 0]
                        work.way[k, 1] += small * work.velocity[k, 1]
            for k in range(begin, end):
                work.pushed[k, 0] = work.velocity[k, 0] - work.pushed[k, 0]
                work.pushed[k, 1] = work.velocity[k, 1] - work.pushed[k, 1]
        _restrain(work, first, last, begin, end, allowed)
        for i in range(first, last):
            contacts.impulse[work.contact[i], 0] *= parts
            contacts.impulse[work.contact[i], 1] *= parts


def settle_loose(
    world: World, contacts: Contacts, chosen: Slots, cluster: Slots, start: Floats, h: float, ahead: Floats
) -> None:
    """Solve the chosen contacts, of loose particles, over a step of h [s].

    cluster: of each contact. start [m/s] (n, 2): the velocities before anything acted in this step. ahead [m] (n, 2):
    to be filled in, how much further than h v' each particle has gone.
    """
    chosen = chosen[np.argsort(cluster[chosen], kind="stable")]
    count = len(chosen)
    edges = np.append(np.flatnonzero(np.diff(cluster[chosen], prepend=-1)), count)
    slots, pairs = np.zeros((2, count), np.int64), np.zeros((4, 2 * count, 2))
    work = Work(
        edges, np.zeros_like(edges), chosen, slots[0], slots[1], np.zeros(count), np.zeros((count, 2)), np.zeros(count),
        np.zeros(2 * count, np.int64), np.zeros(2 * count), *pairs,
    )  # fmt: skip
    local = np.full(world.particle_count, -1)
    size = _gather(contacts, world.inverse_mass, world.radius, start, world.velocity, local, work)
    _settle(contacts, work, h)
    moved = np.flatnonzero(work.weight[:size] > 0.0)
    particle = work.particle[moved]
    world.velocity[particle] = work.velocity[moved]
    ahead[particle] = work.way[moved] - h * work.velocity[moved]
