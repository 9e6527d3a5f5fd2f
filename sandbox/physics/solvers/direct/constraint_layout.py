"""Elements in the pattern of the matrix: which are in it, what they join, and where their blocks lie."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.solvers.direct.constraint_terms import Shapes
from sandbox.physics.world import Slots, World

# Corners of an element that is added to the matrix; one of more is wide.
NARROW = 3


class Chosen(NamedTuple):
    """The elements of the matrix, t of them with q corners: active, and with a free corner.

    slot and kind (t,), start (t+1,) = where corners begin; corner and particle (q,): slots. links (2, k): pairs of
    particles that are joined by them.
    """

    slot: Slots
    kind: Slots
    start: Slots
    corner: Slots
    particle: Slots
    links: Slots


def chosen_elements(world: World, free: NDArray[np.bool_]) -> Chosen:
    """The elements of a world that belong into the matrix; free (n,): particles that are not pinned."""
    sizes = world.element_corners.astype(np.int64)
    owner = np.repeat(np.arange(len(sizes)), sizes)
    movable = np.zeros(len(sizes), dtype=np.bool_)
    movable[owner[free[world.corner_particle]]] = True
    slot = np.flatnonzero(world.element_active & movable)
    corner = np.flatnonzero(np.isin(owner, slot))
    particle = world.corner_particle[corner].astype(np.int64)
    start = np.append(0, np.cumsum(sizes[slot]))
    kind = world.element_kind[slot].astype(np.int64)
    return Chosen(slot, kind, start, corner, particle, _links(start, particle, free))


def _links(start: Slots, particle: Slots, free: NDArray[np.bool_]) -> Slots:
    """Pairs (2, k): of a narrow element all, of a wide one each free corner and the next free one, past the pinned."""
    sizes = np.diff(start)
    three = start[:-1][sizes == NARROW, None] + np.array([0, 1, 2])
    pairs = [particle[three][:, [p, q]].T for p, q in ((0, 1), (1, 2), (2, 0))]
    for begin, end in zip(start[:-1][sizes > NARROW].tolist(), start[1:][sizes > NARROW].tolist(), strict=True):
        movable = particle[begin:end][free[particle[begin:end]]]
        pairs.append(np.stack([movable[:-1], movable[1:]]))
    return np.concatenate(pairs, axis=1)


def lay_out_shapes(
    parts: Chosen, corner_row: Slots, body_of_row: Slots, place: Callable[[Slots, Slots], Slots]
) -> tuple[Shapes, Slots, Slots]:
    """The elements, grouped by body, ready for a step; the body of each, ascending; and the slots of their corners.

    corner_row (q,): the row of each corner. place: the block that two rows share.
    """
    count, sizes = len(parts.slot), np.diff(parts.start)
    owner = np.repeat(np.arange(count), sizes)
    lowest = np.full(count, np.iinfo(np.int64).max)
    np.minimum.at(lowest, owner, corner_row)
    body = body_of_row[lowest] if count else lowest
    grouped = np.argsort(body, kind="stable")
    rank = np.empty(count, dtype=np.int64)
    rank[grouped] = np.arange(count)
    corners = np.argsort(rank[owner], kind="stable")
    row, first = corner_row[corners], np.append(0, np.cumsum(sizes[grouped]))
    narrow = sizes[grouped] == NARROW
    block = np.full((count, 3), -1, dtype=np.int64)
    three = row[first[:-1][narrow, None] + np.array([0, 1, 2])]
    for side in range(3):
        block[narrow, side] = place(three[:, side], three[:, (side + 1) % 3])
    wide, most = _number_wide(narrow, body[grouped])
    numbers = {name: np.zeros(count) for name in Shapes._fields[6:]}
    numbers |= {"rest": np.zeros((count, 2)), "weight": np.zeros(len(row))}
    numbers |= {name: np.zeros((len(row), 2)) for name in ("place", "slope", "spare")}
    numbers |= {"response": np.zeros((most, len(body_of_row) if most else 0, 2)), "scale": np.zeros(most)}
    shapes = Shapes(parts.slot[grouped], parts.kind[grouped], first, row, block, wide, **numbers)
    return shapes, body[grouped], parts.corner[corners]


def _number_wide(narrow: NDArray[np.bool_], body: Slots) -> tuple[Slots, int]:
    """Number of each element among the wide ones of its body, -1 for narrow ones; and the most that a body has."""
    seen: dict[int, int] = {}
    wide = np.full(len(body), -1, dtype=np.int64)
    for k in np.flatnonzero(~narrow).tolist():
        wide[k] = seen.get(int(body[k]), 0)
        seen[int(body[k])] = int(wide[k]) + 1
    return wide, max(seen.values(), default=0)


def shapes_anchored(shapes: Shapes, free_count: int) -> NDArray[np.bool_]:
    """Elements (t,) of which a corner is pinned."""
    owner = np.repeat(np.arange(len(shapes.slot)), np.diff(shapes.first))
    anchored = np.zeros(len(shapes.slot), dtype=np.bool_)
    anchored[owner[shapes.row >= free_count]] = True
    return anchored
