"""Contacts of a step: pairs that touch, or would touch in it, found in every step in a fixed order.

Found are pairs of a particle and a disc, an edge of a body, or an edge of terrain, in ascending order of the particle;
the order within a particle is one of positions. The impulses of the last step are carried over by feature. There is no
manifold: two points at which two bodies touch are two contacts.

Deep contacts last: a disc that has come into a solid body goes out where it came in, however deep it is by now.

A tip is a convex vertex of terrain. A contact whose feature is TIP is one of an edge of a body with such: `particle`
and `end_b` are the ends of the edge, with shares 1 - s and s, and end_a is -1. At its ends an edge meets terrain as a
particle does.
"""

import math

from sandbox.physics.arrays import FloatRows
from sandbox.physics.collision.broad_phase import WITH_ALL, WITH_EDGES, WITH_NOTHING, Boxes, Candidates, Pairs
from sandbox.physics.collision.ghost_vertices import CORNER, is_behind, is_enclosed, is_in
from sandbox.physics.collision.narrow_phase import (
    MARGIN,
    add_contact,
    collide_disc,
    collide_edges,
    find_near,
    leave_out,
    may_collide,
    push_out,
)
from sandbox.physics.collision.outline import TERRAIN_OWNER, Outline
from sandbox.physics.collision.types import Colliders, Contacts, KeptContacts, Near
from sandbox.physics.geometry.segment import SHORTEST, closest_on_segment, doubled_area_of, segment_of
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.marks import EDGE, INSIDE, KINDS, TERRAIN, TIP, TIP_SHIFT
from sandbox.physics.terrain import Terrain, cells_between
from sandbox.physics.topology.sorting import sort_ascending

# A particle that is near no edge of a solid body is looked for deep inside it once in so many ticks; one that is found
# there is pushed in every step until it is out.
PENETRATION_TICKS = 8
# Edges along which it is followed, at most, where a disc is that has come into a body.
MOST_WALK = 64
# Sine of the angle by which an edge may lean beyond a side of a corner of terrain and still lie on that.
LEAN = 1e-6
# A corner of terrain deeper inside a solid body than this share of an edge is none of that edge's.
DEEPEST_TIP = 0.5
# A contact of an edge with a tip exists from this gap on, as a share of the radius: what a solver does to the edge is
# not foreseen.
NEAR_TIP = 0.5


@inner_kernel
def fill_boxes(colliders: Colliders, dynamic: int, h: float, boxes: Boxes) -> None:
    """Fill the box that each particle sweeps in the step, then the box of each edge of a body where it is now.

    dynamic: edges of bodies. Particles with edges of their own are hit there alone.
    """
    box = boxes.box
    particles = boxes.filter.shape[0]
    for p in range(particles):
        boxes.is_target[p] = False
        boxes.filter[p] = WITH_NOTHING
        if colliders.collides[p] == 0:
            box[p, 0] = 1.0
            box[p, 2] = 0.0
            continue
        reach = (1.0 + MARGIN) * colliders.radius[p]
        for axis in range(2):
            x = colliders.position[p, axis]
            way = h * colliders.velocity[p, axis]
            box[p, axis] = x + min(0.0, way) - reach
            box[p, 2 + axis] = x + max(0.0, way) + reach
        is_loose = colliders.edge_start[p] == colliders.edge_start[p + 1] and not colliders.shielded[p]
        boxes.is_target[p] = is_loose
        boxes.filter[p] = WITH_ALL if is_loose else WITH_EDGES
    for e in range(dynamic):
        a, b = colliders.edge_a[e], colliders.edge_b[e]
        k = particles + e
        boxes.is_target[k] = False
        if colliders.collides[a] == 0 or colliders.collides[b] == 0:
            box[k, 0] = 1.0
            box[k, 2] = 0.0
            continue
        boxes.is_target[k] = True
        for axis in range(2):
            box[k, axis] = min(box[a, axis], box[b, axis])
            box[k, 2 + axis] = max(box[a, 2 + axis], box[b, 2 + axis])


@inner_kernel
def find_terrain(boxes: Boxes, terrain: Terrain, pairs: Pairs) -> int:
    """The edges of terrain that reach into each particle's box; their number, counted on where there is no room."""
    count = 0
    box = boxes.box
    start = pairs.start
    other = pairs.other
    particles = boxes.filter.shape[0]
    if terrain.edge_a.shape[0] == 0:
        return count
    per_cell = 1.0 / terrain.cell[0]
    for p in range(particles):
        start[p] = count
        if boxes.filter[p] == WITH_NOTHING:
            continue
        left, right = cells_between(box[p, 0], box[p, 2], terrain.corner[0], per_cell, terrain.size[0])
        bottom, top = cells_between(box[p, 1], box[p, 3], terrain.corner[1], per_cell, terrain.size[1])
        for row in range(bottom, top + 1):
            for column in range(left, right + 1):
                at = row * terrain.size[0] + column
                for entry in range(terrain.cell_start[at], terrain.cell_start[at + 1]):
                    e = terrain.cell_edge[entry]
                    a, b = terrain.edge_a[e], terrain.edge_b[e]
                    if not _passes(
                        box, p, terrain.vertex[a, 0], terrain.vertex[a, 1], terrain.vertex[b, 0], terrain.vertex[b, 1]
                    ):
                        continue
                    known = False
                    for i in range(start[p], min(count, other.shape[0])):
                        if other[i] == e:
                            known = True
                            break
                    if not known:
                        if count < other.shape[0]:
                            other[count] = e
                        count += 1
        # Cells are as the whole of the terrain has them.
        sort_ascending(other, min(start[p], other.shape[0]), min(count, other.shape[0]))
    start[particles] = count
    return count


@inner_kernel
def _passes(box: FloatRows, p: int, ax: float, ay: float, bx: float, by: float) -> bool:
    # Whether the segment from a to b can reach into a particle's box.
    if max(ax, bx) < box[p, 0] or min(ax, bx) > box[p, 2] or max(ay, by) < box[p, 1] or min(ay, by) > box[p, 3]:
        return False
    # |n . (centre - a)| <= |n| . half the box, for n across the segment
    nx = by - ay
    ny = ax - bx
    away = nx * (0.5 * (box[p, 0] + box[p, 2]) - ax) + ny * (0.5 * (box[p, 1] + box[p, 3]) - ay)
    half = 0.5 * (abs(nx) * (box[p, 2] - box[p, 0]) + abs(ny) * (box[p, 3] - box[p, 1]))
    return abs(away) <= half * (1.0 + CORNER)


@inner_kernel
def update_aabbs(colliders: Colliders, outline: Outline, begin: int, end: int, bounds: FloatRows) -> None:
    """Find the box in which a particle can be inside each owner's solid edges begin..end; hollow: everything."""
    solid = outline.solid
    for k in range(begin, end):
        first = colliders.edge_a[solid[k, 0]]
        hollow = _is_hollow(solid[k, 0], solid[k, 1], colliders)
        bounds[k, 4] = 1.0 if hollow else 0.0
        for axis in range(2):
            low = colliders.position[first, axis]
            high = low
            for e in range(solid[k, 0], solid[k, 1]):
                a, b = colliders.position[colliders.edge_a[e], axis], colliders.position[colliders.edge_b[e], axis]
                low = min(low, min(a, b))
                high = max(high, max(a, b))
            bounds[k, axis] = -math.inf if hollow else low
            bounds[k, 2 + axis] = math.inf if hollow else high


@inner_kernel
def _is_hollow(first: int, last: int, colliders: Colliders) -> bool:
    # Whether a chain encloses a negative area: it is terrain that is solid outside.
    area = 0.0
    for e in range(first, last):
        if colliders.side[e] == 0 or colliders.owner[colliders.edge_a[e]] > TERRAIN_OWNER:
            return False
        area += doubled_area_of(colliders.edge_a[first], colliders.edge_a[e], colliders.edge_b[e], colliders.position)
    return area < 0.0


@inner_kernel
def find_contacts(
    colliders: Colliders, outline: Outline, candidates: Candidates, bounds: FloatRows, near: Near, kept: KeptContacts,
    kept_count: int, tick: int, h: float, contacts: Contacts, terrain: Terrain,
) -> int:  # fmt: skip
    """All contacts of a step of h [s]; their number, counted on where there is no room.

    The velocities are those which gravity and all else have left. kept: the contacts of the last step.
    """
    count = 0
    last = 0
    pairs, terrain_pairs, box = candidates.pairs, candidates.terrain, candidates.box
    particles = pairs.start.shape[0] - 1
    dynamic = outline.dynamic[0]
    for p in range(particles):
        if colliders.collides[p] == 0:
            continue
        first = last
        while first < kept_count and kept.particle[first] < p:
            first += 1
        last = first
        while last < kept_count and kept.particle[last] == p:
            last += 1
        edges = 0
        for at in range(pairs.start[p], pairs.start[p + 1]):
            k = pairs.other[at]
            if k < particles:
                count = collide_disc(p, k, h, colliders, contacts, count)
            else:
                edges = find_near(p, k - particles, colliders, near, edges)
        for at in range(terrain_pairs.start[p], terrain_pairs.start[p + 1]):
            edges = find_near(p, dynamic + terrain_pairs.other[at], colliders, near, edges)
        deep = -1
        if last > first and colliders.shape[p] < 0 and outline.dynamic[1] > 0:
            count, deep = _find_deep_contact(
                p, colliders, outline, bounds, kept, first, last, contacts, count
            )  # fmt: skip
            if deep >= 0:
                edges = leave_out(colliders.owner[deep], colliders, near, edges)
        if edges > 0:
            count = collide_edges(p, h, colliders, near, edges, outline.solid, bounds, dynamic, contacts, count)
        if outline.solid.shape[0] > 0 and (
            (tick + p) % PENETRATION_TICKS == 0 or _was_penetrating(colliders, near, edges, dynamic, kept, first, last)
        ):
            count = _find_penetration(p, colliders, outline, bounds, near, edges, deep, contacts, count)
        if terrain.tip.shape[0] > 0:
            count = _find_tips(p, h, box, terrain, colliders, contacts, dynamic, particles, count)
    return count


@inner_kernel
def _find_penetration(
    p: int, colliders: Colliders, outline: Outline, bounds: FloatRows, near: Near, edges: int, deep: int,
    contacts: Contacts, count: int,
) -> int:  # fmt: skip
    # A particle that is near no edge of a solid body, yet inside it, is pushed out at the nearest edge.
    solid = outline.solid
    x, y = colliders.position[p, 0], colliders.position[p, 1]
    for k in range(solid.shape[0]):
        if not (bounds[k, 0] <= x <= bounds[k, 2] and bounds[k, 1] <= y <= bounds[k, 3]):
            continue
        body = colliders.edge_a[solid[k, 0]]
        skipped = colliders.owner[body] == colliders.owner[p] or not may_collide(p, body, colliders)
        if deep >= 0 and colliders.owner[deep] == colliders.owner[body]:
            skipped = True
        for i in range(edges):
            if colliders.owner[colliders.edge_a[near.edge[i]]] == colliders.owner[body]:
                skipped = True
        if skipped or colliders.inverse_mass[p] + colliders.inverse_mass[body] == 0.0:
            continue
        if not is_enclosed(p, k, solid, bounds, colliders):
            continue
        nearest = solid[k, 0]
        lowest = math.inf
        for e in range(solid[k, 0], solid[k, 1]):
            if colliders.side[e] != 0:
                _, distance, _, _ = closest_on_segment(p, colliders.edge_a[e], colliders.edge_b[e], colliders.position)
                if distance < lowest:
                    nearest = e
                    lowest = distance
        share, distance, _, region = closest_on_segment(
            p, colliders.edge_a[nearest], colliders.edge_b[nearest], colliders.position
        )
        count = push_out(p, nearest, share, distance, region, colliders, outline.dynamic[0], contacts, count)
    return count


@inner_kernel
def _was_penetrating(
    colliders: Colliders, near: Near, edges: int, dynamic: int, kept: KeptContacts, first: int, last: int
) -> bool:
    # Whether a particle touched, in the last step, an edge that it is not near now.
    for at in range(first, last):
        kind = kept.feature[at] % KINDS
        if kind != EDGE and kind != TERRAIN:
            continue
        found = False
        for i in range(edges):
            e = near.edge[i]
            if (kind == TERRAIN) == (e >= dynamic) and colliders.number[e] == kept.feature[at] // KINDS:
                found = True
        if not found:
            return True
    return False


@inner_kernel
def _find_deep_contact(
    p: int, colliders: Colliders, outline: Outline, bounds: FloatRows, kept: KeptContacts, first: int, last: int,
    contacts: Contacts, count: int,
) -> tuple[int, int]:  # fmt: skip
    """Contact of a disc that has come into a solid body, to be pushed out where it came in.

    kept[first:last]: its contacts of the last step. Returned: the number of contacts then, and a vertex of the body
    (-1: none).
    """
    chosen = -1
    lowest = math.inf
    for at in range(first, last):
        kind = kept.feature[at] % KINDS
        if kind != EDGE and kind != INSIDE:
            continue
        e = edge_of_spring(kept.feature[at] // KINDS, colliders, outline)
        if e < 0 or colliders.side[e] == 0 or not may_collide(p, colliders.edge_a[e], colliders):
            continue
        g = _nearest_from(p, e, colliders)
        _, distance, signed, region = closest_on_segment(
            p, colliders.edge_a[g], colliders.edge_b[g], colliders.position
        )
        if not (distance < lowest and is_behind(p, g, signed, region, colliders)):
            continue
        # In one step it may have come out on the other side.
        if (kind == EDGE and region == 0) or is_in(
            p, colliders.owner[colliders.edge_a[g]], outline.solid, bounds, colliders
        ):
            chosen = g
            lowest = distance
    if chosen < 0:
        return count, -1
    share, distance, _, region = closest_on_segment(
        p, colliders.edge_a[chosen], colliders.edge_b[chosen], colliders.position
    )  # fmt: skip
    added = count
    count = push_out(p, chosen, share, distance, region, colliders, outline.dynamic[0], contacts, count)
    if added < contacts.particle.shape[0]:
        contacts.feature[added] = KINDS * colliders.number[chosen] + INSIDE
    return count, colliders.edge_a[chosen]


@inner_kernel
def edge_of_spring(spring: int, colliders: Colliders, outline: Outline) -> int:
    """The edge that a spring is; -1: none."""
    if not 0 <= spring < outline.spring_end.shape[0]:
        return -1
    v = outline.spring_end[spring]
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        e = colliders.edge_of[at]
        if e < outline.dynamic[0] and colliders.number[e] == spring:
            return e
    return -1


@inner_kernel
def _nearest_from(p: int, e: int, colliders: Colliders) -> int:
    # From an edge on along the outline as long as that comes nearer to a particle.
    _, lowest, _, _ = closest_on_segment(p, colliders.edge_a[e], colliders.edge_b[e], colliders.position)
    for _ in range(MOST_WALK):
        found = e
        for end in range(2):
            f = _beside(e, end, colliders)
            _, distance, _, _ = closest_on_segment(p, colliders.edge_a[f], colliders.edge_b[f], colliders.position)
            if distance < lowest:
                found = f
                lowest = distance
        if found == e:
            break
        e = found
    return e


@inner_kernel
def _beside(e: int, end: int, colliders: Colliders) -> int:
    # The solid edge that goes on at an end of another one; that itself, if there is none.
    v = colliders.edge_a[e] if end == 0 else colliders.edge_b[e]
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        f = colliders.edge_of[at]
        if f != e and colliders.side[f] != 0:
            return f
    return e


@inner_kernel
def _find_tips(
    p: int, h: float, box: FloatRows, terrain: Terrain, colliders: Colliders, contacts: Contacts, dynamic: int,
    particles: int, count: int,
) -> int:  # fmt: skip
    """Contacts of the edges that begin at particle p with tips of terrain; the number of contacts then."""
    for at in range(colliders.edge_start[p], colliders.edge_start[p + 1]):
        e = colliders.edge_of[at]
        k = particles + e
        if e >= dynamic or colliders.edge_a[e] != p or not box[k, 0] <= box[k, 2]:
            continue
        if colliders.inverse_mass[p] + colliders.inverse_mass[colliders.edge_b[e]] == 0.0:
            continue
        i = _next_tip(-1, k, box, terrain)
        while i >= 0:
            count = _collide_tip(e, i, particles, h, terrain, colliders, contacts, count)
            i = _next_tip(i, k, box, terrain)
    return count


@inner_kernel
def _next_tip(last: int, k: int, box: FloatRows, terrain: Terrain) -> int:
    # The tip of the lowest number above `last` in a box, -1: there is none. Cells are as the whole of the terrain has
    # them.
    per_cell = 1.0 / terrain.cell[0]
    found = -1
    left, right = cells_between(box[k, 0], box[k, 2], terrain.corner[0], per_cell, terrain.size[0])
    bottom, top = cells_between(box[k, 1], box[k, 3], terrain.corner[1], per_cell, terrain.size[1])
    for row in range(bottom, top + 1):
        cell = row * terrain.size[0]
        # Tips of a row of cells lie together.
        for entry in range(terrain.tip_start[cell + left], terrain.tip_start[cell + right + 1]):
            i = terrain.cell_tip[entry]
            if i <= last or (found >= 0 and i >= found):
                continue
            x, y = terrain.vertex[terrain.tip[i], 0], terrain.vertex[terrain.tip[i], 1]
            if box[k, 0] <= x <= box[k, 2] and box[k, 1] <= y <= box[k, 3]:
                found = i
    return found


@inner_kernel
def _collide_tip(
    e: int, i: int, first: int, h: float, terrain: Terrain, colliders: Colliders, contacts: Contacts, count: int
) -> int:
    """Contact of an edge of a body with tip i of terrain; the number of contacts then.

    first: the vertex at which those of terrain begin.
    """
    a, b = colliders.edge_a[e], colliders.edge_b[e]
    v = first + terrain.tip[i]
    if not may_collide(a, v, colliders):
        return count
    reach = colliders.radius[a]
    meets, share, nx, ny, distance = meet_tip(
        e, i, v, (1.0 + NEAR_TIP) * reach, reach, h, colliders.velocity, terrain, colliders
    )  # fmt: skip
    if not meets:
        return count
    feature = KINDS * (terrain.tip[i] * TIP_SHIFT + colliders.number[e]) + TIP
    return add_contact(count, contacts, a, feature, -1, b, share, nx, ny, distance - reach, v, colliders)


@inner_kernel
def meet_tip(
    e: int, i: int, v: int, near: float, reach: float, h: float, velocity: FloatRows, terrain: Terrain,
    colliders: Colliders,
) -> tuple[bool, float, float, float, float]:  # fmt: skip
    """Whether an edge of a body is within `near` [m] of tip i of terrain, vertex v, or comes as near as `reach` in h.

    Then the place along the edge that meets it, the normal from the tip towards the edge and the distance along that
    now. Where the nearest place of the edge is an end of it, that is hit as a particle.
    """
    a, b = colliders.edge_a[e], colliders.edge_b[e]
    ax, ay, dx, dy = segment_of(a, b, colliders.position)
    px, py = colliders.position[v, 0] - ax, colliders.position[v, 1] - ay
    squared = dx * dx + dy * dy
    if not squared > SHORTEST:
        return False, 0.0, 0.0, 0.0, 0.0
    length = math.sqrt(squared)
    way = 1.0
    signed = (px * dy - py * dx) / length
    if colliders.side[e] == 0 and signed < 0.0:
        way, signed = -1.0, -signed
    share = (px * dx + py * dy) / squared
    distance = signed
    when = 0.0
    if signed > near:
        # a, b and so the area of a, b and the tip go along: signed area - reach * length = 0
        ax, ay = h * velocity[a, 0], h * velocity[a, 1]
        tx, ty = h * velocity[b, 0] - ax, h * velocity[b, 1] - ay
        when = _first_root(
            (signed - reach) * length, way * (px * ty - ax * dy - py * tx + ay * dx), way * (ay * tx - ax * ty)
        )  # fmt: skip
        if when > 1.0:
            return False, 0.0, 0.0, 0.0, 0.0
        px -= when * ax
        py -= when * ay
        dx += when * tx
        dy += when * ty
        squared = dx * dx + dy * dy
        if not squared > SHORTEST:
            return False, 0.0, 0.0, 0.0, 0.0
        length = math.sqrt(squared)
        share = (px * dx + py * dy) / squared
    elif signed < -DEEPEST_TIP * length:
        return False, 0.0, 0.0, 0.0, 0.0
    if not 0.0 < share < 1.0:
        return False, 0.0, 0.0, 0.0, 0.0
    nx = -way * dy / length
    ny = way * dx / length
    # What crosses a tip does so whichever way it lies.
    if reach > 0.0 and not _is_in_cone(i, nx, ny, terrain):
        return False, 0.0, 0.0, 0.0, 0.0
    if when > 0.0:
        x = (1.0 - share) * colliders.position[a, 0] + share * colliders.position[b, 0] - colliders.position[v, 0]
        y = (1.0 - share) * colliders.position[a, 1] + share * colliders.position[b, 1] - colliders.position[v, 1]
        distance = nx * x + ny * y
    return True, share, nx, ny, distance


@inlined_kernel
def _is_in_cone(i: int, nx: float, ny: float, terrain: Terrain) -> bool:
    # Whether an edge of this normal can lie on tip i: none of the ways from that leads through it.
    for at in range(terrain.way_start[i], terrain.way_start[i + 1]):
        if nx * terrain.way[at, 0] + ny * terrain.way[at, 1] > LEAN:
            return False
    return True


@inlined_kernel
def _first_root(c: float, b: float, a: float) -> float:
    # The first t > 0 at which c + b t + a t^2, which is above 0 at 0, is 0; 2: never.
    inside = b * b - 4.0 * a * c
    if inside < 0.0:
        return 2.0
    # b < 0 or a < 0, else it only grows.
    root = math.sqrt(inside)
    if b < 0.0:
        when = 2.0 * c / (root - b)
        return when if when > 0.0 else 2.0
    if a < 0.0:
        return (-b - root) / (2.0 * a)
    return 2.0


@inner_kernel
def carry_over(contacts: Contacts, count: int, kept: KeptContacts, kept_count: int) -> None:
    """Start contacts with the last step's impulses of the same features; add its impacts. Both ascend by particle."""
    begin = 0
    for c in range(count):
        p = contacts.particle[c]
        contacts.impulse[c, 0] = contacts.impulse[c, 1] = 0.0
        contacts.impact[c] = 0.0
        while begin < kept_count and kept.particle[begin] < p:
            begin += 1
        at = begin
        while at < kept_count and kept.particle[at] == p:
            if kept.feature[at] == contacts.feature[c]:
                contacts.impulse[c, 0] = kept.impulse[at, 0]
                contacts.impulse[c, 1] = kept.impulse[at, 1]
                contacts.impact[c] = kept.impact[at]
                break
            at += 1
