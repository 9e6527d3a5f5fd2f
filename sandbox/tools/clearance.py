"""Clearance: how far a part has to be lifted so that it stands on what is below it, or that it has no room."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.analysis.query import bodies_around, shown_particles
from sandbox.physics.arrays import FloatRows
from sandbox.physics.geometry.segment import distances_from_segments, doubled_areas, signed_area, winding_number
from sandbox.physics.marks import TERRAIN_GROUP
from sandbox.physics.snapshot import Snapshot
from sandbox.tools.tool import Loop

# How far a part is lifted at most, as a multiple of its height; steps of its height at which room is looked for, and
# halvings of such a step.
MOST_LIFT, STEPS, HALVINGS = 2.0, 16, 6
# A rope counts as so high, as a share of its width.
LEAST_HEIGHT = 0.1
# A part may reach so far into what it stands on [share of its height]: it is not drawn to the very rim.
SLACK = 0.02
# A drawn body lies over another of which it covers this share, or which covers this share of it; less is a stroke that
# runs over a little. Of the other counts what lies deeper than this share of the drawn one's size.
COVERED, DEEP = 0.1, 0.1
# Sides of a part and of the terrain that are looked at, at most: beyond them every drop has room.
MOST_PAIRS = 400_000

Mask = NDArray[np.bool_]


def lift(loops: Sequence[Loop], snapshot: Snapshot, among: Mask | None = None) -> float | None:
    """How far [m] a part has to go up to touch nothing; None: it would have no room there either.

    loops [m]: its outline; lines that do not end where they begin have no inside. among (n,): the particles that it may
    not touch; None: all.
    """
    a, b = _sides(loops)
    width, height = (a.max(axis=0) - a.min(axis=0)).tolist()
    height = max(height, width * LEAST_HEIGHT)
    shown = shown_particles(snapshot) if among is None else among
    obstacles = _Obstacles(snapshot, shown, a, height, is_closed=all(loop[0] == loop[-1] for loop in loops))
    if not obstacles.hits(a, b):
        return 0.0
    step = height / STEPS
    for count in range(1, round(MOST_LIFT * STEPS) + 1):
        if not obstacles.hits(*_raised(a, b, count * step)):
            low, high = (count - 1) * step, count * step
            for _ in range(HALVINGS):
                middle = (low + high) / 2.0
                low, high = (middle, high) if obstacles.hits(*_raised(a, b, middle)) else (low, middle)
            return high
    return None


def covered(corners: Loop, places: FloatRows, snapshot: Snapshot) -> list[int]:
    """Owners of the bodies that a drawn body lies over, rather than beside; corners [m]: its outline.

    places [m] (n, 2): evenly inside of it.
    """
    # What touches the ground alone, or nothing, is in nobody's way.
    a, shown = np.array(corners), np.flatnonzero(shown_particles(snapshot) & (snapshot.collides & ~TERRAIN_GROUP != 0))
    b = np.roll(a, -1, axis=0)
    least, shares = DEEP * math.sqrt(abs(signed_area(a, b))), dict[int, float]()
    around = [owner for x, y in places.tolist() for owner in bodies_around(snapshot, (x, y)).tolist()]
    for owner in np.unique(snapshot.owner[shown]).tolist():
        own = snapshot.position[shown[snapshot.owner[shown] == owner]]
        deep = sum(winding_number(p, a, b) != 0 and distances_from_segments(p, a, b).min() > least for p in own)
        shares[owner] = max(around.count(owner) / len(places), deep / len(own))
    return [owner for owner, share in sorted(shares.items()) if share >= COVERED]


def passable(snapshot: Snapshot, owner: int) -> list[int]:
    """A particle of a body that what is drawn over it may pass: it has a collision group of its own. Else none."""
    slot = int(np.flatnonzero(snapshot.particle_active & (snapshot.owner == owner))[0])
    for joined in snapshot.equipment.joined:
        if 0 <= slot - joined.first_particle < len(joined.particle_names) and "passes" in joined.definition:
            others = snapshot.particle_active & (snapshot.group == snapshot.group[slot])
            others[joined.first_particle : joined.first_particle + len(joined.particle_names)] = False
            return [] if others.any() else [slot]
    return []


def _sides(loops: Sequence[Loop]) -> tuple[FloatRows, FloatRows]:
    """Ends [m] (s, 2) of the sides of loops, a little within them."""
    points = np.concatenate([np.asarray(loop, dtype=np.float64) for loop in loops])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    pairs = [(np.asarray(loop[:-1], dtype=np.float64), np.asarray(loop[1:], dtype=np.float64)) for loop in loops]
    a, b = (np.concatenate([pair[side] for pair in pairs]) for side in range(2))
    return middle + (1.0 - SLACK) * (a - middle), middle + (1.0 - SLACK) * (b - middle)


def _raised(a: FloatRows, b: FloatRows, by: float) -> tuple[FloatRows, FloatRows]:
    shift = np.array([0.0, by])
    return a + shift, b + shift


class _Obstacles:
    """The obstacles that a part with sides from a on may hit within the reach of its lift."""

    def __init__(self, snapshot: Snapshot, shown: Mask, a: FloatRows, height: float, is_closed: bool) -> None:
        self._is_closed = is_closed
        low, high = a.min(axis=0), a.max(axis=0) + np.array([0.0, MOST_LIFT * height])
        position, radius = snapshot.position[shown], snapshot.radius[shown]
        with np.errstate(invalid="ignore"):
            near = np.all((position + radius[:, None] >= low) & (position - radius[:, None] <= high), axis=1)
        self._position, self._radius = position[near], radius[near]
        terrain = snapshot.terrain
        self._a, self._b = terrain.vertex[terrain.edge_a], terrain.vertex[terrain.edge_b]
        if len(self._a) * len(a) > MOST_PAIRS:
            self._a = self._b = self._a[:0]
        solid = terrain.solid.astype(bool)[: len(self._a)]
        chains = [
            np.flatnonzero(solid & (terrain.chain[: len(self._a)] == chain)) for chain in np.unique(terrain.chain)
        ]
        self._solids = [(self._a[edges], self._b[edges]) for edges in chains if len(edges)]

    def hits(self, a: FloatRows, b: FloatRows) -> bool:
        """Whether sides from a to b (s, 2) [m] touch something, or lie in it."""
        return self._in_ground(a) or _cross(a, b, self._a, self._b) or self._at_particles(a, b)

    def _in_ground(self, points: FloatRows) -> bool:
        """Whether one of the points is in the ground, or outside of the walls."""
        for a, b in self._solids:
            # Ground lies on the left: what is solid inside runs counter-clockwise, and walls the other way.
            outside = 0 if signed_area(a, b) > 0.0 else -1
            if any(winding_number(point, a, b) != outside for point in points):
                return True
        return False

    def _at_particles(self, a: FloatRows, b: FloatRows) -> bool:
        if not len(self._position):
            return False
        way, off = b - a, self._position[:, None] - a
        square = np.maximum((way * way).sum(axis=1), 1e-30)
        fraction = np.clip((off * way).sum(axis=2) / square, 0.0, 1.0)
        gap = off - fraction[:, :, None] * way
        if np.any((gap * gap).sum(axis=2) < (self._radius * self._radius)[:, None]):
            return True
        return self._is_closed and any(winding_number(point, a, b) != 0 for point in self._position)


def _cross(a: FloatRows, b: FloatRows, c: FloatRows, d: FloatRows) -> bool:
    """Whether one of the sides from a to b (s, 2) crosses one from c to d (e, 2)."""
    if not len(c):
        return False

    a, b, c, d = a[:, None], b[:, None], c[None], d[None]
    crosses = doubled_areas(a, b, c) * doubled_areas(a, b, d) < 0.0
    return bool(np.any(crosses & (doubled_areas(c, d, a) * doubled_areas(c, d, b) < 0.0)))
