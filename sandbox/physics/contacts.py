"""Contacts of a step: what touches, or would touch in it, found anew in every step, in a fixed order.

Found are pairs of a particle and a disc, an edge of a body, or an edge of terrain, in ascending order of the particle;
the order within a particle is one of positions. The impulses of the last step are carried over by feature.
"""

import math

import numpy as np

from sandbox.physics.broad_phase import bucket_of, is_large, make_grid
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.narrow_phase import (
    MARGIN,
    closest,
    look_at,
    push_out,
    touch_disc,
    touch_edges,
)
from sandbox.physics.outline import TERRAIN_OWNER, outline_of, shapes_of
from sandbox.physics.shapes import Contacts, room_for, room_near
from sandbox.physics.world import World

# A particle that is near no edge of a solid body is looked for deep inside it once in so many ticks: the most that it
# takes before one is pushed out.
DEEP_TICKS = 8


@kernel
def _boxes(shapes, particles, dynamic, h, box, is_target):  # type: ignore[no-untyped-def]
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
def _overlap(box, i, j):  # type: ignore[no-untyped-def]
    return (
        box[i, 0] <= box[j, 2] and box[j, 0] <= box[i, 2] and box[i, 1] <= box[j, 3] and box[j, 1] <= box[i, 3]
    )  # fmt: skip


@inner_kernel
def _meet(p, k, particles, h, shapes, grid, near, edges, contacts, count):  # type: ignore[no-untyped-def]
    # One object whose box overlaps that of particle p.
    if not _overlap(grid.box, p, k):
        return edges, count
    if k >= particles:
        return look_at(p, k - particles, shapes, near, edges), count
    if shapes.shielded[p]:
        return edges, count
    # Two discs that are both looked for meet once.
    if k != p and (k < p or shapes.edge_start[p] != shapes.edge_start[p + 1]):
        count = touch_disc(p, k, h, shapes, contacts, count)
    return edges, count


@inner_kernel
def _meet_grid(p, particles, h, shapes, grid, near, contacts, count):  # type: ignore[no-untyped-def]
    # Everything whose box overlaps that of particle p: discs at once, edges are noted.
    edges = 0
    cell = grid.cell[0]
    box = grid.box
    if is_large(box[p, 0], box[p, 1], box[p, 2], box[p, 3], cell):
        for k in range(box.shape[0]):
            if box[k, 0] <= box[k, 2] and (
                k >= particles or (shapes.edge_start[k] == shapes.edge_start[k + 1] and not shapes.shielded[k])
            ):
                edges, count = _meet(p, k, particles, h, shapes, grid, near, edges, contacts, count)
        return edges, count
    for at in range(grid.large.shape[0]):
        edges, count = _meet(p, grid.large[at], particles, h, shapes, grid, near, edges, contacts, count)
    left = math.floor(box[p, 0] / cell)
    bottom = math.floor(box[p, 1] / cell)
    buckets = grid.start.shape[0] - 1
    for column in range(left, math.floor(box[p, 2] / cell) + 1):
        for row in range(bottom, math.floor(box[p, 3] / cell) + 1):
            bucket = bucket_of(column, row, buckets)
            for entry in range(grid.start[bucket], grid.start[bucket + 1]):
                k = grid.object[entry]
                # Boxes that share many cells meet in the first of them alone.
                if (
                    grid.column[entry] == column
                    and grid.row[entry] == row
                    and column == max(left, grid.low[k, 0])
                    and row == max(bottom, grid.low[k, 1])
                ):
                    edges, count = _meet(p, k, particles, h, shapes, grid, near, edges, contacts, count)
    return edges, count


@inner_kernel
def _meet_terrain(p, dynamic, shapes, terrain, box, near, edges):  # type: ignore[no-untyped-def]
    # Note the edges of terrain in the cells that a particle's box covers.
    cell = terrain.cell[0]
    left, right = span(box[p, 0], box[p, 2], terrain.corner[0], cell, terrain.size[0])
    bottom, top = span(box[p, 1], box[p, 3], terrain.corner[1], cell, terrain.size[1])
    for row in range(bottom, top + 1):
        for column in range(left, right + 1):
            at = row * terrain.size[0] + column
            for entry in range(terrain.cell_start[at], terrain.cell_start[at + 1]):
                e = dynamic + terrain.cell_edge[entry]
                known = False
                for i in range(edges):
                    if near.edge[edges - 1 - i] == e:
                        known = True
                        break
                if not known:
                    edges = look_at(p, e, shapes, near, edges)
    return edges


@inner_kernel
def span(low, high, corner, cell, size):  # type: ignore[no-untyped-def]
    """First and last of `size` cells that an interval covers; none: the last is before the first."""
    first = (low - corner) / cell
    last = (high - corner) / cell
    if not (last >= 0.0 and first < size):
        return 0, -1
    return math.floor(max(0.0, first)), math.floor(min(last, size - 1.0))


@inner_kernel
def _look_deep(p, shapes, solid, near, edges, dynamic, contacts, count):  # type: ignore[no-untyped-def]
    # A particle that is near no edge of a solid body, yet inside it, is pushed out at the nearest edge.
    y = shapes.place[p, 1]
    for k in range(solid.shape[0]):
        owner = shapes.owner[shapes.edge_a[solid[k, 0]]]
        skipped = owner == shapes.owner[p] or not shapes.collides[p] & shapes.group[shapes.edge_a[solid[k, 0]]]
        for i in range(edges):
            if shapes.owner[shapes.edge_a[near.edge[i]]] == owner:
                skipped = True
        if skipped or shapes.inverse[p] + shapes.inverse[shapes.edge_a[solid[k, 0]]] == 0.0:
            continue
        winding = 0
        nearest = -1
        lowest = 0.0
        for e in range(solid[k, 0], solid[k, 1]):
            if shapes.side[e] == 0:
                continue
            _, distance, signed, _ = closest(p, shapes.edge_a[e], shapes.edge_b[e], shapes.place)
            if nearest < 0 or distance < lowest:
                nearest = e
                lowest = distance
            below = shapes.place[shapes.edge_a[e], 1] <= y
            if below != (shapes.place[shapes.edge_b[e], 1] <= y):
                # A ray to the right crosses the edge if the point is on its left going up, on its right going down.
                if below and signed < 0.0:
                    winding += 1
                elif not below and signed > 0.0:
                    winding -= 1
        # A hollow chain runs the other way round: nothing is counted outside it, -1 inside.
        hollow = nearest >= 0 and _is_hollow(solid[k, 0], solid[k, 1], shapes)
        if nearest >= 0 and (winding == 0 if hollow else winding > 0):
            share, distance, _, region = closest(p, shapes.edge_a[nearest], shapes.edge_b[nearest], shapes.place)
            count = push_out(p, nearest, share, distance, region, shapes, dynamic, contacts, count)
    return count


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
def _find(shapes, grid, terrain, solid, particles, dynamic, tick, h, near, contacts):  # type: ignore[no-untyped-def]
    # All contacts; their number, which may be above what there is room for.
    count = 0
    for p in range(particles):
        if shapes.collides[p] == 0:
            continue
        edges, count = _meet_grid(p, particles, h, shapes, grid, near, contacts, count)
        if terrain.edge_a.shape[0] > 0:
            edges = _meet_terrain(p, dynamic, shapes, terrain, grid.box, near, edges)
        if edges > 0:
            count = touch_edges(p, h, shapes, near, edges, dynamic, contacts, count)
        if solid.shape[0] > 0 and (tick + p) % DEEP_TICKS == 0:
            count = _look_deep(p, shapes, solid, near, edges, dynamic, contacts, count)
    return count


@kernel
def _carry_over(contacts, old_particle, old_feature, old_impulse):  # type: ignore[no-untyped-def]
    # The last step's impulses of the same features; both lists ascend by particle.
    begin = 0
    for c in range(contacts.particle.shape[0]):
        p = contacts.particle[c]
        while begin < old_particle.shape[0] and old_particle[begin] < p:
            begin += 1
        at = begin
        while at < old_particle.shape[0] and old_particle[at] == p:
            if old_feature[at] == contacts.feature[c]:
                contacts.impulse[c, 0] = old_impulse[at, 0]
                contacts.impulse[c, 1] = old_impulse[at, 1]
                break
            at += 1


def find_contacts(world: World, h: float) -> Contacts:
    """All contacts of a step of h [s] that begins with the velocities which gravity and all else have left."""
    outline = outline_of(world)
    shapes = shapes_of(world, outline)
    particles = world.particle_count
    box, is_target = np.zeros((particles + outline.dynamic, 4)), np.zeros(particles + outline.dynamic, dtype=np.bool_)
    _boxes(shapes, particles, outline.dynamic, h, box, is_target)
    grid = make_grid(box, is_target)
    near = room_near()
    room = 64 + 2 * len(world.contact_particle)
    while True:
        contacts = room_for(room)
        count = _find(
            shapes, grid, world.terrain, outline.solid, particles, outline.dynamic, world.tick, h, near, contacts
        )  # fmt: skip
        if count <= room:
            break
        room = count
    contacts = Contacts._make(array[:count] for array in contacts)
    _carry_over(contacts, world.contact_particle.astype(np.int64), world.contact_feature, world.contact_impulse)
    return contacts
