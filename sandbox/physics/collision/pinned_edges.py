"""Edges of bodies of which both ends are pinned: terrain of their own, as they stand while topology does not change."""

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_float_rows, new_floats, new_slots
from sandbox.physics.arrays import Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import State
from sandbox.physics.terrain import Chain, GridScratch, Terrain, fill_cells, size_grid

FRICTION, RESTITUTION = Chain.friction, Chain.restitution


@inner_kernel
def _is_still(p: int, state: State) -> bool:
    return state.inverse_mass[p] == 0.0 and state.velocity[p, 0] == 0.0 and state.velocity[p, 1] == 0.0


@inner_kernel
def find_pinned(state: State, edge_a: Slots, edge_b: Slots, side: Slots, pins: Terrain, work: GridScratch) -> int:
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
        count += 1
    if count > 0:
        size_grid(count, pins, work)
    return count


@inner_kernel
def no_pins(arena: Arena) -> Terrain:
    """Lay out pinned edges for a world that has none."""
    none, nothing = new_slots(arena, 0), new_float_rows(arena, 0, 2)
    pins = Terrain(
        nothing, none, none, none, none, new_floats(arena, 0), new_floats(arena, 0), new_floats(arena, 0),
        new_floats(arena, 2), new_floats(arena, 1), new_slots(arena, 2), new_slots(arena, 1), none, none,
        new_slots(arena, 1), nothing, new_slots(arena, 1), none,
    )  # fmt: skip
    if not is_full(arena):
        pins.cell[0] = 1.0
    return pins


@inner_kernel
def _with_cells(pins: Terrain, count: int, cell_start: Slots, cell_edge: Slots, tip_start: Slots) -> Terrain:
    # The first `count` edges, with these lists of cells.
    return Terrain(
        pins.vertex[: 2 * count], pins.edge_a[:count], pins.edge_b[:count], pins.solid[:count], pins.chain[:count],
        pins.friction[:count], pins.restitution[:count], pins.belt[:count], pins.corner, pins.cell, pins.size,
        cell_start, cell_edge, pins.tip, pins.way_start, pins.way, tip_start, pins.cell_tip,
    )  # fmt: skip


@inner_kernel
def _room(edges: int, arena: Arena) -> Terrain:
    none = no_pins(arena)
    return Terrain(
        new_float_rows(arena, 2 * edges, 2), new_slots(arena, edges), new_slots(arena, edges), new_slots(arena, edges),
        new_slots(arena, edges), new_floats(arena, edges), new_floats(arena, edges), new_floats(arena, edges),
        none.corner, none.cell, none.size, none.cell_start, none.cell_edge, none.tip, none.way_start, none.way,
        none.tip_start, none.cell_tip,
    )  # fmt: skip


@inner_kernel
def pinned_edges(state: State, edge_a: Slots, edge_b: Slots, side: Slots, arena: Arena) -> Terrain:
    """Those of the edges a to b of bodies that pins hold at both ends, as terrain; chain = the edge."""
    edges = edge_a.shape[0]
    found = _room(edges, arena)
    start = mark(arena)
    work = GridScratch(new_floats(arena, edges), new_slots(arena, edges), new_slots(arena, edges))
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
