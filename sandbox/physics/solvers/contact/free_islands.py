"""Islands of contacts: contacts that movable particles connect.

The contacts of an island with a particle that a spring or a constraint holds are coupled: the solver solves them with
springs. Contacts of other islands are free.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.collision.types import ENDS, Contacts, weight_of
from sandbox.physics.components import root_of, united
from sandbox.physics.jit import inner_kernel


class Islands(NamedTuple):
    """Islands of a step's contacts, filled in by each step; there is room for more contacts.

    Of particles: label (n,) = the first of its island; is_coupled (n,), by label. Of contacts (k,): contact_label,
    coupled. Free contacts, island by island: contact (k,), those of the g-th at first[g]:first[g + 1]. at (n + 1,):
    scratch.
    """

    label: Annotated[Slots, "particles"]
    is_coupled: Annotated[Flags, "particles"]
    contact_label: Annotated[Slots, "contacts"]
    coupled: Annotated[Flags, "contacts"]
    contact: Annotated[Slots, "contacts"]
    first: Annotated[Slots, "contacts + 1"]
    at: Annotated[Slots, "particles + 1"]


@inner_kernel
def _join(contacts: Contacts, count: int, inverse_mass: Floats, label: Slots) -> None:
    # Label the particles that touch each other alike; what cannot move joins nothing.
    for p in range(label.shape[0]):
        label[p] = p
    for c in range(count):
        first = -1
        for end in range(ENDS):
            p, _ = weight_of(contacts, c, end)
            if p < 0 or inverse_mass[p] == 0.0:
                continue
            node = root_of(label, p)
            first = united(label, first, node)
    for p in range(label.shape[0]):
        label[p] = root_of(label, p)


@inner_kernel
def find_islands(contacts: Contacts, count: int, inverse_mass: Floats, attached: Flags, islands: Islands) -> int:
    """Find the islands of the first `count` contacts; return how many contacts are coupled.

    attached (n,): particles that a spring or a constraint holds.
    """
    label = islands.label
    _join(contacts, count, inverse_mass, label)
    for p in range(label.shape[0]):
        islands.is_coupled[p] = False
    for p in range(label.shape[0]):
        if attached[p] and inverse_mass[p] > 0.0:
            islands.is_coupled[label[p]] = True
    coupled = 0
    for c in range(count):
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0 and inverse_mass[p] > 0.0:
                # All that move have the same.
                islands.contact_label[c] = label[p]
                islands.coupled[c] = islands.is_coupled[label[p]]
                break
        if islands.coupled[c]:
            coupled += 1
    return coupled


@inner_kernel
def sort_free_contacts(count: int, islands: Islands) -> int:
    """Sort the free ones of the first `count` contacts by island, each in their order; how many islands they make."""
    at = islands.at
    for p in range(at.shape[0]):
        at[p] = 0
    for c in range(count):
        if not islands.coupled[c]:
            at[islands.contact_label[c] + 1] += 1
    found = 0
    total = 0
    for p in range(at.shape[0] - 1):
        more = at[p + 1]
        if more > 0:
            islands.first[found] = total
            found += 1
        total += more
        at[p + 1] = total
    islands.first[found] = total
    for c in range(count):
        if not islands.coupled[c]:
            label = islands.contact_label[c]
            islands.contact[at[label]] = c
            at[label] += 1
    return found
