"""Layout of the direct solver's system: which rows springs and constraints join, and the order of elimination.

Symbolic work alone: made again when topology or pins change, no part of a world's state.
"""

from sandbox.physics.arena import (
    Arena,
    is_full,
    new_slots,
    new_tuple,
)
from sandbox.physics.arrays import Flags
from sandbox.physics.jit import inner_kernel, set_field
from sandbox.physics.solvers.direct.choosing import COUNTS, LINKS, MOST_WIDE, NODES, chosen_for_matrix
from sandbox.physics.solvers.direct.jelly_groups import lay_out_groups
from sandbox.physics.solvers.direct.placing import Lying, Places, places_of
from sandbox.physics.solvers.direct.system import Bodies, Constraints, Rows, Springs, System
from sandbox.physics.solvers.linear.dissection import Dissection
from sandbox.physics.solvers.linear.elimination import (
    BODIES,
    BORDERS,
    FRONTS,
    HALVED,
    SMALL,
    WIDEST_NARROW,
    Links,
    Tuning,
    order_for_elimination,
)
from sandbox.physics.solvers.linear.elimination import COUNTS as FOUND_COUNTS
from sandbox.physics.solvers.linear.front_layout import FrontBlocks, new_fronts
from sandbox.physics.solvers.linear.matrix_layout import new_matrix
from sandbox.physics.state import State


@inner_kernel
def lay_out_system(state: State, unlimited: Flags, given: Tuning, arena: Arena, out: System) -> None:
    """Order a world's free particles for elimination and lay out the matrix of its springs and constraints.

    unlimited (m,): active springs of no limited force.
    """
    counts, found = new_slots(arena, COUNTS), new_slots(arena, FOUND_COUNTS)
    chosen = chosen_for_matrix(state, unlimited, given.whole[WIDEST_NARROW], counts, arena)
    if is_full(arena):
        return
    nodes, links = counts[NODES], counts[LINKS]
    joined = Links(chosen.link_a[:links], chosen.link_b[:links], chosen.x[:nodes], chosen.y[:nodes])
    ordered = order_for_elimination(joined, given, found, arena)
    if is_full(arena):
        return
    made, small, bodies = ordered.elimination, ordered.small, found[BODIES]
    dissected = cut_to(ordered.fronts, found[FRONTS], found[BORDERS])
    fronts = new_fronts(nodes, made.first_front, bodies, dissected, given.whole[HALVED], arena)
    matrix = new_matrix(nodes, small.order[: found[SMALL]], small.columns, made.row_of, arena)
    if is_full(arena):
        return
    blocks = FrontBlocks(
        fronts.of_row, fronts.width, fronts.base, fronts.first, fronts.last, fronts.border_start, fronts.border
    )
    lying = Lying(
        made.order, made.rank, made.body, made.first_row, made.lowest, matrix.column_start, matrix.row, blocks
    )
    places = places_of(state, counts, bodies, given.whole[WIDEST_NARROW], chosen, lying, arena)
    set_field(out, "fronts", fronts)
    set_field(out, "matrix", matrix)
    set_field(out, "bodies", _new_bodies(places, arena))
    set_field(out, "rows", new_tuple(Rows, arena, particle=places.particle, rows=places.particle.shape[0]))
    set_field(out, "springs", _new_springs(places, arena))
    set_field(out, "constraints", _new_constraints(places, nodes, counts[MOST_WIDE], arena))
    if not is_full(arena):
        lay_out_groups(state, places.constraint_start, arena, out)


@inner_kernel
def cut_to(room: Dissection, fronts: int, borders: int) -> Dissection:
    """The dissection that so much of it was filled in of."""
    return Dissection(
        room.first[:fronts], room.last[:fronts], room.child[:fronts], room.place[:fronts],
        room.border_start[: fronts + 1], room.border[:borders], room.to_parent[:borders],
    )  # fmt: skip


@inner_kernel
def _new_bodies(places: Places, arena: Arena) -> Bodies:
    return new_tuple(
        Bodies, arena, row_start=places.row_start, spring_start=places.spring_start,
        constraint_start=places.constraint_start, lowest=places.lowest, pivot=places.pivot, anchored=places.anchored,
        bodies=places.lowest.shape[0],
    )  # fmt: skip


@inner_kernel
def _new_springs(places: Places, arena: Arena) -> Springs:
    return new_tuple(
        Springs, arena, slot=places.spring, row_a=places.row_a, row_b=places.row_b, block=places.spring_block,
        springs=places.spring.shape[0],
    )  # fmt: skip


@inner_kernel
def _new_constraints(places: Places, rows: int, most_wide: int, arena: Arena) -> Constraints:
    # Ready for a step; most_wide: how many wide ones a body has at most.
    return new_tuple(
        Constraints, arena, slot=places.constraint, kind=places.kind, first=places.first, row=places.row,
        corner=places.corner, block=places.block, wide=places.wide, constraints=places.constraint.shape[0],
        corners=places.row.shape[0], most_wide=most_wide, answered=rows if most_wide > 0 else 0,
    )  # fmt: skip
