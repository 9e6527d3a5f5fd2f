"""Which edges of a form lie close to each other without meeting: what may cross first when the form is bent."""

import functools
from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.types import Flags
from sandbox.physics.equation import SHORTEST
from sandbox.physics.state import Floats, Slots

# Forms of more edges are not looked at, their pairs are too many; of the others so many pairs for each edge are kept.
MOST_EDGES = 160
KEPT = 8


class CloseEdges(NamedTuple):
    """Pairs of edges of some forms that have no common end and do not cross, the closest first.

    Those of form s: edge[start[s]:start[s + 1]] (k, 2), as far apart as distance [m] (k,). beyond [m] (s,): all others
    of the form are farther apart than this; 0: not known.
    """

    start: Slots
    edge: Slots
    distance: Floats
    beyond: Floats


def close_edges(form: Floats, a: Slots, b: Slots, shape: Slots, looked_at: Flags) -> CloseEdges:
    """The close edges, a[k] to b[k], of forms (n, 2), by shape (k,) of each edge; looked_at (s,): of which."""
    edges, distances = [np.zeros((0, 2), np.int64)], [np.zeros(0)]
    start, beyond = np.zeros(len(looked_at) + 1, np.int64), np.zeros(len(looked_at))
    for s, looks in enumerate(looked_at.tolist()):
        own = np.flatnonzero(shape == s)
        if looks and len(own) <= MOST_EDGES:
            pairs, distance = _by_distance(form, a[own], b[own])
            kept = KEPT * len(own)
            beyond[s] = distance[kept] if kept < len(distance) else np.inf
            edges.append(own[pairs[:kept]])
            distances.append(distance[:kept])
        else:
            edges.append(edges[0])
        start[s + 1] = start[s] + len(edges[-1])
    return CloseEdges(start, np.concatenate(edges), np.concatenate(distances), beyond)


def _by_distance(form: Floats, a: Slots, b: Slots) -> tuple[Slots, Floats]:
    # Places as complex numbers: one product has both how far a place is along an edge, and on which side.
    place = form[:, 0] + 1j * form[:, 1]
    first, second = _pairs(len(a))
    start, way = place[a], place[b] - place[a]
    per_square = 1.0 / np.maximum(np.abs(way) ** 2, SHORTEST)
    sides, squares = [], []
    for edge, other in ((first, second), (second, first)):
        for end in (a, b):
            away = place[end[other]] - start[edge]
            along = np.conj(way[edge]) * away
            away -= np.clip(along.real * per_square[edge], 0.0, 1.0) * way[edge]
            sides.append(along.imag > 0.0)
            squares.append(away.real * away.real + away.imag * away.imag)
    distance = np.sqrt(np.minimum(np.minimum(squares[0], squares[1]), np.minimum(squares[2], squares[3])))
    chosen = (a[first] != a[second]) & (a[first] != b[second]) & (b[first] != a[second]) & (b[first] != b[second])
    chosen &= (sides[0] == sides[1]) | (sides[2] == sides[3])
    distance = distance[chosen]
    order = np.argsort(distance, kind="stable")
    return np.stack([first[chosen][order], second[chosen][order]], axis=1), distance[order]


@functools.lru_cache(maxsize=16)
def _pairs(count: int) -> tuple[Slots, Slots]:
    first, second = np.triu_indices(count, 1)
    return first, second
