"""Types of collision: the arrays in which kernels find contacts, and the contacts that they find."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import Floats, Slots

Flags = NDArray[np.bool_]

# Edges near one particle, at most; further ones are not looked at.
MOST_NEAR = 64


class Colliders(NamedTuple):
    """Everything that can collide: particles, then the vertices of terrain; edges between them, then those of terrain.

    By vertex: position [m], velocity [m/s], origin [m], radius [m], friction, restitution, owner, group, collides,
    inverse_mass [1/kg], turning [1/kg] = the weight of its surface (turning.py), 0: it does not turn, rolling. By edge:
    edge_a, edge_b, side (1: solid on the left, 0: two sides), number = its spring, or of
    terrain. Edges of vertex v: edge_of[edge_start[v]:edge_start[v + 1]]; particles that a spring joins to p: near_of
    likewise. shielded (n,): see outline.py. inverted, by vertex: whether its body is now, or wound, and so does not
    touch itself. shape, by vertex: the number of the outline of its owner, -1: none. parting, by vertex: whether it
    gives way where its shape and another part, of which one is solid at least; caught: the same of two lines, or of one
    with itself. parted (k, 3): these pairs of shapes, the lower first, and 1 where both are lines; parted_count (1,).
    """

    position: Floats
    velocity: Floats
    origin: Floats
    radius: Floats
    friction: Floats
    restitution: Floats
    owner: Slots
    group: Slots
    collides: Slots
    inverse_mass: Floats
    turning: Floats
    rolling: Floats
    edge_a: Slots
    edge_b: Slots
    side: Slots
    number: Slots
    edge_start: Slots
    edge_of: Slots
    near_start: Slots
    near_of: Slots
    shielded: Flags
    inverted: Flags
    shape: Slots
    parting: Flags
    caught: Flags
    parted: Slots
    parted_count: Slots


class Near(NamedTuple):
    """Edges near one particle: which, place along it, distance and signed distance [m], region (-1, 1: at an end)."""

    edge: Slots
    share: Floats
    distance: Floats
    signed: Floats
    region: Slots


class Contacts(NamedTuple):
    """Contacts in ascending order of particle: particle, feature = 3 number + kind, the particles it pushes against.

    end_a, end_b: the other disc and -1, or the ends of an edge; -1, -1: terrain; -1, b: the particle and b are the ends
    of an edge that lies on a corner of terrain. share: place along the edge. normal:
    towards the particle. gap [m], below 0: penetration; bounce [m/s]: the velocity along the normal that is left where
    it bounces, below 0: it does not; impulse [N s] (k, 2) along normal and tangent; impact [N s]: what impacts in this
    tick have given along the normal, which is no part of the impulse and starts no sweep.

    Of its particle and of the other disc (k, 2): turning [1/kg], arm = that of friction over the radius, ratio = the
    smaller radius over its own; and their rolling resistance. couple (k, 2): what an impulse across does to an edge as
    well, on whose surface it acts: that times the impulse is added to end_a and taken from end_b.
    """

    particle: Slots
    feature: Slots
    end_a: Slots
    end_b: Slots
    share: Floats
    normal: Floats
    gap: Floats
    friction: Floats
    restitution: Floats
    bounce: Floats
    impulse: Floats
    turning: Floats
    arm: Floats
    ratio: Floats
    rolling: Floats
    couple: Floats
    impact: Floats


class KeptContacts(NamedTuple):
    """The part of a step's contacts that the next step reads: see Contacts."""

    particle: NDArray[np.int32]
    feature: Slots
    impulse: Floats
    impact: Floats


@inner_kernel
def weight_of(contacts: Contacts, c: int, end: int) -> tuple[int, float]:
    """Particle of an end of a contact (-1: none) and the share of the impulse that it takes, with its sign."""
    a = contacts.end_a[c]
    if a < 0 and contacts.end_b[c] >= 0:
        # An edge on a corner of terrain: both ends are pushed alike.
        if end == 0:
            return contacts.particle[c], 1.0 - contacts.share[c]
        return (-1, 0.0) if end == 1 else (contacts.end_b[c], contacts.share[c])
    if end == 0:
        return contacts.particle[c], 1.0
    if end == 1:
        return a, -1.0 if contacts.end_b[c] < 0 else -(1.0 - contacts.share[c])
    return contacts.end_b[c], -contacts.share[c]


def room_for(count: int) -> Contacts:
    """Contacts to be filled in."""
    slots, numbers, pairs = np.zeros((4, count), dtype=np.int64), np.zeros((7, count)), np.zeros((6, count, 2))
    gap, friction, restitution, bounce, share, rolling, impact = numbers
    particle, feature, end_a, end_b = slots
    return Contacts(
        particle, feature, end_a, end_b, share, pairs[0], gap, friction, restitution, bounce, pairs[1], pairs[2],
        pairs[3], pairs[4], rolling, pairs[5], impact,
    )  # fmt: skip


def room_to_keep(count: int) -> KeptContacts:
    """Empty kept contacts, to be filled in."""
    return KeptContacts(np.zeros(count, np.int32), np.zeros(count, np.int64), np.zeros((count, 2)), np.zeros(count))


def room_near() -> Near:
    """Edges near a particle, to be filled in."""
    slots, numbers = np.zeros((2, MOST_NEAR), dtype=np.int64), np.zeros((3, MOST_NEAR))
    return Near(slots[0], numbers[0], numbers[1], numbers[2], slots[1])


NOTHING_KEPT = room_to_keep(0)
