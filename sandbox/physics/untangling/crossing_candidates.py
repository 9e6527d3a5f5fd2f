"""Candidates for crossings: the edges of a shape that are near others, and shapes that cannot cross themselves.

A truss or a wheel that has kept its form crosses itself nowhere but where it was made so, and a car on a bridge meets
it under its wheels alone. So most edges need not be compared with any other to know where lines cross (overlaps.py).
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Slots
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import Colliders
from sandbox.physics.geometry.rigid import best_turn, fit_of, rotated
from sandbox.physics.geometry.segment import doubled_area
from sandbox.physics.jit import inner_kernel

# By this share of a radius two outlines are taken apart before they are compared, so that ones that lie exactly on each
# other cross.
APART_X, APART_Y = 1e-3, 0.6e-3
# Of a distance in a form what counts: rounding must not make two edges that touch look apart.
SURE = 0.99


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


@inner_kernel
def _bound(s: int, colliders: Colliders, outline: Outline, shape_bounds: ShapeBounds) -> None:
    box = shape_bounds.box
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
def find_crossing_candidates(colliders: Colliders, outline: Outline, shape_bounds: ShapeBounds) -> None:
    """Look where shapes are, and which of them have kept their form."""
    shapes = outline.solid_of.shape[0]
    box, crossing = shape_bounds.box, shape_bounds.crossing
    for s in range(shapes):
        _bound(s, colliders, outline, shape_bounds)
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
