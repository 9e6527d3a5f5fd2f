"""Layout of the direct solver's system: which rows springs and constraints join, and the order of elimination.

Symbolic work alone: made again when topology or pins change, kept on the World meanwhile, no part of its state.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.components import label_bodies
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import bundle
from sandbox.physics.joints.limited_springs import unlimited_active
from sandbox.physics.solvers.direct.system import (
    SPIN_NUMBERS,
    Bodies,
    Constraints,
    Rows,
    ShapeMatchGroups,
    Springs,
    System,
)
from sandbox.physics.solvers.linear.dissection import Dissection, dissect_bodies, make_fronts, spring_places
from sandbox.physics.solvers.linear.fronts import Fronts
from sandbox.physics.solvers.linear.minimum_degree import (
    Columns,
    Heap,
    Marks,
    QuotientGraph,
    minimum_degree,
    update_targets,
)
from sandbox.physics.solvers.linear.parallel import start_helper
from sandbox.physics.solvers.linear.sparse_ldl import Matrix
from sandbox.physics.untangling.inversion import Jellies, group_triangles
from sandbox.physics.untangling.triangle_clamp import ClampedTriangles, new_triangles
from sandbox.physics.world import LAW_HOOKE, LAW_NISSEN, Floats, Slots, World

# First guess of blocks in the factor per particle; too low costs one more pass, too high memory.
FILL_GUESS = 24
# Updates of a factorisation whose places are kept in a table, 4 bytes each; a body of more, some 15,000 particles of a
# lattice, finds them anew in every step: half as fast, without gigabytes.
LARGEST_TABLE = 1 << 25
# Corners of a constraint that is added to the matrix; one of more is wide.
NARROW = 3


@dataclass(frozen=True, eq=False)
class SystemLayout:
    """Everything about a world's system that its topology and pins decide, with the scratch arrays of a step.

    hooke (m,): springs of Hooke's law, which are no part of it. lent: the system as one argument for kernels.
    """

    has_hooke: bool
    hooke: NDArray[np.bool_]
    system: System
    lent: Any


def layout_of(world: World) -> SystemLayout:
    """The layout of a world's system, made again after a change of topology or pins."""
    return world.derived(_hired_layout)


def _hired_layout(world: World) -> SystemLayout:
    layout = make_layout(world)
    start_helper(layout, layout.system.fronts, layout.system.rows.delta_v)
    return layout


class _Chosen(NamedTuple):
    """The constraints of the matrix, t of them with q corners: active, and with a free corner.

    slot and kind (t,), start (t+1,) = where corners begin; corner and particle (q,): slots. links (2, k): pairs of
    particles that are joined by them.
    """

    slot: Slots
    kind: Slots
    start: Slots
    corner: Slots
    particle: Slots
    links: Slots


def make_layout(world: World) -> SystemLayout:
    """Order a world's free particles for elimination and lay out the matrix of its springs and constraints."""
    free = world.inverse_mass > 0.0
    kind = np.where(unlimited_active(world), world.law, -1).astype(np.int64)
    a, b = world.particle_a.astype(np.int64), world.particle_b.astype(np.int64)
    chosen = np.flatnonzero((kind == LAW_NISSEN) & (free[a] | free[b]))
    picked = _choose_constraints(world, free)
    used = np.zeros(world.particle_count, dtype=np.bool_)
    used[a[chosen]] = used[b[chosen]] = used[picked.particle] = True
    nodes = np.flatnonzero(used & free)
    anchors = np.flatnonzero(used & ~free)
    # Rows before the elimination order is known; anchors come after every free particle, in any order.
    index = np.full(world.particle_count, -1, dtype=np.int64)
    index[np.concatenate([nodes, anchors])] = np.arange(len(nodes) + len(anchors))
    end_a, end_b = index[a[chosen]], index[b[chosen]]
    link_a, link_b = (
        np.concatenate([end, more]) for end, more in zip((end_a, end_b), index[picked.links], strict=True)
    )
    links = np.flatnonzero((link_a < len(nodes)) & (link_b < len(nodes)))
    order, label, columns, large = _eliminate(len(nodes), link_a[links], link_b[links], world.origin[nodes])
    rank = np.arange(len(nodes) + len(anchors))
    rank[order] = np.arange(len(nodes))
    row_a, row_b = rank[end_a], rank[end_b]
    body_of_row = label[order]
    first_rows = np.flatnonzero(np.diff(body_of_row, prepend=-1))
    body_number = np.cumsum(np.diff(body_of_row, prepend=-1) != 0) - 1
    spring_body = body_number[np.minimum(row_a, row_b)] if len(nodes) else row_a
    fronts = make_fronts(len(nodes), [(int(np.searchsorted(body_of_row, body)), large[body]) for body in sorted(large)])
    # Springs of a large body in the order of its rows: what a step reads together then lies together.
    low = np.minimum(row_a, row_b)
    in_front = np.append(fronts.of_row, -1)[np.minimum(low, len(nodes))] >= 0
    grouped = np.lexsort((np.where(in_front, low, 0), spring_body))
    matrix, place = lay_out_matrix(len(nodes), columns, rank, fronts)
    constraints, constraint_body = _lay_out_constraints(picked, rank[index[picked.particle]], body_number, place)
    row_a, row_b, spring_body = row_a[grouped], row_b[grouped], spring_body[grouped]
    anchoring = spring_body[np.maximum(row_a, row_b) >= len(nodes)], constraint_body[_anchored(constraints, len(nodes))]
    rows = _lay_out_rows(np.concatenate([nodes[order], anchors]))
    triangles = _triangles_among(constraints, world)
    goals = _lay_out_goals(constraints, triangles, constraint_body, len(first_rows), world)
    system = System(
        _lay_out_bodies(
            first_rows,
            nodes[body_of_row[first_rows]],
            spring_body,
            constraint_body,
            anchoring,
            _pivots(spring_body, np.maximum(row_a, row_b), constraint_body, constraints, len(nodes), len(first_rows)),
            len(nodes),
        ),
        rows,
        _lay_out_springs(chosen[grouped], row_a, row_b, place(row_a, row_b)),
        constraints,
        matrix,
        fronts,
        goals,
        _lay_out_triangles(rows, constraints, triangles, goals, world),
    )
    hooke = kind == LAW_HOOKE
    return SystemLayout(bool(hooke.any()), hooke, system, bundle((system,)))


def _eliminate(
    count: int, link_a: Slots, link_b: Slots, origin: Floats
) -> tuple[Slots, Slots, tuple[Slots, Slots], dict[int, Dissection]]:
    """Elimination order of the nodes, bodies one after another in the order of their lowest nodes.

    Also the body of each node, the blocks (column, row) of small bodies, and the dissections of large ones.
    """
    label = np.arange(count)
    label_bodies(link_a, link_b, label)
    large = dissect_bodies(label, link_a, link_b, origin)
    is_small = ~np.isin(label, list(large))
    small = np.flatnonzero(is_small)
    index = np.cumsum(is_small) - 1
    kept = np.flatnonzero(is_small[link_a])
    order, columns = order_small(len(small), index[link_a[kept]], index[link_b[kept]])
    order = np.concatenate([small[order], *(np.flatnonzero(label == body)[large[body].order] for body in large)])
    by_body = np.argsort(label[order], kind="stable")
    return order[by_body], label, (small[columns[0]], small[columns[1]]), large


def order_small(count: int, link_a: Slots, link_b: Slots) -> tuple[Slots, tuple[Slots, Slots]]:
    """Elimination order of the nodes of small bodies, and the blocks (column, row) of their factor."""
    keys = np.unique(np.concatenate([link_a * count + link_b, link_b * count + link_a]))
    near = keys % count if count else keys
    degree = np.bincount(keys // count, minlength=count) if count else keys
    start = np.append(0, np.cumsum(degree))
    capacity = FILL_GUESS * count + 16
    while True:
        order = np.zeros(count, dtype=np.int64)
        column_start, column = np.zeros(count + 1, dtype=np.int64), np.zeros(capacity, dtype=np.int64)
        counts, marks = np.zeros((5, count), dtype=np.int64), np.full((2, count), -1, dtype=np.int64)
        graph = QuotientGraph(start, near.copy(), degree.copy(), np.zeros_like(near), counts[0])
        found = Marks(np.zeros(count, dtype=np.bool_), marks[0], counts[1], marks[1])
        if minimum_degree(graph, order, Columns(column_start, column), found, Heap(*counts[2:])):
            break
        capacity *= 2
    return order, (np.repeat(order, np.diff(column_start)), column[: column_start[-1]])


def lay_out_matrix(
    count: int, columns: tuple[Slots, Slots], rank: Slots, fronts: Fronts
) -> tuple[Matrix, Callable[[Slots, Slots], Slots]]:
    """The matrix, ready for numbers, and a function: the block that two rows share (-1: one is pinned)."""
    keys = np.sort(rank[columns[0]] * count + rank[columns[1]])
    row = keys % count if count else keys
    lengths = np.bincount(keys // count, minlength=count) if count else keys
    column_start = np.append(0, np.cumsum(lengths))
    pairs = np.append(0, np.cumsum(lengths * (lengths - 1) // 2))
    where = np.zeros(count, dtype=np.int64)
    target = np.zeros(pairs[-1] if pairs[-1] <= LARGEST_TABLE else 0, dtype=np.int32)
    if len(target):
        update_targets(column_start, row, target, where)

    def place(row_a: Slots, row_b: Slots) -> Slots:
        low, high = np.minimum(row_a, row_b), np.maximum(row_a, row_b)
        blocks = np.where(high < count, np.searchsorted(keys, low * count + high), -1)
        in_front = np.flatnonzero((high < count) & (np.append(fronts.of_row, -1)[np.minimum(low, count)] >= 0))
        blocks[in_front] = spring_places(fronts, low[in_front], high[in_front])
        return blocks

    longest = int(lengths.max()) if count else 0
    numbers = np.zeros((count, 3)), np.zeros((len(row), 4)), np.zeros((longest, 4))
    return Matrix(column_start, row, pairs, target, where, *numbers), place


def _choose_constraints(world: World, free: NDArray[np.bool_]) -> _Chosen:
    """The constraints of a world that belong into the matrix; free (n,): particles that are not pinned."""
    sizes = world.constraint_corners.astype(np.int64)
    owner = np.repeat(np.arange(len(sizes)), sizes)
    movable = np.zeros(len(sizes), dtype=np.bool_)
    movable[owner[free[world.corner_particle]]] = True
    slot = np.flatnonzero(world.constraint_active & movable)
    corner = np.flatnonzero(np.isin(owner, slot))
    particle = world.corner_particle[corner].astype(np.int64)
    start = np.append(0, np.cumsum(sizes[slot]))
    kind = world.constraint_kind[slot].astype(np.int64)
    return _Chosen(slot, kind, start, corner, particle, _links(start, particle, free))


def _links(start: Slots, particle: Slots, free: NDArray[np.bool_]) -> Slots:
    """Pairs (2, k): of a narrow constraint all, of a wide one each free corner and the next free one, past the
    pinned."""
    sizes = np.diff(start)
    three = start[:-1][sizes == NARROW, None] + np.array([0, 1, 2])
    pairs = [particle[three][:, [p, q]].T for p, q in ((0, 1), (1, 2), (2, 0))]
    for begin, end in zip(start[:-1][sizes > NARROW].tolist(), start[1:][sizes > NARROW].tolist(), strict=True):
        movable = particle[begin:end][free[particle[begin:end]]]
        pairs.append(np.stack([movable[:-1], movable[1:]]))
    return np.concatenate(pairs, axis=1)


def _lay_out_constraints(
    picked: _Chosen, corner_row: Slots, body_of_row: Slots, place: Callable[[Slots, Slots], Slots]
) -> tuple[Constraints, Slots]:
    """The constraints, grouped by body, ready for a step, and the body of each, ascending.

    corner_row (q,): the row of each corner. place: the block that two rows share.
    """
    count, sizes = len(picked.slot), np.diff(picked.start)
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
    given = {
        "slot": picked.slot[grouped],
        "kind": picked.kind[grouped],
        "first": first,
        "row": row,
    }
    given |= {"corner": picked.corner[corners], "block": block, "wide": wide}
    shapes = {"rest": (count, 2), "weight": len(row), "scale": most}
    shapes |= {name: (len(row), 2) for name in ("place", "gradient", "spare")}
    shapes |= {"response": (most, len(body_of_row) if most else 0, 2)}
    return Constraints(**_scratch(Constraints, given, count, shapes)), body[grouped]


def _number_wide(narrow: NDArray[np.bool_], body: Slots) -> tuple[Slots, int]:
    """Number of each constraint among the wide ones of its body, -1 for narrow ones; and the most that a body has."""
    seen: dict[int, int] = {}
    wide = np.full(len(body), -1, dtype=np.int64)
    for k in np.flatnonzero(~narrow).tolist():
        wide[k] = seen.get(int(body[k]), 0)
        seen[int(body[k])] = int(wide[k]) + 1
    return wide, max(seen.values(), default=0)


def _anchored(constraints: Constraints, free_count: int) -> NDArray[np.bool_]:
    """Constraints (t,) of which a corner is pinned."""
    owner = np.repeat(np.arange(len(constraints.slot)), np.diff(constraints.first))
    anchored = np.zeros(len(constraints.slot), dtype=np.bool_)
    anchored[owner[constraints.row >= free_count]] = True
    return anchored


def _pivots(
    spring_body: Slots, high: Slots, constraint_body: Slots, constraints: Constraints, free_count: int, bodies: int
) -> Slots:
    """The row of the one pinned particle of each body; -1: it has none, -2: several. high: the larger of ends' rows."""
    owner = np.repeat(np.arange(len(constraints.slot)), np.diff(constraints.first))
    body = np.concatenate([spring_body, constraint_body[owner]])
    row = np.concatenate([high, constraints.row])
    lowest, highest = np.full(bodies, np.iinfo(np.int64).max), np.full(bodies, -1)
    pinned = row >= free_count
    np.minimum.at(lowest, body[pinned], row[pinned])
    np.maximum.at(highest, body[pinned], row[pinned])
    return np.where(highest < 0, -1, np.where(lowest == highest, highest, -2))


def _lay_out_bodies(
    first_rows: Slots,
    lowest: Slots,
    spring_body: Slots,
    constraint_body: Slots,
    anchoring: tuple[Slots, Slots],
    pivot: Slots,
    free_count: int,
) -> Bodies:
    """The bodies; anchoring: those of springs and constraints with a pinned end; pivot: see _pivots."""
    count = len(first_rows)
    every_body = np.arange(count + 1)
    scratch = (*np.zeros((4, count), dtype=np.bool_), *np.zeros((3, count)), np.zeros((count, SPIN_NUMBERS)))
    return Bodies(
        np.append(first_rows, free_count), np.searchsorted(spring_body, every_body),
        np.searchsorted(constraint_body, every_body), lowest, pivot,
        np.isin(every_body[:-1], np.concatenate(anchoring)), *scratch,
    )  # fmt: skip


def _lay_out_rows(particles: Slots) -> Rows:
    count = len(particles)
    shapes = {name: count for name in ("mass", "inverse_mass", "inertia")}
    return Rows(**_scratch(Rows, {"particle": particles}, (count, 2), shapes))


def _lay_out_springs(slots: Slots, row_a: Slots, row_b: Slots, block: Slots) -> Springs:
    given = {"slot": slots, "row_a": row_a, "row_b": row_b, "block": block}
    return Springs(**_scratch(Springs, given, len(slots), {"normal": (len(slots), 2)}))


def _scratch(kind: Any, given: dict[str, Slots], shape: Any, shapes: dict[str, Any]) -> dict[str, Any]:
    """The fields of a named tuple: what is given, and scratch of the shapes of their names, or of the shape of all."""
    return given | {name: np.zeros(shapes.get(name, shape)) for name in kind._fields if name not in given}


class _Triangles(NamedTuple):
    """The constraints that are areas of three corners (t,), where those stand and their rows (t, 3), their jellies."""

    constraint: Slots
    corner: Slots
    row: Slots
    jellies: Jellies


def _triangles_among(constraints: Constraints, world: World) -> _Triangles:
    chosen = np.flatnonzero((constraints.kind == AREA) & (constraints.wide < 0))
    corners = constraints.first[:-1][chosen, None] + np.array([0, 1, 2])
    rows = constraints.row[corners]
    return _Triangles(
        chosen,
        corners,
        rows,
        group_triangles(rows, world.constraint_rest[constraints.slot[chosen], 1] > 0.0, world.particle_count),
    )


def _lay_out_goals(
    constraints: Constraints, triangles: _Triangles, body: Slots, bodies: int, world: World
) -> ShapeMatchGroups:
    """The jellies among a world's constraints; body (t,): of each constraint."""
    count, chosen, jellies = len(constraints.slot), triangles.constraint, triangles.jellies
    group, member = np.full(count, -1, dtype=np.int64), np.full((count, 3), -1, dtype=np.int64)
    group[chosen], member[chosen] = jellies.group, jellies.member
    # Constraints lie by body, and so do their groups, in the order of the first of each.
    sample = chosen[jellies.first]
    return ShapeMatchGroups(
        of_body=np.searchsorted(body[sample], np.arange(bodies + 1)),
        start=jellies.start,
        row=jellies.particle,
        form=world.corner_form[constraints.corner[triangles.corner.reshape(-1)[jellies.corner]]],
        sample=sample,
        group=group,
        member=member,
        inner=jellies.inner,
        fan=jellies.fan,
        fan_start=jellies.fan_start,
        turns=np.zeros(len(jellies.particle), dtype=np.int64),
        inverted=np.zeros(len(sample), dtype=np.bool_),
        drawn=np.zeros(len(sample), dtype=np.bool_),
    )


def _lay_out_triangles(
    rows: Rows, constraints: Constraints, triangles: _Triangles, goals: ShapeMatchGroups, world: World
) -> ClampedTriangles:
    """The triangles of all jellies, over the rows."""
    motion = rows.position, rows.v, rows.mass, rows.inverse_mass
    collides = world.collides[rows.particle]
    return new_triangles(
        triangles.constraint, triangles.row, triangles.jellies, constraints.rest, motion, collides, goals.inverted,
        world.terrain,
    )  # fmt: skip
