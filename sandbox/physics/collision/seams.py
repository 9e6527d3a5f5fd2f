"""Seams: corners that are none, since the surface goes on beside them; a body that glides over one must not feel it."""

import math

from sandbox.physics.collision.edge_geometry import is_covered
from sandbox.physics.collision.hollows import is_hollow
from sandbox.physics.collision.types import Colliders, Near
from sandbox.physics.geometry.segment import SHORTEST, segment_of
from sandbox.physics.jit import inner_kernel

# A corner that stands out of another surface by less than this share of the radius of what touches it, where it lies on
# that surface or so many shares beside its end, is a seam of that: nothing touches it there. Higher swallows steps.
SEAM_HEIGHT = 0.002
SEAM_GAP = 0.02


@inner_kernel
def is_seam(p: int, e: int, v: int, x: float, y: float, colliders: Colliders, near: Near, edges: int) -> bool:
    """Whether corner v of edge e is none for particle p at (x, y), as another edge that is near holds it there.

    The corner lies in or under the surface of that edge, and (x, y) over it.
    """
    height = SEAM_HEIGHT * colliders.radius[p]
    slack = SEAM_GAP * colliders.radius[p]
    vx = colliders.position[v, 0]
    vy = colliders.position[v, 1]
    for j in range(edges):
        f = near.edge[j]
        a = colliders.edge_a[f]
        b = colliders.edge_b[f]
        if f == e or a == v or b == v:
            continue
        ax, ay, dx, dy = segment_of(a, b, colliders.position)
        squared = dx * dx + dy * dy
        if not squared > SHORTEST:
            continue
        length = math.sqrt(squared)
        # As in `closest_on_segment`: where that sees a place beside an edge, so does this.
        share = ((x - ax) * dx + (y - ay) * dy) / squared
        if share <= 0.0 or share >= 1.0:
            continue
        foot = ((vx - ax) * dx + (vy - ay) * dy) / length
        if foot < -slack or foot > length + slack:
            continue
        above = (x - ax) * dy - (y - ay) * dx
        out = ((vx - ax) * dy - (vy - ay) * dx) / length
        if above < 0.0:
            if colliders.side[f] != 0:
                continue
            out = -out
        if out + colliders.radius[v] - colliders.radius[a] <= height:
            return True
    return False


@inner_kernel
def passes_beside(
    p: int, i: int, gap: float, wx: float, wy: float, colliders: Colliders, near: Near, edges: int
) -> bool:
    """Whether particle p, on its way w, comes to the line of an edge only beyond its end, over what goes on there.

    i: which of the edges that it is near; gap [m]: to that edge.
    """
    e = near.edge[i]
    a = colliders.edge_a[e]
    b = colliders.edge_b[e]
    ax, ay, dx, dy = segment_of(a, b, colliders.position)
    squared = dx * dx + dy * dy
    # w . n of the normal towards p, times its distance
    px = colliders.position[p, 0] - ax - near.share[i] * dx
    py = colliders.position[p, 1] - ay - near.share[i] * dy
    approach = -(wx * px + wy * py)
    if not (approach > 0.0 and squared > SHORTEST):
        return False
    when = gap * near.distance[i] / approach
    share = near.share[i] + when * (wx * dx + wy * dy) / squared
    if 0.0 <= share <= 1.0:
        return False
    v = a if share < 0.0 else b
    x = colliders.position[p, 0] + when * wx
    y = colliders.position[p, 1] + when * wy
    goes_on = is_covered(e, v, x, y, colliders) or is_seam(p, e, v, x, y, colliders, near, edges)
    return goes_on and not is_hollow(p, e, v, colliders, near, edges)
