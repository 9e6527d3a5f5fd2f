"""Belt marks: chevrons that run along belts at the speed of these, by the time of the picture alone."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import Theme, packed
from sandbox.app.draw.raster.painter import MarkList
from sandbox.physics.marks import LINE, NO_EDGE, SOLID_RIGHT
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.terrain import Terrain

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]

# Half width of the strap of a belt, and size and half width of a chevron [pixels at scale 1].
STRAP_HALF, CHEVRON, CHEVRON_HALF = 3.6, 2.6, 0.85
# What is beside that of each side of a line.
SIDE = 0.5
CHEVRON_COLOUR = 0xFFCF4D
# Chevrons are so far apart [pixels at scale 1], at least: by a power of two of metres, so that they stay where they are
# while somebody zooms a little; and so far that each goes on [1/s] by less than half of that in a picture.
APART, MOST_PASSING = 20.0, 24.0
# Nor are they nearer than this [m], however short their way is.
LEAST_APART = 1e-3
# So far beside a view [pixels] nothing of a belt reaches into it.
BESIDE = 40.0


@dataclass(frozen=True, eq=False)
class BeltSide:
    """A side of a belt as a way from edge to edge: ends (k, 2), vertices of terrain or slots of particles.

    springs (k,): those of the edges, -1: terrain; arc (k + 1,) [m]: where edges begin along the way, at rest; speed
    [m/s] along it; side: 0 = what is on the left is solid, 1 = the left one of a line, -1 = the right one; radius [m]:
    what is solid begins so far on the right of its edges.
    """

    ends: Slots
    springs: Slots
    arc: Floats
    speed: float
    closed: bool
    side: int
    radius: float

    def chevrons(self, zoom: float, scale: float, seconds: float, seen: Floats) -> tuple[Slots, Floats]:
        """The edge and the place on it, as a share, of each chevron; seen (k, 2): from which share of an edge to which
        any is looked for.
        """
        rest, length = np.diff(self.arc), float(self.arc[-1])
        apart = 2.0 ** math.ceil(math.log2(max(APART * scale / zoom, abs(self.speed) / MOST_PASSING)))
        if self.closed:
            # No seam where it comes back to its beginning.
            apart = max(length / max(1, round(length / apart)), LEAST_APART)
        first = self.speed * seconds % apart
        low, high = np.ceil((self.arc[:-1, None] + seen * rest[:, None] - first) / apart).T
        counts = np.maximum(high - low, 0.0).astype(np.int64)
        edge = np.repeat(np.arange(len(rest)), counts)
        number = np.arange(len(edge)) + np.repeat(low - np.cumsum(counts) + counts, counts)
        return edge, (first + apart * number - self.arc[edge]) / rest[edge]


def ground_belts(terrain: Terrain) -> list[BeltSide]:
    """The belts of terrain."""
    made = []
    for chain in np.unique(terrain.chain[terrain.belt != 0.0]).tolist():
        edges = np.flatnonzero(terrain.chain == chain)
        ends = np.stack([terrain.edge_a[edges], terrain.edge_b[edges]], axis=1)
        is_solid, belt = bool(terrain.solid[edges[0]]), float(terrain.belt[edges[0]])
        along = terrain.vertex[ends[:, 1]] - terrain.vertex[ends[:, 0]]
        lengths = np.sqrt(np.sum(along * along, axis=1))
        made += _sides(ends, np.full(len(ends), -1), lengths, belt, not is_solid, 0.0)
    return made


def body_belts(state: Snapshot) -> list[BeltSide]:
    """The belts of bodies' edges, each as long as edges of one speed follow one another."""
    made = []
    running = np.flatnonzero((state.belt != 0.0) & (state.edge != NO_EDGE))
    ends = np.stack([state.particle_a[running], state.particle_b[running]], axis=1).astype(np.int64)
    turned = state.edge[running] == SOLID_RIGHT
    ends[turned] = ends[turned, ::-1]
    kinds = list(zip(state.belt[running].tolist(), (state.edge[running] == LINE).tolist(), strict=True))
    for belt, two_sided in dict.fromkeys(kinds):
        own = [k for k, kind in enumerate(kinds) if kind == (belt, two_sided)]
        for way in _ways(ends[own].tolist()):
            edges = np.array(own)[way]
            lengths, radius = state.natural_length[running[edges]], float(np.median(state.radius[ends[edges]]))
            made += _sides(ends[edges], running[edges], lengths, belt, two_sided, radius)
    return made


def _sides(
    ends: Slots, springs: Slots, lengths: Floats, belt: float, two_sided: bool, radius: float
) -> list[BeltSide]:  # fmt: skip
    # Who stands on the left side looks along the way to the right; on what is solid they stand on the right side.
    arc, closed = np.concatenate([[0.0], np.cumsum(lengths)]), bool(ends[0, 0] == ends[-1, 1])
    sides = ((1, belt), (-1, -belt)) if two_sided else ((0, -belt),)
    return [BeltSide(ends, springs, arc, speed, closed, side, radius) for side, speed in sides]


def _ways(ends: Sequence[Sequence[int]]) -> Iterable[list[int]]:
    """Edges as ways, each of which goes on as long as an edge begins where the last one ends; open ways first."""
    begins: dict[int, list[int]] = {}
    for k, (a, _) in enumerate(ends):
        begins.setdefault(a, []).append(k)
    reached = {b for _, b in ends}
    remaining = set(range(len(ends)))
    for first in sorted(remaining, key=lambda k: (ends[k][0] in reached, k)):
        way, at = [], first
        while at in remaining:
            remaining.remove(at)
            way.append(at)
            at = next((k for k in begins.get(ends[at][1], ()) if k in remaining), -1)
        if way:
            yield way


def mark_belts(
    layer: MarkList, belts: Sequence[BeltSide], at: Floats, active: NDArray[np.bool_], camera: Camera, scale: float,
    seconds: float, theme: Theme,
) -> None:  # fmt: skip
    """Mark belts whose ends are at (n, 2) [pixels]; active (m,): which springs are there."""
    for belt in belts:
        begin, way = at[belt.ends[:, 0]], at[belt.ends[:, 1]] - at[belt.ends[:, 0]]
        length = np.sqrt(np.sum(way * way, axis=1))[:, None]
        along = way / np.maximum(length, 1e-9)
        # Pixels count downwards.
        normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
        size = scale * (SIDE if belt.side else 1.0)
        inset = belt.side * STRAP_HALF * size if belt.side else STRAP_HALF * size - belt.radius * camera.zoom
        begin = begin + inset * normal
        seen = _seen(begin, way, camera.viewport)
        seen[[spring >= 0 and not active[spring] for spring in belt.springs.tolist()]] = 0.0
        drawn = seen[:, 1] > seen[:, 0]
        # Round at its ends, a strap goes to the corners of what is solid and no farther.
        trim = np.minimum(max(0.0, inset), 0.5 * length) * (0.0 if belt.side else 1.0) / np.maximum(length, 1e-9)
        shares = np.clip(seen, trim, 1.0 - trim)[drawn]
        strap = [begin[drawn] + shares[:, k, None] * way[drawn] for k in range(2)]
        layer.strokes(np.concatenate(strap, axis=1), STRAP_HALF * size, packed(theme.tyre))
        edge, along_edge = belt.chevrons(camera.zoom, scale, seconds, seen)
        ahead = math.copysign(CHEVRON * size, belt.speed) * along[edge]
        tip = begin[edge] + along_edge[:, None] * way[edge] + 0.5 * ahead
        for across in (-CHEVRON * size, CHEVRON * size):
            ends = np.concatenate([tip - ahead + across * normal[edge], tip], axis=1)
            layer.strokes(ends, CHEVRON_HALF * scale, CHEVRON_COLOUR)


def _seen(begin: Floats, way: Floats, view: tuple[int, int, int, int]) -> Floats:
    """The shares (k, 2) from which to which edges lie in a view, or close by; the same twice of what does not."""
    low, high = np.zeros(len(begin)), np.ones(len(begin))
    for axis in range(2):
        step = np.where(np.abs(way[:, axis]) > 1e-9, way[:, axis], 1e-9)
        ends = (np.array([-BESIDE, view[2 + axis] + BESIDE]) + view[axis] - begin[:, axis, None]) / step[:, None]
        low, high = np.maximum(low, ends.min(axis=1)), np.minimum(high, ends.max(axis=1))
    # What is nowhere is not seen.
    shares = np.stack([low, high], axis=1)
    return np.where((low < high)[:, None] & np.isfinite(shares), shares, 0.0)
