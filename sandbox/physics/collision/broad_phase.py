"""Broad phase: which boxes overlap, by a uniform grid whose cells are kept in a table by their hash.

Everything that can be met, a disc or an edge, lies in the cells that its box covers; a box that covers too many is
looked at by everybody. Buckets hold objects in ascending order, so the order of pairs is one of positions alone.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.world import Floats, Slots

# Cell in units of the mean box: smaller puts an object into many cells, larger many objects into a cell.
CELL_SIZE = 1.0
# Boxes of more cells, or beyond so many cells from the origin, are looked at by everybody: a box swept at 1e9 m/s
# covers millions. Products of hashes stay inside 64 bits up to 1e10 cells.
MOST_CELLS = 1024.0
FARTHEST = 1e8
HASH_X, HASH_Y = 73856093, 19349663
# What a particle meets: nothing, edges alone, edges and discs.
MEETS_NOTHING, MEETS_EDGES, MEETS_ALL = 0, 1, 2


class Grid(NamedTuple):
    """Objects by bucket: object and cell of each entry, entries of bucket k at start[k]:start[k + 1]; large ones apart.

    box [m] (n, 4) = left, bottom, right, top of every object; one that takes no part has left above right. cell [m]
    (1,). low (n, 2): the cell of each box's corner.
    """

    box: Floats
    cell: Floats
    low: Slots
    start: Slots
    object: Slots
    column: Slots
    row: Slots
    large: Slots


class Pairs(NamedTuple):
    """What each particle may meet: other[start[p]:start[p + 1]]."""

    start: Slots
    other: Slots


@inner_kernel
def is_large(left, bottom, right, top, cell):  # type: ignore[no-untyped-def]
    """Whether a box covers too many cells, or lies too far away, to be put into the grid."""
    reach = FARTHEST * cell
    if not (left > -reach and bottom > -reach and right < reach and top < reach):
        return True
    return ((right - left) / cell + 2.0) * ((top - bottom) / cell + 2.0) > MOST_CELLS


@inner_kernel
def bucket_of(column, row, count):  # type: ignore[no-untyped-def]
    """Bucket of a cell, of a power of two of them."""
    return ((column * HASH_X) ^ (row * HASH_Y)) & (count - 1)


@kernel
def _mean_extent(box):  # type: ignore[no-untyped-def]
    total = 0.0
    count = 0
    for k in range(box.shape[0]):
        if box[k, 0] <= box[k, 2]:
            total += max(box[k, 2] - box[k, 0], box[k, 3] - box[k, 1])
            count += 1
    return total / count if count > 0 else 1.0


@kernel
def _count(box, is_target, cell, low, start, large):  # type: ignore[no-untyped-def]
    # Entries of each bucket, at start[bucket + 1]; how many objects are large.
    buckets = start.shape[0] - 1
    larges = 0
    for k in range(box.shape[0]):
        if not is_target[k] or not box[k, 0] <= box[k, 2]:
            continue
        if is_large(box[k, 0], box[k, 1], box[k, 2], box[k, 3], cell):
            large[larges] = k
            larges += 1
            continue
        low[k, 0] = math.floor(box[k, 0] / cell)
        low[k, 1] = math.floor(box[k, 1] / cell)
        for column in range(low[k, 0], math.floor(box[k, 2] / cell) + 1):
            for row in range(low[k, 1], math.floor(box[k, 3] / cell) + 1):
                start[bucket_of(column, row, buckets) + 1] += 1
    for bucket in range(buckets):
        start[bucket + 1] += start[bucket]
    return larges


@kernel
def _fill(box, is_target, cell, low, start, at, objects, columns, rows):  # type: ignore[no-untyped-def]
    buckets = start.shape[0] - 1
    for k in range(box.shape[0]):
        if not is_target[k] or not box[k, 0] <= box[k, 2]:
            continue
        if is_large(box[k, 0], box[k, 1], box[k, 2], box[k, 3], cell):
            continue
        for column in range(low[k, 0], math.floor(box[k, 2] / cell) + 1):
            for row in range(low[k, 1], math.floor(box[k, 3] / cell) + 1):
                bucket = bucket_of(column, row, buckets)
                entry = start[bucket] + at[bucket]
                at[bucket] += 1
                objects[entry] = k
                columns[entry] = column
                rows[entry] = row


@inner_kernel
def _may_meet(box, p, k):  # type: ignore[no-untyped-def]
    return (
        box[p, 0] <= box[k, 2] and box[k, 0] <= box[p, 2] and box[p, 1] <= box[k, 3] and box[k, 1] <= box[p, 3]
    )  # fmt: skip


@kernel
def _pair(grid, is_target, meets, particles, start, other):  # type: ignore[no-untyped-def]
    # The objects whose boxes overlap that of each particle; their number, counted on where there is no room.
    count = 0
    room = other.shape[0]
    box = grid.box
    cell = grid.cell[0]
    buckets = grid.start.shape[0] - 1
    larges = grid.large.shape[0]
    for p in range(particles):
        start[p] = count
        if meets[p] == MEETS_NOTHING:
            continue
        # Two discs that are both looked for meet once.
        past_discs = 0 if meets[p] == MEETS_EDGES else p if is_target[p] else particles
        if is_large(box[p, 0], box[p, 1], box[p, 2], box[p, 3], cell):
            for k in range(box.shape[0]):
                if is_target[k] and k != p and (k >= particles or k < past_discs) and _may_meet(box, p, k):
                    if count < room:
                        other[count] = k
                    count += 1
            continue
        for at in range(larges):
            k = grid.large[at]
            if k != p and (k >= particles or k < past_discs) and _may_meet(box, p, k):
                if count < room:
                    other[count] = k
                count += 1
        left = math.floor(box[p, 0] / cell)
        bottom = math.floor(box[p, 1] / cell)
        right = math.floor(box[p, 2] / cell)
        top = math.floor(box[p, 3] / cell)
        for column in range(left, right + 1):
            for row in range(bottom, top + 1):
                bucket = bucket_of(column, row, buckets)
                for entry in range(grid.start[bucket], grid.start[bucket + 1]):
                    k = grid.object[entry]
                    # Boxes that share many cells meet in the first of them alone.
                    if (
                        k != p
                        and (k >= particles or k < past_discs)
                        and grid.column[entry] == column
                        and grid.row[entry] == row
                        and column == max(left, grid.low[k, 0])
                        and row == max(bottom, grid.low[k, 1])
                        and _may_meet(box, p, k)
                    ):
                        if count < room:
                            other[count] = k
                        count += 1
    start[particles] = count
    return count


def make_grid(box: Floats, is_target: NDArray[np.bool_]) -> Grid:
    """Sort the boxes (n, 4) of targets into a grid."""
    count = len(box)
    # Boxes of no extent at all, and absurd ones, still need a cell.
    extent = float(_mean_extent(box))
    cell = CELL_SIZE * extent if 0.0 < extent < FARTHEST * FARTHEST else 1.0
    buckets = 64
    while buckets < 2 * count:
        buckets *= 2
    low, start, large = np.zeros((count, 2), np.int64), np.zeros(buckets + 1, np.int64), np.zeros(count, np.int64)
    larges = _count(box, is_target, cell, low, start, large)
    entries = np.zeros((3, start[-1]), dtype=np.int64)
    _fill(box, is_target, cell, low, start, np.zeros(buckets, np.int64), entries[0], entries[1], entries[2])
    return Grid(box, np.array([cell]), low, start, entries[0], entries[1], entries[2], large[:larges])


def find_pairs(box: Floats, is_target: NDArray[np.bool_], meets: Slots, room: int) -> Pairs:
    """Objects that each particle may meet by their boxes (n, 4); room: a guess at their number."""
    grid, particles = make_grid(box, is_target), len(meets)
    start = np.zeros(particles + 1, np.int64)
    while True:
        other = np.zeros(room, np.int64)
        count = _pair(grid, is_target, meets, particles, start, other)
        if count <= room:
            return Pairs(start, other)
        room = count
