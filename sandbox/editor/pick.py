"""What is under the pointer, in a box, in a lasso, of a material; and how that joins what is selected already."""

from collections.abc import Sequence
from typing import Literal, assert_never

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.items import Item, Selection
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level
from sandbox.level.format.quantities import Point
from sandbox.physics.geometry.segment import distances_from_segments, lengths

Box = tuple[float, float, float, float]
Ends = tuple[NDArray[np.float64], ...]
Mode = Literal["replace", "add", "subtract", "toggle"]


def particle_at(scene: Scene, point: Point, within: float, skip: Selection = frozenset()) -> int | None:
    """Slot of the particle at point [m], by its disc, at most `within` [m] beside it, not of `skip`; None = none.

    Where discs overlap the one whose centre is nearest; of those in the same place the one drawn last.
    """
    dx, dy = scene.position[:, 0] - point[0], scene.position[:, 1] - point[1]
    near = np.flatnonzero((np.abs(dx) <= scene.radius + within) & (np.abs(dy) <= scene.radius + within))
    near = near[~scene.chosen(skip)[scene.particle_item[near]]]
    distance = np.sqrt(dx[near] ** 2 + dy[near] ** 2)
    gap = np.maximum(distance - scene.radius[near], 0.0)
    reached = gap <= within
    if not reached.any():
        return None
    near, distance, gap = near[reached], distance[reached], gap[reached]
    return int(near[np.lexsort((-near, distance, gap))[0]])


def spring_at(scene: Scene, point: Point, within: float, skip: Selection = frozenset()) -> int | None:
    """Slot of the spring nearest to point [m], at most `within` [m] away and not of `skip`; None = none.

    Of equals the one drawn last.
    """
    return _nearest_segment(_ends(scene), scene.chosen(skip)[scene.spring_item], point, within)


def edge_at(scene: Scene, point: Point, within: float, skip: Selection = frozenset()) -> int | None:
    """Index of the edge nearest to point [m], at most `within` [m] away and not of `skip`; None = none."""
    a, b = scene.corner[scene.edge[:, 0]], scene.corner[scene.edge[:, 1]]
    return _nearest_segment((a[:, 0], a[:, 1], b[:, 0], b[:, 1]), scene.chosen(skip)[scene.edge_item], point, within)


def corner_at(scene: Scene, item: Item, point: Point, within: float) -> int | None:
    """Number of the corner of a piece of terrain that is nearest to point [m], at most `within` [m] away."""
    mine = np.flatnonzero(scene.chosen(frozenset({item}))[scene.corner_item])
    distance = lengths(scene.corner[mine] - np.array(point))
    return int(distance.argmin()) if len(mine) and float(distance.min()) <= within else None


def _nearest_segment(ends: Ends, left_out: NDArray[np.bool_], point: Point, within: float) -> int | None:
    ax, ay, bx, by = ends
    x, y = point
    near = np.flatnonzero(
        (np.minimum(ax, bx) <= x + within)
        & (np.maximum(ax, bx) >= x - within)
        & (np.minimum(ay, by) <= y + within)
        & (np.maximum(ay, by) >= y - within)
        & ~left_out
    )
    start, end = (np.stack([x[near], y[near]], axis=1) for x, y in ((ax, ay), (bx, by)))
    distance = distances_from_segments(np.array(point), start, end)
    reached = distance <= within
    if not reached.any():
        return None
    near = near[reached]
    return int(near[np.lexsort((-near, distance[reached]))[0]])


def item_at(scene: Scene, point: Point, within: float, skip: Selection = frozenset()) -> Item | None:
    """The item at point [m]: particles count before springs, then edges, insides of bodies, and of terrain and zones.

    within [m]: how far beside a particle, spring or edge still counts. skip: items that do not count. A point is inside
    a body that has springs to its left and right, above and below; of several the one drawn last.
    """
    particle = particle_at(scene, point, within, skip)
    if particle is not None:
        return scene.items[int(scene.particle_item[particle])]
    spring = spring_at(scene, point, within, skip)
    if spring is not None:
        return scene.items[int(scene.spring_item[spring])]
    edge = edge_at(scene, point, within, skip)
    if edge is not None:
        return scene.items[int(scene.edge_item[edge])]
    left_out = scene.chosen(skip)
    bodies = [index for index in _items_around(scene, point) if scene.items[index].kind == "body"]
    for around in (bodies, ground_around(scene, point)):
        found = [index for index in around if not left_out[index]]
        if found:
            return scene.items[max(found)]
    return None


def items_at(scene: Scene, point: Point, within: float, skip: Selection, most: int) -> list[Item]:
    """The items at point [m], as of `item_at`, the one that counts first before those below it; no more than `most`."""
    found: list[Item] = []
    while len(found) < most:
        item = item_at(scene, point, within, skip.union(found))
        if item is None:
            break
        found.append(item)
    return found


def ground_around(scene: Scene, point: Point) -> list[int]:
    """Indices of the solid pieces of terrain and of the zones that a point [m] lies in."""
    a, b = scene.corner[scene.edge[:, 0]], scene.corner[scene.edge[:, 1]]
    crossing = np.flatnonzero((a[:, 1] > point[1]) != (b[:, 1] > point[1]))
    a, b = a[crossing], b[crossing]
    at = a[:, 0] + (b[:, 0] - a[:, 0]) * ((point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]))
    turns = np.bincount(scene.edge_item[crossing[at > point[0]]], minlength=len(scene.items))
    first = scene.terrain_start
    solid = [first + k for k, piece in enumerate(scene.level.terrain) if piece.polygon is not None]
    return [index for index in (*solid, *range(scene.zone_start, len(scene.items))) if turns[index] % 2]


def _ends(scene: Scene) -> Ends:
    x, y = scene.position[:, 0], scene.position[:, 1]
    return x[scene.particle_a], y[scene.particle_a], x[scene.particle_b], y[scene.particle_b]


def _items_around(scene: Scene, point: Point) -> set[int]:
    ax, ay, bx, by = _ends(scene)
    left, right = _beside(scene, ay, ax, by, bx, point[1], point[0])
    below, above = _beside(scene, ax, ay, bx, by, point[0], point[1])
    return left & right & below & above


def _beside(
    scene: Scene,
    au: NDArray[np.float64],
    av: NDArray[np.float64],
    bu: NDArray[np.float64],
    bv: NDArray[np.float64],
    u: float,
    v: float,
) -> tuple[set[int], set[int]]:
    """Items whose springs cross the line of constant u before v and after it."""
    crossing = np.flatnonzero((au <= u) != (bu <= u))
    au, av, bu, bv = au[crossing], av[crossing], bu[crossing], bv[crossing]
    at = av + (bv - av) * ((u - au) / (bu - au))
    owner = scene.spring_item[crossing]
    return set(np.unique(owner[at <= v]).tolist()), set(np.unique(owner[at >= v]).tolist())


def items_in_box(scene: Scene, box: Box, skip: Selection = frozenset()) -> Selection:
    """Items, but for `skip`, of which everything lies in a box: two opposite corners x, y, x, y [m] in any order."""
    left, right = sorted((box[0], box[2]))
    bottom, top = sorted((box[1], box[3]))

    def inside(points: NDArray[np.float64]) -> NDArray[np.bool_]:
        x, y = points[:, 0], points[:, 1]
        return np.asarray((x >= left) & (x <= right) & (y >= bottom) & (y <= top))

    return _enclosed(scene, inside(scene.position), inside(scene.corner)) - skip


def items_in_lasso(scene: Scene, polygon: Sequence[Point], skip: Selection = frozenset()) -> Selection:
    """Items, but for `skip`, of which everything lies inside a closed line through points [m].

    Where it crosses itself, by turns.
    """
    if len(polygon) < 3:
        return frozenset()
    corners = np.array(polygon, dtype=np.float64)
    return _enclosed(scene, _inside(corners, scene.position), _inside(corners, scene.corner)) - skip


def _inside(corners: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points (n, 2) a closed line through corners goes round, an odd number of times."""
    inside = np.zeros(len(points), dtype=np.bool_)
    low, high = corners.min(axis=0), corners.max(axis=0)
    near = np.flatnonzero(np.all((points >= low) & (points <= high), axis=1))
    x, y = points[near, 0], points[near, 1]
    odd = np.zeros(len(near), dtype=np.bool_)
    for (ax, ay), (bx, by) in zip(corners.tolist(), np.roll(corners, -1, axis=0).tolist(), strict=True):
        if ay != by:
            odd ^= ((ay > y) != (by > y)) & (x < ax + (bx - ax) * ((y - ay) / (by - ay)))
    inside[near] = odd
    return inside


def _enclosed(scene: Scene, inside: NDArray[np.bool_], corners: NDArray[np.bool_]) -> Selection:
    """Items of which all particles, springs and corners lie inside."""
    enclosed = np.ones(len(scene.items), dtype=np.bool_)
    enclosed[scene.particle_item[~inside]] = False
    enclosed[scene.corner_item[~corners]] = False
    enclosed[scene.spring_item[~(inside[scene.particle_a] & inside[scene.particle_b])]] = False
    return frozenset(scene.items[index] for index in np.flatnonzero(enclosed).tolist())


def items_of_material(level: Level, name: str) -> Selection:
    """Bodies and loose springs whose springs are of the material of that name."""
    bodies = frozenset(Item("body", body.id) for body in level.bodies if body.material == name)
    return bodies | frozenset(Item("spring", index) for index, s in enumerate(level.springs) if s.material == name)


def combined(old: Selection, new: Selection, mode: Mode) -> Selection:
    """The selection after new items are picked: they alone, too, no longer, or each the other way round."""
    match mode:
        case "replace":
            return new
        case "add":
            return old | new
        case "subtract":
            return old - new
        case "toggle":
            return old ^ new
        case _:
            assert_never(mode)
