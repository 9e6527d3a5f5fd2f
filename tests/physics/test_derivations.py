"""What kernels derive from topology, against slow references of a few lines: sorts, outlines, jellies, joined sets."""

import itertools
from collections import Counter, defaultdict

import numpy as np
import pytest

from sandbox.physics.collision import outline as close
from sandbox.physics.collision.outline import new_colliders, pinned_edges
from sandbox.physics.components import find_joined
from sandbox.physics.driving import Actuators, Motors
from sandbox.physics.marks import GRAB_MATERIAL, LINE, NO_EDGE, SOLID_RIGHT
from sandbox.physics.pipeline.block_owner import block_of, outline_of
from sandbox.physics.state import state_of
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.topology import sorting
from sandbox.physics.untangling.jellies import group_triangles
from tests.support.laid_out import laid_out
from tests.support.tangles import tangle

SEEDS = range(6)


def lists(start, listed):
    return [listed[first:last].tolist() for first, last in itertools.pairwise(start.tolist())]


@pytest.mark.parametrize("seed", SEEDS)
def test_sorts_are_stable_and_lists_are_ascending(seed):
    generator = np.random.default_rng(seed)
    count, bound = int(generator.integers(0, 50)), int(generator.integers(1, 12))
    key = generator.integers(0, bound, count)
    start, listed, spare = np.zeros(bound + 1, np.int64), np.zeros(2 * count, np.int64), np.zeros(2 * count, np.int64)
    items = generator.permutation(count)
    sorting.sort_by_key(key, items, count, bound, start, listed)
    assert lists(start, listed) == [[k for k in items.tolist() if key[k] == value] for value in range(bound)]
    some = np.where(generator.random(count) < 0.3, -1, key)
    sorting.list_by_key(some, count, bound, start, listed)
    assert lists(start, listed) == [np.flatnonzero(some == value).tolist() for value in range(bound)]
    for values in (key - 5, generator.uniform(-1.0, 1.0, count).round(1)):
        order = items.copy()
        middle = count // 3
        sorting.sort_by_value(values, order, middle, count, spare)
        assert order[:middle].tolist() == items[:middle].tolist()
        assert order[middle:].tolist() == sorted(items[middle:].tolist(), key=values.tolist().__getitem__)
    other = generator.integers(0, bound, count)
    sorting.list_ends(key, other, count, bound, start, listed)
    both = sorted([(key[k], k) for k in range(count)] + [(other[k], k) for k in range(count)])
    assert lists(start, listed) == [[k for end, k in both if end == node] for node in range(bound)]
    sorting.list_neighbours(key, other, count, bound, start, listed, spare, np.zeros(bound, np.int64))
    near = [(key[k], other[k]) for k in range(count)] + [(other[k], key[k]) for k in range(count)]
    assert lists(start, listed) == [sorted(q for p, q in near if p == node) for node in range(bound)]
    ascending = np.sort(key)
    for value in range(bound):
        assert sorting.place_among(value, ascending, 0, count) == np.searchsorted(ascending, value)


@pytest.mark.parametrize("seed", SEEDS)
def test_edges_of_one_owner_lie_together_with_the_solid_on_their_left(seed):
    world = tangle(seed)
    outline, count = outline_of(world), world.particle_count
    edges = int(outline.dynamic[0])
    slots = outline.number[:edges]
    assert sorted(slots.tolist()) == np.flatnonzero(world.spring_active & (world.edge != NO_EDGE)).tolist()
    owners = outline.owner[outline.edge_a[:edges]].tolist()
    assert sorted(zip(owners, slots.tolist(), strict=True)) == list(zip(owners, slots.tolist(), strict=True))
    swapped = world.edge[slots] == SOLID_RIGHT
    assert np.array_equal(outline.edge_a[:edges], np.where(swapped, world.particle_b[slots], world.particle_a[slots]))
    assert np.array_equal(outline.edge_b[:edges], np.where(swapped, world.particle_a[slots], world.particle_b[slots]))
    assert np.array_equal(outline.edge_a[edges:], count + world.terrain.edge_a)
    # An owner is torn where edges do not arrive at a vertex of it as often as they leave it.
    solid = world.edge[slots] != LINE
    ways = Counter(outline.edge_a[:edges][solid].tolist())
    ways.subtract(outline.edge_b[:edges][solid].tolist())
    torn = {int(outline.owner[v]) for v, rest in ways.items() if rest}
    own = outline.owner[outline.edge_a].tolist()
    assert outline.side[:edges].tolist() == [int(s and own[e] not in torn) for e, s in enumerate(solid.tolist())]
    assert outline.side[edges:].tolist() == world.terrain.solid.tolist()
    spans = [list(group) for _, group in itertools.groupby(range(len(own)), key=own.__getitem__)]
    assert outline.solid.tolist() == [[span[0], span[-1] + 1] for span in spans if outline.side[span].any()]
    ends = list(zip(outline.edge_a.tolist(), outline.edge_b.tolist(), strict=True))
    of_vertex = [[e for e, pair in enumerate(ends) if v in pair] for v in range(len(outline.owner))]
    assert lists(outline.edge_start, outline.edge_of) == of_vertex


@pytest.mark.parametrize("seed", SEEDS)
def test_an_outline_knows_its_shapes_and_what_lies_inside_and_what_is_held(seed):
    world = tangle(seed)
    outline, count = outline_of(world), world.particle_count
    edges = int(outline.dynamic[0])
    owners = list(dict.fromkeys(outline.owner[outline.edge_a[:edges]].tolist()))
    assert outline.shape.tolist() == [owners.index(o) if o in owners else -1 for o in outline.owner.tolist()]
    members = [
        [p for p in range(count) if world.particle_active[p] and outline.shape[p] == s] for s in range(len(owners))
    ]
    assert lists(outline.member_start, outline.member) == members
    for row, (first, _) in enumerate(outline.solid[: outline.dynamic[1]].tolist()):
        assert outline.shape[outline.edge_a[first]] >= 0 and row in outline.solid_of
    slots = outline.number[:edges]
    inside = set(world.owner[world.particle_a[slots[world.edge[slots] != LINE]]].tolist())
    bare = set(slots.tolist()) | set(np.flatnonzero(~world.spring_active).tolist())
    bare = [s for s in bare if world.material[s] != GRAB_MATERIAL]
    laid_bare = set(world.particle_a[bare].tolist()) | set(world.particle_b[bare].tolist())
    assert outline.shielded.tolist() == [o in inside and p not in laid_bare for p, o in enumerate(world.owner.tolist())]
    near = defaultdict(list)
    for s in np.flatnonzero(world.spring_active & (world.material != GRAB_MATERIAL)).tolist():
        a, b = int(world.particle_a[s]), int(world.particle_b[s])
        near[a].append(b)
        near[b].append(a)
    assert lists(outline.near_start, outline.near_of) == [sorted(near[p]) for p in range(count)]
    cornered = world.corner_particle[np.repeat(world.constraint_active, world.constraint_corners)]
    assert outline.attached.tolist() == [bool(near[p]) or p in cornered for p in range(count)]


def test_terrain_is_filled_in_among_the_colliders():
    world = tangle(0)
    colliders, count = laid_out(new_colliders, world.terrain, outline_of(world), 3), world.particle_count
    assert np.array_equal(colliders.position[count:], world.terrain.vertex)
    assert np.array_equal(colliders.friction[count + world.terrain.edge_b], world.terrain.friction)
    assert not colliders.position[:count].any() and not colliders.friction[:count].any()


@pytest.mark.parametrize("seed", SEEDS)
def test_pinned_edges_are_the_terrain_that_their_ends_make(seed):
    world = tangle(seed)
    generator = np.random.default_rng(seed)
    for particle in generator.choice(40, 25, replace=False).tolist():
        if world.inverse_mass[particle] > 0.0:
            world.pin(particle)
    world.velocity[np.flatnonzero(world.inverse_mass == 0.0)[0]] = 1.0
    outline = outline_of(world)
    edges = int(outline.dynamic[0])
    ends = np.stack([outline.edge_a[:edges], outline.edge_b[:edges]], axis=1)
    still = (world.inverse_mass[ends] == 0.0).all(axis=1) & (world.velocity[ends] == 0.0).all(axis=(1, 2))
    chosen = np.flatnonzero(still)
    wanted = make_terrain([Chain(world.position[pair]) for pair in ends[chosen]], tips=False)
    wanted = wanted._replace(chain=chosen, solid=outline.side[chosen])
    assert 0 < len(chosen) < edges
    for name in wanted._fields:
        assert np.array_equal(getattr(wanted, name), getattr(outline.pins, name)), name
    none = np.zeros(0, np.int64)
    assert not len(laid_out(pinned_edges, state_of(world), none, none, none).edge_a)


@pytest.mark.parametrize("seed", SEEDS)
def test_every_cell_that_an_edge_of_terrain_crosses_holds_it_once_and_few_hold_it_else(seed):
    generator = np.random.default_rng(seed)
    terrain = make_terrain([Chain(np.cumsum(generator.normal(size=(12, 2)), axis=0)) for _ in range(3)])
    a, b = terrain.vertex[terrain.edge_a], terrain.vertex[terrain.edge_b]
    share = np.linspace(0.0, 1.0, 400)[:, None, None]
    cell = np.floor((a + (b - a) * share - terrain.corner) / terrain.cell).astype(np.int64)
    crossed = [set(own) for own in (cell[..., 1] * terrain.size[0] + cell[..., 0]).T.tolist()]
    held = lists(terrain.cell_start, terrain.cell_edge)
    assert len(held) == terrain.size.prod() and all(own == sorted(set(own)) for own in held)
    holding = [{at for at, own in enumerate(held) if edge in own} for edge in range(len(a))]
    assert all(own <= cells for own, cells in zip(crossed, holding, strict=True))
    assert sum(map(len, holding)) <= 1.1 * sum(map(len, crossed))


def apart(one, other, form):
    """How far apart two segments are; None where they cross."""
    found, sides = [], []
    for (a, b), ends in ((one, other), (other, one)):
        way = form[b] - form[a]
        for p in ends:
            away = form[p] - form[a]
            share = min(max(float(way @ away) / max(float(way @ way), 1e-150), 0.0), 1.0)
            found.append(float(np.linalg.norm(away - share * way)))
            sides.append(float(way[0] * away[1] - way[1] * away[0]) > 0.0)
    return None if sides[0] != sides[1] and sides[2] != sides[3] else min(found)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_closest_edges_of_lines_come_first_and_all_others_are_beyond(seed, monkeypatch):
    generator = np.random.default_rng(seed)
    form, shape = generator.uniform(-1.0, 1.0, (40, 2)), np.repeat([0, 1], 20)
    a = generator.permutation(40)[:30]
    b = np.where(shape[a] == 0, (a + 1) % 20, 20 + (a - 19) % 20)
    found = laid_out(close.close_edges, form, a, b, shape, np.array([-1, -1 if seed % 2 else 4]))
    for s, pairs in enumerate(lists(found.start, np.arange(len(found.edge)))):
        own = np.flatnonzero(shape[a] == s).tolist()
        wanted = {}
        for e, f in itertools.combinations(own, 2):
            if len({a[e], b[e], a[f], b[f]}) == 4:
                distance = apart((a[e], b[e]), (a[f], b[f]), form)
                if distance is not None:
                    wanted[e, f] = distance
        if s == 1 and seed % 2 == 0:
            assert not pairs and found.beyond[s] == 0.0
            continue
        closest = sorted(wanted, key=wanted.__getitem__)
        kept = close.KEPT * len(own)
        assert found.edge[pairs].tolist() == [list(pair) for pair in closest[:kept]]
        assert np.abs(found.distance[pairs] - [wanted[pair] for pair in closest[:kept]]).max(initial=0.0) < 1e-12
        beyond = wanted[closest[kept]] if kept < len(closest) else np.inf
        assert found.beyond[s] == pytest.approx(beyond)


@pytest.mark.parametrize("seed", SEEDS)
def test_triangles_that_share_sides_are_one_jelly(seed):
    generator = np.random.default_rng(seed)
    count = 30
    corners = np.array([generator.choice(14, 3, replace=False) for _ in range(count)])
    corners[:6] = [[20, 21 + k, 21 + (k + 1) % 6] for k in range(6)]
    corners[6:9] = [[27, 28 + k, 29 + k] for k in range(3)]
    is_left = generator.random(count) < 0.1 * seed
    is_left[:9] = True
    jellies = laid_out(group_triangles, corners, is_left, 40)
    sides = [[frozenset((row[c], row[(c + 1) % 3])) for c in range(3)] for row in corners.tolist()]
    for t, u in itertools.combinations(range(count), 2):
        if set(sides[t]) & set(sides[u]):
            assert jellies.group[t] == jellies.group[u]
    for g, first in enumerate(jellies.first.tolist()):
        own = np.flatnonzero(jellies.group == g).tolist()
        assert own[0] == first
        reached, waiting = {first}, [first]
        while waiting:
            t = waiting.pop()
            new = {u for u in own if set(sides[t]) & set(sides[u])} - reached
            reached |= new
            waiting += new
        assert sorted(reached) == own
        particles = jellies.particle[jellies.start[g] : jellies.start[g + 1]].tolist()
        assert particles == sorted(set(corners[own].reshape(-1).tolist()))
    assert np.array_equal(jellies.particle[jellies.member], corners)
    assert np.array_equal(corners.reshape(-1)[jellies.corner], jellies.particle)
    # Inner ones have as many triangles as neighbours, in jellies that do not lie folded.
    for g in range(len(jellies.first)):
        own = np.flatnonzero(jellies.group == g).tolist()
        flat = len(set(is_left[own].tolist())) == 1
        for i in range(jellies.start[g], jellies.start[g + 1]):
            about = [row for row in corners[own].tolist() if jellies.particle[i] in row]
            assert jellies.inner[i] == (flat and 2 < len(about) == len({p for row in about for p in row}) - 1)
    assert jellies.inner[jellies.particle == 20].all()
    # The rim of three triangles about one corner, as it is walked through.
    strip = jellies.gap[(jellies.gap[:, 1] >= 27)]
    assert {tuple(row[1:]) for row in strip.tolist()} == {
        (27, 31, 28), (28, 27, 29), (29, 28, 30), (30, 29, 31), (31, 30, 27),
    }  # fmt: skip
    fan = {tuple(row) for row in jellies.fan.tolist() if row[0] == 27}
    assert fan == {(27, 28, 29, 30), (27, 28, 30, 31)}


@pytest.mark.parametrize("seed", SEEDS)
def test_particles_are_labelled_with_the_lowest_one_that_they_are_joined_to(seed):
    world = tangle(seed)
    generator = np.random.default_rng(seed)
    springs = world.spring_active & (generator.random(world.spring_count) < 0.2)
    particles = generator.random(world.particle_count) < 0.7
    world.change("constraint_active", generator.random(world.constraint_count) < 0.1)
    joined = [
        (a, b) for a, b in zip(world.particle_a[springs], world.particle_b[springs], strict=True)
        if particles[a] and particles[b]
    ]  # fmt: skip
    for first, size in zip(world.constraint_first, world.constraint_corners, strict=True):
        k = int(np.flatnonzero(world.constraint_first == first)[0])
        own = [p for p in world.corner_particle[first : first + size] if particles[p]]
        joined += list(itertools.pairwise(own)) if world.constraint_active[k] else []
    label = list(range(world.particle_count))
    for _ in range(world.particle_count):
        for a, b in joined:
            label[a] = label[b] = min(label[a], label[b])
    found = np.zeros(len(particles), np.int64)
    find_joined(world, springs, particles, found)
    assert found.tolist() == label


def sides_of_motor(world, hub, rim):
    """The wheel and the mount of a motor."""
    joined = np.flatnonzero(world.spring_active & (world.material >= 0))
    pairs = [(int(world.particle_a[s]), int(world.particle_b[s])) for s in joined]
    free = world.inverse_mass > 0.0
    label = list(range(world.particle_count))
    for _ in range(world.particle_count):
        for a, b in pairs:
            if free[a] and free[b]:
                label[a] = label[b] = min(label[a], label[b])
    ends = {q for pair in pairs if hub in pair for q in pair} - {hub}
    spokes, others = ends & set(rim), ends - set(rim)
    bodies = {label[hub]} if free[hub] else {label[p] for p in spokes}
    wheel = sorted(p for p in set(rim) if label[p] in bodies or not free[p])
    mount = [*sorted(others), hub]
    idle = not spokes or (mount == [hub] and free[hub])
    return tuple([] if idle or not all(free[p] for p in side) else side for side in (wheel, mount))


@pytest.mark.parametrize("seed", range(20))
def test_a_motor_has_its_wheel_on_one_side_and_its_mount_on_the_other(seed):
    world = tangle(seed, 16)
    generator = np.random.default_rng(seed)
    for particle in np.flatnonzero(world.inverse_mass[:16] == 0.0)[1:].tolist():
        world.unpin(particle)
    rims = [generator.choice(16, 5, replace=False) for _ in range(3)]
    hubs = [int(next(p for p in range(16) if p not in rim)) for rim in rims]
    ones = np.ones(3)
    motors = Motors(
        np.array(hubs), ones, ones, np.zeros(3, np.int64), np.array([0, 5, 10, 15]), np.concatenate(rims)
    )  # fmt: skip
    world.fit(Actuators(("wheel",), motors=motors), [1.0])
    wanted = [sides_of_motor(world, hub, rim.tolist()) for hub, rim in zip(hubs, rims, strict=True)]
    sides = block_of(world).arrays.sides
    groups = lists(sides.first, sides.particle)
    assert list(zip(groups[::2], groups[1::2], strict=True)) == wanted
