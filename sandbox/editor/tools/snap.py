"""Snapping: where a pointer is taken to be, near particles, round angles and a grid, and a word that says why."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.items import Selection
from sandbox.editor.scene import Scene
from sandbox.level.format.quantities import Point
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.geometry import turn
from sandbox.physics.geometry.segment import lengths, nearest_on_segments

Kind = Literal["particle", "end", "corner", "edge", "angle", "grid", "free"]

# Directions from the anchor that a line is drawn to.
ANGLE_STEP = 15  # [degrees]
# A direction this far off a round one still counts as it; larger: hardly a direction is left free.
ANGLE_REACH = 3.0  # [degrees]
# An edge of terrain draws from this part of the distance alone: beside it is the grid.
EDGE_SHARE = 0.5
# Places are rounded to micrometres, so that files hold 0.3 and not 0.30000000000000004.
PLACE_DECIMALS = 6
# Places are told to a tenth of a millimetre where nobody typed them.
SHOWN_DECIMALS = 4


@dataclass(frozen=True)
class Snap:
    """A snapped place [m], the thing it snapped to, whose particle that is, and a word for the person.

    pointer [m]: where it really is; None = there.
    """

    point: Point
    kind: Kind = "free"
    name: str | None = None
    hint: str = ""
    pointer: Point | None = None

    @property
    def raw(self) -> Point:
        """Where the pointer really is [m]."""
        return self.point if self.pointer is None else self.pointer


def snap(
    scene: Scene,
    point: Point,
    within: float,
    grid: float | None = None,
    anchor: Point | None = None,
    skip: Selection = frozenset(),
) -> Snap:
    """Where a pointer at point [m] is taken to be.

    First the ends of bodies and loose particles, then other particles, then corners of terrain and then its edges, at
    most `within` [m] away and not of items in `skip`; then directions of whole 15 degrees from the anchor and points
    of a grid of that spacing [m], whichever is nearer. within = 0, grid = None is the pointer itself.
    """
    return replace(_drawn(scene, point, within, grid, anchor, skip), pointer=point)


def _drawn(
    scene: Scene, point: Point, within: float, grid: float | None, anchor: Point | None, skip: Selection
) -> Snap:
    place = _particle(scene, point, within, skip) or _ground(scene, point, within, grid, skip)
    if place is not None:
        return place
    places = []
    if anchor is not None and within > 0.0:
        places += _on_angle(point, anchor, within, grid)
    if grid is not None:
        places.append(Snap(_rounded(*(round(c / grid) * grid for c in point)), "grid", None, f"grid {grid:g} m"))
    if places:
        return min(places, key=lambda place: math.dist(place.point, point))
    return Snap(_rounded(*point))


def _rounded(x: float, y: float) -> Point:
    return round(x, PLACE_DECIMALS) + 0.0, round(y, PLACE_DECIMALS) + 0.0


def _particle(scene: Scene, point: Point, within: float, skip: Selection) -> Snap | None:
    """The nearest end, or else the nearest particle, that the pointer snaps to."""
    if within <= 0.0:
        return None
    offset = scene.position - np.array(point)
    near = np.flatnonzero(np.all(np.abs(offset) <= within, axis=1))
    if skip and len(near):
        near = near[~scene.particles_of(skip)[near]]
    distance = np.sqrt(np.sum(offset[near] ** 2, axis=1))
    near, distance = near[distance <= within], distance[distance <= within]
    if not len(near):
        return None
    slots = near[np.argsort(distance, kind="stable")].tolist()
    ends = _ends(scene, near)
    slot = next((slot for slot in slots if slot in ends), slots[0])
    name = ends.get(slot) or scene.names(slot)
    return Snap(scene.place(slot), "end" if slot in ends else "particle", name, f"on {name}")


def _ground(scene: Scene, point: Point, within: float, grid: float | None, skip: Selection) -> Snap | None:
    """The nearest corner of terrain that draws the pointer, or else the nearest place on an edge.

    On an edge it is where a line of the grid crosses it, if that is near as well.
    """
    if within <= 0.0 or not len(scene.corner):
        return None
    left_out = scene.chosen(skip)
    left_out[scene.zone_start :] = True
    if left_out[scene.terrain_start :].all():
        return None
    corner = np.where(left_out[scene.corner_item, None], np.inf, scene.corner)
    distance = np.hypot(*(corner - np.array(point)).T)
    nearest = int(distance.argmin())
    if distance[nearest] <= within:
        name = scene.items[int(scene.corner_item[nearest])].key
        return Snap(_rounded(*corner[nearest].tolist()), "corner", None, f"on a corner of {name}")
    edges = np.flatnonzero(~left_out[scene.edge_item])
    start, end = scene.corner[scene.edge[edges, 0]], scene.corner[scene.edge[edges, 1]]
    along = end - start
    fraction, way = nearest_on_segments(np.array(point), start, end)
    places, distance = start + fraction[:, None] * along, lengths(way)
    nearest = int(distance.argmin()) if len(edges) else -1
    if nearest < 0 or distance[nearest] > EDGE_SHARE * within:
        return None
    name = scene.items[int(scene.edge_item[edges[nearest]])].key
    place = _rounded(*places[nearest].tolist())
    if grid is not None:
        crossing = _at_grid_line(place, along[nearest].tolist(), start[nearest].tolist(), grid)
        place = crossing if math.dist(crossing, point) <= within else place
    return Snap(place, "edge", None, f"on {name}")


def _at_grid_line(place: Point, along: Point, start: Point, grid: float) -> Point:
    """Where the nearest line of the grid crosses an edge most squarely; the place itself beyond the edge's ends."""
    axis = 0 if abs(along[0]) >= abs(along[1]) else 1
    fraction = (round(place[axis] / grid) * grid - start[axis]) / along[axis]
    if not 0.0 <= fraction <= 1.0:
        return place
    return _rounded(start[0] + fraction * along[0], start[1] + fraction * along[1])


def _ends(scene: Scene, near: NDArray[np.int64]) -> dict[int, str]:
    """Names of the loose particles and of the ends of bodies among some particles, by slot."""
    ends: dict[int, str] = {}
    for item in np.unique(scene.particle_item[near]).tolist():
        first = int(np.searchsorted(scene.particle_item, item))
        if item < len(scene.level.bodies):
            body = scene.level.bodies[item]
            ends |= {first + index: f"{body.id}.{part}" for part, index in expansion(body).named_particles.items()}
        else:
            ends[first] = str(scene.items[item].key)
    return {slot: ends[slot] for slot in near.tolist() if slot in ends}


def _on_angle(point: Point, anchor: Point, within: float, grid: float | None) -> list[Snap]:
    """The point of the nearest round direction from the anchor, moved along it to the nearest line of the grid."""
    dx, dy = point[0] - anchor[0], point[1] - anchor[1]
    if math.hypot(dx, dy) <= within:
        return []
    pointed = math.degrees(math.atan2(dy, dx))
    degrees = round(pointed / ANGLE_STEP) * ANGLE_STEP
    cosine, sine = turn(math.radians(degrees))
    along, across = dx * cosine + dy * sine, dy * cosine - dx * sine
    if abs(pointed - degrees) > ANGLE_REACH or abs(across) > within:
        return []
    if grid is not None:
        # The lines that the direction crosses most squarely.
        axis, slope = (0, cosine) if abs(cosine) >= abs(sine) else (1, sine)
        line = round((anchor[axis] + along * slope) / grid) * grid
        along = (line - anchor[axis]) / slope
        if along <= 0.0:
            return []
    place = _rounded(anchor[0] + along * cosine, anchor[1] + along * sine)
    return [Snap(place, "angle", None, f"{180 - (180 - degrees) % 360}°")]
