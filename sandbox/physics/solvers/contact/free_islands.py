"""Islands of contacts: contacts that movable particles connect.

The contacts of an island with a particle that a spring or a constraint holds are coupled: the solver solves them with
springs. Contacts of other islands are free.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.collision.types import ENDS, Contacts, weight_of
from sandbox.physics.components import root_of, united
from sandbox.physics.jit import inner_kernel
from sandbox.physics.topology.sorting import list_by_key


class Islands(NamedTuple):
    """Islands of a step's contacts, filled in by each step; there is room for more contacts."""

    label: Annotated[Slots, "particles"]  # the first particle of its island
    is_coupled: Annotated[Flags, "particles"]  # by label
    contact_label: Annotated[Slots, "contacts"]  # by contact, as found
    first: Annotated[Slots, "contacts + 1"]  # free contacts of the g-th island: first[g]:first[g + 1], as sorted
    at: Annotated[Slots, "particles + 2"]  # scratch


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
                break
        if islands.is_coupled[islands.contact_label[c]]:
            coupled += 1
    return coupled


@inner_kernel
def list_contacts(islands: Islands, key: Slots, source: Slots) -> int:
    """List contacts: coupled ones first, then the free ones by island, each as found; how many islands those make.

    key: scratch, as long as source.
    """
    at, count = islands.at, source.shape[0]
    for c in range(count):
        label = islands.contact_label[c]
        key[c] = 0 if islands.is_coupled[label] else 1 + label
    list_by_key(key, count, at.shape[0] - 1, at, source)
    found = 0
    for k in range(1, at.shape[0] - 1):
        if at[k + 1] > at[k]:
            islands.first[found] = at[k]
            found += 1
    islands.first[found] = count
    return found
