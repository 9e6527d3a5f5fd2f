"""Overlaps: bodies that lie in each other, or in themselves, deeper than contacts can undo.

Contacts push a particle out where it is nearest, and so hold a body that has gone through another just there. Seen are
edges that cross, found in the grid of the broad phase, and shapes of which one lies in the other. What is pressed
together crosses nowhere, so nothing more is looked at where nothing overlaps. Lines that cross lines are seen as well:
a particle that is caught in a mesh narrower than itself must not hold it open.

Most edges need not be compared: a truss or a wheel that has kept its form crosses itself nowhere but where it was made
so, and a car on a bridge meets it under its wheels alone.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, SlotRows, Slots
from sandbox.physics.collision.broad_phase import Boxes, Grid, bucket_of, cell_number, overlap
from sandbox.physics.collision.ghost_vertices import winds
from sandbox.physics.collision.narrow_phase import may_collide
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import Colliders, KeptContacts
from sandbox.physics.geometry.rigid import best_turn, fit_of, rotated
from sandbox.physics.geometry.segment import closest_on_segment, doubled_area, nearest_share, segment_of
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.marks import DISC, KINDS, TERRAIN, TIP

# By this share of a radius two outlines are taken apart before they are compared, so that ones that lie exactly on each
# other cross.
APART_X, APART_Y = 1e-3, 0.6e-3
# Of a distance in a form what counts: rounding must not make two edges that touch look apart.
SURE = 0.99
# Outlines of solid bodies that overlap deeper than this many radii of a particle part, until nothing crosses. Less
# takes contacts from what is only pressed together, more leaves what has been pushed through.
DEEP = 1.0
# Places in `counts`: crossings, and pairs.
CROSSINGS, OVERLAPS, COUNTS = range(3)


class ShapeBounds(NamedTuple):
    """Of shapes in a step: box [m] (s, 4) = left, bottom, right, top, radii included; crossing (s, 4): around all that
    the boxes of others share with it, left above right: nothing. group, collides (s,): those of all its particles.
    intact (s,): it crosses itself nowhere but where it was made so.
    """

    box: Annotated[FloatRows, "shapes, 4"]
    crossing: Annotated[FloatRows, "shapes, 4"]
    group: Annotated[Slots, "shapes"]
    collides: Annotated[Slots, "shapes"]
    intact: Annotated[Flags, "shapes"]


class Overlaps(NamedTuple):
    """The overlaps of a step: crossings of edges, and the pairs of shapes that overlap; there is room for more."""

    edge: Annotated[SlotRows, "crossings, 2"]  # of a crossing: that of the lower shape first
    ratio: Annotated[FloatRows, "crossings, 2"]  # along them
    following: Annotated[Slots, "crossings"]  # the next crossing of the same pair, -1: none
    shape: Annotated[SlotRows, "pairs, 2"]  # of a pair: the lower first
    first: Annotated[Slots, "pairs"]  # its first crossing
    separates: Annotated[Flags, "pairs"]  # whether they do
    next_pair: Annotated[Slots, "pairs"]  # the next of the same lower shape
    first_pair: Annotated[Slots, "shapes"]  # by shape
    counts: Annotated[Slots, f"{COUNTS}"]


@inner_kernel
def find_crossings(
    boxes: Boxes,
    grid: Grid,
    larges: int,
    colliders: Colliders,
    outline: Outline,
    shape_bounds: ShapeBounds,
    found: Overlaps,
) -> int:
    """Find where outlines cross each other or themselves; the number of crossings, even if there is no room for all."""
    count = 0
    # As of the last step some may not touch.
    colliders.parted_count[0] = 0
    cells = grid.cells
    particles = boxes.filter.shape[0]
    buckets = grid.start.shape[0] - 1
    find_crossing_candidates(colliders, outline, shape_bounds)
    first = 0
    for e in range(outline.dynamic[0]):
        _sort_crossings(first, min(count, found.edge.shape[0]), found)
        first = count
        k = particles + e
        if not (boxes.is_target[k] and is_crossing_candidate(e, colliders, shape_bounds)):
            continue
        left = cells[k, 0]
        bottom = cells[k, 1]
        if cells[k, 2] < left:
            for f in range(e):
                if boxes.is_target[particles + f]:
                    count = _compare(e, f, particles, boxes, colliders, outline, found, count)
            continue
        for at in range(larges):
            f = grid.large[at] - particles
            if 0 <= f < e:
                count = _compare(e, f, particles, boxes, colliders, outline, found, count)
        for column in range(left, cells[k, 2] + 1):
            for row in range(bottom, cells[k, 3] + 1):
                bucket = bucket_of(column, row, buckets)
                here = cell_number(column, row)
                seen = (0 if column == left else 1) + (0 if row == bottom else 2)
                for at in range(grid.start[bucket], grid.start[bucket + 1]):
                    entry = grid.object[at]
                    f = (entry >> 2) - particles
                    if f >= e:
                        break
                    if f >= 0 and entry & seen == seen and grid.cell[at] == here:
                        count = _compare(e, f, particles, boxes, colliders, outline, found, count)
    _sort_crossings(first, min(count, found.edge.shape[0]), found)
    found.counts[CROSSINGS] = count
    return count


@inner_kernel
def find_crossing_candidates(colliders: Colliders, outline: Outline, shape_bounds: ShapeBounds) -> None:
    """Look where shapes are, and which of them have kept their form."""
    shapes = outline.solid_of.shape[0]
    box, crossing = shape_bounds.box, shape_bounds.crossing
    for s in range(shapes):
        group = 0
        collides = 0
        box[s, 0] = box[s, 1] = math.inf
        box[s, 2] = box[s, 3] = -math.inf
        for i in range(outline.member_start[s], outline.member_start[s + 1]):
            p = outline.member[i]
            group |= colliders.group[p]
            collides |= colliders.collides[p]
            for axis in range(2):
                box[s, axis] = min(box[s, axis], colliders.position[p, axis] - colliders.radius[p])
                box[s, 2 + axis] = max(box[s, 2 + axis], colliders.position[p, axis] + colliders.radius[p])
        shape_bounds.group[s] = group
        shape_bounds.collides[s] = collides
        shape_bounds.intact[s] = _is_intact(s, colliders, outline)
    for s in range(shapes):
        crossing[s, 0] = crossing[s, 1] = math.inf
        crossing[s, 2] = crossing[s, 3] = -math.inf
        for t in range(shapes if shape_bounds.intact[s] else 0):
            if t == s or not (
                shape_bounds.collides[s] & shape_bounds.group[t] != 0
                and shape_bounds.collides[t] & shape_bounds.group[s] != 0
            ):
                continue
            left, bottom = max(box[s, 0], box[t, 0]), max(box[s, 1], box[t, 1])
            right, top = min(box[s, 2], box[t, 2]), min(box[s, 3], box[t, 3])
            if left <= right and bottom <= top:
                crossing[s, 0], crossing[s, 1] = min(crossing[s, 0], left), min(crossing[s, 1], bottom)
                crossing[s, 2], crossing[s, 3] = max(crossing[s, 2], right), max(crossing[s, 3], top)


@inner_kernel
def _is_intact(s: int, colliders: Colliders, outline: Outline) -> bool:
    # Two edges have come together by no more than both are bent: only those that were made that close are looked at.
    close = outline.close
    if not close.beyond[s] > 0.0:
        return False
    near = 4.0 * _bent(s, colliders, outline) / SURE
    if not near < close.beyond[s] * close.beyond[s]:
        return False
    for k in range(close.start[s], close.start[s + 1]):
        if close.distance[k] * close.distance[k] > near:
            break
        along, _ = cross(close.edge[k, 0], close.edge[k, 1], 0.0, colliders.position, colliders)
        if along >= 0.0:
            return False
    return True


@inner_kernel
def _bent(s: int, colliders: Colliders, outline: Outline) -> float:
    # The square of how far [m] a particle is at most from where its shape's form, moved and turned as a whole, has it.
    position, origin = colliders.position, colliders.origin
    first, last = outline.member_start[s], outline.member_start[s + 1]
    if first == last:
        return math.inf
    x, y, form_x, form_y, along, across = fit_of(origin, position, outline.member[first:last])
    if not along * along + across * across > 0.0:
        return math.inf
    cosine, sine = best_turn(along, across)
    farthest = 0.0
    for i in range(first, last):
        p = outline.member[i]
        fx, fy = rotated(cosine, sine, origin[p, 0] - form_x, origin[p, 1] - form_y)
        dx = position[p, 0] - x - fx
        dy = position[p, 1] - y - fy
        farthest = max(farthest, dx * dx + dy * dy)
    return farthest


@inner_kernel
def cross(e: int, f: int, apart: float, position: FloatRows, colliders: Colliders) -> tuple[float, float]:
    """Where edge e crosses edge f, which is widened a little: the shares along both; -1: they do not cross."""
    a = colliders.edge_a[e]
    b = colliders.edge_b[e]
    c = colliders.edge_a[f]
    d = colliders.edge_b[f]
    ax = position[a, 0]
    ay = position[a, 1]
    bx = position[b, 0]
    by = position[b, 1]
    cx = position[c, 0] + APART_X * apart
    cy = position[c, 1] + APART_Y * apart
    dx = position[d, 0] + APART_X * apart
    dy = position[d, 1] + APART_Y * apart
    if max(ax, bx) < min(cx, dx) or max(cx, dx) < min(ax, bx):
        return -1.0, -1.0
    if max(ay, by) < min(cy, dy) or max(cy, dy) < min(ay, by):
        return -1.0, -1.0
    of_c = doubled_area(ax, ay, bx, by, cx, cy)
    of_d = doubled_area(ax, ay, bx, by, dx, dy)
    of_a = doubled_area(cx, cy, dx, dy, ax, ay)
    of_b = doubled_area(cx, cy, dx, dy, bx, by)
    if (of_c > 0.0) == (of_d > 0.0) or (of_a > 0.0) == (of_b > 0.0):
        return -1.0, -1.0
    return of_a / (of_a - of_b), of_c / (of_c - of_d)


@inner_kernel
def _sort_crossings(first: int, last: int, found: Overlaps) -> None:
    # Put the crossings of one edge into the order of the others' slots: that in which cells list them follows from the
    # size of all boxes of the world.
    edge, ratio = found.edge, found.ratio
    for at in range(first + 1, last):
        to = at
        while to > first and edge[to - 1, 0] + edge[to - 1, 1] > edge[to, 0] + edge[to, 1]:
            for side in range(2):
                edge[to, side], edge[to - 1, side] = edge[to - 1, side], edge[to, side]
                ratio[to, side], ratio[to - 1, side] = ratio[to - 1, side], ratio[to, side]
            to -= 1


@inner_kernel
def is_crossing_candidate(e: int, colliders: Colliders, shape_bounds: ShapeBounds) -> bool:
    """Whether an edge of a body may cross any other edge that it was not made to cross."""
    a = colliders.edge_a[e]
    b = colliders.edge_b[e]
    s = colliders.shape[a]
    if not shape_bounds.intact[s]:
        return True
    crossing = shape_bounds.crossing
    reach = max(colliders.radius[a], colliders.radius[b])
    for axis in range(2):
        x, y = colliders.position[a, axis], colliders.position[b, axis]
        if max(x, y) + reach < crossing[s, axis] or min(x, y) - reach > crossing[s, 2 + axis]:
            return False
    return True


@inlined_kernel
def _compare(
    e: int, f: int, particles: int, boxes: Boxes, colliders: Colliders, outline: Outline, found: Overlaps, count: int
) -> int:
    if overlap(boxes.box, particles + e, particles + f):
        if colliders.shape[colliders.edge_a[e]] <= colliders.shape[colliders.edge_a[f]]:
            count = _note_crossing(e, f, colliders, outline, found, count)
        else:
            count = _note_crossing(f, e, colliders, outline, found, count)
    return count


@inner_kernel
def _note_crossing(e: int, f: int, colliders: Colliders, outline: Outline, found: Overlaps, count: int) -> int:
    # Note where edge e, of the lower shape, crosses edge f, if it may not; the number of crossings then.
    a = colliders.edge_a[e]
    c = colliders.edge_a[f]
    s = colliders.shape[a]
    t = colliders.shape[c]
    solid_s = outline.solid_of[s] >= 0
    solid_t = outline.solid_of[t] >= 0
    if (solid_s and colliders.side[e] == 0) or (solid_t and colliders.side[f] == 0):
        return count
    if not may_collide(a, c, colliders):
        return count
    apart = 0.0
    if s != t:
        apart = colliders.radius[c]
    elif a == c or a == colliders.edge_b[f] or colliders.edge_b[e] == c or colliders.edge_b[e] == colliders.edge_b[f]:
        return count
    along_e, along_f = cross(e, f, apart, colliders.position, colliders)
    if along_e < 0.0:
        return count
    if s == t and not solid_s:
        # A mesh may be made of lines that cross.
        made_so, _ = cross(e, f, apart, colliders.origin, colliders)
        if made_so >= 0.0:
            return count
    if count < found.edge.shape[0]:
        found.edge[count, 0] = e
        found.edge[count, 1] = f
        found.ratio[count, 0] = along_e
        found.ratio[count, 1] = along_f
    return count + 1


@inner_kernel
def pair_overlaps(
    colliders: Colliders, outline: Outline, bounds: FloatRows, kept: KeptContacts, kept_count: int, found: Overlaps
) -> int:
    """Sort the crossings by pairs of shapes, and decide which part; the number of pairs, counted on without room.

    Contacts between those that part are left out of the step: see `may_collide`. kept: the contacts of the last step.
    """
    found.counts[OVERLAPS] = 0
    if outline.dynamic[0] == 0:
        return 0
    for p in range(colliders.parting.shape[0]):
        colliders.parting[p] = False
        colliders.caught[p] = False
    for s in range(found.first_pair.shape[0]):
        found.first_pair[s] = -1
    for c in range(found.counts[CROSSINGS]):
        at = _pair_of(
            colliders.shape[colliders.edge_a[found.edge[c, 0]]], colliders.shape[colliders.edge_a[found.edge[c, 1]]],
            found,
        )  # fmt: skip
        if at < found.shape.shape[0]:
            found.following[c] = found.first[at]
            found.first[at] = c
    _pair_enclosed(colliders, outline, bounds, found)
    pairs = found.counts[OVERLAPS]
    if pairs > found.shape.shape[0] or pairs > colliders.parted.shape[0]:
        return pairs
    for at in range(pairs):
        s = found.shape[at, 0]
        t = found.shape[at, 1]
        both = outline.solid_of[s] >= 0 and outline.solid_of[t] >= 0
        found.separates[at] = not both or _is_crossed_deep(at, colliders, found)
        if not found.separates[at] and s != t:
            found.separates[at] = _is_inside_deep(s, t, outline, bounds, colliders) or _is_inside_deep(
                t, s, outline, bounds, colliders
            )
        # What parts goes on until nothing crosses: contacts that hold what they are to push out would take it back.
        if not found.separates[at] and kept_count > 0:
            found.separates[at] = not _touched(s, t, colliders, outline, kept, kept_count)
    # Only now, as nobody may be left out while others are looked at.
    for at in range(pairs):
        if found.separates[at]:
            colliders.parted[colliders.parted_count[0], 0] = found.shape[at, 0]
            colliders.parted[colliders.parted_count[0], 1] = found.shape[at, 1]
            alone = outline.solid_of[found.shape[at, 0]] < 0 and outline.solid_of[found.shape[at, 1]] < 0
            colliders.parted[colliders.parted_count[0], 2] = 1 if alone else 0
            colliders.parted_count[0] += 1
            # Apart: what is caught in itself, as crumpled cloth is all over, must not go through what holds it.
            mark_separating(at, colliders, outline, bounds, found, colliders.caught if alone else colliders.parting)
            if found.shape[at, 0] == found.shape[at, 1] and not alone and _is_crossed_deep(at, colliders, found):
                # Nothing but its springs parts a body from itself, and friction under a heap can hold them back.
                s = found.shape[at, 0]
                for i in range(outline.member_start[s], outline.member_start[s + 1]):
                    colliders.friction[outline.member[i]] = 0.0
    return pairs


@inner_kernel
def _pair_of(s: int, t: int, found: Overlaps) -> int:
    # The place of the pair of two shapes, the lower first, made where there is none: then it is in `counts` already.
    at = found.first_pair[s]
    while at >= 0:
        if found.shape[at, 1] == t:
            return at
        at = found.next_pair[at]
    at = found.counts[OVERLAPS]
    found.counts[OVERLAPS] = at + 1
    if at < found.shape.shape[0]:
        found.shape[at, 0] = s
        found.shape[at, 1] = t
        found.first[at] = -1
        found.next_pair[at] = found.first_pair[s]
        found.first_pair[s] = at
    return at


@inner_kernel
def _pair_enclosed(colliders: Colliders, outline: Outline, bounds: FloatRows, found: Overlaps) -> None:
    # Solid bodies that lie in others, and cross them nowhere: one corner tells.
    solids = outline.dynamic[1]
    for inner in range(solids):
        first = outline.solid[inner, 0]
        v = colliders.edge_a[first]
        for outer in range(solids):
            if inner == outer or not (
                bounds[outer, 0] <= bounds[inner, 0]
                and bounds[outer, 1] <= bounds[inner, 1]
                and bounds[outer, 2] >= bounds[inner, 2]
                and bounds[outer, 3] >= bounds[inner, 3]
            ):
                continue
            begin = outline.solid[outer, 0]
            end = outline.solid[outer, 1]
            w = colliders.edge_a[begin]
            if not may_collide(v, w, colliders):
                continue
            if winds(colliders.position[v, 0], colliders.position[v, 1], begin, end, colliders) > 0:
                s = colliders.shape[v]
                t = colliders.shape[w]
                _pair_of(min(s, t), max(s, t), found)


@inner_kernel
def _is_crossed_deep(pair: int, colliders: Colliders, found: Overlaps) -> bool:
    # Whether the least way of one of the four ends of a crossing to the other edge is long.
    c = found.first[pair]
    while c >= 0:
        least = 1e300
        for side in range(2):
            e = found.edge[c, side]
            f = found.edge[c, 1 - side]
            for end in range(2):
                p = colliders.edge_a[e] if end == 0 else colliders.edge_b[e]
                _, distance, _, _ = closest_on_segment(p, colliders.edge_a[f], colliders.edge_b[f], colliders.position)
                least = min(least, distance)
        if least > DEEP * colliders.radius[colliders.edge_a[found.edge[c, 0]]]:
            return True
        c = found.following[c]
    return False


@inner_kernel
def _is_inside_deep(s: int, t: int, outline: Outline, bounds: FloatRows, colliders: Colliders) -> bool:
    # Whether a particle of shape s, or the middle of all of them, is deep inside the solid body of shape t.
    k = outline.solid_of[t]
    x = 0.0
    y = 0.0
    first = outline.member_start[s]
    last = outline.member_start[s + 1]
    for i in range(first, last):
        p = outline.member[i]
        px = colliders.position[p, 0]
        py = colliders.position[p, 1]
        x += px
        y += py
        if _is_deep_at(px, py, DEEP * colliders.radius[p], k, outline, bounds, colliders):
            return True
    x /= last - first
    y /= last - first
    deep = DEEP * colliders.radius[outline.member[first]]
    # Of two rings that lie on each other no particle is inside.
    return _is_deep_at(x, y, deep, outline.solid_of[s], outline, bounds, colliders) and _is_deep_at(
        x, y, deep, k, outline, bounds, colliders
    )


@inner_kernel
def _is_deep_at(
    x: float, y: float, deep: float, k: int, outline: Outline, bounds: FloatRows, colliders: Colliders
) -> bool:
    # Whether a place is deeper than that inside solid body k.
    if not _is_in(x, y, k, outline, bounds, colliders):
        return False
    for e in range(outline.solid[k, 0], outline.solid[k, 1]):
        if colliders.side[e] != 0:
            ax, ay, dx, dy = segment_of(colliders.edge_a[e], colliders.edge_b[e], colliders.position)
            ratio = nearest_share(x - ax, y - ay, dx, dy)
            qx = x - ax - ratio * dx
            qy = y - ay - ratio * dy
            if not qx * qx + qy * qy > deep * deep:
                return False
    return True


@inner_kernel
def _is_in(x: float, y: float, k: int, outline: Outline, bounds: FloatRows, colliders: Colliders) -> bool:
    # Whether a place is inside solid body k.
    if not (bounds[k, 0] <= x <= bounds[k, 2] and bounds[k, 1] <= y <= bounds[k, 3]):
        return False
    return winds(x, y, outline.solid[k, 0], outline.solid[k, 1], colliders) > 0


@inner_kernel
def _touched(s: int, t: int, colliders: Colliders, outline: Outline, kept: KeptContacts, kept_count: int) -> bool:
    # Whether two shapes touched in the last step.
    for c in range(kept_count):
        k = colliders.shape[kept.particle[c]]
        kind = kept.feature[c] % KINDS
        if k in (s, t) and kind != TERRAIN and kind != TIP:
            number = kept.feature[c] // KINDS
            # An edge that a disc has come in by is its spring too.
            other = colliders.shape[number if kind == DISC else outline.spring_end[number]]
            if (k == s and other == t) or (k == t and other == s):
                return True
    return False


@inner_kernel
def mark_separating(
    pair: int, colliders: Colliders, outline: Outline, bounds: FloatRows, found: Overlaps, flags: Flags
) -> None:
    """Flag the particles that are separated: all of solid bodies; of a line those inside, and the ends of crossing
    edges.
    """
    for side in range(2):
        s = found.shape[pair, side]
        other = outline.solid_of[found.shape[pair, 1 - side]]
        for i in range(outline.member_start[s], outline.member_start[s + 1]):
            p = outline.member[i]
            if outline.solid_of[s] >= 0 or (
                other >= 0
                and _is_in(colliders.position[p, 0], colliders.position[p, 1], other, outline, bounds, colliders)
            ):
                flags[p] = True
        if outline.solid_of[s] < 0:
            c = found.first[pair]
            while c >= 0:
                flags[colliders.edge_a[found.edge[c, side]]] = True
                flags[colliders.edge_b[found.edge[c, side]]] = True
                c = found.following[c]
