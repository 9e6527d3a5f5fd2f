"""Broad phase: which boxes overlap, by a uniform grid whose cells are kept in a table by their hash.

Everything that can be hit, a disc or an edge, lies in the cells that its box covers; a box that covers too many is
looked at by everybody. Buckets hold objects in ascending order, so the order of pairs is one of positions alone.
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.types import Flags
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import Floats, Slots

# Cell in units of the mean box: smaller puts an object into many cells, larger many objects into a cell.
CELL_SIZE = 1.0
# Boxes of more cells, or beyond so many cells from the origin, are looked at by everybody: a box swept at 1e9 m/s
# covers millions. Products of hashes stay inside 64 bits up to 1e10 cells.
MOST_CELLS = 1024.0
FARTHEST = 1e8
HASH_X, HASH_Y = 73856093, 19349663
# What a particle collides with: nothing, edges alone, edges and discs.
WITH_NOTHING, WITH_EDGES, WITH_ALL = 0, 1, 2


class Boxes(NamedTuple):
    """Boxes of o objects: n particles, then the edges of bodies.

    box [m] (o, 4) = left, bottom, right, top; of what takes no part left is above right. is_target (o,): whether others
    look for it. filter (n,): what a particle looks for.
    """

    box: Floats
    is_target: Flags
    filter: Slots


class Grid(NamedTuple):
    """Objects by bucket: object and cell of each entry, entries of bucket k at start[k]:start[k + 1]; large ones apart.

    low (o, 2): the cell of each box's corner. at: how many entries of a bucket are filled in. object, column, row have
    room for more than there are.
    """

    low: Slots
    large: Slots
    start: Slots
    at: Slots
    object: Slots
    column: Slots
    row: Slots


class Pairs(NamedTuple):
    """What each particle may touch: other[start[p]:start[p + 1]]; there is room for more."""

    start: Slots
    other: Slots


@inner_kernel
def is_large(left: float, bottom: float, right: float, top: float, cell: float) -> bool:
    """Whether a box covers too many cells, or lies too far away, to be put into the grid."""
    reach = FARTHEST * cell
    if not (left > -reach and bottom > -reach and right < reach and top < reach):
        return True
    return ((right - left) / cell + 2.0) * ((top - bottom) / cell + 2.0) > MOST_CELLS


@inner_kernel
def bucket_of(column: int, row: int, count: int) -> int:
    """Bucket of a cell, of a power of two of them."""
    return ((column * HASH_X) ^ (row * HASH_Y)) & (count - 1)


@inner_kernel
def cell_size(box: Floats) -> float:
    """Side of a cell [m]: the mean extent of the boxes; boxes of no extent at all, and absurd ones, still get one."""
    total = 0.0
    count = 0
    for k in range(box.shape[0]):
        if box[k, 0] <= box[k, 2]:
            total += max(box[k, 2] - box[k, 0], box[k, 3] - box[k, 1])
            count += 1
    extent = total / count if count > 0 else 1.0
    return CELL_SIZE * extent if 0.0 < extent < FARTHEST * FARTHEST else 1.0


@inner_kernel
def _count(boxes: Boxes, cell: float, grid: Grid) -> int:
    # Where the entries of each bucket begin; how many objects are large.
    box = boxes.box
    start = grid.start
    buckets = start.shape[0] - 1
    for bucket in range(buckets + 1):
        start[bucket] = 0
    larges = 0
    for k in range(box.shape[0]):
        if not boxes.is_target[k] or not box[k, 0] <= box[k, 2]:
            continue
        if is_large(box[k, 0], box[k, 1], box[k, 2], box[k, 3], cell):
            grid.large[larges] = k
            larges += 1
            continue
        left = math.floor(box[k, 0] / cell)
        bottom = math.floor(box[k, 1] / cell)
        grid.low[k, 0] = left
        grid.low[k, 1] = bottom
        for column in range(left, math.floor(box[k, 2] / cell) + 1):
            for row in range(bottom, math.floor(box[k, 3] / cell) + 1):
                start[bucket_of(column, row, buckets) + 1] += 1
    for bucket in range(buckets):
        start[bucket + 1] += start[bucket]
        grid.at[bucket] = start[bucket]
    return larges


@inner_kernel
def _fill(boxes: Boxes, cell: float, grid: Grid) -> None:
    box = boxes.box
    buckets = grid.start.shape[0] - 1
    for k in range(box.shape[0]):
        if not boxes.is_target[k] or not box[k, 0] <= box[k, 2]:
            continue
        if is_large(box[k, 0], box[k, 1], box[k, 2], box[k, 3], cell):
            continue
        for column in range(grid.low[k, 0], math.floor(box[k, 2] / cell) + 1):
            for row in range(grid.low[k, 1], math.floor(box[k, 3] / cell) + 1):
                bucket = bucket_of(column, row, buckets)
                entry = grid.at[bucket]
                grid.at[bucket] = entry + 1
                grid.object[entry] = k
                grid.column[entry] = column
                grid.row[entry] = row


@inner_kernel
def fill_grid(boxes: Boxes, cell: float, grid: Grid) -> tuple[int, int]:
    """Sort the boxes of targets into the grid; how many are large, and how many entries they need in all.

    Where these are more than there is room for, none is filled in.
    """
    larges = _count(boxes, cell, grid)
    entries = grid.start[grid.start.shape[0] - 1]
    if entries <= grid.object.shape[0]:
        _fill(boxes, cell, grid)
    return larges, entries


@inner_kernel
def _overlap(box: Floats, p: int, k: int) -> bool:
    return (
        box[p, 0] <= box[k, 2] and box[k, 0] <= box[p, 2] and box[p, 1] <= box[k, 3] and box[k, 1] <= box[p, 3]
    )  # fmt: skip


@inner_kernel
def find_pairs(boxes: Boxes, cell: float, grid: Grid, larges: int, pairs: Pairs) -> int:
    """The objects whose boxes overlap that of each particle; their number, counted on where there is no room."""
    count = 0
    start = pairs.start
    other = pairs.other
    room = other.shape[0]
    box = boxes.box
    is_target = boxes.is_target
    particles = boxes.filter.shape[0]
    buckets = grid.start.shape[0] - 1
    for p in range(particles):
        start[p] = count
        if boxes.filter[p] == WITH_NOTHING:
            continue
        # Two discs that both look for others are found once.
        past_discs = 0 if boxes.filter[p] == WITH_EDGES else p if is_target[p] else particles
        if is_large(box[p, 0], box[p, 1], box[p, 2], box[p, 3], cell):
            for k in range(box.shape[0]):
                if is_target[k] and k != p and (k >= particles or k < past_discs) and _overlap(box, p, k):
                    if count < room:
                        other[count] = k
                    count += 1
            continue
        for at in range(larges):
            k = grid.large[at]
            if k != p and (k >= particles or k < past_discs) and _overlap(box, p, k):
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
                        and _overlap(box, p, k)
                    ):
                        if count < room:
                            other[count] = k
                        count += 1
    start[particles] = count
    return count


def new_boxes(particles: int, objects: int) -> Boxes:
    """Boxes to be filled in."""
    return Boxes(np.zeros((objects, 4)), np.zeros(objects, np.bool_), np.zeros(particles, np.int64))


def new_grid(objects: int, entries: int) -> Grid:
    """A grid for so many objects, with room for so many entries."""
    buckets = 64
    while buckets < 2 * objects:
        buckets *= 2
    return Grid(
        np.zeros((objects, 2), np.int64), np.zeros(objects, np.int64), np.zeros(buckets + 1, np.int64),
        np.zeros(buckets, np.int64), *np.zeros((3, entries), dtype=np.int64),
    )  # fmt: skip


def new_pairs(particles: int, room: int) -> Pairs:
    """Pairs to be filled in, with room for so many."""
    return Pairs(np.zeros(particles + 1, np.int64), np.zeros(room, np.int64))
