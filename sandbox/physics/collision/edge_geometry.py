"""Places of particles relative to edges: normals, the owner of a corner, the inside of an outline."""

import math

from sandbox.physics.arrays import FloatRows, SlotRows
from sandbox.physics.collision.types import Colliders
from sandbox.physics.geometry.polygon import winding_of_side
from sandbox.physics.geometry.segment import difference, doubled_area, unit
from sandbox.physics.jit import inlined_kernel, inner_kernel

# Parts of an edge by which a path may miss it: a path through a corner meets one of the two edges.
CORNER = 1e-9


@inlined_kernel
def time_to_circle(dx: float, dy: float, wx: float, wy: float, reach: float) -> float:
    """Part of the way w from d at which the origin is first `reach` [m] away; 2 where it never is."""
    squared = wx * wx + wy * wy
    along = dx * wx + dy * wy
    if not (squared > 0.0 and along < 0.0):
        return 2.0
    inside = along * along - squared * (dx * dx + dy * dy - reach * reach)
    if inside < 0.0:
        return 2.0
    when = (-along - math.sqrt(inside)) / squared
    return when if when >= 0.0 else 2.0


@inner_kernel
def edge_normal(e: int, colliders: Colliders) -> tuple[float, float]:
    """Unit normal on the right of the edge, away from the solid side."""
    dx, dy = difference(colliders.edge_a[e], colliders.edge_b[e], colliders.position)
    return unit(dy, -dx)


@inner_kernel
def end_of(e: int, region: int, colliders: Colliders) -> int:
    """The vertex at which an edge ends, by the region beyond it that a place is in: -1 or 1."""
    return colliders.edge_a[e] if region < 0 else colliders.edge_b[e]


@inner_kernel
def is_covered(e: int, v: int, x: float, y: float, colliders: Colliders) -> bool:
    """Whether an edge that meets vertex v, but for e (-1: any), has a place nearer to (x, y) than that."""
    vx = colliders.position[v, 0]
    vy = colliders.position[v, 1]
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        f = colliders.edge_of[at]
        if f == e:
            continue
        other = colliders.edge_a[f] if colliders.edge_a[f] != v else colliders.edge_b[f]
        dx = colliders.position[other, 0] - vx
        dy = colliders.position[other, 1] - vy
        if (x - vx) * dx + (y - vy) * dy > CORNER * (dx * dx + dy * dy):
            return True
    return False


@inner_kernel
def owns_corner(e: int, v: int, x: float, y: float, colliders: Colliders) -> bool:
    """Whether (x, y) is nearer to vertex v than to any other place of its edges, and e is the first of those."""
    if colliders.edge_of[colliders.edge_start[v]] != e:
        return False
    return not is_covered(-1, v, x, y, colliders)


@inner_kernel
def corner_normal(v: int, colliders: Colliders) -> tuple[float, float]:
    """Sum of the normals of the solid edges that meet in a vertex."""
    nx = 0.0
    ny = 0.0
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        e = colliders.edge_of[at]
        if colliders.side[e] != 0:
            ex, ey = edge_normal(e, colliders)
            nx += ex
            ny += ey
    return unit(nx, ny)


@inner_kernel
def place_on(e: int, share: float, axis: int, colliders: Colliders) -> float:
    """A coordinate [m] of the place at a share of an edge."""
    a = colliders.position[colliders.edge_a[e], axis]
    return a + share * (colliders.position[colliders.edge_b[e], axis] - a)


@inner_kernel
def winds(x: float, y: float, first: int, last: int, colliders: Colliders) -> int:
    """How often solid edges first..last run round a place."""
    winding = 0
    for e in range(first, last):
        ax, ay = colliders.position[colliders.edge_a[e], 0], colliders.position[colliders.edge_a[e], 1]
        bx, by = colliders.position[colliders.edge_b[e], 0], colliders.position[colliders.edge_b[e], 1]
        if (ay <= y) != (by <= y) and colliders.side[e] != 0:
            winding += winding_of_side(ay <= y, by <= y, doubled_area(ax, ay, bx, by, x, y))
    return winding


@inner_kernel
def is_enclosed(p: int, k: int, solid: SlotRows, bounds: FloatRows, colliders: Colliders) -> bool:
    """Whether particle p is inside the solid edges of span k."""
    winding = winds(colliders.position[p, 0], colliders.position[p, 1], solid[k, 0], solid[k, 1], colliders)
    # A hollow chain runs the other way round: nothing is counted outside it, -1 inside.
    return winding == 0 if bounds[k, 4] > 0.0 else winding > 0


@inner_kernel
def is_in(p: int, owner: int, solid: SlotRows, bounds: FloatRows, colliders: Colliders) -> bool:
    """Whether particle p is inside the solid edges of that owner."""
    for k in range(solid.shape[0]):
        if colliders.owner[colliders.edge_a[solid[k, 0]]] == owner:
            return is_enclosed(p, k, solid, bounds, colliders)
    return False


@inner_kernel
def is_behind(p: int, e: int, signed: float, region: int, colliders: Colliders) -> bool:
    """Whether a particle is behind a solid edge, to which it lies so."""
    if region == 0:
        return signed < 0.0
    v = end_of(e, region, colliders)
    nx, ny = corner_normal(v, colliders)
    return (colliders.position[p, 0] - colliders.position[v, 0]) * nx + (
        colliders.position[p, 1] - colliders.position[v, 1]
    ) * ny < 0.0
