"""How discs turn: the moment of inertia m r^2 / 2 of a disc, written for the speed of its surface, spin times radius.

An impulse J across a contact, which acts at the surface, changes the speed of the surface by J r^2 / I = 2 J / m: the
weight of a surface is twice that of its particle, whatever its radius. Who turns is loose: no spring, constraint or pin
holds it.
"""

import math

from sandbox.physics.collision.narrow_phase import FAST, MARGIN
from sandbox.physics.collision.rims import load_couple
from sandbox.physics.collision.types import Colliders, Contacts
from sandbox.physics.jit import inlined_kernel, inner_kernel

# r^2 / I of a disc, times its mass.
SURFACE_WEIGHT = 2.0


@inlined_kernel
def rolling_ratios(p: int, q: int, colliders: Colliders) -> tuple[float, float]:
    """The smaller radius of two discs, at which rolling resistance acts, over that of each; q -1: there is one disc."""
    if q < 0:
        return 1.0, 0.0
    own = colliders.radius[p]
    other = colliders.radius[q]
    smaller = min(own, other)
    return smaller / own if own > 0.0 else 0.0, smaller / other if other > 0.0 else 0.0


@inlined_kernel
def spin_of(surface: float, spin: float, radius: float) -> float:
    """The spin [rad/s] of a disc of that surface, which was `spin` before: the same bits where it has not changed."""
    return spin if surface == spin * radius else surface / radius


@inner_kernel
def load_arms(contacts: Contacts, count: int, colliders: Colliders) -> None:
    """How the particles of the first `count` contacts turn; see Contacts."""
    for c in range(count):
        p = contacts.particle[c]
        a = contacts.end_a[c]
        b = contacts.end_b[c]
        disc = a if b < 0 else -1
        contacts.turning[c, 0] = colliders.turning[p]
        contacts.turning[c, 1] = colliders.turning[a] if disc >= 0 else 0.0
        contacts.arm[c, 0] = 1.0
        contacts.arm[c, 1] = 0.0
        contacts.ratio[c, 0], contacts.ratio[c, 1] = rolling_ratios(p, disc, colliders)
        arm = 1.0
        if a >= 0:
            # So all that is turned is turned by both; but what is followed along its way is not there yet.
            reach = colliders.radius[p] + colliders.radius[a]
            if reach > 0.0:
                arm = min(1.0 + MARGIN + FAST, _distance(contacts, c, colliders) / reach)
            contacts.arm[c, 0] = arm
            contacts.arm[c, 1] = arm if disc >= 0 else 0.0
        load_couple(contacts, c, 0, p, arm * colliders.radius[p], colliders)
        load_couple(contacts, c, 1, a, arm * colliders.radius[a] if a >= 0 else 0.0, colliders)


@inner_kernel
def _distance(contacts: Contacts, c: int, colliders: Colliders) -> float:
    # From the particle of a contact to the middle of what it touches.
    p = contacts.particle[c]
    a = contacts.end_a[c]
    b = contacts.end_b[c] if contacts.end_b[c] >= 0 else a
    share = contacts.share[c]
    dx = colliders.position[p, 0] - (1.0 - share) * colliders.position[a, 0] - share * colliders.position[b, 0]
    dy = colliders.position[p, 1] - (1.0 - share) * colliders.position[a, 1] - share * colliders.position[b, 1]
    return math.sqrt(dx * dx + dy * dy)
