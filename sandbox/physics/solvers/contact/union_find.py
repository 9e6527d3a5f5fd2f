"""Union-find: labels of nodes that hang together, the lowest of each set; with path halving (Tarjan 1975)."""

from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import Slots


@inner_kernel
def root_of(label: Slots, node: int) -> int:
    """The label of the set that a node is in."""
    while label[node] != node:
        label[node] = label[label[node]]
        node = label[node]
    return node


@inner_kernel
def united(label: Slots, first: int, node: int) -> int:
    """The label of two sets, by their labels, once they are one; first below 0: there was none before."""
    if first < 0:
        return node
    if node < first:
        label[first] = node
        return node
    label[node] = first
    return first
