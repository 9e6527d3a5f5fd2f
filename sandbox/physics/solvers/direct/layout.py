"""Layout of the direct solver's system: which rows springs and constraints join, and the order of elimination.

Symbolic work alone, in kernels: made again when topology or pins change, kept on the World meanwhile, no part of its
state.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.physics.solvers.direct.choosing import LINKS, NODES, chosen_of
from sandbox.physics.solvers.direct.jelly_groups import group_constraints
from sandbox.physics.solvers.direct.placing import Lying, Places, places_of
from sandbox.physics.solvers.direct.system import SPIN_NUMBERS, Bodies, Constraints, Rows, Springs, System
from sandbox.physics.solvers.linear.elimination import BODIES, BORDERS, FRONTS, SMALL, Links, order_for_elimination
from sandbox.physics.solvers.linear.front_layout import FrontBlocks, new_fronts
from sandbox.physics.solvers.linear.matrix_layout import new_matrix
from sandbox.physics.solvers.linear.parallel import start_helper
from sandbox.physics.state import Slots
from sandbox.physics.untangling.triangle_clamp import new_triangles
from sandbox.physics.world import World


@dataclass(frozen=True, eq=False)
class SystemLayout:
    """Everything about a world's system that its topology and pins decide, with the scratch arrays of a step."""

    system: System


def layout_of(world: World) -> SystemLayout:
    """The layout of a world's system, made again after a change of topology or pins."""
    return world.derived(_hired_layout, of_hands=False)


def _hired_layout(world: World) -> SystemLayout:
    layout = make_layout(world)
    start_helper(layout, layout.system.fronts, layout.system.rows.delta_v)
    return layout


def make_layout(world: World) -> SystemLayout:
    """Order a world's free particles for elimination and lay out the matrix of its springs and constraints."""
    chosen, counts = chosen_of(world)
    nodes, links = counts[NODES], counts[LINKS]
    joined = Links(chosen.link_a[:links], chosen.link_b[:links], chosen.x[:nodes], chosen.y[:nodes])
    elimination, room, small, found = order_for_elimination(joined)
    bodies = found[BODIES]
    fronts = new_fronts(nodes, elimination.first_front, bodies, room, found[FRONTS], found[BORDERS])
    matrix = new_matrix(nodes, small.order[: found[SMALL]], small.columns, elimination.row_of)
    blocks = FrontBlocks._make([getattr(fronts, name) for name in FrontBlocks._fields])
    lying = Lying(
        elimination.order, elimination.rank, elimination.body, elimination.first_row, elimination.lowest,
        matrix.column_start, matrix.row, blocks,
    )  # fmt: skip
    places, most_wide = places_of(world, counts, bodies, chosen, lying)
    rows = _rows(places.particle)
    constraints = _constraints(places, nodes, most_wide)
    triangles, jellies, groups = group_constraints(
        constraints, places.constraint_start, world.particle_count, world.constraint_rest, world.corner_form
    )
    motion, collides = (rows.position, rows.v, rows.mass, rows.inverse_mass), world.collides[rows.particle]
    clamped = new_triangles(
        triangles.constraint, triangles.row, jellies, constraints.rest, motion, collides, groups.inverted,
        world.terrain,
    )  # fmt: skip
    system = System(_bodies(places), rows, _springs(places), constraints, matrix, fronts, groups, clamped)
    return SystemLayout(system)


def _bodies(places: Places) -> Bodies:
    count = len(places.lowest)
    scratch = (*np.zeros((4, count), dtype=np.bool_), *np.zeros((3, count)), np.zeros((count, SPIN_NUMBERS)))
    return Bodies(
        places.row_start, places.spring_start, places.constraint_start, places.lowest, places.pivot, places.anchored,
        *scratch,
    )  # fmt: skip


def _rows(particles: Slots) -> Rows:
    count = len(particles)
    shapes = {name: count for name in ("mass", "inverse_mass", "inertia")}
    return Rows(**_scratch(Rows, {"particle": particles}, (count, 2), shapes))


def _springs(places: Places) -> Springs:
    given = {
        "slot": places.spring, "row_a": places.row_a, "row_b": places.row_b, "block": places.spring_block,
    }  # fmt: skip
    count = len(places.spring)
    return Springs(**_scratch(Springs, given, count, {"normal": (count, 2)}))


def _constraints(places: Places, rows: int, most_wide: int) -> Constraints:
    """The constraints, ready for a step; most_wide: how many wide ones a body has at most."""
    count, corners = len(places.constraint), len(places.row)
    given = {
        "slot": places.constraint, "kind": places.kind, "first": places.first, "row": places.row,
        "corner": places.corner, "block": places.block, "wide": places.wide,
    }  # fmt: skip
    shapes = {"rest": (count, 2), "weight": corners, "scale": most_wide}
    shapes |= {name: (corners, 2) for name in ("place", "gradient", "spare")}
    shapes |= {"response": (most_wide, rows if most_wide else 0, 2)}
    return Constraints(**_scratch(Constraints, given, count, shapes))


def _scratch(kind: Any, given: dict[str, Slots], shape: Any, shapes: dict[str, Any]) -> dict[str, Any]:
    """The fields of a named tuple: what is given, and scratch of the shapes of their names, or of the shape of all."""
    return given | {name: np.zeros(shapes.get(name, shape)) for name in kind._fields if name not in given}
