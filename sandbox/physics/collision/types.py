"""Types of collision: the arrays in which kernels find contacts, and the contacts that they find."""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, Int32s, SlotRows, Slots
from sandbox.physics.jit import inner_kernel

# Edges near one particle, at most; further ones are not looked at.
MOST_NEAR = 64
# Ends of a contact: TOUCHING ones, its particle and what that touches, and their partners.
TOUCHING = 3
ENDS = 5


class Colliders(NamedTuple):
    """Everything that can collide: particles, then vertices of terrain; edges between those, then edges of terrain."""

    position: Annotated[FloatRows, "vertices, 2"]  # [m], by vertex, as all down to rolling
    velocity: Annotated[FloatRows, "vertices, 2"]  # [m/s]
    origin: Annotated[FloatRows, "vertices, 2"]  # [m]: where it was created
    radius: Annotated[Floats, "vertices"]  # [m]
    friction: Annotated[Floats, "vertices"]
    restitution: Annotated[Floats, "vertices"]
    owner: Slots
    group: Annotated[Slots, "vertices"]
    collides: Annotated[Slots, "vertices"]
    inverse_mass: Annotated[Floats, "vertices"]  # [1/kg]
    turning: Annotated[Floats, "vertices"]  # [1/kg]: the weight of its surface (surfaces.py), 0: it does not turn
    rolling: Annotated[Floats, "vertices"]
    edge_a: Slots  # by edge, as the three below
    edge_b: Slots
    side: Slots  # 1: solid on the left, 0: two sides
    number: Slots  # its spring, or edge of terrain
    edge_start: Slots
    edge_of: Slots  # edges of vertex v: edge_of[edge_start[v]:edge_start[v + 1]]
    near_start: Slots
    near_of: Slots  # particles that a spring joins to p: likewise
    shielded: Flags  # (n,): see Outline
    inverted: Annotated[Flags, "vertices"]  # by vertex: its body is inverted or wound, and so does not touch itself
    shape: Slots  # by vertex: see Outline
    parting: Annotated[Flags, "vertices"]  # by vertex: its shape and another, one of them solid, part here
    caught: Annotated[Flags, "vertices"]  # the same of two lines, or of one with itself
    parted: Annotated[SlotRows, "pairs, 3"]  # pairs of shapes that part, the lower first, and 1 where both are lines
    parted_count: Annotated[Slots, "1"]  # (1,)


class Near(NamedTuple):
    """Edges near one particle: which, place along it, distance and signed distance [m], region (-1, 1: at an end)."""

    edge: Annotated[Slots, f"{MOST_NEAR}"]
    share: Annotated[Floats, f"{MOST_NEAR}"]
    distance: Annotated[Floats, f"{MOST_NEAR}"]
    signed: Annotated[Floats, f"{MOST_NEAR}"]
    region: Annotated[Slots, f"{MOST_NEAR}"]


class Contacts(NamedTuple):
    """Contacts of a step: found in ascending order of the particle that touches, then sorted by who solves them.

    An impulse across acts at the surface of what does not roll as well, and turns it by a couple with its partner: see
    surfaces.py.
    """

    particle: Annotated[Slots, "rows"]
    feature: Annotated[Slots, "rows"]  # 3 number + kind
    end_a: Annotated[Slots, "rows"]  # end_a, end_b: the other disc and -1, or the ends of an edge; -1, -1: terrain;
    end_b: Annotated[Slots, "rows"]  # -1, b: particle and b are the ends of an edge that lies on a corner of terrain
    share: Annotated[Floats, "rows"]  # place along the edge
    normal: Annotated[FloatRows, "rows, 2"]  # towards the particle
    gap: Annotated[Floats, "rows"]  # [m], below 0: penetration
    friction: Annotated[Floats, "rows"]
    restitution: Annotated[Floats, "rows"]
    bounce: Annotated[Floats, "rows"]  # [m/s]: velocity along the normal where it bounces, below 0: it does not
    impulse: Annotated[FloatRows, "rows, 2"]  # [N s] (k, 2): along normal and tangent
    turning: Annotated[FloatRows, "rows, 2"]  # [1/kg] (k, 2): of the particle and of the other disc, as arm and ratio
    arm: Annotated[FloatRows, "rows, 2"]  # that of friction over the radius
    ratio: Annotated[FloatRows, "rows, 2"]  # the smaller radius over its own
    rolling: Annotated[Floats, "rows"]  # rolling resistance of both
    partner: Annotated[SlotRows, "rows, 2"]  # (k, 2): which particles the couple is taken from, -1: none
    couple: Annotated[FloatRows, "rows, 4"]  # (k, 4): of the particle and of end_a, by a unit impulse
    impact: Annotated[Floats, "rows"]  # [N s]: what impacts of this tick gave; not in impulse, starts no sweep
    belt: Annotated[Floats, "rows"]  # [m/s]: of both surfaces together, each to the right of who stands on it
    ahead: Annotated[Flags, "rows"]  # with an edge that a disc comes to from others, on which it lies


class KeptContacts(NamedTuple):
    """The part of a step's contacts that the next step reads: see Contacts."""

    particle: Annotated[Int32s, "contacts"]
    feature: Annotated[Slots, "contacts"]
    impulse: Annotated[FloatRows, "contacts, 2"]
    impact: Annotated[Floats, "contacts"]


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
    """Couple (x, y) that a tangential impulse of 1 gives an end of a contact, beside its share along the tangent."""
    if end < TOUCHING - 1:
        return contacts.couple[c, 2 * end], contacts.couple[c, 2 * end + 1]
    x, y = 0.0, 0.0
    for of in range(2):
        is_end_b = contacts.partner[c, of] == contacts.end_b[c]
        if is_end_b if end == TOUCHING - 1 else of == end - TOUCHING and not is_end_b:
            x -= contacts.couple[c, 2 * of]
            y -= contacts.couple[c, 2 * of + 1]
    return x, y


@inner_kernel
def contacts_between(contacts: Contacts, first: int, last: int) -> Contacts:
    """The contacts first..last, in the same arrays."""
    b = contacts
    return Contacts(
        b.particle[first:last], b.feature[first:last], b.end_a[first:last], b.end_b[first:last], b.share[first:last],
        b.normal[first:last], b.gap[first:last], b.friction[first:last], b.restitution[first:last],
        b.bounce[first:last], b.impulse[first:last], b.turning[first:last], b.arm[first:last], b.ratio[first:last],
        b.rolling[first:last], b.partner[first:last], b.couple[first:last], b.impact[first:last], b.belt[first:last],
        b.ahead[first:last],
    )  # fmt: skip


@inner_kernel
def _move(contacts: Contacts, c: int, to: int) -> None:
    # What is known of a contact before its step is prepared.
    contacts.particle[to] = contacts.particle[c]
    contacts.feature[to] = contacts.feature[c]
    contacts.end_a[to] = contacts.end_a[c]
    contacts.end_b[to] = contacts.end_b[c]
    contacts.share[to] = contacts.share[c]
    contacts.gap[to] = contacts.gap[c]
    contacts.friction[to] = contacts.friction[c]
    contacts.restitution[to] = contacts.restitution[c]
    contacts.rolling[to] = contacts.rolling[c]
    contacts.impact[to] = contacts.impact[c]
    contacts.ahead[to] = contacts.ahead[c]
    for axis in range(2):
        contacts.normal[to, axis] = contacts.normal[c, axis]
        contacts.partner[to, axis] = contacts.partner[c, axis]
        contacts.impulse[to, axis] = contacts.impulse[c, axis]


@inner_kernel
def sort_contacts(contacts: Contacts, source: Slots, place: Slots) -> None:
    """Sort the first contacts: the k-th is then the one that was found as source[k], and place says where each is.

    source is scratch then. The last row of contacts is none, but scratch as well.
    """
    for k in range(source.shape[0]):
        place[source[k]] = k
    spare = contacts.particle.shape[0] - 1
    for k in range(source.shape[0]):
        if source[k] == k:
            continue
        # Round the circle of those that take each other's place.
        _move(contacts, k, spare)
        to = k
        while source[to] != k:
            c = source[to]
            _move(contacts, c, to)
            source[to] = to
            to = c
        _move(contacts, spare, to)
        source[to] = to


@inner_kernel
def new_contacts(arena: Arena, most: int) -> Contacts:
    """Lay out contacts for a step to fill in, and a row to sort them by."""
    return new_tuple(Contacts, arena, rows=most + 1)
