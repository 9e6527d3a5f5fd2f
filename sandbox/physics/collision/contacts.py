"""Contacts of a step: pairs that touch, or would touch in it, found in every step in a fixed order.

Found are pairs of a particle and a disc, an edge of a body, or an edge of terrain, in ascending order of the particle;
the order within a particle is one of positions. The impulses of the last step are carried over by feature. There is no
manifold: two points at which two bodies touch are two contacts.
"""

import math

from sandbox.physics.arrays import FloatRows
from sandbox.physics.collision.broad_phase import WITH_ALL, WITH_EDGES, WITH_NOTHING, Boxes, Candidates, Pairs
from sandbox.physics.collision.edge_geometry import CORNER, is_enclosed
from sandbox.physics.collision.entered import find_entered
from sandbox.physics.collision.narrow_phase import (
    EDGE,
    KINDS,
    MARGIN,
    TERRAIN,
    collide_disc,
    collide_edges,
    find_near,
    leave_out,
    may_collide,
    push_out,
)
from sandbox.physics.collision.outline import TERRAIN_OWNER, Outline
from sandbox.physics.collision.tips import find_tips
from sandbox.physics.collision.types import Colliders, Contacts, KeptContacts, Near
from sandbox.physics.geometry.segment import closest_on_segment, doubled_area_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.terrain import Terrain, cells_between
from sandbox.physics.topology.sorting import sort_ascending

# A particle that is near no edge of a solid body is looked for deep inside it once in so many ticks; one that is found
# there is pushed in every step until it is out.
PENETRATION_TICKS = 8


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
        a = colliders.edge_a[e]
        b = colliders.edge_b[e]
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
                    a = terrain.edge_a[e]
                    b = terrain.edge_b[e]
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
def _find_penetration(
    p: int,
    colliders: Colliders,
    outline: Outline,
    bounds: FloatRows,
    near: Near,
    edges: int,
    entered: int,
    contacts: Contacts,
    count: int,
) -> int:
    # A particle that is near no edge of a solid body, yet inside it, is pushed out at the nearest edge.
    solid = outline.solid
    x = colliders.position[p, 0]
    y = colliders.position[p, 1]
    for k in range(solid.shape[0]):
        if not (bounds[k, 0] <= x <= bounds[k, 2] and bounds[k, 1] <= y <= bounds[k, 3]):
            continue
        body = colliders.edge_a[solid[k, 0]]
        skipped = colliders.owner[body] == colliders.owner[p] or not may_collide(p, body, colliders)
        if entered >= 0 and colliders.owner[entered] == colliders.owner[body]:
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
def _is_hollow(first: int, last: int, colliders: Colliders) -> bool:
    # Whether a chain encloses a negative area: it is terrain that is solid outside.
    area = 0.0
    for e in range(first, last):
        if colliders.side[e] == 0 or colliders.owner[colliders.edge_a[e]] > TERRAIN_OWNER:
            return False
        area += doubled_area_of(colliders.edge_a[first], colliders.edge_a[e], colliders.edge_b[e], colliders.position)
    return area < 0.0


@inner_kernel
def update_aabbs(colliders: Colliders, outline: Outline, begin: int, end: int, bounds: FloatRows) -> None:
    """The box in which a particle can be inside each owner's solid edges begin..end; hollow ones: it is everything."""
    solid = outline.solid
    for k in range(begin, end):
        first = colliders.edge_a[solid[k, 0]]
        hollow = _is_hollow(solid[k, 0], solid[k, 1], colliders)
        bounds[k, 4] = 1.0 if hollow else 0.0
        for axis in range(2):
            low = colliders.position[first, axis]
            high = low
            for e in range(solid[k, 0], solid[k, 1]):
                a = colliders.position[colliders.edge_a[e], axis]
                b = colliders.position[colliders.edge_b[e], axis]
                low = min(low, min(a, b))
                high = max(high, max(a, b))
            bounds[k, axis] = -math.inf if hollow else low
            bounds[k, 2 + axis] = math.inf if hollow else high


@inner_kernel
def find_contacts(
    colliders: Colliders,
    outline: Outline,
    candidates: Candidates,
    bounds: FloatRows,
    near: Near,
    kept: KeptContacts,
    kept_count: int,
    tick: int,
    h: float,
    contacts: Contacts,
    terrain: Terrain,
) -> int:
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
        entered = -1
        if last > first and colliders.shape[p] < 0 and outline.dynamic[1] > 0:
            count, entered = find_entered(
                p, colliders, outline, bounds, kept, first, last, contacts, count
            )  # fmt: skip
            if entered >= 0:
                edges = leave_out(colliders.owner[entered], colliders, near, edges)
        if edges > 0:
            count = collide_edges(p, h, colliders, near, edges, outline.solid, bounds, dynamic, contacts, count)
        if outline.solid.shape[0] > 0 and (
            (tick + p) % PENETRATION_TICKS == 0 or _was_penetrating(colliders, near, edges, dynamic, kept, first, last)
        ):
            count = _find_penetration(p, colliders, outline, bounds, near, edges, entered, contacts, count)
        if terrain.tip.shape[0] > 0:
            count = find_tips(p, h, box, terrain, colliders, contacts, dynamic, particles, count)
    return count


@inner_kernel
def carry_over(contacts: Contacts, count: int, kept: KeptContacts, kept_count: int) -> None:
    """Start contacts with the last step's impulses of the same features; add its impacts. Both ascend by particle."""
    begin = 0
    for c in range(count):
        p = contacts.particle[c]
        contacts.impulse[c, 0] = 0.0
        contacts.impulse[c, 1] = 0.0
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
