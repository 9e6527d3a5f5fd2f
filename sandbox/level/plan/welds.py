"""Welds, the rigid joints: which particles become one."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Slots = NDArray[np.int64]


def united(count: int, pairs: Iterable[tuple[int, int]]) -> Slots:
    """The first particle (count,) of the union that each particle belongs to; itself without a weld.

    pairs: slots before welds, all below count. A chain of welds is one union.
    """
    parents: dict[int, int] = {}

    def root(slot: int) -> int:
        while (parent := parents.get(slot, slot)) != slot:
            parents[slot] = slot = parents.get(parent, parent)
        return slot

    for a, b in pairs:
        first, second = sorted((root(a), root(b)))
        parents[second] = first
    firsts = np.arange(count, dtype=np.int64)
    for slot in parents:
        firsts[slot] = root(slot)
    return firsts
