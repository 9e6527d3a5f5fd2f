"""Narrow phase: where a particle, a disc, touches or is about to touch discs and edges, and along which direction.

Of what is solid only the outside pushes: a particle whose nearest place of an outline is seen from behind is inside,
and is pushed out there. What moves fast is followed along its way, and meets what stands first in it.
"""

import math

from sandbox.physics.collision.types import MOST_NEAR
from sandbox.physics.equation import SHORTEST
from sandbox.physics.jit import inlined_kernel, inner_kernel

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


@inlined_kernel
def may_touch(p, v, shapes):  # type: ignore[no-untyped-def]
    """Whether the groups of two vertices let them touch."""
    return shapes.collides[p] & shapes.group[v] != 0 and shapes.collides[v] & shapes.group[p] != 0


@inlined_kernel
def are_joined(p, v, shapes):  # type: ignore[no-untyped-def]
    """Whether a spring joins two particles."""
    found = False
    for at in range(shapes.near_start[p], shapes.near_start[p + 1]):
        if shapes.near_of[at] == v:
            found = True
    return found


@inlined_kernel
def add_contact(count, contacts, p, feature, a, b, share, nx, ny, gap, surface, shapes):  # type: ignore[no-untyped-def]
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
        contacts.friction[count] = math.sqrt(shapes.friction[p] * shapes.friction[surface])
        contacts.restitution[count] = max(shapes.restitution[p], shapes.restitution[surface])
    return count + 1


@inlined_kernel
def touch_disc(p, q, h, shapes, contacts, count):  # type: ignore[no-untyped-def]
    """Contact of two discs, if there is one; the number of contacts then."""
    if shapes.inverse[p] + shapes.inverse[q] == 0.0 or not may_touch(p, q, shapes):
        return count
    if shapes.owner[p] == shapes.owner[q] or are_joined(p, q, shapes):
        return count
    dx = shapes.place[p, 0] - shapes.place[q, 0]
    dy = shapes.place[p, 1] - shapes.place[q, 1]
    wx = h * (shapes.motion[p, 0] - shapes.motion[q, 0])
    wy = h * (shapes.motion[p, 1] - shapes.motion[q, 1])
    reach = shapes.radius[p] + shapes.radius[q]
    distance = math.sqrt(dx * dx + dy * dy)
    travel = math.sqrt(wx * wx + wy * wy)
    gap = distance - reach
    if travel > FAST * reach and gap > MARGIN * reach:
        when = _meets_circle(dx, dy, wx, wy, reach)
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
    return add_contact(count, contacts, p, 3 * q + DISC, q, -1, 0.0, nx, ny, gap, q, shapes)


@inlined_kernel
def _meets_circle(dx, dy, wx, wy, reach):  # type: ignore[no-untyped-def]
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
def look_at(p, e, shapes, near, count):  # type: ignore[no-untyped-def]
    """Note where the particle lies to an edge that it may touch; the number of edges noted then."""
    a = shapes.edge_a[e]
    b = shapes.edge_b[e]
    if count >= MOST_NEAR or a == p or b == p or not may_touch(p, a, shapes):
        return count
    if shapes.inverse[p] + shapes.inverse[a] + shapes.inverse[b] == 0.0:
        return count
    own = shapes.owner[a] == shapes.owner[p]
    # A tangled jelly would be kept so by its own edges.
    if own and (shapes.tangled[p] or shapes.edge_start[p] == shapes.edge_start[p + 1]):
        return count
    if are_joined(p, a, shapes) or are_joined(p, b, shapes):
        return count
    if own:
        reach = OWN_REACH * (shapes.radius[p] + shapes.radius[a])
        _, distance, _, _ = closest(p, a, b, shapes.origin)
        if distance <= reach:
            return count
    near.edge[count] = e
    share, distance, signed, region = closest(p, a, b, shapes.place)
    near.share[count] = share
    near.distance[count] = distance
    near.signed[count] = signed
    near.region[count] = region
    return count + 1


@inner_kernel
def closest(p, a, b, place):  # type: ignore[no-untyped-def]
    """Place along the edge a b that is closest to p, distance, signed distance (right of the edge: above 0), region."""
    dx = place[b, 0] - place[a, 0]
    dy = place[b, 1] - place[a, 1]
    px = place[p, 0] - place[a, 0]
    py = place[p, 1] - place[a, 1]
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
def _edge_normal(e, shapes):  # type: ignore[no-untyped-def]
    # Unit normal on the right of the edge, away from what is solid.
    dx = shapes.place[shapes.edge_b[e], 0] - shapes.place[shapes.edge_a[e], 0]
    dy = shapes.place[shapes.edge_b[e], 1] - shapes.place[shapes.edge_a[e], 1]
    length = math.sqrt(dx * dx + dy * dy)
    if length > SHORTEST:
        return dy / length, -dx / length
    return 0.0, 1.0


@inner_kernel
def _end_of(e, region, shapes):  # type: ignore[no-untyped-def]
    return shapes.edge_a[e] if region < 0 else shapes.edge_b[e]


@inner_kernel
def _owns_corner(e, v, x, y, shapes):  # type: ignore[no-untyped-def]
    # Whether (x, y) is nearer to vertex v than to any other place of its edges, and e is the first of those.
    first = shapes.edge_start[v]
    if shapes.edge_of[first] != e:
        return False
    vx = shapes.place[v, 0]
    vy = shapes.place[v, 1]
    for at in range(first, shapes.edge_start[v + 1]):
        other = shapes.edge_a[shapes.edge_of[at]]
        if other == v:
            other = shapes.edge_b[shapes.edge_of[at]]
        dx = shapes.place[other, 0] - vx
        dy = shapes.place[other, 1] - vy
        if (x - vx) * dx + (y - vy) * dy > CORNER * (dx * dx + dy * dy):
            return False
    return True


@inner_kernel
def _corner_normal(v, shapes):  # type: ignore[no-untyped-def]
    # Sum of the normals of the solid edges that meet in a vertex.
    nx = 0.0
    ny = 0.0
    for at in range(shapes.edge_start[v], shapes.edge_start[v + 1]):
        e = shapes.edge_of[at]
        if shapes.side[e] != 0:
            ex, ey = _edge_normal(e, shapes)
            nx += ex
            ny += ey
    length = math.sqrt(nx * nx + ny * ny)
    if length > SHORTEST:
        return nx / length, ny / length
    return 0.0, 1.0


@inner_kernel
def _winds(x, y, first, last, shapes):  # type: ignore[no-untyped-def]
    # How often solid edges run round a place: a ray to the right crosses one that has it on its left going up, or on
    # its right going down.
    winding = 0
    for e in range(first, last):
        a = shapes.edge_a[e]
        b = shapes.edge_b[e]
        below = shapes.place[a, 1] <= y
        if below == (shapes.place[b, 1] <= y) or shapes.side[e] == 0:
            continue
        dx = shapes.place[b, 0] - shapes.place[a, 0]
        dy = shapes.place[b, 1] - shapes.place[a, 1]
        right = (x - shapes.place[a, 0]) * dy - (y - shapes.place[a, 1]) * dx
        if below and right < 0.0:
            winding += 1
        elif not below and right > 0.0:
            winding -= 1
    return winding


@inner_kernel
def is_enclosed(p, k, solid, bounds, shapes):  # type: ignore[no-untyped-def]
    """Whether particle p is inside the solid edges of span k."""
    winding = _winds(shapes.place[p, 0], shapes.place[p, 1], solid[k, 0], solid[k, 1], shapes)
    # A hollow chain runs the other way round: nothing is counted outside it, -1 inside.
    return winding == 0 if bounds[k, 4] > 0.0 else winding > 0


@inner_kernel
def _is_in(p, owner, solid, bounds, shapes):  # type: ignore[no-untyped-def]
    # Whether particle p is inside the solid edges of that owner.
    for k in range(solid.shape[0]):
        if shapes.owner[shapes.edge_a[solid[k, 0]]] == owner:
            return is_enclosed(p, k, solid, bounds, shapes)
    return False


@inner_kernel
def touch_edges(p, h, shapes, near, edges, solid, bounds, dynamic, contacts, count):  # type: ignore[no-untyped-def]
    """Contacts of a particle with the edges noted, owner by owner; the number of contacts then."""
    for i in range(edges):
        owner = shapes.owner[shapes.edge_a[near.edge[i]]]
        nearest = i
        seen = False
        for j in range(edges):
            if shapes.owner[shapes.edge_a[near.edge[j]]] == owner:
                if j < i:
                    seen = True
                    break
                if near.distance[j] < near.distance[nearest]:
                    nearest = j
        if seen:
            continue
        # Where an outline is folded, the edge that is nearest by itself can be seen from behind outside.
        behind = owner != shapes.owner[p] and _is_behind(p, nearest, shapes, near)
        if behind and _is_in(p, owner, solid, bounds, shapes):
            count = push_out(p, near.edge[nearest], near.share[nearest], near.distance[nearest],
                             near.region[nearest], shapes, dynamic, contacts, count)  # fmt: skip
        else:
            count = _touch_outside(p, h, i, edges, owner, shapes, near, dynamic, contacts, count)
    return count


@inner_kernel
def _is_behind(p, i, shapes, near):  # type: ignore[no-untyped-def]
    e = near.edge[i]
    if shapes.side[e] == 0:
        return False
    if near.region[i] == 0:
        return near.signed[i] < 0.0
    v = _end_of(e, near.region[i], shapes)
    nx, ny = _corner_normal(v, shapes)
    return (shapes.place[p, 0] - shapes.place[v, 0]) * nx + (shapes.place[p, 1] - shapes.place[v, 1]) * ny < 0.0


@inner_kernel
def push_out(p, e, share, distance, region, shapes, dynamic, contacts, count):  # type: ignore[no-untyped-def]
    """Contact of a particle inside a solid body with the edge that is nearest; the number of contacts then."""
    nx, ny = _edge_normal(e, shapes)
    if region != 0:
        nx, ny = _corner_normal(_end_of(e, region, shapes), shapes)
    reach = shapes.radius[p] + shapes.radius[shapes.edge_a[e]]
    return _touch_edge(p, e, share, nx, ny, -distance - reach, shapes, dynamic, contacts, count)


@inner_kernel
def _touch_edge(p, e, share, nx, ny, gap, shapes, dynamic, contacts, count):  # type: ignore[no-untyped-def]
    a = shapes.edge_a[e]
    if e < dynamic:
        return add_contact(
            count, contacts, p, 3 * shapes.number[e] + EDGE, a, shapes.edge_b[e], share, nx, ny, gap, a, shapes
        )
    return add_contact(count, contacts, p, 3 * shapes.number[e] + TERRAIN, -1, -1, share, nx, ny, gap, a, shapes)


@inner_kernel
def _touch_outside(p, h, first, edges, owner, shapes, near, dynamic, contacts, count):  # type: ignore[no-untyped-def]
    # Every edge of the owner that is close, and the first one in the way of a fast particle.
    soonest = 2.0
    met = -1
    met_share = 0.0
    met_x = 0.0
    met_y = 0.0
    met_gap = 0.0
    for j in range(first, edges):
        e = near.edge[j]
        a = shapes.edge_a[e]
        b = shapes.edge_b[e]
        if shapes.owner[a] != owner:
            continue
        reach = shapes.radius[p] + shapes.radius[a]
        wx = h * (shapes.motion[p, 0] - 0.5 * (shapes.motion[a, 0] + shapes.motion[b, 0]))
        wy = h * (shapes.motion[p, 1] - 0.5 * (shapes.motion[a, 1] + shapes.motion[b, 1]))
        travel = math.sqrt(wx * wx + wy * wy)
        gap = near.distance[j] - reach
        fast = travel > FAST * reach
        if gap <= MARGIN * reach + (0.0 if fast else travel):
            if shapes.side[e] != 0 and near.signed[j] < 0.0 and near.region[j] == 0:
                continue
            if near.region[j] != 0:
                v = _end_of(e, near.region[j], shapes)
                if not _owns_corner(e, v, shapes.place[p, 0], shapes.place[p, 1], shapes):
                    continue
            if near.distance[j] > SHORTEST:
                nx = (shapes.place[p, 0] - _along(e, near.share[j], 0, shapes)) / near.distance[j]
                ny = (shapes.place[p, 1] - _along(e, near.share[j], 1, shapes)) / near.distance[j]
            else:
                nx, ny = _edge_normal(e, shapes)
            count = _touch_edge(p, e, near.share[j], nx, ny, gap, shapes, dynamic, contacts, count)
        elif fast:
            when, share, nx, ny, gap = _sweep(p, e, wx, wy, reach, near.signed[j], shapes)
            if when < soonest:
                soonest, met, met_share, met_x, met_y, met_gap = when, e, share, nx, ny, gap
    if met >= 0:
        count = _touch_edge(p, met, met_share, met_x, met_y, met_gap, shapes, dynamic, contacts, count)
    return count


@inner_kernel
def _along(e, share, axis, shapes):  # type: ignore[no-untyped-def]
    a = shapes.place[shapes.edge_a[e], axis]
    return a + share * (shapes.place[shapes.edge_b[e], axis] - a)


@inner_kernel
def _sweep(p, e, wx, wy, reach, signed, shapes):  # type: ignore[no-untyped-def]
    # Where the way w of a particle first comes within reach of an edge: when (2: never), share, normal, gap.
    nx, ny = _edge_normal(e, shapes)
    if shapes.side[e] == 0 and signed < 0.0:
        nx, ny, signed = -nx, -ny, -signed
    approach = -(wx * nx + wy * ny)
    x = shapes.place[p, 0]
    y = shapes.place[p, 1]
    a = shapes.edge_a[e]
    dx = shapes.place[shapes.edge_b[e], 0] - shapes.place[a, 0]
    dy = shapes.place[shapes.edge_b[e], 1] - shapes.place[a, 1]
    squared = dx * dx + dy * dy
    if approach > 0.0 and signed >= reach and squared > SHORTEST:
        when = (signed - reach) / approach
        share = ((x + when * wx - shapes.place[a, 0]) * dx + (y + when * wy - shapes.place[a, 1]) * dy) / squared
        if when <= 1.0 and -CORNER <= share <= 1.0 + CORNER:
            return when, min(1.0, max(0.0, share)), nx, ny, signed - reach
    soonest = 2.0
    found = 0.0
    gap = 0.0
    if reach > 0.0:
        for end in range(2):
            v = a if end == 0 else shapes.edge_b[e]
            vx = x - shapes.place[v, 0]
            vy = y - shapes.place[v, 1]
            when = _meets_circle(vx, vy, wx, wy, reach)
            if when <= 1.0 and when < soonest and _owns_corner(e, v, x + when * wx, y + when * wy, shapes):
                soonest = when
                found = float(end)
                nx = (vx + when * wx) / reach
                ny = (vy + when * wy) / reach
                gap = -when * (wx * nx + wy * ny)
    return soonest, found, nx, ny, gap
