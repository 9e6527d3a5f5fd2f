"""Edges of bodies of which both ends are pinned: terrain of their own, as they stand while topology does not change."""

import math
from typing import NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_float_rows, new_floats, new_slots
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import State
from sandbox.physics.terrain import CELL_SLACK, LEAST_CELL, MOST_CELLS, Chain, Terrain
from sandbox.physics.topology.sorting import sort_by_value

FRICTION, RESTITUTION = Chain.friction, Chain.restitution


class PinScratch(NamedTuple):
    """Scratch, as long as the edges."""

    length: Floats
    order: Slots
    spare: Slots


@inner_kernel
def _is_still(p: int, state: State) -> bool:
    return state.inverse_mass[p] == 0.0 and state.velocity[p, 0] == 0.0 and state.velocity[p, 1] == 0.0


@inner_kernel
def find_pinned(state: State, edge_a: Slots, edge_b: Slots, side: Slots, pins: Terrain, work: PinScratch) -> int:
    """Fill in the edges that are pinned, and corner, cell and size of their grid; how many there are."""
    count = 0
    for e in range(edge_a.shape[0]):
        a = edge_a[e]
        b = edge_b[e]
        if not (_is_still(a, state) and _is_still(b, state)):
            continue
        dx = state.position[b, 0] - state.position[a, 0]
        dy = state.position[b, 1] - state.position[a, 1]
        if dx == 0.0 and dy == 0.0:
            continue
        for axis in range(2):
            # -0.0 becomes 0.0
            pins.vertex[2 * count, axis] = state.position[a, axis] + 0.0
            pins.vertex[2 * count + 1, axis] = state.position[b, axis] + 0.0
        pins.edge_a[count] = 2 * count
        pins.edge_b[count] = 2 * count + 1
        pins.solid[count] = side[e]
        pins.chain[count] = e
        pins.friction[count] = FRICTION
        pins.restitution[count] = RESTITUTION
        work.length[count] = math.sqrt(dx * dx + dy * dy)
        count += 1
    if count > 0:
        _size_grid(count, pins, work)
    return count


@inner_kernel
def _reach(count: int, axis: int, pins: Terrain) -> tuple[float, float]:
    # The lowest and the highest coordinate of the edges.
    low = pins.vertex[0, axis]
    high = low
    for v in range(1, 2 * count):
        low = min(low, pins.vertex[v, axis])
        high = max(high, pins.vertex[v, axis])
    return low, high


@inner_kernel
def _size_grid(count: int, pins: Terrain, work: PinScratch) -> None:
    # As that of terrain: cells about as large as the shorter edges, of which a quarter is below.
    for k in range(count):
        work.order[k] = k
    sort_by_value(work.length, work.order, 0, count, work.spare)
    place = 0.25 * (count - 1)
    below = math.floor(place)
    share = place - below
    shorter = work.length[work.order[below]]
    longer = work.length[work.order[min(below + 1, count - 1)]]
    apart = longer - shorter
    cell = longer - apart * (1.0 - share) if share >= 0.5 else shorter + apart * share
    left, right = _reach(count, 0, pins)
    bottom, top = _reach(count, 1, pins)
    cell = max(cell, max(right - left, top - bottom) / (MOST_CELLS - 2), LEAST_CELL)
    pins.cell[0] = cell
    pins.corner[0] = left - cell
    pins.corner[1] = bottom - cell
    pins.size[0] = math.floor((right - pins.corner[0]) / cell) + 2
    pins.size[1] = math.floor((top - pins.corner[1]) / cell) + 2


@inner_kernel
def _enter(k: int, pins: Terrain, fills: bool) -> None:
    # Count edge k in every cell that it crosses or comes close to, or enter it there, from the ends of their lists.
    corner, cell, start = pins.corner, pins.cell[0], pins.cell_start
    ax = (pins.vertex[2 * k, 0] - corner[0]) / cell
    ay = (pins.vertex[2 * k, 1] - corner[1]) / cell
    bx = (pins.vertex[2 * k + 1, 0] - corner[0]) / cell
    by = (pins.vertex[2 * k + 1, 1] - corner[1]) / cell
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
            at = row * pins.size[0] + column
            if fills:
                start[at] -= 1
                pins.cell_edge[start[at]] = k
            else:
                start[at] += 1


@inner_kernel
def fill_cells(count: int, pins: Terrain) -> int:
    """Enter `count` pinned edges in the cells of their grid; how many entries there are, which may lack room."""
    start = pins.cell_start
    for at in range(start.shape[0]):
        start[at] = 0
    for k in range(count):
        _enter(k, pins, False)
    total = 0
    for at in range(start.shape[0]):
        total += start[at]
        start[at] = total
    if total <= pins.cell_edge.shape[0]:
        for back in range(count):
            _enter(count - 1 - back, pins, True)
    return total


@inner_kernel
def no_pins(arena: Arena) -> Terrain:
    """Of no edges."""
    none, nothing = new_slots(arena, 0), new_float_rows(arena, 0, 2)
    pins = Terrain(
        nothing, none, none, none, none, new_floats(arena, 0), new_floats(arena, 0), new_floats(arena, 2),
        new_floats(arena, 1), new_slots(arena, 2), new_slots(arena, 1), none, none, new_slots(arena, 1), nothing,
        new_slots(arena, 1), none,
    )  # fmt: skip
    if not is_full(arena):
        pins.cell[0] = 1.0
    return pins


@inner_kernel
def _with_cells(pins: Terrain, count: int, cell_start: Slots, cell_edge: Slots, tip_start: Slots) -> Terrain:
    # The first `count` edges, with these lists of cells.
    return Terrain(
        pins.vertex[: 2 * count], pins.edge_a[:count], pins.edge_b[:count], pins.solid[:count], pins.chain[:count],
        pins.friction[:count], pins.restitution[:count], pins.corner, pins.cell, pins.size, cell_start, cell_edge,
        pins.tip, pins.way_start, pins.way, tip_start, pins.cell_tip,
    )  # fmt: skip


@inner_kernel
def _room(edges: int, arena: Arena) -> Terrain:
    none = no_pins(arena)
    return Terrain(
        new_float_rows(arena, 2 * edges, 2), new_slots(arena, edges), new_slots(arena, edges), new_slots(arena, edges),
        new_slots(arena, edges), new_floats(arena, edges), new_floats(arena, edges), none.corner, none.cell, none.size,
        none.cell_start, none.cell_edge, none.tip, none.way_start, none.way, none.tip_start, none.cell_tip,
    )  # fmt: skip


@inner_kernel
def pinned_edges(state: State, edge_a: Slots, edge_b: Slots, side: Slots, arena: Arena) -> Terrain:
    """Those of the edges a to b of bodies that pins hold at both ends, as terrain; chain = the edge."""
    edges = edge_a.shape[0]
    found = _room(edges, arena)
    start = mark(arena)
    work = PinScratch(new_floats(arena, edges), new_slots(arena, edges), new_slots(arena, edges))
    if is_full(arena):
        return found
    count = find_pinned(state, edge_a, edge_b, side, found, work)
    give_back(arena, start)
    if count == 0:
        return no_pins(arena)
    cells, entries = found.size[0] * found.size[1], 4 * count
    cell_start, tip_start = new_slots(arena, cells + 1), new_slots(arena, cells + 1)
    found = _with_cells(found, count, cell_start, new_slots(arena, entries), tip_start)
    if is_full(arena):
        return found
    needed = fill_cells(count, found)
    if needed > entries:
        found = _with_cells(found, count, cell_start, new_slots(arena, needed), tip_start)
        if is_full(arena):
            return found
        fill_cells(count, found)
    return _with_cells(found, count, cell_start, found.cell_edge[:needed], tip_start)
