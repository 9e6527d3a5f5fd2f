"""Terrain: lines and solid shapes that never move, as edges in a grid that is laid once."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.geometry.segment import lengths, signed_area, winding_number
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.topology.sorting import sort_by_value

# Cells of the grid along its longer side, at most: more cost memory, fewer make particles look at edges far away.
MOST_CELLS = 256
# Side of a cell [m], at least.
LEAST_CELL = 1e-3
# Share by which a cell is left wider than it must be, so that rounding puts no edge into the wrong one.
CELL_SLACK = 1e-6
# Corners of pieces of terrain that are so near [m] to another piece meet it; 1 - cosine of the angle by which ways must
# differ from a straight line to be a corner.
WELD = 1e-3
FLAT = 1e-6


@dataclass(frozen=True, eq=False)
class Chain:
    """Corners [m] (k, 2) of a piece of terrain, with its contact properties.

    belt [m/s]: how fast the surface runs, to the right of who stands on it.
    kind: "line" has two sides; "solid" is a polygon that is solid inside, "hollow" one that is solid outside.
    """

    corners: ArrayLike
    kind: Literal["line", "solid", "hollow"] = "line"
    friction: float = 0.5
    restitution: float = 0.0
    belt: float = 0.0


class Terrain(NamedTuple):
    """Edges of all chains and the grid that finds them."""

    vertex: Annotated[FloatRows, "vertices, 2"]  # [m] (k, 2)
    edge_a: Annotated[Slots, "edges"]  # (e,): vertices, as edge_b
    edge_b: Annotated[Slots, "edges"]
    solid: Annotated[Slots, "edges"]  # (e,): where the ground lies on the left of the way from a to b
    chain: Annotated[Slots, "edges"]
    friction: Annotated[Floats, "edges"]
    restitution: Annotated[Floats, "edges"]
    belt: Annotated[Floats, "edges"]  # [m/s]: see Chain
    corner: Annotated[Floats, "2"]  # [m] (2,): of the grid
    cell: Annotated[Floats, "1"]  # [m] (1,)
    size: Annotated[Slots, "2"]  # (2,): columns, rows
    cell_start: Annotated[Slots, "cells + 1"]
    cell_edge: Annotated[Slots, "entries"]  # edges of cell c, row by row: cell_edge[cell_start[c]:cell_start[c + 1]]
    tip: Annotated[Slots, "tips"]  # vertices that stand out, which an edge of a body can hit: no seams, no hollows
    way_start: Annotated[Slots, "tips + 1"]
    way: Annotated[FloatRows, "ways, 2"]  # of length 1, along terrain from tip i on: way[way_start[i]:way_start[i + 1]]
    tip_start: Annotated[Slots, "cells + 1"]
    cell_tip: Annotated[Slots, "tips"]  # places in tip by cell: cell_tip[tip_start[c]:tip_start[c + 1]]


@inner_kernel
def cells_between(low: float, high: float, corner: float, per_cell: float, size: int) -> tuple[int, int]:
    """First and last of `size` cells of the grid that an interval covers; none: the last is before the first.

    per_cell [1/m]: 1 over the side of a cell.
    """
    first = (low - corner) * per_cell
    last = (high - corner) * per_cell
    if not (last >= 0.0 and first < size):
        return 0, -1
    return math.floor(max(0.0, first)), math.floor(min(last, size - 1.0))


def make_terrain(chains: Sequence[Chain], tips: bool = True) -> Terrain:
    """Lay chains out as edges, in their order, and sort those into a grid; tips: whether to look for corners."""
    vertices, ends, rows = [np.zeros((0, 2))], [np.zeros((0, 2), dtype=np.int64)], []
    first = 0
    for number, chain in enumerate(chains):
        corners = _oriented(chain)
        index = first + np.arange(len(corners))
        following = np.roll(index, -1)
        pairs = np.stack([index, following], axis=1)[: len(corners) - (chain.kind == "line")]
        vertices.append(corners)
        ends.append(pairs)
        rows += [(number, chain.kind != "line", chain.friction, chain.restitution, chain.belt)] * len(pairs)
        first += len(corners)
    vertex, pairs = np.concatenate(vertices), np.concatenate(ends)
    table = np.array(rows, dtype=np.float64).reshape(-1, 5)
    none, of_surface = np.zeros(0, np.int64), np.ascontiguousarray(table.T)
    edges = _with_grid(Terrain(
        vertex, np.ascontiguousarray(pairs[:, 0]), np.ascontiguousarray(pairs[:, 1]), of_surface[1].astype(np.int64),
        of_surface[0].astype(np.int64), of_surface[2].copy(), of_surface[3].copy(), of_surface[4].copy(), np.zeros(2),
        np.ones(1), np.zeros(2, np.int64), np.zeros(1, np.int64), none, none, none, np.zeros((0, 2)), none, none,
    ))  # fmt: skip
    tip, way_start, way, tip_start, cell_tip = _tips(vertex if tips else vertex[:0], pairs, edges)
    return edges._replace(tip=tip, way_start=way_start, way=way, tip_start=tip_start, cell_tip=cell_tip)


def _oriented(chain: Chain) -> Floats:
    """Corners in the order that leaves the solid side on the left."""
    corners = np.array(chain.corners, dtype=np.float64).reshape(-1, 2) + 0.0
    turned = (signed_area(corners, np.roll(corners, -1, axis=0)) < 0.0) == (chain.kind == "solid")
    return np.ascontiguousarray(corners[::-1]) if chain.kind != "line" and turned else corners


def _with_grid(edges: Terrain) -> Terrain:
    """Edges of terrain with the grid that finds them, of which there is nothing yet."""
    count = len(edges.edge_a)
    if not count:
        return edges
    _size_grid(edges, GridScratch(np.zeros(count), np.zeros(count, np.int64), np.zeros(count, np.int64)))
    # Without room for entries they are counted.
    found = edges._replace(cell_start=np.zeros(int(edges.size[0] * edges.size[1]) + 1, np.int64))
    found = found._replace(cell_edge=np.zeros(_fill_cells(found), np.int64))
    _fill_cells(found)
    return found


class GridScratch(NamedTuple):
    """Scratch, as long as the edges."""

    length: Floats
    order: Slots
    merge_buffer: Slots


@inner_kernel
def _reach(count: int, axis: int, edges: Terrain) -> tuple[float, float]:
    # The lowest and the highest coordinate of the edges.
    low = high = edges.vertex[edges.edge_a[0], axis]
    for k in range(count):
        a, b = edges.vertex[edges.edge_a[k], axis], edges.vertex[edges.edge_b[k], axis]
        low = min(low, min(a, b))
        high = max(high, max(a, b))
    return low, high


@inner_kernel
def size_grid(count: int, edges: Terrain, work: GridScratch) -> None:
    """Find corner, cell and size of the grid for the first `count` edges.

    Cells are about as large as the shorter edges, of which a quarter is below: so a cell holds few, and an edge lies in
    few.
    """
    for k in range(count):
        a, b = edges.edge_a[k], edges.edge_b[k]
        dx, dy = edges.vertex[b, 0] - edges.vertex[a, 0], edges.vertex[b, 1] - edges.vertex[a, 1]
        work.length[k] = math.sqrt(dx * dx + dy * dy)
        work.order[k] = k
    sort_by_value(work.length, work.order, 0, count, work.merge_buffer)
    place = 0.25 * (count - 1)
    below = math.floor(place)
    share = place - below
    shorter = work.length[work.order[below]]
    longer = work.length[work.order[min(below + 1, count - 1)]]
    apart = longer - shorter
    cell = longer - apart * (1.0 - share) if share >= 0.5 else shorter + apart * share
    left, right = _reach(count, 0, edges)
    bottom, top = _reach(count, 1, edges)
    cell = max(cell, max(right - left, top - bottom) / (MOST_CELLS - 2), LEAST_CELL)
    edges.cell[0] = cell
    edges.corner[0] = left - cell
    edges.corner[1] = bottom - cell
    edges.size[0] = math.floor((right - edges.corner[0]) / cell) + 2
    edges.size[1] = math.floor((top - edges.corner[1]) / cell) + 2


@kernel
def _size_grid(edges: Terrain, work: GridScratch) -> None:
    size_grid(edges.edge_a.shape[0], edges, work)


@inner_kernel
def _enter(k: int, edges: Terrain, fills: bool) -> None:
    # Count edge k in every cell that it crosses or comes close to, or enter it there, from the ends of their lists.
    corner, cell, start, a, b = edges.corner, edges.cell[0], edges.cell_start, edges.edge_a[k], edges.edge_b[k]
    ax, ay = (edges.vertex[a, 0] - corner[0]) / cell, (edges.vertex[a, 1] - corner[1]) / cell
    bx, by = (edges.vertex[b, 0] - corner[0]) / cell, (edges.vertex[b, 1] - corner[1]) / cell
    if by < ay:
        ax, ay, bx, by = bx, by, ax, ay
    for row in range(math.floor(ay - CELL_SLACK), math.floor(by + CELL_SLACK) + 1):
        # The part of the edge that lies in this row.
        one = (min(max(row, ay), by) - ay) / (by - ay) if by > ay else 0.0
        other = (min(max(row + 1.0, ay), by) - ay) / (by - ay) if by > ay else 1.0
        one = ax + (bx - ax) * one
        other = ax + (bx - ax) * other
        last = math.floor(max(one, other) + CELL_SLACK)
        for column in range(math.floor(min(one, other) - CELL_SLACK), last + 1):
            at = row * edges.size[0] + column
            if fills:
                start[at] -= 1
                edges.cell_edge[start[at]] = k
            else:
                start[at] += 1


@inner_kernel
def fill_cells(count: int, edges: Terrain) -> int:
    """Enter the first `count` edges in the cells of their grid; how many entries there are, which may lack room."""
    start = edges.cell_start
    for at in range(start.shape[0]):
        start[at] = 0
    for k in range(count):
        _enter(k, edges, False)
    total = 0
    for at in range(start.shape[0]):
        total += start[at]
        start[at] = total
    if total <= edges.cell_edge.shape[0]:
        for back in range(count):
            _enter(count - 1 - back, edges, True)
    return total


@kernel
def _fill_cells(edges: Terrain) -> int:
    return fill_cells(edges.edge_a.shape[0], edges)


def _tips(looked_at: Floats, pairs: Slots, edges: Terrain) -> tuple[Slots, Slots, Floats, Slots, Slots]:
    """The tips of terrain with the ways from them, and tips by cell; see Terrain."""
    vertex, solid, corner, cell, size = edges.vertex, edges.solid != 0, edges.corner, edges.cell, edges.size
    cells = int(size[0] * size[1])
    tips, starts, ways, at = [], [0], [np.zeros((0, 2))], []
    a, b = vertex[pairs[:, 0]], vertex[pairs[:, 1]]
    rim_a, rim_b = a[solid], b[solid]
    taken = np.zeros((0, 2))
    for v, place in enumerate(looked_at):
        if len(taken) and (np.sum((taken - place) ** 2, axis=1) <= WELD * WELD).any():
            continue
        left, bottom = ((place - WELD - corner) / cell).astype(np.int64).tolist()
        right, top = ((place + WELD - corner) / cell).astype(np.int64).tolist()
        rows = range(bottom * int(size[0]), top * int(size[0]) + 1, int(size[0]))
        near_cells = [slice(edges.cell_start[row + left], edges.cell_start[row + right + 1]) for row in rows]
        close = np.unique(np.concatenate([edges.cell_edge[part] for part in near_cells]))
        along = b[close] - a[close]
        length = lengths(along)
        from_a = place - a[close]
        share = np.clip(np.sum(from_a * along, axis=1) / np.maximum(length * length, 1e-300), 0.0, 1.0)
        off = from_a - share[:, None] * along
        near = (np.sum(off * off, axis=1) <= WELD * WELD) & (length > 0.0)
        unit = along[near] / length[near, None]
        found = np.concatenate([
            unit[(1.0 - share[near]) * length[near] > WELD], -unit[share[near] * length[near] > WELD]
        ])  # fmt: skip
        if not len(found) or (found @ found.T < FLAT - 1.0).any() or _is_hollow(v, pairs[close], solid[close], along):
            continue
        # Directions that may lie across all ways: those away from each, and the two across each.
        across = np.stack([-found[:, 1], found[:, 0]], axis=1)
        polar = np.concatenate([-found, across, -across])
        if not (polar @ found.T <= 1e-9).all(axis=1).any() or _is_buried(place, rim_a, rim_b):
            continue
        tips.append(v)
        starts.append(starts[-1] + len(found))
        ways.append(found)
        taken = np.append(taken, [place], axis=0)
        column, row = ((place - corner) / cell).astype(np.int64).tolist()
        at.append(row * int(size[0]) + column)
    order = np.argsort(np.array(at, dtype=np.int64), kind="stable")
    tip_start = np.append(0, np.cumsum(np.bincount(np.array(at, dtype=np.int64), minlength=cells)))
    return (
        np.array(tips, dtype=np.int64), np.array(starts, dtype=np.int64), np.ascontiguousarray(np.concatenate(ways)),
        tip_start.astype(np.int64), order.astype(np.int64),
    )  # fmt: skip


def _is_hollow(v: int, pairs: Slots, solid: NDArray[np.bool_], along: Floats) -> bool:
    """Whether the solid side of a vertex spans more than half a turn."""
    incoming, outgoing = np.flatnonzero(pairs[:, 1] == v), np.flatnonzero(pairs[:, 0] == v)
    if not len(incoming) or not len(outgoing) or not solid[incoming[0]]:
        return False
    one, two = along[incoming[0]], along[outgoing[0]]
    return bool(one[0] * two[1] - one[1] * two[0] <= 0.0)


def _is_buried(place: Floats, a: Floats, b: Floats) -> bool:
    """Whether a place lies inside solid terrain with edges a to b (e, 2), and not at its rim."""
    # Looked at a little to four sides of it: at a rim one of these is outside.
    sides = WELD * np.array([(2.0, 1.0), (-1.0, 2.0), (-2.0, -1.0), (1.0, -2.0)])
    return all(winding_number(place + side, a, b) > 0 for side in sides)


NO_TERRAIN = make_terrain(())
