"""Narrow phase: where a particle, a disc, touches or is about to touch discs and edges, and along which direction.

Only the outside of a solid body pushes: a particle whose nearest place of an outline is seen from behind is inside, and
is pushed out there. What moves fast is followed along its way, and meets what stands first in it.
"""

import math

from sandbox.physics.arrays import FloatRows, SlotRows
from sandbox.physics.collision.ghost_vertices import (
    CORNER,
    corner_normal,
    edge_normal,
    end_of,
    is_behind,
    is_ghost_vertex,
    is_in,
    is_loose,
    owns_corner,
    passes_beside,
    place_on,
    put_ahead_in_order,
    rises_ahead,
    time_to_circle,
)
from sandbox.physics.collision.types import MOST_NEAR, Colliders, Contacts, Near
from sandbox.physics.geometry.segment import SHORTEST, closest_on_segment, difference, segment_of, unit
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.marks import DISC, EDGE, KINDS, TERRAIN

# A contact exists from this gap on, as a share of the radii together, so that what rests keeps its contacts; a larger
# share costs contacts that do nothing, a smaller one lets crowded particles overlap when they are pushed.
MARGIN = 0.1
# What moves by more than this share of the radii in a step is followed along its way.
FAST = 0.5
# Particles of one body this many radii apart where they were created, or nearer, never touch each other.
OWN_REACH = 2.0
# Edges that a fast particle meets one after the other in a step, at most.
MOST_BOUNCES = 4


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
    count: int, contacts: Contacts, p: int, feature: int, a: int, b: int, share: float, nx: float, ny: float,
    gap: float, surface: int, colliders: Colliders,
) -> int:  # fmt: skip
    """Append a contact of particle p if there is room; the number of contacts then, counted on where there is none.

    What cannot move touches nothing that cannot.
    """
    moves = colliders.inverse_mass[p]
    moves += colliders.inverse_mass[a] if a >= 0 else 0.0
    moves += colliders.inverse_mass[b] if b >= 0 else 0.0
    if moves == 0.0:
        return count
    if count < contacts.particle.shape[0]:
        contacts.particle[count] = p
        contacts.feature[count] = feature
        contacts.end_a[count] = a
        contacts.end_b[count] = b
        contacts.share[count] = share
        contacts.normal[count, 0] = nx
        contacts.normal[count, 1] = ny
        contacts.gap[count] = gap
        contacts.ahead[count] = False
        # Friction: the geometric mean, so that ice is slippery for all; restitution: the livelier of the two.
        contacts.friction[count] = math.sqrt(colliders.friction[p] * colliders.friction[surface])
        contacts.restitution[count] = max(colliders.restitution[p], colliders.restitution[surface])
        contacts.rolling[count] = max(colliders.rolling[p], colliders.rolling[surface])
    return count + 1


@inlined_kernel
def _closing(px: float, py: float, qx: float, qy: float, dx: float, dy: float, distance: float) -> float:
    # How far two sides whose ways are p and q come nearer, p from the side that d points to, if something stops either
    # of them within the step.
    if not distance > 0.0:
        return 0.0
    return max(0.0, -(px * dx + py * dy), qx * dx + qy * dy) / distance


@inlined_kernel
def collide_disc(p: int, q: int, h: float, colliders: Colliders, contacts: Contacts, count: int) -> int:
    """Contact of two discs, if there is one; the number of contacts then."""
    if colliders.inverse_mass[p] + colliders.inverse_mass[q] == 0.0 or not may_collide(p, q, colliders):
        return count
    if colliders.owner[p] == colliders.owner[q] or are_joined(p, q, colliders):
        return count
    dx, dy = difference(q, p, colliders.position)
    px, py = h * colliders.velocity[p, 0], h * colliders.velocity[p, 1]
    qx, qy = h * colliders.velocity[q, 0], h * colliders.velocity[q, 1]
    wx, wy = px - qx, py - qy
    if _is_corner_before(p, dx, dy, colliders):
        return count
    reach = colliders.radius[p] + colliders.radius[q]
    distance = math.sqrt(dx * dx + dy * dy)
    travel = math.sqrt(wx * wx + wy * wy)
    gap = distance - reach
    if travel > FAST * reach and gap > MARGIN * reach:
        when = time_to_circle(dx, dy, wx, wy, reach)
        if when > 1.0 or not reach > 0.0:
            return count
        nx, ny = (dx + when * wx) / reach, (dy + when * wy) / reach
        gap = -when * (wx * nx + wy * ny)
    else:
        if gap > MARGIN * reach + max(travel, _closing(px, py, qx, qy, dx, dy, distance)):
            return count
        nx, ny = unit(dx, dy)
    return add_contact(count, contacts, p, KINDS * q + DISC, q, -1, 0.0, nx, ny, gap, q, colliders)


@inner_kernel
def _is_corner_before(p: int, dx: float, dy: float, colliders: Colliders) -> bool:
    # Whether p is a corner of a solid body, and looks towards d: what lies behind it is inside, and edges push it out.
    for at in range(colliders.edge_start[p], colliders.edge_start[p + 1]):
        if colliders.side[colliders.edge_of[at]] != 0:
            nx, ny = corner_normal(p, colliders)
            return nx * dx + ny * dy > 0.0
    return False


@inlined_kernel
def find_near(p: int, e: int, colliders: Colliders, near: Near, count: int) -> int:
    """Note where the particle lies to an edge that it may touch; the number of edges noted then."""
    a, b = colliders.edge_a[e], colliders.edge_b[e]
    if a == p or b == p or not may_collide(p, a, colliders):
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
        _, distance, _, _ = closest_on_segment(p, a, b, colliders.origin)
        if distance <= reach:
            return count
    share, distance, signed, region = closest_on_segment(p, a, b, colliders.position)
    at = count
    if count == MOST_NEAR:
        at = 0
        for i in range(1, count):
            if near.distance[i] > near.distance[at]:
                at = i
        if distance >= near.distance[at]:
            return count
    near.edge[at] = e
    near.share[at] = share
    near.distance[at] = distance
    near.signed[at] = signed
    near.region[at] = region
    return min(MOST_NEAR, count + 1)


@inner_kernel
def collide_edges(
    p: int, h: float, colliders: Colliders, near: Near, edges: int, solid: SlotRows, bounds: FloatRows, dynamic: int,
    contacts: Contacts, count: int,
) -> int:  # fmt: skip
    """Contacts of a particle with the edges noted, owner by owner; the number of contacts then."""
    begun = count
    way_x, way_y = _allowed_way(p, h, colliders, near, edges)
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
        e = near.edge[nearest]
        behind = owner != colliders.owner[p] and colliders.side[e] != 0
        behind = behind and is_behind(p, e, near.signed[nearest], near.region[nearest], colliders)
        if behind and is_in(p, owner, solid, bounds, colliders):
            count = push_out(p, e, near.share[nearest], near.distance[nearest],
                             near.region[nearest], colliders, dynamic, contacts, count)  # fmt: skip
        else:
            count = _collide_outside(
                p, h, way_x, way_y, i, edges, owner, colliders, near, dynamic, contacts, count
            )  # fmt: skip
    return _collide_later(p, h, edges, colliders, near, dynamic, begun, contacts, count)


@inner_kernel
def _collide_later(
    p: int, h: float, edges: int, colliders: Colliders, near: Near, dynamic: int, begun: int, contacts: Contacts,
    count: int,
) -> int:  # fmt: skip
    # What a fast particle meets in the step, one edge that stands after the other, as it bounces off each.
    if colliders.inverse_mass[p] == 0.0:
        return count
    x, y = colliders.position[p, 0], colliders.position[p, 1]
    wx, wy = h * colliders.velocity[p, 0], h * colliders.velocity[p, 1]
    last = -1
    travel = math.sqrt(wx * wx + wy * wy)
    for _ in range(MOST_BOUNCES):
        soonest = 2.0
        met = -1
        met_share, met_x, met_y = 0.0, 0.0, 0.0
        for j in range(edges):
            e = near.edge[j]
            a, b = colliders.edge_a[e], colliders.edge_b[e]
            reach = colliders.radius[p] + colliders.radius[a]
            if e == last or travel <= FAST * reach or colliders.inverse_mass[a] + colliders.inverse_mass[b] > 0.0:
                continue
            ax, ay, dx, dy = segment_of(a, b, colliders.position)
            length = math.sqrt(dx * dx + dy * dy)
            if not length > SHORTEST:
                continue
            px, py = x - ax, y - ay
            signed = (px * dy - py * dx) / length
            when, share, nx, ny, _ = _sweep_edge(p, x, y, e, wx, wy, reach, signed, colliders, near, edges)
            if when < soonest:
                soonest, met, met_share, met_x, met_y = when, e, share, nx, ny
        if met < 0:
            return count
        a = colliders.edge_a[met]
        if not _is_known(met, begun, count, dynamic, colliders, contacts):
            px = colliders.position[p, 0] - place_on(met, met_share, 0, colliders)
            py = colliders.position[p, 1] - place_on(met, met_share, 1, colliders)
            gap = px * met_x + py * met_y - colliders.radius[p] - colliders.radius[a]
            count = _add_edge(p, met, met_share, met_x, met_y, gap, colliders, dynamic, contacts, count)
        restitution = max(colliders.restitution[p], colliders.restitution[a])
        x, y = x + soonest * wx, y + soonest * wy
        wx, wy = (1.0 - soonest) * wx, (1.0 - soonest) * wy
        along = (1.0 + restitution) * (wx * met_x + wy * met_y)
        wx, wy = wx - along * met_x, wy - along * met_y
        last = met
    return count


@inner_kernel
def _is_known(e: int, begun: int, count: int, dynamic: int, colliders: Colliders, contacts: Contacts) -> bool:
    # Whether the particle whose contacts begin there has one with that edge already.
    feature = KINDS * colliders.number[e] + (EDGE if e < dynamic else TERRAIN)
    known = False
    for c in range(begun, min(count, contacts.particle.shape[0])):
        known = known or contacts.feature[c] == feature
    return known


@inlined_kernel
def _allowed_way(p: int, h: float, colliders: Colliders, near: Near, edges: int) -> tuple[float, float]:
    # The way of a particle in a step of h [s], as edges on which it lies let it go, or the corner that is nearest.
    wx, wy = h * colliders.velocity[p, 0], h * colliders.velocity[p, 1]
    nearest = -1
    lies = False
    for _ in range(2):
        was_cut = False
        for j in range(edges):
            a = colliders.edge_a[near.edge[j]]
            reach = colliders.radius[p] + colliders.radius[a]
            if near.distance[j] - reach > MARGIN * reach or not near.distance[j] > SHORTEST:
                continue
            if near.region[j] != 0:
                if nearest < 0 or near.distance[j] < near.distance[nearest]:
                    nearest = j
                continue
            if colliders.side[near.edge[j]] != 0 and near.signed[j] < 0.0:
                continue
            lies = True
            ux, uy = _cut_way(p, j, wx, wy, h, colliders, near)
            was_cut = was_cut or ux != wx or uy != wy
            wx, wy = ux, uy
        if not was_cut:
            break
    if not lies and nearest >= 0:
        wx, wy = _cut_way(p, nearest, wx, wy, h, colliders, near)
    return wx, wy


@inlined_kernel
def _cut_way(p: int, j: int, wx: float, wy: float, h: float, colliders: Colliders, near: Near) -> tuple[float, float]:
    e = near.edge[j]
    a, b = colliders.edge_a[e], colliders.edge_b[e]
    share = near.share[j]
    nx = (colliders.position[p, 0] - place_on(e, share, 0, colliders)) / near.distance[j]
    ny = (colliders.position[p, 1] - place_on(e, share, 1, colliders)) / near.distance[j]
    ux = wx - h * ((1.0 - share) * colliders.velocity[a, 0] + share * colliders.velocity[b, 0])
    uy = wy - h * ((1.0 - share) * colliders.velocity[a, 1] + share * colliders.velocity[b, 1])
    gap = near.distance[j] - colliders.radius[p] - colliders.radius[a]
    missing = -(ux * nx + uy * ny) - max(0.0, gap)
    if missing > 0.0:
        return wx + missing * nx, wy + missing * ny
    return wx, wy


@inner_kernel
def leave_out(owner: int, colliders: Colliders, near: Near, edges: int) -> int:
    """Strike an owner's edges off the list that a particle is near; how many are left."""
    left = 0
    for i in range(edges):
        if colliders.owner[colliders.edge_a[near.edge[i]]] != owner:
            near.edge[left] = near.edge[i]
            near.share[left] = near.share[i]
            near.distance[left] = near.distance[i]
            near.signed[left] = near.signed[i]
            near.region[left] = near.region[i]
            left += 1
    return left


@inner_kernel
def push_out(
    p: int, e: int, share: float, distance: float, region: int, colliders: Colliders, dynamic: int, contacts: Contacts,
    count: int,
) -> int:  # fmt: skip
    """Contact of a particle inside a solid body with the edge that is nearest; the number of contacts then."""
    nx, ny = edge_normal(e, colliders)
    if region != 0:
        nx, ny = corner_normal(end_of(e, region, colliders), colliders)
    reach = colliders.radius[p] + colliders.radius[colliders.edge_a[e]]
    return _add_edge(p, e, share, nx, ny, -distance - reach, colliders, dynamic, contacts, count)


@inner_kernel
def _add_edge(
    p: int, e: int, share: float, nx: float, ny: float, gap: float, colliders: Colliders, dynamic: int,
    contacts: Contacts, count: int,
) -> int:  # fmt: skip
    a = colliders.edge_a[e]
    if e < dynamic:
        return add_contact(
            count, contacts, p, KINDS * colliders.number[e] + EDGE, a, colliders.edge_b[e], share, nx, ny, gap, a,
            colliders,
        )  # fmt: skip
    return add_contact(
        count, contacts, p, KINDS * colliders.number[e] + TERRAIN, -1, -1, share, nx, ny, gap, a, colliders
    )


@inner_kernel
def _collide_outside(
    p: int, h: float, way_x: float, way_y: float, first: int, edges: int, owner: int, colliders: Colliders, near: Near,
    dynamic: int, contacts: Contacts, count: int,
) -> int:  # fmt: skip
    # Every edge of the owner that is close, and the first one in the way of a fast particle.
    soonest = 2.0
    met = -1
    met_share = 0.0
    met_x, met_y = 0.0, 0.0
    met_gap = 0.0
    begun = count
    for j in range(first, edges):
        e = near.edge[j]
        a, b = colliders.edge_a[e], colliders.edge_b[e]
        if colliders.owner[a] != owner:
            continue
        reach = colliders.radius[p] + colliders.radius[a]
        part = near.share[j]
        wx = way_x - h * ((1.0 - part) * colliders.velocity[a, 0] + part * colliders.velocity[b, 0])
        wy = way_y - h * ((1.0 - part) * colliders.velocity[a, 1] + part * colliders.velocity[b, 1])
        travel = math.sqrt(wx * wx + wy * wy)
        gap = near.distance[j] - reach
        fast = travel > FAST * reach
        touches = False
        ahead = 0.0 if fast else travel
        if not fast and e < dynamic and gap > MARGIN * reach + travel:
            x = colliders.position[p, 0] - place_on(e, part, 0, colliders)
            y = colliders.position[p, 1] - place_on(e, part, 1, colliders)
            ahead = _closing(way_x, way_y, way_x - wx, way_y - wy, x, y, near.distance[j])
        if gap <= MARGIN * reach + ahead:
            touches, nx, ny, gap = _touch_edge(p, j, gap, wx, wy, colliders, near, edges)
            if touches:
                count = _add_edge(p, e, near.share[j], nx, ny, gap, colliders, dynamic, contacts, count)
        elif fast:
            x, y = colliders.position[p, 0], colliders.position[p, 1]
            when, share, nx, ny, gap = _sweep_edge(p, x, y, e, wx, wy, reach, near.signed[j], colliders, near, edges)
            touches = when <= 1.0
            if when < soonest:
                soonest, met, met_share, met_x, met_y, met_gap = when, e, share, nx, ny, gap
        if not touches and near.region[j] != 0 and is_loose(p, colliders):
            count = _collide_ahead(p, j, wx, wy, colliders, near, edges, dynamic, contacts, count)
    if count > begun and is_loose(p, colliders):
        put_ahead_in_order(way_x, way_y, begun, min(count, contacts.particle.shape[0]), contacts)
    if met >= 0:
        count = _add_edge(p, met, met_share, met_x, met_y, met_gap, colliders, dynamic, contacts, count)
    return count


@inner_kernel
def _collide_ahead(
    p: int, j: int, wx: float, wy: float, colliders: Colliders, near: Near, edges: int, dynamic: int,
    contacts: Contacts, count: int,
) -> int:  # fmt: skip
    # The next edges of a hollow push where they begin; what meets another before them does not bounce off them.
    rises, nx, ny, gap, is_met = rises_ahead(p, j, wx, wy, colliders, near, edges)
    if not rises:
        return count
    added = count
    count = _add_edge(p, near.edge[j], near.share[j], nx, ny, gap, colliders, dynamic, contacts, count)
    if added < contacts.particle.shape[0]:
        contacts.ahead[added] = True
        if not is_met:
            contacts.restitution[added] = 0.0
    return count


@inner_kernel
def _touch_edge(
    p: int, j: int, gap: float, wx: float, wy: float, colliders: Colliders, near: Near, edges: int
) -> tuple[bool, float, float, float]:
    # Whether a particle, whose way on an edge that is close is w, touches that; the normal and the gap.
    e = near.edge[j]
    x, y = colliders.position[p, 0], colliders.position[p, 1]
    if near.region[j] == 0:
        if colliders.side[e] != 0 and near.signed[j] < 0.0:
            return False, 0.0, 0.0, gap
        if gap > 0.0 and passes_beside(p, j, gap, wx, wy, colliders, near, edges):
            return False, 0.0, 0.0, gap
    else:
        v = end_of(e, near.region[j], colliders)
        if not owns_corner(e, v, x, y, colliders) or is_ghost_vertex(p, e, v, x, y, colliders, near, edges):
            return False, 0.0, 0.0, gap
    if near.distance[j] > SHORTEST:
        nx = (x - place_on(e, near.share[j], 0, colliders)) / near.distance[j]
        ny = (y - place_on(e, near.share[j], 1, colliders)) / near.distance[j]
    else:
        nx, ny = edge_normal(e, colliders)
    if near.region[j] != 0 and gap > 0.0 and -2.0 * (wx * nx + wy * ny) > gap:
        # What comes to a corner meets it where its way does, or passes it. Small steps look ahead, by one more at most.
        v = end_of(e, near.region[j], colliders)
        reach = colliders.radius[p] + colliders.radius[v]
        px, py = x - colliders.position[v, 0], y - colliders.position[v, 1]
        when = time_to_circle(px, py, wx, wy, reach)
        if when >= 2.0 or not reach > 0.0:
            return False, 0.0, 0.0, gap
        nx, ny = (px + when * wx) / reach, (py + when * wy) / reach
        gap = -when * (wx * nx + wy * ny)
    return True, nx, ny, gap


@inner_kernel
def _sweep_edge(
    p: int, x: float, y: float, e: int, wx: float, wy: float, reach: float, signed: float, colliders: Colliders,
    near: Near, edges: int,
) -> tuple[float, float, float, float, float]:  # fmt: skip
    # Where the way w of a particle first comes within reach of an edge: when (2: never), share, normal, gap.
    nx, ny = edge_normal(e, colliders)
    if colliders.side[e] == 0 and signed < 0.0:
        nx, ny, signed = -nx, -ny, -signed
    approach = -(wx * nx + wy * ny)
    a = colliders.edge_a[e]
    ax, ay, dx, dy = segment_of(a, colliders.edge_b[e], colliders.position)
    squared = dx * dx + dy * dy
    if approach > 0.0 and signed >= reach and squared > SHORTEST:
        when = (signed - reach) / approach
        share = ((x + when * wx - ax) * dx + (y + when * wy - ay) * dy) / squared
        if when <= 1.0 and -CORNER <= share <= 1.0 + CORNER:
            return when, min(1.0, max(0.0, share)), nx, ny, signed - reach
    soonest = 2.0
    found = 0.0
    gap = 0.0
    if reach > 0.0:
        for end in range(2):
            v = a if end == 0 else colliders.edge_b[e]
            vx, vy = x - colliders.position[v, 0], y - colliders.position[v, 1]
            when = time_to_circle(vx, vy, wx, wy, reach)
            if not (when <= 1.0 and when < soonest):
                continue
            ox, oy = x + when * wx, y + when * wy
            if owns_corner(e, v, ox, oy, colliders) and not is_ghost_vertex(p, e, v, ox, oy, colliders, near, edges):
                soonest = when
                found = float(end)
                nx, ny = (vx + when * wx) / reach, (vy + when * wy) / reach
                gap = -when * (wx * nx + wy * ny)
    return soonest, found, nx, ny, gap
