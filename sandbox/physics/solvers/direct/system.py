"""Pattern of the direct solver's matrix: what springs and elements join, in what order particles are eliminated.

Symbolic work alone: made anew when topology or pins change, kept on the World meanwhile, no part of its state.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.components import label_bodies
from sandbox.physics.jit import bundle
from sandbox.physics.solvers.direct.constraint_layout import chosen_elements, lay_out_shapes, shapes_anchored
from sandbox.physics.solvers.direct.constraint_terms import Shapes
from sandbox.physics.solvers.direct.shape_matching import Goals, lay_out_goals
from sandbox.physics.solvers.linear.dissection import Dissection, dissect_bodies, make_fronts, spring_places
from sandbox.physics.solvers.linear.fronts import Fronts
from sandbox.physics.solvers.linear.minimum_degree import minimum_degree, update_targets
from sandbox.physics.world import LAW_HOOKE, LAW_NISSEN, Floats, Slots, World

# First guess of blocks in the factor per particle; too low costs one more pass, too high memory.
FILL_GUESS = 24
# Updates of a factorisation whose places are kept in a table, 4 bytes each; a body of more, some 15,000 particles of a
# lattice, finds them anew in every step: half as fast, without gigabytes.
LARGEST_TABLE = 1 << 25


class Rows(NamedTuple):
    """One row for every particle that springs of the matrix touch: free ones in elimination order, then pinned ones."""

    particle: Slots
    mass: Floats
    position: Floats
    start: Floats
    target: Floats
    inertia: Floats
    aim: Floats
    slow: Floats
    moved: Floats
    trial: Floats
    best: Floats
    change: Floats
    held: Floats


class Springs(NamedTuple):
    """The springs of the matrix by body: ends as rows, the block they share (-1: one end is pinned), and scratch."""

    slot: Slots
    row_a: Slots
    row_b: Slots
    block: Slots
    along: Floats
    pull: Floats
    measured: Floats
    hidden: Floats
    length: Floats
    error: Floats
    foreseen: Floats
    normal: Floats
    across: Floats
    impulse: Floats
    sideways: Floats
    tension: Floats


class Matrix(NamedTuple):
    """The matrix by columns: blocks below the diagonal, where their updates land, and the numbers.

    Columns of large bodies are empty: those are in the fronts.
    """

    column_start: Slots
    row: Slots
    target_start: Slots
    target: NDArray[np.int32]
    where: Slots
    diagonal: Floats
    lower: Floats
    scaled: Floats
    fronts: Fronts


class Bodies(NamedTuple):
    """First row, spring and element of each body and one past the last; free particle of lowest slot; if anchored."""

    row_start: Slots
    spring_start: Slots
    shape_start: Slots
    lowest: Slots
    anchored: NDArray[np.bool_]


@dataclass(frozen=True)
class Pattern:
    """Everything about a world's matrix that its topology and pins decide, with the scratch arrays of a step.

    corners: those of the elements of the matrix. numbers: the six named tuples as a bundle for kernels.
    """

    corners: Slots
    has_hooke: bool
    hooke: NDArray[np.bool_]
    bodies: Bodies
    rows: Rows
    springs: Springs
    shapes: Shapes
    matrix: Matrix
    goals: Goals
    numbers: Any


def make_pattern(world: World) -> Pattern:
    """Order a world's free particles for elimination and lay out the matrix of its springs and elements."""
    free = world.inverse_mass > 0.0
    kind = np.where(world.spring_active, world.law, -1).astype(np.int64)
    a, b = world.particle_a.astype(np.int64), world.particle_b.astype(np.int64)
    chosen = np.flatnonzero((kind == LAW_NISSEN) & (free[a] | free[b]))
    parts = chosen_elements(world, free)
    used = np.zeros(world.particle_count, dtype=np.bool_)
    used[a[chosen]] = used[b[chosen]] = used[parts.particle] = True
    nodes = np.flatnonzero(used & free)
    anchors = np.flatnonzero(used & ~free)
    # Rows before the elimination order is known; anchors come after every free particle, in any order.
    index = np.full(world.particle_count, -1, dtype=np.int64)
    index[np.concatenate([nodes, anchors])] = np.arange(len(nodes) + len(anchors))
    end_a, end_b = index[a[chosen]], index[b[chosen]]
    link_a, link_b = (np.concatenate([end, more]) for end, more in zip((end_a, end_b), index[parts.links], strict=True))
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
    matrix, place = _lay_out(len(nodes), columns, rank, fronts)
    corner_row = rank[index[parts.particle]]
    shapes, shape_body, corners = lay_out_shapes(parts, corner_row, body_number, place)
    row_a, row_b, spring_body = row_a[grouped], row_b[grouped], spring_body[grouped]
    held = spring_body[np.maximum(row_a, row_b) >= len(nodes)], shape_body[shapes_anchored(shapes, len(nodes))]
    every_body = np.arange(len(first_rows) + 1)
    bodies = Bodies(
        np.append(first_rows, len(nodes)),
        np.searchsorted(spring_body, every_body),
        np.searchsorted(shape_body, every_body),
        nodes[body_of_row[first_rows]],
        np.isin(every_body[:-1], np.concatenate(held)),
    )
    rows = _scratch_rows(np.concatenate([nodes[order], anchors]))
    goals = lay_out_goals(shapes, shape_body, len(first_rows), world.corner_form[corners])
    springs = _scratch_springs(chosen[grouped], row_a, row_b, place(row_a, row_b))
    return Pattern(
        corners=corners,
        has_hooke=bool((kind == LAW_HOOKE).any()),
        hooke=kind == LAW_HOOKE,
        bodies=bodies,
        rows=rows,
        springs=springs,
        shapes=shapes,
        matrix=matrix,
        goals=goals,
        numbers=bundle((bodies, rows, springs, shapes, matrix, goals)),
    )


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
    order, columns = _order_small(len(small), index[link_a[kept]], index[link_b[kept]])
    order = np.concatenate([small[order], *(np.flatnonzero(label == body)[large[body].order] for body in large)])
    by_body = np.argsort(label[order], kind="stable")
    return order[by_body], label, (small[columns[0]], small[columns[1]]), large


def _order_small(count: int, link_a: Slots, link_b: Slots) -> tuple[Slots, tuple[Slots, Slots]]:
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
        if minimum_degree(
            start, near.copy(), degree.copy(), np.zeros_like(near), counts[0], order, column_start, column,
            np.zeros(count, dtype=np.bool_), marks[0], counts[1], marks[1], counts[2], counts[3], counts[4],
        ):  # fmt: skip
            break
        capacity *= 2
    return order, (np.repeat(order, np.diff(column_start)), column[: column_start[-1]])


def _lay_out(
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
    return Matrix(column_start, row, pairs, target, where, *numbers, fronts), place


def _scratch_rows(particles: Slots) -> Rows:
    count = len(particles)
    numbers = {name: np.zeros(count if name in ("mass", "inertia") else (count, 2)) for name in Rows._fields[1:]}
    return Rows(particles, **numbers)


def _scratch_springs(slots: Slots, row_a: Slots, row_b: Slots, block: Slots) -> Springs:
    count = len(slots)
    numbers = {name: np.zeros(count) for name in Springs._fields[4:]}
    return Springs(slots, row_a, row_b, block, **(numbers | {"normal": np.zeros((count, 2))}))
