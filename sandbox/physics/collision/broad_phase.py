"""Broad phase: which boxes overlap, by a uniform grid whose cells are kept in a table by their hash.

Everything that can be hit, a disc or an edge, lies in the cells that its box covers; a box that covers too many is
looked at by everybody. The size of cells follows from all boxes of a world, so pairs are put into the order of slots:
what is far away changes nothing.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, SlotRows, Slots
from sandbox.physics.geometry.segment import SHORTEST
from sandbox.physics.jit import inner_kernel
from sandbox.physics.topology.sorting import sort_ascending

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

    box [m] (o, 4) = left, bottom, right, top; an object that takes no part has its left above its right. is_target
    (o,): whether others look for it. filter (n,): the groups that a particle looks for.
    """

    box: Annotated[FloatRows, "objects, 4"]
    is_target: Annotated[Flags, "objects"]
    filter: Annotated[Slots, "particles"]


class Grid(NamedTuple):
    """Objects by bucket: those of bucket k at start[k]:start[k + 1], with the cell in which they lie there.

    cells (o, 4): first column and row, last column and row of each box; of a large one the last is before the first.
    large: those, of them that others look for. at: how many entries of a bucket are filled in. object = 4 times its
    number, + 1 in the first column of its cells, + 2 in their first row; object and cell have room for more.
    """

    cells: Annotated[SlotRows, "objects, 4"]
    large: Annotated[Slots, "objects"]
    start: Annotated[Slots, "buckets + 1"]
    at: Annotated[Slots, "buckets"]
    object: Annotated[Slots, "entries"]
    cell: Annotated[Slots, "entries"]


class Pairs(NamedTuple):
    """The objects that each particle may touch: other[start[p]:start[p + 1]]; there is room for more."""

    start: Annotated[Slots, "particles + 1"]
    other: Annotated[Slots, "room"]


class Candidates(NamedTuple):
    """Pairs whose boxes overlap: particles with moving objects, and particles with terrain.

    box (n, 4) [m]: those of particles, then of edges.
    """

    pairs: Pairs
    terrain: Pairs
    box: FloatRows


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
def cell_size(box: FloatRows) -> float:
    """Side of a cell [m]: the mean extent of the boxes; boxes of no extent at all, and absurd ones, still get one."""
    total = 0.0
    count = 0
    for k in range(box.shape[0]):
        if box[k, 0] <= box[k, 2]:
            total += max(box[k, 2] - box[k, 0], box[k, 3] - box[k, 1])
            count += 1
    extent = total / count if count > 0 else 1.0
    return CELL_SIZE * extent if SHORTEST < extent < FARTHEST * FARTHEST else 1.0


@inner_kernel
def cell_number(column: int, row: int) -> int:
    """One number of a cell: both are within FARTHEST."""
    return column * 0x100000000 + row


@inner_kernel
def _find_cells(boxes: Boxes, cell: float, grid: Grid) -> int:
    # The cells of every box that takes part; how many of those that others look for are large.
    box = boxes.box
    larges = 0
    per_cell = 1.0 / cell
    for k in range(box.shape[0]):
        if not box[k, 0] <= box[k, 2]:
            continue
        if is_large(box[k, 0], box[k, 1], box[k, 2], box[k, 3], cell):
            grid.cells[k, 0] = 0
            grid.cells[k, 2] = -1
            if boxes.is_target[k]:
                grid.large[larges] = k
                larges += 1
            continue
        for side in range(4):
            grid.cells[k, side] = math.floor(box[k, side] * per_cell)
    return larges


@inner_kernel
def _count(boxes: Boxes, grid: Grid) -> int:
    # Where the entries of each bucket begin; how many there are in all.
    cells = grid.cells
    start = grid.start
    buckets = start.shape[0] - 1
    for bucket in range(buckets + 1):
        start[bucket] = 0
    for k in range(boxes.is_target.shape[0]):
        if boxes.is_target[k]:
            for column in range(cells[k, 0], cells[k, 2] + 1):
                for row in range(cells[k, 1], cells[k, 3] + 1):
                    start[bucket_of(column, row, buckets) + 1] += 1
    entries = 0
    for bucket in range(buckets):
        grid.at[bucket] = entries
        entries += start[bucket + 1]
        start[bucket + 1] = entries
    return entries


@inner_kernel
def fill_grid(boxes: Boxes, cell: float, grid: Grid) -> tuple[int, int]:
    """Sort the boxes of targets into the grid; how many are large, and how many entries they need in all.

    Where these are more than there is room for, none is filled in.
    """
    larges = _find_cells(boxes, cell, grid)
    entries = _count(boxes, grid)
    if entries > grid.object.shape[0]:
        return larges, entries
    cells = grid.cells
    for k in range(boxes.is_target.shape[0]):
        if boxes.is_target[k]:
            for column in range(cells[k, 0], cells[k, 2] + 1):
                for row in range(cells[k, 1], cells[k, 3] + 1):
                    bucket = bucket_of(column, row, grid.start.shape[0] - 1)
                    entry = grid.at[bucket]
                    grid.at[bucket] = entry + 1
                    first = (1 if column == cells[k, 0] else 0) + (2 if row == cells[k, 1] else 0)
                    grid.object[entry] = 4 * k + first
                    grid.cell[entry] = cell_number(column, row)
    return larges, entries


@inner_kernel
def overlap(box: FloatRows, p: int, k: int) -> bool:
    """Whether the boxes of two objects do."""
    return (
        box[p, 0] <= box[k, 2] and box[k, 0] <= box[p, 2] and box[p, 1] <= box[k, 3] and box[k, 1] <= box[p, 3]
    )  # fmt: skip


@inner_kernel
def _pair_with_all(boxes: Boxes, p: int, past_discs: int, other: Slots, count: int) -> int:
    # The objects that a particle with a large box may touch.
    particles = boxes.filter.shape[0]
    for k in range(boxes.is_target.shape[0]):
        if boxes.is_target[k] and k != p and (k >= particles or k < past_discs) and overlap(boxes.box, p, k):
            if count < other.shape[0]:
                other[count] = k
            count += 1
    return count


@inner_kernel
def find_pairs(boxes: Boxes, grid: Grid, larges: int, pairs: Pairs) -> int:
    """The objects whose boxes overlap that of each particle; their number, counted on where there is no room."""
    count = 0
    other = pairs.other
    capacity = other.shape[0]
    box = boxes.box
    cells = grid.cells
    particles = boxes.filter.shape[0]
    buckets = grid.start.shape[0] - 1
    for p in range(particles):
        pairs.start[p] = count
        if boxes.filter[p] == WITH_NOTHING:
            continue
        # Two discs that both look for others are found once.
        past_discs = 0 if boxes.filter[p] == WITH_EDGES else p if boxes.is_target[p] else particles
        left = cells[p, 0]
        bottom = cells[p, 1]
        if cells[p, 2] < left:
            count = _pair_with_all(boxes, p, past_discs, other, count)
            continue
        for at in range(larges):
            k = grid.large[at]
            if k != p and (k >= particles or k < past_discs) and overlap(box, p, k):
                if count < capacity:
                    other[count] = k
                count += 1
        for column in range(left, cells[p, 2] + 1):
            for row in range(bottom, cells[p, 3] + 1):
                bucket = bucket_of(column, row, buckets)
                here = cell_number(column, row)
                # Boxes that share many cells are found in the first of them alone.
                seen = (0 if column == left else 1) + (0 if row == bottom else 2)
                for entry in range(grid.start[bucket], grid.start[bucket + 1]):
                    found = grid.object[entry]
                    k = found >> 2
                    if (
                        (k >= particles or k < past_discs)
                        and k != p
                        and found & seen == seen
                        and grid.cell[entry] == here
                        and overlap(box, p, k)
                    ):
                        if count < capacity:
                            other[count] = k
                        count += 1
        sort_ascending(other, min(pairs.start[p], capacity), min(count, capacity))
    pairs.start[particles] = count
    return count


@inner_kernel
def new_grid(objects: int, entries: int, arena: Arena) -> Grid:
    """A grid for a number of objects, with room for a number of entries."""
    buckets = 16
    while buckets < 4 * objects:
        buckets *= 2
    return new_tuple(Grid, arena, objects=objects, buckets=buckets, entries=entries)
