"""Steps within which a contact begins: until then the load stands where it stood before.

A step knows one velocity, so a corner that comes down in it bears the load from its start, half a step too early in the
mean: what rolls on corners is braked by g h / 4 a radian. So the step is divided where the first contact begins, at a
share t of it. Contacts that were there give t of the impulse with which they alone would end the step, and what is left
of the step is solved on top of that, with all contacts: no contact takes back what it gave before.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.types import Contacts
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.gauss_seidel import (
    ContactConstraints,
    Delassus,
    approach_of,
    push_contact,
)

# Velocities stand so many steps behind places: what carries at a time of the drift carries so much more of the kick.
BEHIND = 0.5
# How far ahead, in steps, contacts are asked about that come nearer before forces and turning have their say.
SOON = 2.0


@inner_kernel
def is_landing(
    contacts: Contacts, terms: ContactConstraints, start: FloatRows, delta_v: FloatRows, h: float
) -> bool:  # fmt: skip
    """Whether contacts begin within a step of h [s], which are then left out, where others carry; and none bounces.

    start (n, 2): velocities before forces [m/s], by which what is at rest does not begin; delta_v: zeros.
    """
    lands, carries = False, False
    for c in range(contacts.particle.shape[0]):
        if contacts.bounce[c] >= 0.0:
            return False
        if not terms.normal[c] > 0.0:
            continue
        carries = carries or contacts.impulse[c, 0] > 0.0
        if _is_new(contacts, c) and contacts.gap[c] + SOON * h * approach_of(contacts, c, start, delta_v) < 0.0:
            lands = True
    if not (lands and carries):
        return False
    for c in range(contacts.particle.shape[0]):
        if _is_new(contacts, c):
            terms.bias[c] = math.inf
    return True


@inner_kernel
def _is_new(contacts: Contacts, c: int) -> bool:
    return contacts.gap[c] > 0.0 and contacts.impulse[c, 0] == 0.0


@inner_kernel
def divide_step(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, h: float
) -> None:  # fmt: skip
    """Find where the first contact that was left out begins, and what those that were there give until then."""
    share = 1.0
    for c in range(contacts.particle.shape[0]):
        if terms.bias[c] == math.inf:
            terms.bias[c] = contacts.gap[c] / h
            u = approach_of(contacts, c, velocity, delta_v)
            if terms.normal[c] > 0.0 and u + terms.bias[c] < 0.0:
                share = min(share, -terms.bias[c] / u)
    share = min(1.0, share + BEHIND) if share < 1.0 else 0.0
    for c in range(contacts.particle.shape[0]):
        for axis in range(2):
            terms.given[c, axis] = share * contacts.impulse[c, axis]


@inner_kernel
def give(
    contacts: Contacts, terms: ContactConstraints, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus
) -> None:  # fmt: skip
    """Push by what contacts give before the first one begins; their impulses are what they give after that."""
    for c in range(contacts.particle.shape[0]):
        jn, jt = terms.given[c, 0], terms.given[c, 1]
        if jn != 0.0 or jt != 0.0:
            contacts.impulse[c, 0] -= jn
            contacts.impulse[c, 1] -= jt
            push_contact(contacts, c, jn, jt, terms.surface, delta_v, inverse_mass, delassus)


@inner_kernel
def add_given(contacts: Contacts, terms: ContactConstraints) -> None:
    """Bring impulses to those of the whole step."""
    for c in range(contacts.particle.shape[0]):
        contacts.impulse[c, 0] += terms.given[c, 0]
        contacts.impulse[c, 1] += terms.given[c, 1]
