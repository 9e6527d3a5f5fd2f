"""The elimination order of the direct solver and where the blocks of its factor lie, against a slow elimination."""

import itertools

import numpy as np
import pytest

from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.solvers.direct import layout
from sandbox.physics.solvers.direct.layout import cut_to, tuning
from sandbox.physics.solvers.linear import elimination
from sandbox.physics.solvers.linear.elimination import (
    BODIES,
    BORDERS,
    COUNTS,
    FRONTS,
    SMALL,
    Links,
    order_for_elimination,
)
from sandbox.physics.solvers.linear.fronts import new_fronts
from sandbox.physics.solvers.linear.sparse_ldl import new_matrix, order_by_degree
from tests.support.laid_out import laid_out
from tests.support.tangles import tangle

SEEDS = range(5)


@pytest.fixture(params=["small", "large", "mixed"])
def smallest_body(request, monkeypatch):
    smallest = {"small": 10**9, "large": 2, "mixed": 30}[request.param]
    monkeypatch.setattr(elimination, "SMALLEST_BODY", smallest)
    monkeypatch.setattr(elimination, "NARROWEST_BORDER", 0.0)
    return smallest


def graph(seed, count=90):
    """Several bodies: nodes are joined to near ones of the same colour, some of them twice."""
    generator = np.random.default_rng(seed)
    place, colour = generator.uniform(0.0, 1.0, (count, 2)), generator.choice(3, count, p=[0.6, 0.3, 0.1])
    distance = np.sum((place[:, None] - place[None]) ** 2, axis=2) + 10.0 * (colour[:, None] != colour[None])
    a, b = np.nonzero(np.triu(distance < 0.05, 1))
    a, b = np.append(a, a[:5]), np.append(b, b[:5])
    return Links(a, b, np.ascontiguousarray(place[:, 0]), np.ascontiguousarray(place[:, 1]))


def ordered(links):
    """The elimination order of nodes, and how much there is of all."""
    counts = np.zeros(COUNTS, np.int64)
    return laid_out(order_for_elimination, links, tuning(), counts), counts.tolist()


def fill(count, rank, links):
    """The later rows that each row is joined to by the time that it is eliminated."""
    joined = [set() for _ in range(count)]
    for a, b in zip(rank[links.a].tolist(), rank[links.b].tolist(), strict=True):
        joined[min(a, b)].add(max(a, b))
    for row in range(count):
        for low, high in itertools.combinations(sorted(joined[row]), 2):
            joined[low].add(high)
    return joined


@pytest.mark.parametrize("seed", SEEDS)
def test_the_order_is_a_permutation_body_by_body(seed, smallest_body):
    links = graph(seed)
    (made, _, _), counts = ordered(links)
    count = len(links.x)
    assert sorted(made.order.tolist()) == list(range(count))
    assert np.array_equal(made.rank[made.order], np.arange(count))
    label = list(range(count))
    for _ in range(count):
        for a, b in zip(links.a.tolist(), links.b.tolist(), strict=True):
            label[a] = label[b] = min(label[a], label[b])
    lowest = sorted(set(label))
    assert counts[BODIES] == len(lowest) and made.lowest[: len(lowest)].tolist() == lowest
    assert [lowest[b] for b in made.body.tolist()] == [label[node] for node in made.order.tolist()]
    assert (np.diff(made.body) >= 0).all()
    sizes = np.diff(made.first_row[: len(lowest) + 1])
    assert ((np.diff(made.first_front[: len(lowest) + 1]) > 0) == (sizes >= smallest_body)).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_every_block_of_the_factor_has_its_place(seed, smallest_body):
    links = graph(seed)
    (made, room, small), counts = ordered(links)
    count = len(links.x)
    joined = fill(count, made.rank, links)
    found = cut_to(room, counts[FRONTS], counts[BORDERS])
    fronts = laid_out(new_fronts, count, made.first_front, counts[BODIES], found, 10**9)
    matrix = laid_out(new_matrix, count, small.order[: counts[SMALL]], small.columns, made.row_of)
    of_body = np.diff(made.first_front[: counts[BODIES] + 1]) > 0
    assert np.array_equal(fronts.of_row >= 0, of_body[made.body])
    for row in np.flatnonzero(fronts.of_row < 0).tolist():
        assert matrix.row[matrix.column_start[row] : matrix.column_start[row + 1]].tolist() == sorted(joined[row])
    for front, (first, last) in enumerate(zip(fronts.first.tolist(), fronts.last.tolist(), strict=True)):
        border = fronts.border[fronts.border_start[front] : fronts.border_start[front + 1]].tolist()
        assert border == sorted(set(border)) and (fronts.of_row[first:last] == front).all()
        # Fronts are dense: a border may hold rows that only some of it is joined to.
        assert set().union(*joined[first:last]) <= {*range(first, last), *border}
        own = [*range(first, last), *border]
        for below in [child for child in fronts.child[front].tolist() if child >= 0]:
            assert below < front
            at = slice(fronts.border_start[below], fronts.border_start[below + 1])
            assert [own[place] for place in fronts.to_parent[at].tolist()] == fronts.border[at].tolist()
    # No two numbers of fronts share a place.
    taken = [
        base + np.arange(2 * (last - first) * width)
        for base, width, first, last in zip(fronts.base, fronts.width, fronts.first, fronts.last, strict=True)
    ]
    assert sorted(np.concatenate([*taken, np.zeros(0, np.int64)]).tolist()) == list(range(len(fronts.numbers)))


def test_too_little_room_is_asked_for_again(monkeypatch):
    links = graph(1)
    monkeypatch.setattr(elimination, "SMALLEST_BODY", 40)
    monkeypatch.setattr(elimination, "NARROWEST_BORDER", 0.0)
    wanted, counts = ordered(links)
    assert counts[FRONTS] > 1 and counts[SMALL] > 0
    monkeypatch.setattr(elimination, "FILL_GUESS", 0)
    monkeypatch.setattr(elimination, "BORDER_GUESS", 1)
    rooms, new_dissection = [], elimination.new_dissection

    def less_room(nodes, borders, arena):
        rooms.append(borders)
        return new_dissection(nodes, borders // 8, arena)

    monkeypatch.setattr(elimination, "new_dissection", less_room)
    made, counts_made = ordered(links)
    assert len(set(rooms)) > 2
    assert counts_made == counts and np.array_equal(made.elimination.order, wanted.elimination.order)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_graph_is_eliminated_with_little_fill(seed):
    links = graph(seed)
    count = len(links.x)
    made = laid_out(order_by_degree, count, links.a, links.b)
    order, columns = made.order, made.columns
    rank = np.empty(count, np.int64)
    rank[order] = np.arange(count)
    joined = fill(count, rank, links)
    assert columns.start[count] == sum(map(len, joined))
    plain = fill(count, np.arange(count), links)
    assert sum(map(len, joined)) < 0.7 * sum(map(len, plain))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("narrow", [3, 2])
def test_everything_lies_where_its_rows_do(seed, narrow, smallest_body, monkeypatch):
    monkeypatch.setattr(layout, "NARROW", narrow)
    world = tangle(seed)
    system = block_of(world).arrays.system
    rows, bodies, springs, constraints = system.rows, system.bodies, system.springs, system.constraints
    free = len(system.matrix.diagonal)
    assert (world.inverse_mass[rows.particle] > 0.0).tolist() == [row < free for row in range(len(rows.particle))]
    assert np.array_equal(rows.particle[springs.row_a], world.particle_a[springs.slot])
    assert np.array_equal(rows.particle[springs.row_b], world.particle_b[springs.slot])
    assert np.array_equal(rows.particle[constraints.row], world.corner_particle[constraints.corner])
    body_of_row = np.repeat(np.arange(len(bodies.lowest)), np.diff(bodies.row_start))
    for b in range(len(bodies.lowest)):
        own = slice(bodies.row_start[b], bodies.row_start[b + 1])
        assert rows.particle[own].min() == bodies.lowest[b]
        of_springs = np.arange(bodies.spring_start[b], bodies.spring_start[b + 1])
        ends = np.append(springs.row_a[of_springs], springs.row_b[of_springs])
        corners = slice(*constraints.first[[bodies.constraint_start[b], bodies.constraint_start[b + 1]]])
        every = np.append(ends, constraints.row[corners])
        assert (body_of_row[every[every < free]] == b).all()
        pinned = set(every[every >= free].tolist())
        assert bodies.anchored[b] == bool(pinned)
        assert bodies.pivot[b] == (-1 if not pinned else pinned.pop() if len(pinned) == 1 else -2)
    pairs = [*zip(springs.row_a.tolist(), springs.row_b.tolist(), springs.block.tolist(), strict=True)]
    for k in range(len(constraints.slot)):
        three = constraints.row[constraints.first[k] : constraints.first[k + 1]].tolist()
        is_narrow = len(three) <= narrow
        assert (constraints.wide[k] < 0) == is_narrow
        blocks = constraints.block[k].tolist()
        pairs += [(three[c], three[(c + 1) % 3], blocks[c]) for c in range(3)] if is_narrow else []
        assert is_narrow or blocks == [-1, -1, -1]
    seen = {}
    for a, b, block in pairs:
        low, high = min(a, b), max(a, b)
        front = system.fronts.of_row[low] if low < free else -1
        assert seen.setdefault((low, high), block) == block
        if high >= free:
            assert block == -1
        elif front < 0:
            assert system.matrix.row[block] == high
            assert system.matrix.column_start[low] <= block < system.matrix.column_start[low + 1]
        else:
            row, column = divmod(block - system.fronts.base[front], system.fronts.width[front])
            border = slice(system.fronts.border_start[front], system.fronts.border_start[front + 1])
            own = [*range(system.fronts.first[front], system.fronts.last[front]), *system.fronts.border[border]]
            assert (own[row // 2], own[column // 2]) == (low, high) and row % 2 == column % 2 == 0
