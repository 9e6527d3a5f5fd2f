"""Hollows: ground whose corners point away from a loose disc that lies in it, so that it feels the next edges ahead.

In a hollow the centre of a disc may be anywhere in front of the lines of all its edges at once. So an edge may push
beyond its ends, and those that a disc comes to within a step push when it does. Otherwise the disc would go on along
the line of one edge and come into the next ones, which would then lift it out: at no cost, so that it would gain.
"""

from sandbox.physics.collision.edge_geometry import CORNER
from sandbox.physics.collision.types import Colliders, Contacts, Near
from sandbox.physics.geometry.segment import SHORTEST, closest_on_segment, difference, segment_of, unit
from sandbox.physics.jit import inlined_kernel, inner_kernel

# An edge is looked for so many ways of a step ahead: what a solver does to the way is not foreseen.
AHEAD = 2.0
# What has sunk into the line of an edge by more than this share of the radii is not in front of it.
SUNK = 0.1
# Pieces that do not share a corner are one surface where they come so near to each other, as a share of the radius.
NEAREST = 0.02


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
def is_hollow(p: int, e: int, v: int, colliders: Colliders, near: Near, edges: int) -> bool:
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
    if here + AHEAD * along < 0.0 or met > 1.0 or not is_hollow(p, e, v, colliders, near, edges):
        return False, 0.0, 0.0, 0.0, False
    return True, nx, ny, gap, met >= 0.0


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
def _put_in_order(wx: float, wy: float, begin: int, end: int, contacts: Contacts) -> None:
    # The edges of a hollow as the way w meets them.
    for i in range(begin + 1, end):
        for j in range(i, begin, -1):
            here = wx * contacts.normal[j, 0] + wy * contacts.normal[j, 1]
            if here <= wx * contacts.normal[j - 1, 0] + wy * contacts.normal[j - 1, 1]:
                break
            _swap(j - 1, j, contacts)


@inner_kernel
def go_on_ahead(wx: float, wy: float, begin: int, end: int, contacts: Contacts) -> None:
    """Put a disc's contacts begin..end with edges of one owner in order, where its way w leads from one to the next."""
    comes = False
    for c in range(begin, end):
        # Where it has sunk into what carries it, it may have into the line of the next edge.
        contacts.gap[c] = max(0.0, contacts.gap[c]) if contacts.ahead[c] else contacts.gap[c]
        contacts.ahead[c] = contacts.ahead[c] or (contacts.gap[c] > 0.0 and end > begin + 1)
        comes = comes or contacts.ahead[c]
    if comes:
        _put_in_order(wx, wy, begin, end, contacts)
