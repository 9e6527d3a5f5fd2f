"""Types of collision: the arrays in which kernels find contacts, and the contacts that they find."""

from typing import NamedTuple

from sandbox.physics.arena import Arena, new_flags, new_float_rows, new_floats, new_int32s, new_slot_rows, new_slots
from sandbox.physics.arrays import Flags, FloatRows, Floats, Int32s, SlotRows, Slots
from sandbox.physics.jit import inner_kernel

# Edges near one particle, at most; further ones are not looked at.
MOST_NEAR = 64
# Ends of a contact: TOUCHING ones, its particle and what that touches, and their partners.
TOUCHING = 3
ENDS = 5


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

    position: FloatRows
    velocity: FloatRows
    origin: FloatRows
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
    parted: SlotRows
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
    smaller radius over its own; and their rolling resistance. An impulse across acts at the surface of what does not
    roll as well, and turns it by a couple: couple (k, 4), of the particle and of end_a, times the impulse is added to
    these and taken from their partner (k, 2), -1: none; see rims.py.

    ahead: it is with an edge of a hollow that a disc comes to from others, on which it lies (seams.py).
    """

    particle: Slots
    feature: Slots
    end_a: Slots
    end_b: Slots
    share: Floats
    normal: FloatRows
    gap: Floats
    friction: Floats
    restitution: Floats
    bounce: Floats
    impulse: FloatRows
    turning: FloatRows
    arm: FloatRows
    ratio: FloatRows
    rolling: Floats
    partner: SlotRows
    couple: FloatRows
    impact: Floats
    ahead: Flags


class KeptContacts(NamedTuple):
    """The part of a step's contacts that the next step reads: see Contacts."""

    particle: Int32s
    feature: Slots
    impulse: FloatRows
    impact: Floats


@inner_kernel
def weight_of(contacts: Contacts, c: int, end: int) -> tuple[int, float]:
    """Particle of an end of a contact (-1: none) and the share of the impulse that it takes, with its sign.

    Partners take none; one that is end_b as well is left out.
    """
    if end >= TOUCHING:
        q = contacts.partner[c, end - TOUCHING]
        return -1 if q == contacts.end_b[c] else q, 0.0
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


@inner_kernel
def couple_of(contacts: Contacts, c: int, end: int) -> tuple[float, float]:
    """What an impulse of 1 across adds to that of an end of a contact, beside its share along the tangent."""
    if end < TOUCHING - 1:
        return contacts.couple[c, 2 * end], contacts.couple[c, 2 * end + 1]
    x = 0.0
    y = 0.0
    for of in range(2):
        is_end_b = contacts.partner[c, of] == contacts.end_b[c]
        if is_end_b if end == TOUCHING - 1 else of == end - TOUCHING and not is_end_b:
            x -= contacts.couple[c, 2 * of]
            y -= contacts.couple[c, 2 * of + 1]
    return x, y


@inner_kernel
def contacts_between(contacts: Contacts, first: int, last: int) -> Contacts:
    """Some of the contacts."""
    b = contacts
    return Contacts(
        b.particle[first:last], b.feature[first:last], b.end_a[first:last], b.end_b[first:last], b.share[first:last],
        b.normal[first:last], b.gap[first:last], b.friction[first:last], b.restitution[first:last],
        b.bounce[first:last], b.impulse[first:last], b.turning[first:last], b.arm[first:last], b.ratio[first:last],
        b.rolling[first:last], b.partner[first:last], b.couple[first:last], b.impact[first:last], b.ahead[first:last],
    )  # fmt: skip


@inner_kernel
def new_contacts(arena: Arena, count: int) -> Contacts:
    """Contacts to be filled in."""
    return Contacts(
        new_slots(arena, count), new_slots(arena, count), new_slots(arena, count), new_slots(arena, count),
        new_floats(arena, count), new_float_rows(arena, count, 2), new_floats(arena, count), new_floats(arena, count),
        new_floats(arena, count), new_floats(arena, count), new_float_rows(arena, count, 2),
        new_float_rows(arena, count, 2), new_float_rows(arena, count, 2), new_float_rows(arena, count, 2),
        new_floats(arena, count), new_slot_rows(arena, count, 2), new_float_rows(arena, count, 4),
        new_floats(arena, count), new_flags(arena, count),
    )  # fmt: skip


@inner_kernel
def new_kept_contacts(arena: Arena, count: int) -> KeptContacts:
    """Empty kept contacts, to be filled in."""
    return KeptContacts(
        new_int32s(arena, count), new_slots(arena, count), new_float_rows(arena, count, 2), new_floats(arena, count)
    )


@inner_kernel
def new_near(arena: Arena) -> Near:
    """Edges near a particle, to be filled in."""
    return Near(
        new_slots(arena, MOST_NEAR), new_floats(arena, MOST_NEAR), new_floats(arena, MOST_NEAR),
        new_floats(arena, MOST_NEAR), new_slots(arena, MOST_NEAR),
    )  # fmt: skip
