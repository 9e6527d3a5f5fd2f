"""Restitution: the velocity with which what meets fast enough leaves again."""

import math

from sandbox.physics.arrays import Flags, FloatRows
from sandbox.physics.collision.types import Contacts, weight_of
from sandbox.physics.jit import inner_kernel

# Bodies that meet more slowly [m/s] do not bounce. Lower makes what rests tremble, higher cuts off a last bounce.
SLOWEST_BOUNCE = 0.5
# What a bounce pushes passes it on to what it approaches faster than this [m/s].
# Less costs passes, more leaves balls of a row with a part of the impulse.
SLOWEST_PASSED = 0.05


@inner_kernel
def find_bounces(
    contacts: Contacts, count: int, start: FloatRows, velocity: FloatRows, attached: Flags, h: float, small: float
) -> None:
    """The bounce [m/s] of every contact, from the velocities before and after gravity and all else from outside.

    attached (n,): particles that a spring or a constraint holds; they fall in steps of h [s], others in those of
    `small`.
    """
    for c in range(count):
        contacts.bounce[c] = -1.0
        if contacts.restitution[c] == 0.0:
            continue
        nx = contacts.normal[c, 0]
        ny = contacts.normal[c, 1]
        u0 = 0.0
        u = 0.0
        for end in range(3):
            p, weight = weight_of(contacts, c, end)
            if p >= 0:
                u0 += weight * (start[p, 0] * nx + start[p, 1] * ny)
                u += weight * (velocity[p, 0] * nx + velocity[p, 1] * ny)
        gap = contacts.gap[c]
        if u < -SLOWEST_BOUNCE and gap + h * u < 0.0:
            p = contacts.particle[c]
            q = contacts.end_a[c]
            fallen = h if attached[p] and (q < 0 or attached[q]) else small
            contacts.bounce[c] = bounce_of(contacts.restitution[c], -u0, (u0 - u) / h, gap, fallen, h)


@inner_kernel
def bounce_of(restitution: float, speed: float, fall: float, gap: float, fallen: float, h: float) -> float:
    """Velocity [m/s] after a step of h [s] in which what approaches at `speed` and falls at `fall` [m/s^2] bounces."""
    # It bounces off at the height of the surface, not where the step begins, and then is at gap + h v: symplectic Euler
    # in steps of `fallen` keeps v^2/2 + g x - g fallen v/2 in free fall, and restitution^2 is left.
    energy = 0.5 * speed * speed + fall * gap + 0.5 * fall * fallen * speed
    late = h - 0.5 * fallen
    left = 2.0 * (restitution * restitution * energy - fall * gap) + fall * fall * late * late
    return max(0.0, math.sqrt(max(0.0, left)) - fall * late)
