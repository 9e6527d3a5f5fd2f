"""Contacts of a step: what touches, or would touch in it, found anew in every step, in a fixed order.

Found are pairs of a particle and a disc, an edge of a body, or an edge of terrain, in ascending order of the particle;
the order within a particle is one of positions. The impulses of the last step are carried over by feature. There is no
manifold: two points at which two bodies touch are two contacts.
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.broad_phase import MEETS_ALL, MEETS_EDGES, MEETS_NOTHING, Pairs, find_pairs
from sandbox.physics.collision.narrow_phase import (
    CORNER,
    DISC,
    MARGIN,
    TERRAIN,
    closest,
    is_enclosed,
    look_at,
    may_touch,
    push_out,
    touch_disc,
    touch_edges,
)
from sandbox.physics.collision.outline import TERRAIN_OWNER, Outline, shapes_of
from sandbox.physics.collision.restitution import load_bounces
from sandbox.physics.collision.types import Contacts, room_for, room_near
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.terrain import Terrain
from sandbox.physics.world import Floats, Slots, World

# A particle that is near no edge of a solid body is looked for deep inside it once in so many ticks; one that is found
# there is pushed in every step until it is out.
DEEP_TICKS = 8


class Kept(NamedTuple):
    """What is kept of the contacts of the last step: see Contacts."""

    particle: Slots
    feature: Slots
    impulse: Floats


@kernel
def _boxes(shapes, particles, dynamic, h, box, is_target, meets):  # type: ignore[no-untyped-def]
    # What each particle, then each edge of a body, sweeps in the step; particles with edges of their own are met there.
    for p in range(particles):
        if shapes.collides[p] == 0:
            box[p, 0] = 1.0
            continue
        reach = (1.0 + MARGIN) * shapes.radius[p]
        for axis in range(2):
            x = shapes.place[p, axis]
            way = h * shapes.motion[p, axis]
            box[p, axis] = x + min(0.0, way) - reach
            box[p, 2 + axis] = x + max(0.0, way) + reach
        is_target[p] = shapes.edge_start[p] == shapes.edge_start[p + 1] and not shapes.shielded[p]
        meets[p] = MEETS_EDGES if shapes.shielded[p] else MEETS_ALL
    for e in range(dynamic):
        a = shapes.edge_a[e]
        b = shapes.edge_b[e]
        k = particles + e
        if shapes.collides[a] == 0 or shapes.collides[b] == 0:
            box[k, 0] = 1.0
            continue
        is_target[k] = True
        for axis in range(2):
            box[k, axis] = min(box[a, axis], box[b, axis])
            box[k, 2 + axis] = max(box[a, 2 + axis], box[b, 2 + axis])


@inner_kernel
def span(low, high, corner, cell, size):  # type: ignore[no-untyped-def]
    """First and last of `size` cells that an interval covers; none: the last is before the first."""
    first = (low - corner) / cell
    last = (high - corner) / cell
    if not (last >= 0.0 and first < size):
        return 0, -1
    return math.floor(max(0.0, first)), math.floor(min(last, size - 1.0))


@inner_kernel
def _passes(box, p, ax, ay, bx, by):  # type: ignore[no-untyped-def]
    # Whether the segment from a to b can reach into a particle's box.
    if max(ax, bx) < box[p, 0] or min(ax, bx) > box[p, 2] or max(ay, by) < box[p, 1] or min(ay, by) > box[p, 3]:
        return False
    # |n . (centre - a)| <= |n| . half the box, for n across the segment
    nx = by - ay
    ny = ax - bx
    away = nx * (0.5 * (box[p, 0] + box[p, 2]) - ax) + ny * (0.5 * (box[p, 1] + box[p, 3]) - ay)
    half = 0.5 * (abs(nx) * (box[p, 2] - box[p, 0]) + abs(ny) * (box[p, 3] - box[p, 1]))
    return abs(away) <= half * (1.0 + CORNER)


@kernel
def _pair_terrain(box, meets, terrain, start, other):  # type: ignore[no-untyped-def]
    # The edges of terrain that reach into the box of each particle; their number, counted on where there is no room.
    count = 0
    cell = terrain.cell[0]
    for p in range(meets.shape[0]):
        start[p] = count
        if meets[p] == MEETS_NOTHING:
            continue
        left, right = span(box[p, 0], box[p, 2], terrain.corner[0], cell, terrain.size[0])
        bottom, top = span(box[p, 1], box[p, 3], terrain.corner[1], cell, terrain.size[1])
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
    start[meets.shape[0]] = count
    return count


@inner_kernel
def _look_deep(p, shapes, solid, bounds, near, edges, dynamic, contacts, count):  # type: ignore[no-untyped-def]
    # A particle that is near no edge of a solid body, yet inside it, is pushed out at the nearest edge.
    x = shapes.place[p, 0]
    y = shapes.place[p, 1]
    for k in range(solid.shape[0]):
        if not (bounds[k, 0] <= x <= bounds[k, 2] and bounds[k, 1] <= y <= bounds[k, 3]):
            continue
        body = shapes.edge_a[solid[k, 0]]
        skipped = shapes.owner[body] == shapes.owner[p] or not may_touch(p, body, shapes)
        for i in range(edges):
            if shapes.owner[shapes.edge_a[near.edge[i]]] == shapes.owner[body]:
                skipped = True
        if skipped or shapes.inverse[p] + shapes.inverse[body] == 0.0:
            continue
        if not is_enclosed(p, k, solid, bounds, shapes):
            continue
        nearest = solid[k, 0]
        lowest = math.inf
        for e in range(solid[k, 0], solid[k, 1]):
            if shapes.side[e] != 0:
                _, distance, _, _ = closest(p, shapes.edge_a[e], shapes.edge_b[e], shapes.place)
                if distance < lowest:
                    nearest = e
                    lowest = distance
        share, distance, _, region = closest(p, shapes.edge_a[nearest], shapes.edge_b[nearest], shapes.place)
        count = push_out(p, nearest, share, distance, region, shapes, dynamic, contacts, count)
    return count


@inner_kernel
def _was_deep(shapes, near, edges, dynamic, kept, first, last):  # type: ignore[no-untyped-def]
    # Whether a particle touched, in the last step, an edge that it is not near now.
    for at in range(first, last):
        kind = kept.feature[at] % 3
        if kind == DISC:
            continue
        found = False
        for i in range(edges):
            e = near.edge[i]
            if (kind == TERRAIN) == (e >= dynamic) and shapes.number[e] == kept.feature[at] // 3:
                found = True
        if not found:
            return True
    return False


@inner_kernel
def _is_hollow(first, last, shapes):  # type: ignore[no-untyped-def]
    # Whether a chain encloses a negative area: it is terrain that is solid outside.
    x = shapes.place[shapes.edge_a[first], 0]
    y = shapes.place[shapes.edge_a[first], 1]
    area = 0.0
    for e in range(first, last):
        if shapes.side[e] == 0 or shapes.owner[shapes.edge_a[e]] > TERRAIN_OWNER:
            return False
        a = shapes.edge_a[e]
        b = shapes.edge_b[e]
        area += (shapes.place[a, 0] - x) * (shapes.place[b, 1] - y) - (shapes.place[b, 0] - x) * (
            shapes.place[a, 1] - y
        )
    return area < 0.0


@kernel
def _bound(shapes, solid, bounds):  # type: ignore[no-untyped-def]
    # The box in which a particle can be inside each owner's solid edges, and whether they are hollow: then it is all.
    for k in range(solid.shape[0]):
        first = shapes.edge_a[solid[k, 0]]
        hollow = _is_hollow(solid[k, 0], solid[k, 1], shapes)
        bounds[k, 4] = 1.0 if hollow else 0.0
        for axis in range(2):
            low = shapes.place[first, axis]
            high = low
            for e in range(solid[k, 0], solid[k, 1]):
                low = min(low, min(shapes.place[shapes.edge_a[e], axis], shapes.place[shapes.edge_b[e], axis]))
                high = max(high, max(shapes.place[shapes.edge_a[e], axis], shapes.place[shapes.edge_b[e], axis]))
            bounds[k, axis] = -math.inf if hollow else low
            bounds[k, 2 + axis] = math.inf if hollow else high


@kernel
def _find(shapes, pairs, edges_of_terrain, solid, bounds, particles, dynamic, tick, h, near, kept, contacts):  # type: ignore[no-untyped-def]
    # All contacts; their number, which may be above what there is room for.
    count = 0
    last = 0
    for p in range(particles):
        if shapes.collides[p] == 0:
            continue
        first = last
        while first < kept.particle.shape[0] and kept.particle[first] < p:
            first += 1
        last = first
        while last < kept.particle.shape[0] and kept.particle[last] == p:
            last += 1
        edges = 0
        for at in range(pairs.start[p], pairs.start[p + 1]):
            k = pairs.other[at]
            if k < particles:
                count = touch_disc(p, k, h, shapes, contacts, count)
            else:
                edges = look_at(p, k - particles, shapes, near, edges)
        for at in range(edges_of_terrain.start[p], edges_of_terrain.start[p + 1]):
            edges = look_at(p, dynamic + edges_of_terrain.other[at], shapes, near, edges)
        if edges > 0:
            count = touch_edges(p, h, shapes, near, edges, solid, bounds, dynamic, contacts, count)
        if solid.shape[0] > 0 and (
            (tick + p) % DEEP_TICKS == 0 or _was_deep(shapes, near, edges, dynamic, kept, first, last)
        ):
            count = _look_deep(p, shapes, solid, bounds, near, edges, dynamic, contacts, count)
    return count


@kernel
def _carry_over(contacts, kept):  # type: ignore[no-untyped-def]
    # The last step's impulses of the same features; both lists ascend by particle.
    begin = 0
    for c in range(contacts.particle.shape[0]):
        p = contacts.particle[c]
        while begin < kept.particle.shape[0] and kept.particle[begin] < p:
            begin += 1
        at = begin
        while at < kept.particle.shape[0] and kept.particle[at] == p:
            if kept.feature[at] == contacts.feature[c]:
                contacts.impulse[c, 0] = kept.impulse[at, 0]
                contacts.impulse[c, 1] = kept.impulse[at, 1]
                break
            at += 1


def _pairs_of_terrain(terrain: Terrain, box: Floats, meets: Slots, room: int) -> Pairs:
    start = np.zeros(len(meets) + 1, np.int64)
    if not len(terrain.edge_a):
        return Pairs(start, np.zeros(0, np.int64))
    while True:
        other = np.zeros(room, np.int64)
        count = _pair_terrain(box, meets, terrain, start, other)
        if count <= room:
            return Pairs(start, other)
        room = count


def find_contacts(world: World, outline: Outline, start: Floats, h: float) -> Contacts:
    """All contacts of a step of h [s] that begins with the velocities which gravity and all else have left.

    outline: of the world as it is now. start [m/s] (n, 2): the velocities before those.
    """
    shapes = shapes_of(world, outline)
    particles = world.particle_count
    objects = particles + outline.dynamic
    box, is_target, meets = np.zeros((objects, 4)), np.zeros(objects, np.bool_), np.zeros(particles, np.int64)
    _boxes(shapes, particles, outline.dynamic, h, box, is_target, meets)
    room = 64 + 2 * len(world.contact_particle)
    pairs = find_pairs(box, is_target, meets, room)
    edges_of_terrain = _pairs_of_terrain(world.terrain, box, meets, room)
    kept = Kept(world.contact_particle.astype(np.int64), world.contact_feature, world.contact_impulse)
    near, bounds = room_near(), np.zeros((len(outline.solid), 5))
    _bound(shapes, outline.solid, bounds)
    while True:
        contacts = room_for(room)
        count = _find(
            shapes, pairs, edges_of_terrain, outline.solid, bounds, particles, outline.dynamic, world.tick, h, near,
            kept, contacts,
        )  # fmt: skip
        if count <= room:
            break
        room = count
    contacts = Contacts._make(array[:count] for array in contacts)
    load_bounces(contacts, start, world.velocity, world.inverse_mass, h)
    _carry_over(contacts, kept)
    return contacts
