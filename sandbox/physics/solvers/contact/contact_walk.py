"""The contacts of an island in the order of a walk from one end of it to the other: rows of their matrix are short."""

from sandbox.physics.arrays import Floats
from sandbox.physics.collision.types import ENDS, Contacts, weight_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.active_set import ActiveSet
from sandbox.physics.solvers.contact.gauss_seidel import Delassus


@inner_kernel
def node_at(contacts: Contacts, c: int, end: int, inverse_mass: Floats, delassus: Delassus) -> int:
    """The node of an end of a contact; -1: none, it cannot move, or an earlier end has it."""
    p, _ = weight_of(contacts, c, end)
    node = _node_of(p, inverse_mass, delassus)
    for earlier in range(end):
        q, _ = weight_of(contacts, c, earlier)
        if node >= 0 and _node_of(q, inverse_mass, delassus) == node:
            node = -1
    return node


@inner_kernel
def _node_of(p: int, inverse_mass: Floats, delassus: Delassus) -> int:
    if p < 0 or not inverse_mass[p] > 0.0:
        return -1
    k = delassus.block[p]
    return k if k >= 0 else delassus.start.shape[0] - 1 + p


@inner_kernel
def _list_contacts(contacts: Contacts, at: ActiveSet, inverse_mass: Floats, delassus: Delassus) -> None:
    # The slow contacts of each node, in their order.
    count = contacts.particle.shape[0]
    for c in range(count):
        for end in range(ENDS):
            node = node_at(contacts, c, end, inverse_mass, delassus)
            if node >= 0:
                at.head[node] = at.rank[node] = -1
    for c in range(count - 1, -1, -1):
        if not at.slow[c]:
            continue
        for end in range(ENDS):
            node = node_at(contacts, c, end, inverse_mass, delassus)
            if node >= 0:
                at.following[ENDS * c + end] = at.head[node]
                at.head[node] = ENDS * c + end


@inner_kernel
def _walk(contacts: Contacts, at: ActiveSet, inverse_mass: Floats, delassus: Delassus, root: int, base: int) -> int:
    # Ranks of what hangs together with a node, breadth first, from `base` on; the rank after the last.
    at.queue[base] = root
    at.rank[root] = base
    end = base + 1
    begin = base
    while begin < end:
        place = at.head[at.queue[begin]]
        begin += 1
        while place >= 0:
            for side in range(ENDS):
                other = node_at(contacts, place // ENDS, side, inverse_mass, delassus)
                if other >= 0 and at.rank[other] < 0:
                    at.rank[other] = end
                    at.queue[end] = other
                    end += 1
            place = at.following[place]
    return end


@inner_kernel
def _rank_nodes(contacts: Contacts, at: ActiveSet, inverse_mass: Floats, delassus: Delassus) -> int:
    # Ranks of all nodes with slow contacts, how many: joints may be all that holds two of them together.
    base = 0
    for c in range(contacts.particle.shape[0]):
        if not at.slow[c]:
            continue
        for side in range(ENDS):
            node = node_at(contacts, c, side, inverse_mass, delassus)
            if node < 0 or at.rank[node] >= 0:
                continue
            end = _walk(contacts, at, inverse_mass, delassus, node, base)
            # From an end of it.
            for _ in range(2):
                root = at.queue[end - 1]
                for i in range(base, end):
                    at.rank[at.queue[i]] = -1
                end = _walk(contacts, at, inverse_mass, delassus, root, base)
            base = end
    return base


@inner_kernel
def order_contacts(contacts: Contacts, at: ActiveSet, inverse_mass: Floats, delassus: Delassus) -> int:
    """Order slow contacts by the later rank of what they touch; how many there are."""
    _list_contacts(contacts, at, inverse_mass, delassus)
    ranked = _rank_nodes(contacts, at, inverse_mass, delassus)
    placed = 0
    for rank in range(ranked):
        place = at.head[at.queue[rank]]
        while place >= 0:
            latest = -1
            for end in range(ENDS):
                other = node_at(contacts, place // ENDS, end, inverse_mass, delassus)
                if other >= 0:
                    latest = max(latest, at.rank[other])
            if latest == rank:
                at.order[placed] = place // ENDS
                placed += 1
            place = at.following[place]
    return placed
