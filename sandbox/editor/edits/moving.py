"""Moving, turning, scaling, mirroring and lining up what is selected; loose springs follow their ends."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Literal, TypeVar

import numpy as np

from sandbox.editor.document import Document, EditError, all_validated, check_places, check_terrain, subject, validated
from sandbox.editor.edits.names import owner_of
from sandbox.editor.edits.remap import rebuilt
from sandbox.editor.edits.terrain import mapped_zone, shifted_zone
from sandbox.editor.items import (
    Definition,
    Item,
    Selection,
    changed,
    chosen_bodies,
    chosen_particles,
    chosen_terrain,
    chosen_zones,
    exchanged,
    group_of,
    keys,
)
from sandbox.editor.kinds.editing import PlaneMap, mapped_velocity, stretch
from sandbox.editor.kinds.table import editing
from sandbox.editor.panel.field_info import DEGREES, fields_of
from sandbox.editor.scene import Scene, make_scene, positions
from sandbox.level.document.model import Level, ParticleDef, SpringDef, TerrainDef
from sandbox.level.format.limits import COORDINATE_LIMIT
from sandbox.level.format.quantities import Description, Point, replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.geometry import Points

Edge = Literal["left", "right", "top", "bottom", "centre_x", "centre_y"]
Axis = Literal["x", "y"]


Placed = TypeVar("Placed", AnyBody, TerrainDef)
Described = TypeVar("Described", bound=Description)
# Lengths, angles and speeds that an edit works out are rounded to 1e-12, far below what is seen, so that
# a file holds 2.28 and not 2.2800000000000002.
DECIMALS = 12
_MEASURES = ("m", "rad", "m/s")


def move(document: Document, dx: float, dy: float) -> Document:
    """Move the selection by dx, dy [m]. Raises EditError where it would leave the world."""
    _finite("a move", dx, dy)
    return document if (dx, dy) == (0.0, 0.0) else _moved(document, lambda ids: np.full((len(ids), 2), (dx, dy)))


def rotate(document: Document, angle: float, centre: Point) -> Document:
    """Turn the selection by an angle [rad], counter-clockwise, about a centre [m]; start velocities turn with it."""
    _finite("a turn", angle, *centre)
    return _mapped(document, PlaneMap(centre, angle=math.remainder(angle, 2.0 * math.pi)))


def scale(document: Document, sx: float, sy: float, centre: Point) -> Document:
    """Make the selection sx times as wide and sy times as high about a centre [m]. Raises EditError where it bends."""
    _finite("a scale", sx, sy, *centre)
    if min(sx, sy) <= 0.0:
        raise EditError("a scale is a number above 0; use Mirror to turn something over")
    return _mapped(document, PlaneMap(centre, sx=sx, sy=sy))


def scale_exactly(document: Document, factor: float) -> Document:
    """Make the selection as much larger about [0, 0], to the last bit, for what is to run as it did."""
    return _mapped(document, PlaneMap((0.0, 0.0), sx=factor, sy=factor), lambda part: part)


def can_scale_unevenly(document: Document) -> bool:
    """Whether everything selected can be made longer without being made higher as much."""
    level, selection = document.level, document.selection
    is_round = any(zone.circle is not None for zone in chosen_zones(level, selection))
    return not is_round and all(editing(body).can_stretch() for body in chosen_bodies(level, selection))


def mirror(document: Document, axis: Axis, centre: Point) -> Document:
    """Turn the selection over, left to right ("x") or upside down ("y"), about a centre [m]."""
    _finite("a centre", *centre)
    return _mapped(document, PlaneMap(centre, sx=-1.0) if axis == "x" else PlaneMap(centre, sy=-1.0))


def align(document: Document, edge: Edge) -> Document:
    """Move every selected item, groups as one, so that an edge or middle lies where that of all of them does.

    Raises EditError for less than two.
    """
    parts, low, high = _boxes(document)
    if len(low) < 2:
        raise EditError("select two things or more to line them up; a group counts as one")
    axis = 0 if edge in ("left", "right", "centre_x") else 1
    fraction = {"left": 0.0, "bottom": 0.0, "right": 1.0, "top": 1.0}.get(edge, 0.5)
    # Of each and of all: the low border, the high one, or the middle between them.
    own = low[:, axis] + fraction * (high[:, axis] - low[:, axis])
    whole = low[:, axis].min() + fraction * (high[:, axis].max() - low[:, axis].min())
    return _moved_along(document, parts, whole - own, axis)


def distribute(document: Document, axis: Axis) -> Document:
    """Move every selected item, groups as one, so that the gaps between neighbours along an axis are the same."""
    parts, lows, highs = _boxes(document)
    if len(lows) < 3:
        raise EditError("select three things or more to space them evenly")
    along = 0 if axis == "x" else 1
    low, high = lows[:, along], highs[:, along]
    order = np.argsort(low + high, kind="stable")
    size = (high - low)[order]
    gap = (high[order[-1]] - low[order[0]] - size.sum()) / (len(order) - 1)
    apart = np.zeros(len(order))
    apart[order] = low[order[0]] + np.cumsum(size + gap) - (size + gap) - low[order]
    return _moved_along(document, parts, apart, along)


def _moved(document: Document, by: Callable[[list[str]], Points]) -> Document:
    """Move each selected thing that has an id by what is asked for their ids [m] (k, 2)."""
    level = document.level
    bodies = chosen_bodies(level, document.selection)
    particles = chosen_particles(level, document.selection)
    places = np.round(positions(particles) + by([particle.id for particle in particles]), DECIMALS) + 0.0
    outside = np.flatnonzero(np.any(np.abs(places) > COORDINATE_LIMIT, axis=1))
    if len(outside):
        raise _beyond(particles[outside[0]])

    def aside(parts: Sequence[Any], shift: Callable[[Any, float, float], Any]) -> list[Any]:
        ways = zip(parts, by([part.id for part in parts]).tolist(), strict=True)
        return [without_dust(shift(part, dx, dy)) for part, (dx, dy) in ways]

    moved = list(map(within, aside(bodies, shifted)))
    ground = list(map(within, aside(chosen_terrain(level, document.selection), shifted)))
    areas = all_validated(aside(chosen_zones(level, document.selection), shifted_zone))
    check_places(moved)
    rows = zip(particles, zip(*places.T.tolist(), strict=True), strict=True)
    placed = [replaced(particle, position=place) for particle, place in rows]
    level = exchanged(level, document.selection, moved, placed, ground, areas)
    if ground or areas:
        check_terrain(level)
    return replace(document, level=level)


def _finite(what: str, *numbers: float) -> None:
    if not all(map(math.isfinite, numbers)):
        raise EditError(f"{what} needs finite numbers")


def _beyond(part: Definition) -> EditError:
    return EditError(f"{subject(part)} would lie beyond the limit {COORDINATE_LIMIT:.15g}")


def within(body: Placed) -> Placed:
    """A body or piece of terrain whose points all lie inside the world. Raises EditError."""
    for name in ("start", "end", "position"):
        if max(map(abs, body.__dict__.get(name, (0.0,)))) > COORDINATE_LIMIT:
            raise _beyond(body)
    for name in ("particles", "pose", "polyline", "polygon"):
        points = body.__dict__.get(name)
        if points is not None and float(np.max(np.abs(np.array(points)))) > COORDINATE_LIMIT:
            raise _beyond(body)
    return body


def without_dust(part: Described) -> Described:
    """A body, particle, spring or piece of terrain, its lengths, angles and speeds rounded, in what it holds too."""
    changes: dict[str, Any] = {}
    about = fields_of(type(part))
    for name, value in part.__dict__.items():
        if isinstance(value, Description):
            changes[name] = without_dust(value)
        elif isinstance(value, float | tuple) and (about[name].unit in _MEASURES or about[name].unit == DEGREES):
            new = _rounded(value)
            # What would be nothing is left: a size is above 0.
            changes[name] = new if new or not value else value
    changes = {name: new for name, new in changes.items() if new != part.__dict__[name]}
    return replaced(part, **changes) if changes else part


def _rounded(value: Any) -> Any:
    """A number, or all in a tuple of tuples of them, without the dust of arithmetic."""
    if isinstance(value, tuple):
        return tuple(map(_rounded, value))
    return round(value, DECIMALS) + 0.0 if isinstance(value, float) else value


def _mapped(document: Document, motion: PlaneMap, tidy: Callable[[Any], Any] = without_dust) -> Document:
    if (motion.angle, motion.sx, motion.sy) == (0.0, 1.0, 1.0):
        return document
    level, selection = document.level, document.selection
    chosen = chosen_bodies(level, selection)
    mapped = [mapped_body(body, motion) for body in chosen]
    bodies = {body.id: body for body in all_validated([tidy(body) for body, _ in mapped])}
    images = {body.id: image for body, image in mapped}
    loose, ground = chosen_particles(level, selection), chosen_terrain(level, selection)
    particles = all_validated([tidy(mapped_particle(part, motion)) for part in loose])
    terrain = all_validated([tidy(mapped_terrain(piece, motion)) for piece in ground])
    zones = all_validated([tidy(mapped_zone(zone, motion)) for zone in chosen_zones(level, selection)])
    moved = exchanged(level, selection, chosen, particles, terrain, zones)
    if motion.factor != 1.0 or not motion.is_even:
        moved = _stretched(level, moved, _placed(selection), motion, tidy)
    if terrain or zones:
        check_terrain(moved)
    return replace(document, level=rebuilt(moved, bodies, images) if bodies else moved)


def _stretched(old: Level, new: Level, selection: Selection, motion: PlaneMap, tidy: Callable[[Any], Any]) -> Level:
    """The new level with what a motion makes of the given rest lengths between selected things of the old."""
    springs = _inside_springs(old, selection)
    scene = make_scene(old)

    def part(spring: Definition) -> Definition:
        if not isinstance(spring, SpringDef):
            return spring
        return validated(tidy(_scaled(spring, _spring_stretch(scene, spring, motion))))

    return changed(new, springs, part)


def _inside_springs(level: Level, selection: Selection) -> Selection:
    """Loose springs of a given rest length, or hydraulics, between two selected things."""
    owners = keys(selection, "body") | keys(selection, "particle")
    return frozenset(
        Item("spring", index)
        for index, spring in enumerate(level.springs)
        if spring.given_length is not None and owner_of(spring.a) in owners and owner_of(spring.b) in owners
    )


def _scaled(spring: SpringDef, factor: float) -> SpringDef:
    """A loose spring with the lengths that it is given times a factor."""
    if spring.rest_length is not None:
        spring = replaced(spring, rest_length=spring.rest_length * factor)
    if spring.hydraulic is not None:
        longest, shortest = spring.hydraulic.longest * factor, spring.hydraulic.shortest * factor
        spring = replaced(spring, hydraulic=replaced(spring.hydraulic, shortest=shortest, longest=longest))
    return spring


def _spring_stretch(scene: Scene, spring: SpringDef, motion: PlaneMap) -> float:
    (ax, ay), (bx, by) = (scene.position[scene.slot(end)].tolist() for end in (spring.a, spring.b))
    return stretch((ax, ay), (bx, by), motion)


def _placed(selection: Selection) -> Selection:
    return frozenset([item for item in selection if item[0] != "spring"])


def shifted(body: Placed, dx: float, dy: float) -> Placed:
    """A body or piece of terrain moved by dx, dy [m]."""
    changes: dict[str, Any] = {}
    for name in ("start", "end", "position"):
        if name in body.__dict__:
            x, y = body.__dict__[name]
            changes[name] = (x + dx, y + dy)
    for name in ("particles", "pose", "polyline", "polygon"):
        points = body.__dict__.get(name)
        if points is not None:
            changes[name] = tuple([(x + dx, y + dy) for x, y in points])
    return replaced(body, **changes)


def mapped_particle(particle: ParticleDef, motion: PlaneMap) -> ParticleDef:
    """A loose particle, its place and start motion mapped; its disc grows with a scale."""
    return replaced(
        particle,
        position=motion.point(particle.position),
        radius=particle.radius * motion.factor,
        velocity=mapped_velocity(particle.velocity, motion),
        spin=-particle.spin if motion.is_mirror else particle.spin,
    )


def mapped_terrain(piece: TerrainDef, motion: PlaneMap) -> TerrainDef:
    """A piece of terrain with its corners mapped."""
    polyline, polygon = (corners and motion.points(corners) for corners in (piece.polyline, piece.polygon))
    return replaced(piece, polyline=polyline, polygon=polygon)


def mapped_body(body: AnyBody, motion: PlaneMap) -> tuple[AnyBody, Points]:
    """A body mapped, and where the particles of its old form lie in the new one [m] (n, 2).

    Where the parameters of its kind cannot say what becomes of it, its pose does. Raises EditError for a stretch that
    bends it.
    """
    form = expansion(body).form
    image = np.array(motion.points(map(tuple, form.tolist())))
    pose = None if body.pose is None else motion.points(body.pose)
    edited = editing(body)
    if edited.lies_askew(motion):
        middle = tuple(((form.min(axis=0) + form.max(axis=0)) / 2.0).tolist())
        goes = motion.point(middle)
        aside = shifted(replaced(body, pose=None), goes[0] - middle[0], goes[1] - middle[1])
        start = pose if pose is not None else tuple(map(tuple, image.tolist()))
        return replaced(aside, pose=start, velocity=mapped_velocity(body.velocity, motion)), expansion(aside).form
    if not motion.is_even and not edited.can_stretch():
        raise EditError(f"{subject(body)}: a {edited.noun} can only be scaled evenly")
    changes = edited.mapped(motion)
    if pose is not None:
        changes["pose"] = pose
    return replaced(body, velocity=mapped_velocity(body.velocity, motion), **changes), image


def _boxes(document: Document) -> tuple[dict[str, int], Points, Points]:
    """The boxes that are lined up: of groups, and of items in none; ids, lowest and highest corners [m] (k, 2)."""
    placed = (chosen_bodies, chosen_particles, chosen_terrain, chosen_zones)
    chosen: list[Any] = [part for found in placed for part in found(document.level, document.selection)]
    numbers: dict[tuple[bool, str], int] = {}
    parts = {
        part.id: numbers.setdefault((group is None, part.id if group is None else group), len(numbers))
        for part, group in zip(chosen, map(group_of, chosen), strict=True)
    }
    scene = make_scene(document.level)
    part_of_item = np.array([parts.get(str(item.key), 0) for item in scene.items], dtype=np.int64)
    mine = scene.particles_of(_placed(document.selection))
    part = part_of_item[scene.particle_item[mine]]
    low, high = np.full((len(numbers), 2), np.inf), np.full((len(numbers), 2), -np.inf)
    np.minimum.at(low, part, scene.position[mine])
    np.maximum.at(high, part, scene.position[mine])
    mine = scene.chosen(document.selection)[scene.corner_item]
    part = part_of_item[scene.corner_item[mine]]
    np.minimum.at(low, part, scene.corner[mine])
    np.maximum.at(high, part, scene.corner[mine])
    return parts, low, high


def _moved_along(document: Document, parts: dict[str, int], apart: Points, axis: int) -> Document:
    if not np.any(apart):
        return document

    def by(ids: list[str]) -> Points:
        shift = np.zeros((len(ids), 2))
        shift[:, axis] = apart[[parts[name] for name in ids]]
        return shift

    return _moved(document, by)
