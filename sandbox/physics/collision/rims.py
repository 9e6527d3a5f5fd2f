"""Rims: where friction acts on particles of bodies, and the couples by which it turns them.

A particle of a body has no spin of its own: it turns with a spring that holds it. So an impulse J across a contact,
which acts at its surface, so far [m], the arm, from the particle, gives it and its partner at the other end of that
spring a couple as well: J arm/|d| across the spring. Slip is measured at the surface by the same couple, so W stays
symmetric, and a body's angular momentum changes by what friction does at its rim.
"""

import math

from sandbox.physics.arrays import Flags, FloatRows
from sandbox.physics.collision.types import TOUCHING, Colliders, Contacts, weight_of
from sandbox.physics.geometry.segment import difference
from sandbox.physics.jit import inner_kernel

# A partner that is touched itself is taken if it is as far off as this share of the farthest. On a short spring of soft
# or light particles a couple bends the body where it touches; a wheel's turns with its spokes instead.
FAR_ENOUGH = 0.5
# A spring shorter than so many arms, on which two discs overlap, takes a part of the couple: what is crushed would be
# thrown about.
SHORT = 2.0


@inner_kernel
def choose_partners(contacts: Contacts, count: int, attached: Flags, colliders: Colliders, touched: Flags) -> None:
    """Choose the partners of the first `count` contacts; see Contacts.

    attached (n,): what springs hold; touched (n,): scratch.
    """
    for p in range(touched.shape[0]):
        touched[p] = False
    for c in range(count):
        for end in range(TOUCHING):
            p, _ = weight_of(contacts, c, end)
            if p >= 0:
                touched[p] = True
    for c in range(count):
        contacts.partner[c, 0] = -1
        contacts.partner[c, 1] = -1
        if not contacts.friction[c] > 0.0:
            continue
        p = contacts.particle[c]
        a = contacts.end_a[c]
        # The ends of an edge turn with each other.
        of_particle = contacts.end_b[c] if a < 0 else -1
        contacts.partner[c, 0] = _partner_of(p, of_particle, attached, colliders, touched)
        if a >= 0:
            contacts.partner[c, 1] = _partner_of(a, contacts.end_b[c], attached, colliders, touched)


@inner_kernel
def _partner_of(p: int, end_b: int, attached: Flags, colliders: Colliders, touched: Flags) -> int:
    # Who turns with a particle: the other end of its edge, unless that is short, else the farthest that a spring joins
    # to it, or one that is near to as far and touched itself, so that nothing more answers to contacts. -1: none. What
    # is far is so where particles were made: in what is crushed it would be another in every step.
    radius = colliders.radius[p]
    if not radius > 0.0:
        return -1
    if end_b >= 0 and _distance(p, end_b, colliders.origin) > SHORT * radius:
        return end_b
    if not attached[p] or not colliders.inverse_mass[p] > 0.0:
        return -1
    first, last = colliders.near_start[p], colliders.near_start[p + 1]
    farthest = 0.0
    for at in range(first, last):
        farthest = max(farthest, _distance(p, colliders.near_of[at], colliders.origin))
    partner = -1
    longest = 0.0
    for at in range(first, last):
        q = colliders.near_of[at]
        distance = _distance(p, q, colliders.origin)
        is_far = distance > max(FAR_ENOUGH * farthest, SHORT * radius)
        preferred = distance + farthest if touched[q] and is_far else distance
        if preferred > longest:
            partner = q
            longest = preferred
    return partner


@inner_kernel
def load_couple(contacts: Contacts, c: int, of: int, p: int, arm: float, colliders: Colliders) -> None:
    """The couple of a contact's particle (of 0) or its end_a (of 1), which is p, for an arm [m]."""
    contacts.couple[c, 2 * of] = 0.0
    contacts.couple[c, 2 * of + 1] = 0.0
    q = contacts.partner[c, of]
    if q >= 0:
        dx, dy = difference(p, q, colliders.position)
        squared = max(dx * dx + dy * dy, SHORT * SHORT * arm * arm)
        if squared > 0.0:
            contacts.couple[c, 2 * of] = -arm * dy / squared  # (36)
            contacts.couple[c, 2 * of + 1] = arm * dx / squared


@inner_kernel
def _distance(p: int, q: int, position: FloatRows) -> float:
    dx, dy = difference(p, q, position)
    return math.sqrt(dx * dx + dy * dy)
