"""Which particles of a body keep an area or an angle between them."""

import numpy as np

from sandbox.level.kinds.bodies import AnyBody, BendingDef, JellyDef, MeshDef, RingDef, RopeDef
from sandbox.level.kinds.shapes import Pairs, jelly_triangles


def areas(body: AnyBody, pairs: Pairs) -> Pairs:
    """Polygons (t, k) of a body's particles that keep their area; pairs (m, 2): those that springs join.

    One of which a spring along a side is cut keeps nothing.
    """
    match body:
        case JellyDef() if body.area:
            polygons = jelly_triangles(body)
        case RingDef() if body.inflation is not None:
            polygons = np.arange(body.segments, dtype=np.int64)[None]
        case _:
            return np.zeros((0, 3), dtype=np.int64)
    sides = np.stack([polygons, np.roll(polygons, -1, axis=1)], axis=-1)
    return polygons[np.isin(_keys(sides), _keys(pairs)).all(axis=1)]


def bending(body: AnyBody) -> BendingDef | None:
    """The bending of a body whose kind has any."""
    return body.bending if isinstance(body, RopeDef | RingDef | MeshDef) else None


def bends(pairs: Pairs) -> Pairs:
    """Triples (t, 3), in order of their middle ones: each particle where just two springs meet, between the other ends.

    Of the two ends, the one of the earlier spring comes first.
    """
    ends = pairs.reshape(-1)
    order = np.argsort(ends, kind="stable")
    particle, start, count = np.unique(ends[order], return_index=True, return_counts=True)
    joints = np.flatnonzero(count == 2)
    first, second = order[start[joints]], order[start[joints] + 1]
    # The other end of a spring is next to it in the list.
    return np.stack([ends[first ^ 1], particle[joints], ends[second ^ 1]], axis=1)


def _keys(pairs: Pairs) -> Pairs:
    low, high = pairs.min(axis=-1), pairs.max(axis=-1)
    return np.asarray(low << 32 | high)
