"""Edges as a particle meets them: which vertices it feels, and where it lies relative to an edge or an outline.

A ghost vertex is a corner that is none, since the surface goes on beside it: a body that glides over one must not feel
it. At a concave vertex the ground points away from a loose disc, whose centre may be in front of the lines of all its
edges at once. So an edge may push beyond its ends, and those that a disc comes to within a step push when it does.
Otherwise the disc would go on along the line of one edge and come into the next ones, which would then lift it out: at
no cost, so that it would gain.
"""

import math

from sandbox.physics.arrays import FloatRows, SlotRows
from sandbox.physics.collision.types import Colliders, Contacts, Near
from sandbox.physics.geometry.segment import (
    SHORTEST,
    closest_on_segment,
    difference,
    doubled_area,
    segment_of,
    unit,
    winding_of_side,
)
from sandbox.physics.jit import inlined_kernel, inner_kernel

# A corner that stands out of another surface by less than this share of the radius of what touches it, where it lies on
# that surface or so many shares beside its end, is a seam of that: nothing touches it there. Higher swallows steps.
GHOST_HEIGHT = 0.002
GHOST_GAP = 0.02
# An edge is looked for so many ways of a step ahead: what a solver does to the way is not foreseen.
AHEAD = 2.0
# What has sunk into the line of an edge by more than this share of the radii is not in front of it.
SUNK = 0.1
# Pieces that do not share a corner are one surface where they come so near to each other, as a share of the radius.
NEAREST = 0.02
# Parts of an edge by which a path may miss it: a path through a corner meets one of the two edges.
CORNER = 1e-9


@inner_kernel
def passes_beside(
    p: int, i: int, gap: float, wx: float, wy: float, colliders: Colliders, near: Near, edges: int
) -> bool:
    """Whether particle p, on its way w, comes to the line of an edge only beyond its end, over what goes on there.

    i: which of the edges that it is near; gap [m]: to that edge.
    """
    e = near.edge[i]
    a, b = colliders.edge_a[e], colliders.edge_b[e]
    ax, ay, dx, dy = segment_of(a, b, colliders.position)
    squared = dx * dx + dy * dy
    # w . n of the normal towards p, times its distance
    px, py = colliders.position[p, 0] - ax - near.share[i] * dx, colliders.position[p, 1] - ay - near.share[i] * dy
    approach = -(wx * px + wy * py)
    if not (approach > 0.0 and squared > SHORTEST):
        return False
    when = gap * near.distance[i] / approach
    share = near.share[i] + when * (wx * dx + wy * dy) / squared
    if 0.0 <= share <= 1.0:
        return False
    v = a if share < 0.0 else b
    x, y = colliders.position[p, 0] + when * wx, colliders.position[p, 1] + when * wy
    goes_on = is_covered(e, v, x, y, colliders) or is_ghost_vertex(p, e, v, x, y, colliders, near, edges)
    return goes_on and not _is_concave(p, e, v, colliders, near, edges)


@inner_kernel
def is_ghost_vertex(p: int, e: int, v: int, x: float, y: float, colliders: Colliders, near: Near, edges: int) -> bool:
    """Whether corner v of edge e is none for particle p at (x, y), as another edge that is near holds it there.

    The corner lies in or under the surface of that edge, and (x, y) over it.
    """
    height = GHOST_HEIGHT * colliders.radius[p]
    slack = GHOST_GAP * colliders.radius[p]
    vx, vy = colliders.position[v, 0], colliders.position[v, 1]
    for j in range(edges):
        f = near.edge[j]
        a, b = colliders.edge_a[f], colliders.edge_b[f]
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
def _is_concave(p: int, e: int, v: int, colliders: Colliders, near: Near, edges: int) -> bool:
    """Whether what goes on at end v of an edge rises towards p, a loose disc, or goes on straight."""
    if not is_loose(p, colliders):
        return False
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        f = colliders.edge_of[at]
        o = colliders.edge_a[f] if colliders.edge_a[f] != v else colliders.edge_b[f]
        if f != e and _opens(p, e, v, f, o, colliders):
            return True
    slack = NEAREST * colliders.radius[p]
    for j in range(edges):
        f = near.edge[j]
        a, b = colliders.edge_a[f], colliders.edge_b[f]
        if f == e or a == v or b == v:
            continue
        _, distance, _, _ = closest_on_segment(v, a, b, colliders.position)
        if distance <= slack and (_opens(p, e, v, f, a, colliders) or _opens(p, e, v, f, b, colliders)):
            return True
    return False


@inner_kernel
def _opens(p: int, e: int, v: int, f: int, o: int, colliders: Colliders) -> bool:
    # Whether edge f, one end of which is o, and e, which ends at v, lie in front of each other, as p sees them.
    far = colliders.edge_a[e] if colliders.edge_b[e] == v else colliders.edge_b[e]
    ex, ey = difference(v, far, colliders.position)
    fx, fy = difference(colliders.edge_a[f], colliders.edge_b[f], colliders.position)
    px, py = difference(v, p, colliders.position)
    ox, oy = difference(v, o, colliders.position)
    qx, qy = difference(colliders.edge_a[f], p, colliders.position)
    rx, ry = difference(colliders.edge_a[f], far, colliders.position)
    least = CORNER * (ex * ex + ey * ey + fx * fx + fy * fy)
    of_e = ex * oy - ey * ox
    of_f = fx * ry - fy * rx
    if ex * py - ey * px < 0.0:
        of_e = -of_e
    if fx * qy - fy * qx < 0.0:
        of_f = -of_f
    # Where both are one straight line, o is beyond v.
    return of_e >= -least and of_f >= -least and (of_e > least or ex * ox + ey * oy <= 0.0)


@inlined_kernel
def is_loose(p: int, colliders: Colliders) -> bool:
    """Whether no spring joins a particle to another."""
    return colliders.near_start[p] == colliders.near_start[p + 1]


@inner_kernel
def rises_ahead(
    p: int, i: int, wx: float, wy: float, colliders: Colliders, near: Near, edges: int
) -> tuple[bool, float, float, float, bool]:
    """Whether an edge of a hollow, beyond an end of which particle p lies, comes in its way w on that.

    i: which of the edges that it is near. Then its normal, the gap [m] to its line, and whether it is hit itself.
    """
    e = near.edge[i]
    a, b = colliders.edge_a[e], colliders.edge_b[e]
    _, _, dx, dy = segment_of(a, b, colliders.position)
    squared = dx * dx + dy * dy
    signed = near.signed[i]
    if not squared > SHORTEST or (signed < 0.0 and colliders.side[e] != 0):
        return False, 0.0, 0.0, 0.0, False
    nx, ny = unit(dy, -dx)
    if signed < 0.0:
        nx, ny, signed = -nx, -ny, -signed
    approach = -(wx * nx + wy * ny)
    reach = colliders.radius[p] + colliders.radius[a]
    gap = signed - reach
    if not approach > 0.0 or gap < -SUNK * reach or gap > AHEAD * approach:
        return False, 0.0, 0.0, 0.0, False
    # Along the edge from the end that p is beyond: where it is, may come to, and would meet the line.
    v = a if near.region[i] < 0 else b
    sign = 1.0 if near.region[i] < 0 else -1.0
    here = sign * ((colliders.position[p, 0] - colliders.position[v, 0]) * dx
                   + (colliders.position[p, 1] - colliders.position[v, 1]) * dy) / squared  # fmt: skip
    along = sign * (wx * dx + wy * dy) / squared
    met = here + max(0.0, gap) / approach * along
    if here + AHEAD * along < 0.0 or met > 1.0 or not _is_concave(p, e, v, colliders, near, edges):
        return False, 0.0, 0.0, 0.0, False
    return True, nx, ny, gap, met >= 0.0


@inner_kernel
def put_ahead_in_order(wx: float, wy: float, begin: int, end: int, contacts: Contacts) -> None:
    """Put a disc's contacts begin..end with edges of one owner in order, where its way w leads from one to the next."""
    comes = False
    for c in range(begin, end):
        # Where it has sunk into what carries it, it may have into the line of the next edge.
        contacts.gap[c] = max(0.0, contacts.gap[c]) if contacts.ahead[c] else contacts.gap[c]
        contacts.ahead[c] = contacts.ahead[c] or (contacts.gap[c] > 0.0 and end > begin + 1)
        comes = comes or contacts.ahead[c]
    if not comes:
        return
    for i in range(begin + 1, end):
        for j in range(i, begin, -1):
            here = wx * contacts.normal[j, 0] + wy * contacts.normal[j, 1]
            if here <= wx * contacts.normal[j - 1, 0] + wy * contacts.normal[j - 1, 1]:
                break
            _swap(j - 1, j, contacts)


@inner_kernel
def _swap(i: int, j: int, contacts: Contacts) -> None:
    # Two contacts of one particle.
    c = contacts
    c.feature[i], c.feature[j] = c.feature[j], c.feature[i]
    c.end_a[i], c.end_a[j] = c.end_a[j], c.end_a[i]
    c.end_b[i], c.end_b[j] = c.end_b[j], c.end_b[i]
    c.share[i], c.share[j] = c.share[j], c.share[i]
    c.gap[i], c.gap[j] = c.gap[j], c.gap[i]
    c.friction[i], c.friction[j] = c.friction[j], c.friction[i]
    c.restitution[i], c.restitution[j] = c.restitution[j], c.restitution[i]
    c.rolling[i], c.rolling[j] = c.rolling[j], c.rolling[i]
    c.ahead[i], c.ahead[j] = c.ahead[j], c.ahead[i]
    for k in range(2):
        c.normal[i, k], c.normal[j, k] = c.normal[j, k], c.normal[i, k]


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
def place_on(e: int, share: float, axis: int, colliders: Colliders) -> float:
    """A coordinate [m] of the place at a share of an edge."""
    a = colliders.position[colliders.edge_a[e], axis]
    return a + share * (colliders.position[colliders.edge_b[e], axis] - a)


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
def is_covered(e: int, v: int, x: float, y: float, colliders: Colliders) -> bool:
    """Whether an edge that meets vertex v, but for e (-1: any), has a place nearer to (x, y) than that."""
    vx, vy = colliders.position[v, 0], colliders.position[v, 1]
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        f = colliders.edge_of[at]
        if f == e:
            continue
        other = colliders.edge_a[f] if colliders.edge_a[f] != v else colliders.edge_b[f]
        dx, dy = colliders.position[other, 0] - vx, colliders.position[other, 1] - vy
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
    nx, ny = 0.0, 0.0
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        e = colliders.edge_of[at]
        if colliders.side[e] != 0:
            ex, ey = edge_normal(e, colliders)
            nx += ex
            ny += ey
    return unit(nx, ny)


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


@inner_kernel
def is_in(p: int, owner: int, solid: SlotRows, bounds: FloatRows, colliders: Colliders) -> bool:
    """Whether particle p is inside the solid edges of that owner."""
    for k in range(solid.shape[0]):
        if colliders.owner[colliders.edge_a[solid[k, 0]]] == owner:
            return is_enclosed(p, k, solid, bounds, colliders)
    return False


@inner_kernel
def is_enclosed(p: int, k: int, solid: SlotRows, bounds: FloatRows, colliders: Colliders) -> bool:
    """Whether particle p is inside the solid edges of span k."""
    winding = winds(colliders.position[p, 0], colliders.position[p, 1], solid[k, 0], solid[k, 1], colliders)
    # A hollow chain runs the other way round: nothing is counted outside it, -1 inside.
    return winding == 0 if bounds[k, 4] > 0.0 else winding > 0


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
