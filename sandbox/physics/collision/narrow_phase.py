"""Narrow phase: where a particle, a disc, touches or is about to touch discs and edges, and along which direction.

Of what is solid only the outside pushes: a particle whose nearest place of an outline is seen from behind is inside,
and is pushed out there. What moves fast is followed along its way, and meets what stands first in it.
"""

import math

from sandbox.physics.collision.types import MOST_NEAR, Colliders, Contacts, Near
from sandbox.physics.equation import SHORTEST
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.state import Floats, Slots

# A contact exists from this gap on, as a share of the radii together, so that what rests keeps its contacts; a larger
# share costs contacts that do nothing, a smaller one lets crowded particles overlap when they are pushed.
MARGIN = 0.1
# What moves by more than this share of the radii in a step is followed along its way.
FAST = 0.5
# Parts of an edge by which a path may miss it: a path through a corner meets one of the two edges.
CORNER = 1e-9
# Particles of one body this many radii apart where they were created, or nearer, never touch each other.
OWN_REACH = 2.0
DISC, EDGE, TERRAIN = 0, 1, 2


@inner_kernel
def are_parting(p: int, v: int, colliders: Colliders) -> bool:
    """Whether two vertices give way to each other in this step, as their shapes part (overlaps.py)."""
    s = min(colliders.shape[p], colliders.shape[v])
    t = max(colliders.shape[p], colliders.shape[v])
    for pair in range(colliders.parted_count[0]):
        if colliders.parted[pair, 0] == s and colliders.parted[pair, 1] == t:
            # A line that is caught in another, or in itself, is let go whatever else of that would hold it.
            if colliders.parted[pair, 2] == 1:
                return colliders.caught[p] or colliders.caught[v]
            return colliders.parting[p] and colliders.parting[v]
    return False


@inlined_kernel
def may_collide(p: int, v: int, colliders: Colliders) -> bool:
    """Whether the groups of two vertices let them touch, and they are not to part."""
    return (
        colliders.collides[p] & colliders.group[v] != 0
        and colliders.collides[v] & colliders.group[p] != 0
        and not (colliders.parted_count[0] > 0 and are_parting(p, v, colliders))
    )


@inlined_kernel
def are_joined(p: int, v: int, colliders: Colliders) -> bool:
    """Whether a spring joins two particles."""
    found = False
    for at in range(colliders.near_start[p], colliders.near_start[p + 1]):
        if colliders.near_of[at] == v:
            found = True
    return found


@inlined_kernel
def add_contact(
    count: int,
    contacts: Contacts,
    p: int,
    feature: int,
    a: int,
    b: int,
    share: float,
    nx: float,
    ny: float,
    gap: float,
    surface: int,
    colliders: Colliders,
) -> int:
    """Append a contact of particle p if there is room; the number of contacts then, counted on where there is none."""
    if count < contacts.particle.shape[0]:
        contacts.particle[count] = p
        contacts.feature[count] = feature
        contacts.end_a[count] = a
        contacts.end_b[count] = b
        contacts.share[count] = share
        contacts.normal[count, 0] = nx
        contacts.normal[count, 1] = ny
        contacts.gap[count] = gap
        # Friction: the geometric mean, so that ice is slippery for all; restitution: the livelier of the two.
        contacts.friction[count] = math.sqrt(colliders.friction[p] * colliders.friction[surface])
        contacts.restitution[count] = max(colliders.restitution[p], colliders.restitution[surface])
        contacts.rolling[count] = max(colliders.rolling[p], colliders.rolling[surface])
    return count + 1


@inlined_kernel
def collide_disc(p: int, q: int, h: float, colliders: Colliders, contacts: Contacts, count: int) -> int:
    """Contact of two discs, if there is one; the number of contacts then."""
    if colliders.inverse_mass[p] + colliders.inverse_mass[q] == 0.0 or not may_collide(p, q, colliders):
        return count
    if colliders.owner[p] == colliders.owner[q] or are_joined(p, q, colliders):
        return count
    dx = colliders.position[p, 0] - colliders.position[q, 0]
    dy = colliders.position[p, 1] - colliders.position[q, 1]
    wx = h * (colliders.velocity[p, 0] - colliders.velocity[q, 0])
    wy = h * (colliders.velocity[p, 1] - colliders.velocity[q, 1])
    if _is_corner_before(p, dx, dy, colliders):
        return count
    reach = colliders.radius[p] + colliders.radius[q]
    distance = math.sqrt(dx * dx + dy * dy)
    travel = math.sqrt(wx * wx + wy * wy)
    gap = distance - reach
    if travel > FAST * reach and gap > MARGIN * reach:
        when = _time_to_circle(dx, dy, wx, wy, reach)
        if when > 1.0 or not reach > 0.0:
            return count
        nx = (dx + when * wx) / reach
        ny = (dy + when * wy) / reach
        gap = -when * (wx * nx + wy * ny)
    else:
        if gap > MARGIN * reach + travel:
            return count
        if distance > SHORTEST:
            nx = dx / distance
            ny = dy / distance
        else:
            nx = 0.0
            ny = 1.0
    return add_contact(count, contacts, p, 3 * q + DISC, q, -1, 0.0, nx, ny, gap, q, colliders)


@inner_kernel
def _is_corner_before(p: int, dx: float, dy: float, colliders: Colliders) -> bool:
    # Whether p is a corner of a solid body, and looks towards d: what lies behind it is inside, and edges push it out.
    for at in range(colliders.edge_start[p], colliders.edge_start[p + 1]):
        if colliders.side[colliders.edge_of[at]] != 0:
            nx, ny = _corner_normal(p, colliders)
            return nx * dx + ny * dy > 0.0
    return False


@inlined_kernel
def _time_to_circle(dx: float, dy: float, wx: float, wy: float, reach: float) -> float:
    # Part of the way w from d at which the origin is first `reach` away; 2 where it never is.
    squared = wx * wx + wy * wy
    along = dx * wx + dy * wy
    if not (squared > 0.0 and along < 0.0):
        return 2.0
    inside = along * along - squared * (dx * dx + dy * dy - reach * reach)
    if inside < 0.0:
        return 2.0
    when = (-along - math.sqrt(inside)) / squared
    return when if when >= 0.0 else 2.0


@inlined_kernel
def find_near(p: int, e: int, colliders: Colliders, near: Near, count: int) -> int:
    """Note where the particle lies to an edge that it may touch; the number of edges noted then."""
    a = colliders.edge_a[e]
    b = colliders.edge_b[e]
    if count >= MOST_NEAR or a == p or b == p or not may_collide(p, a, colliders):
        return count
    if colliders.inverse_mass[p] + colliders.inverse_mass[a] + colliders.inverse_mass[b] == 0.0:
        return count
    own = colliders.owner[a] == colliders.owner[p]
    # An inverted or wound jelly would be kept so by its own edges.
    if own and (colliders.inverted[p] or colliders.edge_start[p] == colliders.edge_start[p + 1]):
        return count
    if are_joined(p, a, colliders) or are_joined(p, b, colliders):
        return count
    if own:
        reach = OWN_REACH * (colliders.radius[p] + colliders.radius[a])
        _, distance, _, _ = closest(p, a, b, colliders.origin)
        if distance <= reach:
            return count
    near.edge[count] = e
    share, distance, signed, region = closest(p, a, b, colliders.position)
    near.share[count] = share
    near.distance[count] = distance
    near.signed[count] = signed
    near.region[count] = region
    return count + 1


@inner_kernel
def closest(p: int, a: int, b: int, position: Floats) -> tuple[float, float, float, int]:
    """Place along the edge a b that is closest to p, distance, signed distance (right of the edge: above 0), region."""
    dx = position[b, 0] - position[a, 0]
    dy = position[b, 1] - position[a, 1]
    px = position[p, 0] - position[a, 0]
    py = position[p, 1] - position[a, 1]
    squared = dx * dx + dy * dy
    if not squared > SHORTEST:
        distance = math.sqrt(px * px + py * py)
        return 0.0, distance, distance, -1
    share = (px * dx + py * dy) / squared
    signed = (px * dy - py * dx) / math.sqrt(squared)
    region = 0
    if share <= 0.0:
        share = 0.0
        region = -1
    elif share >= 1.0:
        share = 1.0
        region = 1
    qx = px - share * dx
    qy = py - share * dy
    return share, math.sqrt(qx * qx + qy * qy), signed, region


@inner_kernel
def edge_normal(e: int, colliders: Colliders) -> tuple[float, float]:
    """Unit normal on the right of the edge, away from what is solid."""
    dx = colliders.position[colliders.edge_b[e], 0] - colliders.position[colliders.edge_a[e], 0]
    dy = colliders.position[colliders.edge_b[e], 1] - colliders.position[colliders.edge_a[e], 1]
    length = math.sqrt(dx * dx + dy * dy)
    if length > SHORTEST:
        return dy / length, -dx / length
    return 0.0, 1.0


@inner_kernel
def _end_of(e: int, region: int, colliders: Colliders) -> int:
    return colliders.edge_a[e] if region < 0 else colliders.edge_b[e]


@inner_kernel
def _owns_corner(e: int, v: int, x: float, y: float, colliders: Colliders) -> bool:
    # Whether (x, y) is nearer to vertex v than to any other place of its edges, and e is the first of those.
    first = colliders.edge_start[v]
    if colliders.edge_of[first] != e:
        return False
    vx = colliders.position[v, 0]
    vy = colliders.position[v, 1]
    for at in range(first, colliders.edge_start[v + 1]):
        other = colliders.edge_a[colliders.edge_of[at]]
        if other == v:
            other = colliders.edge_b[colliders.edge_of[at]]
        dx = colliders.position[other, 0] - vx
        dy = colliders.position[other, 1] - vy
        if (x - vx) * dx + (y - vy) * dy > CORNER * (dx * dx + dy * dy):
            return False
    return True


@inner_kernel
def _corner_normal(v: int, colliders: Colliders) -> tuple[float, float]:
    # Sum of the normals of the solid edges that meet in a vertex.
    nx = 0.0
    ny = 0.0
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        e = colliders.edge_of[at]
        if colliders.side[e] != 0:
            ex, ey = edge_normal(e, colliders)
            nx += ex
            ny += ey
    length = math.sqrt(nx * nx + ny * ny)
    if length > SHORTEST:
        return nx / length, ny / length
    return 0.0, 1.0


@inner_kernel
def winds(x: float, y: float, first: int, last: int, colliders: Colliders) -> int:
    """How often solid edges first..last run round a place."""
    # A ray to the right crosses one that has it on its left going up, or on its right going down.
    winding = 0
    for e in range(first, last):
        a = colliders.edge_a[e]
        b = colliders.edge_b[e]
        below = colliders.position[a, 1] <= y
        if below == (colliders.position[b, 1] <= y) or colliders.side[e] == 0:
            continue
        dx = colliders.position[b, 0] - colliders.position[a, 0]
        dy = colliders.position[b, 1] - colliders.position[a, 1]
        right = (x - colliders.position[a, 0]) * dy - (y - colliders.position[a, 1]) * dx
        if below and right < 0.0:
            winding += 1
        elif not below and right > 0.0:
            winding -= 1
    return winding


@inner_kernel
def is_enclosed(p: int, k: int, solid: Slots, bounds: Floats, colliders: Colliders) -> bool:
    """Whether particle p is inside the solid edges of span k."""
    winding = winds(colliders.position[p, 0], colliders.position[p, 1], solid[k, 0], solid[k, 1], colliders)
    # A hollow chain runs the other way round: nothing is counted outside it, -1 inside.
    return winding == 0 if bounds[k, 4] > 0.0 else winding > 0


@inner_kernel
def _is_in(p: int, owner: int, solid: Slots, bounds: Floats, colliders: Colliders) -> bool:
    # Whether particle p is inside the solid edges of that owner.
    for k in range(solid.shape[0]):
        if colliders.owner[colliders.edge_a[solid[k, 0]]] == owner:
            return is_enclosed(p, k, solid, bounds, colliders)
    return False


@inner_kernel
def collide_edges(
    p: int,
    h: float,
    colliders: Colliders,
    near: Near,
    edges: int,
    solid: Slots,
    bounds: Floats,
    dynamic: int,
    contacts: Contacts,
    count: int,
) -> int:
    """Contacts of a particle with the edges noted, owner by owner; the number of contacts then."""
    for i in range(edges):
        owner = colliders.owner[colliders.edge_a[near.edge[i]]]
        nearest = i
        seen = False
        for j in range(edges):
            if colliders.owner[colliders.edge_a[near.edge[j]]] == owner:
                if j < i:
                    seen = True
                    break
                if near.distance[j] < near.distance[nearest]:
                    nearest = j
        if seen:
            continue
        # Where an outline is folded, the edge that is nearest by itself can be seen from behind outside.
        behind = owner != colliders.owner[p] and _is_behind(p, nearest, colliders, near)
        if behind and _is_in(p, owner, solid, bounds, colliders):
            count = push_out(p, near.edge[nearest], near.share[nearest], near.distance[nearest],
                             near.region[nearest], colliders, dynamic, contacts, count)  # fmt: skip
        else:
            count = _collide_outside(p, h, i, edges, owner, colliders, near, dynamic, contacts, count)
    return count


@inner_kernel
def _is_behind(p: int, i: int, colliders: Colliders, near: Near) -> bool:
    e = near.edge[i]
    if colliders.side[e] == 0:
        return False
    if near.region[i] == 0:
        return near.signed[i] < 0.0
    v = _end_of(e, near.region[i], colliders)
    nx, ny = _corner_normal(v, colliders)
    return (colliders.position[p, 0] - colliders.position[v, 0]) * nx + (
        colliders.position[p, 1] - colliders.position[v, 1]
    ) * ny < 0.0


@inner_kernel
def push_out(
    p: int,
    e: int,
    share: float,
    distance: float,
    region: int,
    colliders: Colliders,
    dynamic: int,
    contacts: Contacts,
    count: int,
) -> int:
    """Contact of a particle inside a solid body with the edge that is nearest; the number of contacts then."""
    nx, ny = edge_normal(e, colliders)
    if region != 0:
        nx, ny = _corner_normal(_end_of(e, region, colliders), colliders)
    reach = colliders.radius[p] + colliders.radius[colliders.edge_a[e]]
    return _add_edge(p, e, share, nx, ny, -distance - reach, colliders, dynamic, contacts, count)


@inner_kernel
def _add_edge(
    p: int,
    e: int,
    share: float,
    nx: float,
    ny: float,
    gap: float,
    colliders: Colliders,
    dynamic: int,
    contacts: Contacts,
    count: int,
) -> int:
    a = colliders.edge_a[e]
    if e < dynamic:
        return add_contact(
            count, contacts, p, 3 * colliders.number[e] + EDGE, a, colliders.edge_b[e], share, nx, ny, gap, a, colliders
        )
    return add_contact(count, contacts, p, 3 * colliders.number[e] + TERRAIN, -1, -1, share, nx, ny, gap, a, colliders)


@inner_kernel
def _collide_outside(
    p: int,
    h: float,
    first: int,
    edges: int,
    owner: int,
    colliders: Colliders,
    near: Near,
    dynamic: int,
    contacts: Contacts,
    count: int,
) -> int:
    # Every edge of the owner that is close, and the first one in the way of a fast particle.
    soonest = 2.0
    met = -1
    met_share = 0.0
    met_x = 0.0
    met_y = 0.0
    met_gap = 0.0
    for j in range(first, edges):
        e = near.edge[j]
        a = colliders.edge_a[e]
        b = colliders.edge_b[e]
        if colliders.owner[a] != owner:
            continue
        reach = colliders.radius[p] + colliders.radius[a]
        wx = h * (colliders.velocity[p, 0] - 0.5 * (colliders.velocity[a, 0] + colliders.velocity[b, 0]))
        wy = h * (colliders.velocity[p, 1] - 0.5 * (colliders.velocity[a, 1] + colliders.velocity[b, 1]))
        travel = math.sqrt(wx * wx + wy * wy)
        gap = near.distance[j] - reach
        fast = travel > FAST * reach
        if gap <= MARGIN * reach + (0.0 if fast else travel):
            if colliders.side[e] != 0 and near.signed[j] < 0.0 and near.region[j] == 0:
                continue
            if near.region[j] != 0:
                v = _end_of(e, near.region[j], colliders)
                if not _owns_corner(e, v, colliders.position[p, 0], colliders.position[p, 1], colliders):
                    continue
            if near.distance[j] > SHORTEST:
                nx = (colliders.position[p, 0] - _along(e, near.share[j], 0, colliders)) / near.distance[j]
                ny = (colliders.position[p, 1] - _along(e, near.share[j], 1, colliders)) / near.distance[j]
            else:
                nx, ny = edge_normal(e, colliders)
            count = _add_edge(p, e, near.share[j], nx, ny, gap, colliders, dynamic, contacts, count)
        elif fast:
            when, share, nx, ny, gap = _sweep_edge(p, e, wx, wy, reach, near.signed[j], colliders)
            if when < soonest:
                soonest, met, met_share, met_x, met_y, met_gap = when, e, share, nx, ny, gap
    if met >= 0:
        count = _add_edge(p, met, met_share, met_x, met_y, met_gap, colliders, dynamic, contacts, count)
    return count


@inner_kernel
def _along(e: int, share: float, axis: int, colliders: Colliders) -> float:
    a = colliders.position[colliders.edge_a[e], axis]
    return a + share * (colliders.position[colliders.edge_b[e], axis] - a)


@inner_kernel
def _sweep_edge(
    p: int, e: int, wx: float, wy: float, reach: float, signed: float, colliders: Colliders
) -> tuple[float, float, float, float, float]:
    # Where the way w of a particle first comes within reach of an edge: when (2: never), share, normal, gap.
    nx, ny = edge_normal(e, colliders)
    if colliders.side[e] == 0 and signed < 0.0:
        nx, ny, signed = -nx, -ny, -signed
    approach = -(wx * nx + wy * ny)
    x = colliders.position[p, 0]
    y = colliders.position[p, 1]
    a = colliders.edge_a[e]
    dx = colliders.position[colliders.edge_b[e], 0] - colliders.position[a, 0]
    dy = colliders.position[colliders.edge_b[e], 1] - colliders.position[a, 1]
    squared = dx * dx + dy * dy
    if approach > 0.0 and signed >= reach and squared > SHORTEST:
        when = (signed - reach) / approach
        share = (
            (x + when * wx - colliders.position[a, 0]) * dx + (y + when * wy - colliders.position[a, 1]) * dy
        ) / squared
        if when <= 1.0 and -CORNER <= share <= 1.0 + CORNER:
            return when, min(1.0, max(0.0, share)), nx, ny, signed - reach
    soonest = 2.0
    found = 0.0
    gap = 0.0
    if reach > 0.0:
        for end in range(2):
            v = a if end == 0 else colliders.edge_b[e]
            vx = x - colliders.position[v, 0]
            vy = y - colliders.position[v, 1]
            when = _time_to_circle(vx, vy, wx, wy, reach)
            if when <= 1.0 and when < soonest and _owns_corner(e, v, x + when * wx, y + when * wy, colliders):
                soonest = when
                found = float(end)
                nx = (vx + when * wx) / reach
                ny = (vy + when * wy) / reach
                gap = -when * (wx * nx + wy * ny)
    return soonest, found, nx, ny, gap
