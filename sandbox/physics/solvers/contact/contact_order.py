"""The order of the contacts that a solver gets: island by island, so that each can be solved as if it were alone."""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.topology.sorting import list_by_key


class ContactOrder(NamedTuple):
    """Contacts of island i: first[i] to first[i + 1]; islands (1,): how many there are.

    By contact, scratch: island, order.
    """

    first: Annotated[Slots, "groups + 1"]
    islands: Annotated[Slots, "1"]
    island: Annotated[Slots, "contacts"]
    order: Annotated[Slots, "contacts"]


@inner_kernel
def put_in_order(source: Slots, order: ContactOrder, islands: int) -> None:
    """Put contacts into the order of their islands, so many; those of one island stay in theirs.

    source: which contacts; order.island has the island of each.
    """
    count = source.shape[0]
    list_by_key(order.island, count, islands, order.first, order.order)
    for k in range(count):
        order.island[k] = source[order.order[k]]
    for k in range(count):
        source[k] = order.island[k]
    order.islands[0] = islands


@inner_kernel
def order_by_label(source: Slots, contact_label: Slots, order: ContactOrder, number: Slots) -> None:
    """Put contacts into the order of the islands that they make alone.

    source: which contacts; contact_label: a particle that stands for the island of each. number (n,): scratch.
    """
    for p in range(number.shape[0]):
        number[p] = -1
    islands = 0
    for k in range(source.shape[0]):
        label = contact_label[source[k]]
        if number[label] < 0:
            number[label] = islands
            islands += 1
        order.island[k] = number[label]
    put_in_order(source, order, islands)
