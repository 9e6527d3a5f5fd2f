"""Contacts of loose particles among themselves and with what cannot move: small steps, alike in every solver.

No spring joins a loose particle, so a step of a heap can be taken in many small ones whose cost is a sweep over its
contacts: overlap falls with the square of their number. In each, a first sweep pushes apart what overlaps, the
particles move, and a second sweep, which leaves overlap alone, takes back the speed that pushing has given
(soft contacts that relax: Catto 2023, "Solver2D"; small steps: Macklin and others 2019).
"""

import numpy as np

from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.shapes import Contacts
from sandbox.physics.solvers.contact_sweep import FASTEST_PUSH
from sandbox.physics.world import Floats, Slots, World

# A small step is no longer than this [s] while a step has no more than MOST_PARTS of them: 8 at 60 Hz. A quarter of
# them lets heaps of 50 layers sink into each other by a seventh of a radius, twice as many double the time.
SMALL_STEP = 1.0 / 480.0
MOST_PARTS = 16
# Part of an overlap that a small step removes, and 1 - Cd of a contact while it does. More of the first, or less of the
# second, shakes heaps; less of the first, or more of the second, lets them sink into each other.
OVERLAP_SHARE = 0.05
SOFTNESS = 0.013


def parts_of(h: float) -> int:
    """Small steps, a power of two, in a step of h [s]."""
    parts = 1
    while parts < MOST_PARTS and h > SMALL_STEP * parts * (1.0 + 1e-9):
        parts *= 2
    return parts


@kernel
def _gather(contacts, chosen, inverse_mass, velocity, local, particle, first, second, mass, drift, start):  # type: ignore[no-untyped-def]
    # Number the particles of the chosen contacts; how many there are. What has two ends cannot move, but may drift.
    count = 0
    for i in range(chosen.shape[0]):
        c = chosen[i]
        p = contacts.particle[c]
        a = contacts.end_a[c]
        b = contacts.end_b[c]
        drift[i, 0] = 0.0
        drift[i, 1] = 0.0
        second[i] = -1
        weight = inverse_mass[p]
        if b >= 0:
            share = contacts.share[c]
            for axis in range(2):
                drift[i, axis] = (1.0 - share) * velocity[a, axis] + share * velocity[b, axis]
        elif a >= 0:
            weight += inverse_mass[a]
            if local[a] < 0:
                local[a] = count
                particle[count] = a
                count += 1
            second[i] = local[a]
        if local[p] < 0:
            local[p] = count
            particle[count] = p
            count += 1
        first[i] = local[p]
        mass[i] = 1.0 / weight
    for k in range(count):
        p = particle[k]
        start[k, 0] = velocity[p, 0]
        start[k, 1] = velocity[p, 1]
    return count


@inner_kernel
def _begin(contacts, chosen, first, second, weight, pushed, scale):  # type: ignore[no-untyped-def]
    # The impulses that contacts bring along, as those of a small step; pushed: what they add to the velocities.
    for i in range(chosen.shape[0]):
        c = chosen[i]
        jn = contacts.impulse[c, 0] * scale
        jt = contacts.impulse[c, 1] * scale
        contacts.impulse[c, 0] = jn
        contacts.impulse[c, 1] = jt
        jx = jn * contacts.normal[c, 0] - jt * contacts.normal[c, 1]
        jy = jn * contacts.normal[c, 1] + jt * contacts.normal[c, 0]
        p = first[i]
        pushed[p, 0] += jx * weight[p]
        pushed[p, 1] += jy * weight[p]
        q = second[i]
        if q >= 0:
            pushed[q, 0] -= jx * weight[q]
            pushed[q, 1] -= jy * weight[q]


@inner_kernel
def _sweep(contacts, chosen, first, second, mass, drift, weight, velocity, way, small, passed, pushing):  # type: ignore[no-untyped-def]
    # One sweep in order; way [m]: of each particle in the time `passed`; pushing: what overlaps is pushed apart.
    for i in range(chosen.shape[0]):
        c = chosen[i]
        p = first[i]
        q = second[i]
        nx = contacts.normal[c, 0]
        ny = contacts.normal[c, 1]
        ux = velocity[p, 0] - drift[i, 0]
        uy = velocity[p, 1] - drift[i, 1]
        wx = way[p, 0] - passed * drift[i, 0]
        wy = way[p, 1] - passed * drift[i, 1]
        if q >= 0:
            ux -= velocity[q, 0]
            uy -= velocity[q, 1]
            wx -= way[q, 0]
            wy -= way[q, 1]
        gap = contacts.gap[c] + nx * wx + ny * wy
        # J = max(0, J - ((u + b) m + soft J) / (1 + soft));  |J_t| <= friction J
        soft = 0.0
        bias = 0.0
        if contacts.bounce[c] >= 0.0:
            bias = -contacts.bounce[c]
        elif gap > 0.0:
            bias = gap / small
        elif pushing:
            bias = max(OVERLAP_SHARE * gap / small, -FASTEST_PUSH)
            soft = SOFTNESS
        old = contacts.impulse[c, 0]
        new = max(0.0, old - ((nx * ux + ny * uy + bias) * mass[i] + soft * old) / (1.0 + soft))
        most = contacts.friction[c] * new
        held = contacts.impulse[c, 1]
        across = min(most, max(-most, held - (nx * uy - ny * ux) * mass[i]))
        contacts.impulse[c, 0] = new
        contacts.impulse[c, 1] = across
        jx = (new - old) * nx - (across - held) * ny
        jy = (new - old) * ny + (across - held) * nx
        velocity[p, 0] += jx * weight[p]
        velocity[p, 1] += jy * weight[p]
        if q >= 0:
            velocity[q, 0] -= jx * weight[q]
            velocity[q, 1] -= jy * weight[q]


@kernel
def _settle(contacts, chosen, first, second, mass, drift, weight, gain, velocity, pushed, way, h, parts):  # type: ignore[no-untyped-def]
    # velocity, pushed, way (k, 2): at the end of the step, what impulses add in a small step, the way so far.
    small = h / parts
    scale = 1.0 / parts
    _begin(contacts, chosen, first, second, weight, pushed, scale)
    for part in range(parts):
        # The impulses of the last small step start this one; `pushed` holds the velocities without them meanwhile.
        for k in range(weight.shape[0]):
            for axis in range(2):
                free = velocity[k, axis] + gain[k, axis] * scale
                velocity[k, axis] = free + pushed[k, axis]
                pushed[k, axis] = free
        passed = small * part
        _sweep(contacts, chosen, first, second, mass, drift, weight, velocity, way, small, passed, True)
        for k in range(weight.shape[0]):
            way[k, 0] += small * velocity[k, 0]
            way[k, 1] += small * velocity[k, 1]
        passed += small
        _sweep(contacts, chosen, first, second, mass, drift, weight, velocity, way, small, passed, False)
        for k in range(weight.shape[0]):
            pushed[k, 0] = velocity[k, 0] - pushed[k, 0]
            pushed[k, 1] = velocity[k, 1] - pushed[k, 1]
    for i in range(chosen.shape[0]):
        contacts.impulse[chosen[i], 0] *= parts
        contacts.impulse[chosen[i], 1] *= parts


def settle_loose(world: World, contacts: Contacts, chosen: Slots, start: Floats, h: float, ahead: Floats) -> None:
    """Solve the chosen contacts, of loose particles, over a step of h [s].

    start [m/s] (n, 2): the velocities before anything acted in this step. ahead [m] (n, 2): to be filled in, how much
    further than h v' each particle has gone.
    """
    count, room = len(chosen), min(2 * len(chosen), world.particle_count)
    particle, local = np.zeros(room, np.int64), np.full(world.particle_count, -1)
    first, second = np.zeros((2, count), np.int64)
    mass, drift, velocity = np.zeros(count), np.zeros((count, 2)), np.zeros((room, 2))
    size = _gather(
        contacts, chosen, world.inverse_mass, start, local, particle, first, second, mass, drift, velocity
    )  # fmt: skip
    particle, velocity = particle[:size], velocity[:size]
    weight, gain = world.inverse_mass[particle], world.velocity[particle] - start[particle]
    pushed, way = np.zeros((2, size, 2))
    _settle(
        contacts, chosen, first, second, mass, drift, weight, gain, velocity, pushed, way, h, parts_of(h)
    )  # fmt: skip
    free = weight > 0.0
    world.velocity[particle[free]] = velocity[free]
    ahead[particle[free]] = way[free] - h * velocity[free]
