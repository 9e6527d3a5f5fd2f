"""Terrain: lines and solid shapes that never move, as edges in a grid that is laid once."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.jit import inner_kernel

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]

# Cells of the grid along its longer side, at most: more cost memory, fewer make particles look at edges far away.
MOST_CELLS = 256
# Share by which a cell is left wider than it must be, so that rounding puts no edge into the wrong one.
CELL_SLACK = 1e-6


@dataclass(frozen=True, eq=False)
class Chain:
    """Corners [m] (k, 2) of a piece of terrain, and what its surface is like.

    kind: "line" has two sides; "solid" is a polygon that is solid inside, "hollow" one that is solid outside.
    """

    corners: ArrayLike
    kind: Literal["line", "solid", "hollow"] = "line"
    friction: float = 0.5
    restitution: float = 0.0


class Terrain(NamedTuple):
    """Edges of all chains and the grid that finds them.

    vertex [m] (k, 2); edge_a, edge_b (e,) = vertices, what is solid lies on the left of the way from a to b where solid
    (e,); chain (e,); friction, restitution (e,). Grid: corner [m] (2,), cell [m] (1,), size (2,) = columns, rows;
    edges by cell, row by row: cell_edge[cell_start[c]:cell_start[c + 1]].
    """

    vertex: Floats
    edge_a: Slots
    edge_b: Slots
    solid: Slots
    chain: Slots
    friction: Floats
    restitution: Floats
    corner: Floats
    cell: Floats
    size: Slots
    cell_start: Slots
    cell_edge: Slots


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


def make_terrain(chains: Sequence[Chain]) -> Terrain:
    """Lay chains out as edges, in their order, and sort those into a grid."""
    vertices, ends, rows = [np.zeros((0, 2))], [np.zeros((0, 2), dtype=np.int64)], []
    first = 0
    for number, chain in enumerate(chains):
        corners = _oriented(chain)
        index = first + np.arange(len(corners))
        following = np.roll(index, -1)
        pairs = np.stack([index, following], axis=1)[: len(corners) - (chain.kind == "line")]
        vertices.append(corners)
        ends.append(pairs)
        rows += [(number, chain.kind != "line", chain.friction, chain.restitution)] * len(pairs)
        first += len(corners)
    vertex, pairs = np.concatenate(vertices), np.concatenate(ends)
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    return Terrain(
        vertex,
        np.ascontiguousarray(pairs[:, 0]),
        np.ascontiguousarray(pairs[:, 1]),
        table[:, 1].astype(np.int64),
        table[:, 0].astype(np.int64),
        np.ascontiguousarray(table[:, 2]),
        np.ascontiguousarray(table[:, 3]),
        *_grid(vertex[pairs[:, 0]], vertex[pairs[:, 1]]),
    )


def _oriented(chain: Chain) -> Floats:
    """Corners in the order that leaves what is solid on the left."""
    corners = np.array(chain.corners, dtype=np.float64).reshape(-1, 2) + 0.0
    x, y = corners[:, 0], corners[:, 1]
    area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    turned = (area < 0.0) == (chain.kind == "solid")
    return np.ascontiguousarray(corners[::-1]) if chain.kind != "line" and turned else corners


def _grid(a: Floats, b: Floats) -> tuple[Floats, Floats, Slots, Slots, Slots]:
    """Corner, cell, size, and the edges (e, 2) a to b by cell: every cell that an edge crosses holds it."""
    if not len(a):
        return np.zeros(2), np.ones(1), np.zeros(2, dtype=np.int64), np.zeros(1, dtype=np.int64), np.zeros(0, np.int64)
    low, high = np.minimum(a, b).min(axis=0), np.maximum(a, b).max(axis=0)
    length = np.sqrt(np.sum((b - a) ** 2, axis=1))
    # Cells are about as large as the shorter edges, so that a cell holds few and an edge lies in few.
    cell = max(float(np.quantile(length, 0.25)), float((high - low).max()) / (MOST_CELLS - 2), 1e-3)
    corner = low - cell
    size = ((high - corner) / cell).astype(np.int64) + 2
    held: list[list[int]] = [[] for _ in range(int(size[0] * size[1]))]
    for edge, (start, end) in enumerate(
        zip(((a - corner) / cell).tolist(), ((b - corner) / cell).tolist(), strict=True)
    ):
        for column, row in _cells(start, end):
            held[row * int(size[0]) + column].append(edge)
    first = np.append(0, np.cumsum([len(edges) for edges in held]))
    return corner, np.array([cell]), size, first, np.array([e for edges in held for e in edges], dtype=np.int64)


def _cells(start: list[float], end: list[float]) -> list[tuple[int, int]]:
    """Cells (column, row) that a segment crosses, in units of cells, and those that it comes close to."""
    (ax, ay), (bx, by) = sorted([start, end], key=lambda point: point[1])
    found = []
    for row in range(int(ay - CELL_SLACK), int(by + CELL_SLACK) + 1):
        # The part of the segment that lies in this row.
        share = [(min(max(level, ay), by) - ay) / (by - ay) if by > ay else level - row for level in (row, row + 1)]
        across = [ax + (bx - ax) * part for part in share]
        columns = range(int(min(across) - CELL_SLACK), int(max(across) + CELL_SLACK) + 1)
        found += [(column, row) for column in columns]
    return found


NO_TERRAIN = make_terrain(())
