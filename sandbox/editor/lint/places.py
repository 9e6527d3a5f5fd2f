"""Things in the same place: particles that lie on each other unjoined, bodies that cross, and water in other water."""

import itertools
from collections.abc import Generator, Iterator

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.lint.finding import Finding, Rule, called, joint
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level
from sandbox.level.format.limits import BODY_RADIUS

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]

# Particles nearer than this [m] and than half the smaller radius look like one. Larger: what is only close is named.
OVERLAP = BODY_RADIUS / 2.0
# Comparisons of one grid, and pairs of items that are found, at most: a heap of 10,000 particles in one place has
# millions, which say no more.
COMPARED = 2_000_000
PAIRS = 200
# Springs of two bodies are held against each other in blocks of at most this many: a few milliseconds each.
BLOCK = 128
OTHER_BLOCK = 128
# Springs that meet within this share of their length from an end touch; beyond rounding, below what is seen.
EDGE = 1e-6


def overlapping_particles(scene: Scene) -> Rule:
    """Pairs of items with particles that lie on each other and are not joined."""
    count = len(scene.position)
    first = scene.first_of_weld
    loose = scene.spring_item >= len(scene.level.bodies)
    joined = _pair_keys(first[scene.particle_a[loose]], first[scene.particle_b[loose]], count)
    yield None
    # By pair of items: particles of theirs that lie on each other, and whether there are more.
    found: dict[int, tuple[int, int, bool]] = {}
    for a, b in _near_pairs(scene):
        owner_a, owner_b = scene.particle_item[a], scene.particle_item[b]
        apart = (owner_a != owner_b) & (first[a] != first[b])
        apart &= ~np.isin(_pair_keys(first[a], first[b], count), joined)
        items = _pair_keys(owner_a, owner_b, len(scene.items))
        a, b = np.minimum(a, b)[apart], np.maximum(a, b)[apart]
        pairs, first_of, counts = np.unique(items[apart], return_index=True, return_counts=True)
        for pair, index, times in zip(pairs.tolist(), first_of.tolist(), counts.tolist(), strict=True):
            slot, other, several = found.get(pair, (int(a[index]), int(b[index]), False))
            several |= times > 1 or (slot, other) != (int(a[index]), int(b[index]))
            found[pair] = slot, other, several
            if len(found) == PAIRS:
                break
        yield None
        if len(found) == PAIRS:
            break
    for pair, (slot, other, several) in sorted(found.items()):
        more = ", and so do more of theirs" if several else ""
        text = (
            f'"{scene.names(slot)}" lies on "{scene.names(other)}" and is not joined to it{more}; '
            "weld them or move one away"
        )
        both = frozenset(scene.items[index] for index in divmod(pair, len(scene.items)))
        remedy = None if several else joint(str(scene.names(slot)), str(scene.names(other)))
        many = "{count} pairs lie on each other and are not joined; join them or move them away"
        yield Finding("warning", text, both, scene.place(slot), remedy, many)
        yield None


def _pair_keys(a: Slots, b: Slots, count: int) -> Slots:
    """One number for each pair of numbers below count, the same in either order."""
    return np.asarray(np.minimum(a, b) * count + np.maximum(a, b))


def _near_pairs(scene: Scene) -> Iterator[tuple[Slots, Slots]]:
    """Particles that lie on each other, a few arrays at a time, pairs in any order and more than once.

    Two points nearer than half a cell share a cell in one of four grids that are half a cell apart.
    """
    scaled = scene.position / (2.0 * OVERLAP)
    for shift in itertools.product((0.0, 0.5), repeat=2):
        column, row = np.floor(scaled + np.array(shift)).astype(np.int64).T
        cell = (column << 32) + row
        order = np.argsort(cell, kind="stable")
        cell = cell[order]
        yield order[:0], order[:0]
        compared, ahead = 0, 0
        same = np.arange(len(order))
        while compared < COMPARED:
            ahead += 1
            same = same[same < len(order) - ahead]
            same = same[cell[same] == cell[same + ahead]]
            if not len(same):
                break
            compared += len(same)
            a, b = order[same], order[same + ahead]
            offset = scene.position[a] - scene.position[b]
            reach = np.minimum(np.minimum(scene.radius[a], scene.radius[b]) / 2.0, OVERLAP)
            near = np.sum(offset * offset, axis=1) <= reach * reach
            yield a[near], b[near]


def crossing_bodies(level: Level, scene: Scene) -> Rule:
    """Pairs of bodies of which springs cross, where nothing joins the two."""
    count = len(level.bodies)
    first = np.searchsorted(scene.particle_item, np.arange(count))
    joined = yield from _joined_bodies(scene, count)
    for a, b in _overlapping_boxes(scene, count):
        yield None
        if a < 0 or (a, b) in joined:
            continue
        crossing = yield from _crossing(scene, a, b)
        if crossing is not None:
            items, p, q = (scene.items[a], scene.items[b]), first[a], first[b]
            collide = level.has_contacts and bool(scene.collision.meet(int(p), int(q)))
            then = "and will be pushed apart" if collide else "and will pass through each other"
            text = f"{called(level, items[0])} and {called(level, items[1])} cross, {then}; move one away, or join them"
            many = f"{{count}} pairs cross, {then}; move them away, or join them"
            yield Finding("warning" if collide else "hint", text, frozenset(items), crossing, many=many)


def _joined_bodies(scene: Scene, count: int) -> Generator[None, None, set[tuple[int, int]]]:
    """Pairs of bodies that a weld or a loose spring joins, directly or through one particle of its own."""
    part = scene.first_of_weld
    ends = [part[scene.welds], part[np.stack([scene.particle_a, scene.particle_b], 1)[scene.spring_item >= count]]]
    yield None
    # Bodies by the particles that joints touch: a weld's, or the ends of a loose spring.
    touched = np.zeros(len(part), dtype=np.bool_)
    for pairs in ends:
        touched[pairs.ravel()] = True
    slots = np.flatnonzero(touched[part] & (scene.particle_item < count))
    at: dict[int, set[int]] = {}
    for slot in slots.tolist():
        at.setdefault(int(part[slot]), set()).add(int(scene.particle_item[slot]))
    yield None
    joined = {pair for bodies in at.values() for pair in itertools.combinations(sorted(bodies), 2)}
    for a, b in ends[1].tolist():
        joined |= {(min(p, q), max(p, q)) for p in at.get(a, ()) for q in at.get(b, ())}
    return joined


def _overlapping_boxes(scene: Scene, count: int) -> Iterator[tuple[int, int]]:
    """Pairs of bodies whose boxes overlap, the earlier first; (-1, -1) now and then between them."""
    if count < 2:
        return
    starts = np.searchsorted(scene.particle_item, np.arange(count))
    last = int(np.searchsorted(scene.particle_item, count))
    low = np.minimum.reduceat(scene.position[:last], starts)
    high = np.maximum.reduceat(scene.position[:last], starts)
    yield -1, -1
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    for ahead in range(1, count):
        # Sorted by their left sides: a box that does not reach the k-th after it reaches none beyond.
        reached = low[ahead:, 0] <= high[:-ahead, 0]
        if not reached.any():
            return
        overlap = reached & (low[ahead:, 1] <= high[:-ahead, 1]) & (low[:-ahead, 1] <= high[ahead:, 1])
        yield -1, -1
        for index in np.flatnonzero(overlap).tolist():
            a, b = int(order[index]), int(order[index + ahead])
            yield min(a, b), max(a, b)


def _crossing(scene: Scene, a: int, b: int) -> Generator[None, None, tuple[float, float] | None]:
    """Where [m] a spring of one body crosses one of another, the first found; touching is not crossing."""
    first, second = _segments(scene, a), _segments(scene, b)
    first = first[_meeting(first, second)]
    yield None
    for start in range(0, len(first), BLOCK):
        block = first[start : start + BLOCK]
        others = second[_meeting(second, block)]
        yield None
        for begin in range(0, len(others), OTHER_BLOCK):
            place = _first_crossing(block, others[begin : begin + OTHER_BLOCK])
            yield None
            if place is not None:
                return place
    return None


def _segments(scene: Scene, body: int) -> Floats:
    """Ends [m] of a body's springs (k, 2, 2)."""
    start, end = np.searchsorted(scene.spring_item, [body, body + 1])
    return scene.position[np.stack([scene.particle_a[start:end], scene.particle_b[start:end]], axis=1)]


def _meeting(segments: Floats, others: Floats) -> NDArray[np.bool_]:
    """Which segments (k,) reach into the box of all others."""
    if not len(others):
        return np.zeros(len(segments), dtype=np.bool_)
    corners = others.reshape(-1, 2)
    low, high = corners.min(axis=0), corners.max(axis=0)
    a, b = segments[:, 0], segments[:, 1]
    reaches = (np.minimum(a, b) <= high) & (np.maximum(a, b) >= low)
    return reaches[:, 0] & reaches[:, 1]


def _first_crossing(segments: Floats, others: Floats) -> tuple[float, float] | None:
    p, along = segments[:, None, 0], segments[:, None, 1] - segments[:, None, 0]
    q, across = others[None, :, 0], others[None, :, 1] - others[None, :, 0]
    turn = _cross(along, across)
    inverse = np.divide(1.0, turn, out=np.zeros_like(turn), where=turn != 0.0)
    at, other_at = _cross(q - p, across) * inverse, _cross(q - p, along) * inverse
    crossing = (turn != 0.0) & (at > EDGE) & (at < 1.0 - EDGE) & (other_at > EDGE) & (other_at < 1.0 - EDGE)
    found = np.argwhere(crossing)
    if not len(found):
        return None
    i, j = found[0].tolist()
    x, y = (segments[i, 0] + at[i, j] * (segments[i, 1] - segments[i, 0])).tolist()
    return x, y


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def water_in_water(level: Level) -> Rule:
    """Pairs of zones with water whose boxes overlap."""
    pools = [(zone.id, zone.box) for zone in level.zones if zone.water is not None and zone.box is not None]
    for (one, a), (other, b) in itertools.combinations(pools, 2):
        left, bottom, right, top = max(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3])
        if left < right and bottom < top:
            text = f'the water of "{one}" and "{other}" overlaps, and lifts twice there; part them'
            middle = 0.5 * (left + right), 0.5 * (bottom + top)
            many = "{count} pairs of zones with water overlap, and lift twice there; part them"
            yield Finding("warning", text, frozenset(), middle, many=many)
    yield None
