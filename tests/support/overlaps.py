"""How deep bodies lie in each other, found without the kernels that part them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import Floats
from sandbox.physics.collision.outline import Outline
from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.world import World


class Found(NamedTuple):
    """Depth [radii] by pair of shapes, which is one of the same for a body that crosses itself.

    lines: how often lines cross outlines of solid bodies.
    """

    depth: dict[tuple[int, int], float]
    lines: int


def _side(a: Floats, b: Floats, p: Floats) -> Floats:
    return (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0])


def _distance(p: Floats, a: Floats, b: Floats) -> Floats:
    along = b - a
    share = np.clip(np.sum((p - a) * along, axis=-1) / np.maximum(np.sum(along**2, axis=-1), 1e-30), 0.0, 1.0)
    return np.sqrt(np.sum((p - a - share[..., None] * along) ** 2, axis=-1))


def _crossings(w: World, outline: Outline, e: int, solid: NDArray[np.bool_]) -> tuple[NDArray[np.int64], Floats]:
    """The edges before e that it crosses and may not, and how deep [m]."""
    a, b, f = outline.edge_a[e], outline.edge_b[e], np.arange(e)
    c, d = outline.edge_a[f], outline.edge_b[f]
    s, t = outline.shape[a], outline.shape[c]
    f = f[(solid[s] | solid[t]) & (c != a) & (c != b) & (d != a) & (d != b)]
    c, d = outline.edge_a[f], outline.edge_b[f]
    place = w.position
    across = (_side(place[a], place[b], place[c]) > 0) != (_side(place[a], place[b], place[d]) > 0)
    across &= (_side(place[c], place[d], place[a]) > 0) != (_side(place[c], place[d], place[b]) > 0)
    f, c, d = f[across], c[across], d[across]
    ends = [_distance(place[p], place[c], place[d]) for p in (a, b)]
    ends += [_distance(place[p], place[a], place[b]) for p in (c, d)]
    return f, np.min(ends, axis=0) if len(f) else np.zeros(0)


def crossed_by_itself(w: World) -> dict[int, float]:
    """How deep [m] the solid outlines of shapes cross themselves, by shape; lines that hang from them do not count."""
    outline = outline_of(w)
    depth: dict[int, float] = {}
    for e in np.flatnonzero(outline.side[: outline.dynamic[0]] == 1).tolist():
        s = int(outline.shape[outline.edge_a[e]])
        for f, deep in zip(*_crossings(w, outline, e, outline.solid_of >= 0), strict=True):
            if outline.side[f] == 1 and outline.shape[outline.edge_a[f]] == s:
                depth[s] = max(depth.get(s, 0.0), float(deep))
    return depth


def overlaps(w: World) -> Found:
    """All overlaps: crossings of edges, and particles of solid bodies inside others."""
    outline = outline_of(w)
    solid, place = outline.solid_of >= 0, w.position
    depth: dict[tuple[int, int], float] = {}
    lines = 0

    def note(s: int, t: int, deep: float) -> None:
        key = (min(s, t), max(s, t))
        depth[key] = max(depth.get(key, 0.0), deep)

    for e in range(outline.dynamic[0]):
        s = int(outline.shape[outline.edge_a[e]])
        for f, deep in zip(*_crossings(w, outline, e, solid), strict=True):
            t = int(outline.shape[outline.edge_a[f]])
            if solid[s] and solid[t]:
                note(s, t, float(deep / w.radius[outline.edge_a[e]]))
            else:
                lines += 1
    for first, last in outline.solid[: outline.dynamic[1]]:
        edges = np.arange(first, last)[outline.side[first:last] != 0]
        a, b = outline.edge_a[edges], outline.edge_b[edges]
        t = int(outline.shape[a[0]])
        for p in outline.member[(outline.shape[outline.member] != t) & solid[outline.shape[outline.member]]]:
            below, above = place[a, 1] <= place[p, 1], place[b, 1] > place[p, 1]
            left = _side(place[a], place[b], place[p]) > 0
            if np.sum(below & above & left) - np.sum(~below & ~above & ~left) > 0:
                deep = _distance(place[p], place[a], place[b]).min()
                note(int(outline.shape[p]), t, float(deep / w.radius[p]))
    return Found(depth, lines)
