"""Borders: closed loops of particles around what is filled, traced again where springs are torn."""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
Mask = NDArray[np.bool_]


def keys_of(pairs: Slots) -> Slots:
    """A number for each pair of particles, in either order."""
    low, high = pairs.min(axis=-1), pairs.max(axis=-1)
    return np.asarray(low << 32 | high)


def sides_of(triangles: Slots, pairs: Slots) -> Slots:
    """Index (t, 3) into pairs of the spring along each side of triangles (t, 3), -1 where there is none."""
    sides = keys_of(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1))
    known = keys_of(pairs)
    order = np.argsort(known, kind="stable")
    place = np.minimum(np.searchsorted(known[order], sides), max(len(known) - 1, 0))
    if not len(known):
        return np.full(sides.shape, -1)
    found = order[place]
    return np.where(known[found] == sides, found, -1)


def trace_loops(triangles: Slots) -> list[Slots]:
    """Closed loops of particles around triangles (t, 3) of one winding, those around holes included."""
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    there, back = sides[:, 0] << 32 | sides[:, 1], sides[:, 1] << 32 | sides[:, 0]
    follow: dict[int, list[int]] = {}
    for a, b in sides[~np.isin(there, back)].tolist():
        follow.setdefault(a, []).append(b)
    loops = []
    while follow:
        first = next(iter(follow))
        loop, at = [], first
        while at in follow:
            loop.append(at)
            onward = follow[at]
            after = onward.pop()
            if not onward:
                del follow[at]
            at = after
            if at == first:
                break
        if len(loop) > 2:
            loops.append(np.array(loop, dtype=np.int64))
    return loops


def hull_of(form: Floats, pairs: Slots) -> Slots:
    """The loop around a net of springs (m, 2) between places (n, 2), walked along its outside; empty where it has none.

    From the lowest particle always the next spring to the right of where it came from.
    """
    joined: dict[int, list[int]] = {}
    for a, b in pairs.tolist():
        joined.setdefault(a, []).append(b)
        joined.setdefault(b, []).append(a)
    if not joined:
        return np.zeros(0, dtype=np.int64)
    first = min(joined, key=lambda k: (form[k, 1], form[k, 0]))
    loop, at, came = [first], first, -math.pi / 2
    for _ in range(2 * len(pairs) + 2):

        def turn(other: int, at: int = at, came: float = came) -> float:
            dx, dy = form[other] - form[at]
            return (math.atan2(dy, dx) - came - 1e-9) % math.tau

        onward = min(joined[at], key=turn)
        dx, dy = form[at] - form[onward]
        at, came = onward, math.atan2(dy, dx)
        if at == first:
            break
        loop.append(at)
    # A way there and back is no border.
    kept: list[int] = []
    for particle in loop:
        if len(kept) > 1 and kept[-2] == particle:
            kept.pop()
        else:
            kept.append(particle)
    return np.array(kept if len(kept) > 2 else [], dtype=np.int64)


def chains_of(ends: Slots) -> list[tuple[Slots, Slots]]:
    """Ways along springs (m, 2) through particles that just two of them meet in: particles (k + 1,), springs (k,)."""
    at: dict[int, list[int]] = {}
    for spring, (a, b) in enumerate(ends.tolist()):
        at.setdefault(a, []).append(spring)
        at.setdefault(b, []).append(spring)
    rows = ends.tolist()
    left = set(range(len(rows)))

    def walk(first: int, spring: int) -> tuple[Slots, Slots]:
        particles, springs = [first], []
        while spring in left:
            left.remove(spring)
            springs.append(spring)
            a, b = rows[spring]
            particles.append(b if particles[-1] == a else a)
            near = at[particles[-1]]
            if len(near) != 2:
                break
            spring = near[0] if near[1] == spring else near[1]
        return np.array(particles, dtype=np.int64), np.array(springs, dtype=np.int64)

    starts = [(particle, spring) for particle, near in at.items() if len(near) != 2 for spring in near]
    found = [walk(particle, spring) for particle, spring in starts if spring in left]
    while left:
        spring = min(left)
        found.append(walk(rows[spring][0], spring))
    return found


def starts_of(lengths: list[int]) -> Slots:
    """Where each of this many rows begins, and where the last ends."""
    return np.array([0, *np.cumsum(lengths)], dtype=np.int64) if lengths else np.zeros(1, dtype=np.int64)


def spans(starts: Slots) -> list[tuple[int, int]]:
    """First row and one past the last of each."""
    return list(pairwise(starts.tolist()))
