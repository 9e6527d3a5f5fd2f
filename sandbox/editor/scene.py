"""Scene: a level as arrays to draw, pick from and measure, made again after every edit from what did not change."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from operator import is_, itemgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.items import Item, Selection, items_of
from sandbox.level.document.model import Level, ParticleDef, ZoneDef
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef
from sandbox.level.format.limits import BODY_RADIUS, DEFAULT_MATERIAL
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.geometry import distances
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.plan.actuators import actuators
from sandbox.level.plan.plan import Layout, Plan, kept_plan, united
from sandbox.level.plan.surfaces import surfaces_of

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
Mask = NDArray[np.bool_]
Box = tuple[float, float, float, float]


# Fields of a body that its particles do not depend on, but for the place that is added to each of them.
_PLACED = ("type", "id", "position", "velocity", "material", "group", "extras")


# Sides by which a circle is drawn.
ROUND = 72


class _Joined(NamedTuple):
    """The expansions of bodies with their arrays joined; of a body that has an origin, about that."""

    made: list[Expansion[Any]]
    counts: list[int]
    position: Floats
    mass: Floats
    pinned: Mask
    pairs: Slots
    numbers: Slots
    rest_length: Floats
    spring_counts: list[int]


class _Loose(NamedTuple):
    """Arrays of the loose particles."""

    position: Floats
    mass: Floats
    radius: Floats
    pinned: Mask


class _Links(NamedTuple):
    """Arrays of the loose springs: ends (k, 2), rest_length (k,), NaN = as placed, material (k,) of `materials`."""

    ends: Slots
    rest_length: Floats
    material: Slots
    materials: tuple[str, ...]


class _Ground(NamedTuple):
    """Arrays of terrain, then of zones: corner [m] (c, 2), counts (t,), edge (e, 2) of corners, edge_counts (t,)."""

    corner: Floats
    counts: list[int]
    edge: Slots
    edge_counts: list[int]


class Collision(NamedTuple):
    """Bits (n,) of the collision group that each particle is in, and of those that it touches."""

    group: Slots
    touches: Slots

    def meet(self, a: Slots | int, b: Slots | int) -> Mask:
        """Whether particles collide with others, both (k,) or one for all."""
        return np.asarray((self.touches[a] & self.group[b] != 0) & (self.touches[b] & self.group[a] != 0))


class _Names:
    """Names of particles and springs: the same in every scene whose items and counts are the same."""

    def __init__(self, level: Level, items: tuple[Item, ...], plan: Plan) -> None:
        self.level, self.items, self.plan = level, items, plan
        self.counts = [made.form_count[0] for made in plan.bodies]

    @property
    def layout(self) -> Layout:
        return self.plan.layout

    @cached_property
    def item_index(self) -> dict[Item, int]:
        return {item: index for index, item in enumerate(self.items)}

    def serve(self, level: Level, counts: list[int]) -> bool:
        """Whether another level has the same items with the same names of particles."""
        old = self.level
        return (
            counts == self.counts
            and len(level.springs) == len(old.springs)
            and (level.bodies is old.bodies or _alike(level.bodies, old.bodies))
            and (level.particles is old.particles or [part.id for part in level.particles] == self._particle_ids)
            and [piece.id for piece in level.terrain] == [piece.id for piece in old.terrain]
            and [zone.id for zone in level.zones] == [zone.id for zone in old.zones]
        )

    @cached_property
    def _particle_ids(self) -> list[str]:
        return [part.id for part in self.level.particles]


def _alike(new: tuple[AnyBody, ...], old: tuple[AnyBody, ...]) -> bool:
    return [body.id for body in new] == [body.id for body in old] and [*map(type, new)] == [*map(type, old)]


@dataclass(frozen=True, eq=False)
class _Parts:
    """Parts of a scene that the next one may reuse."""

    bodies: _Joined
    origin: Floats  # (k, 2) [m] of each body
    forms: dict[tuple[Any, ...], Expansion[Any]]
    loose: _Loose
    names: _Names
    links: _Links
    ground: _Ground


@dataclass(frozen=True, eq=False)
class Scene:
    """Arrays of what a level expands to, before welds: n particles, those of bodies first, m springs, and terrain.

    position [m] (n, 2), of welded particles that of the first; mass [kg] and radius [m] (n,), each its own; pinned
    (n,), whether it or one it is welded to is held; particle_item (n,), spring_item (m,): indices into items;
    particle_a, particle_b (m,): particles; rest_length [m] (m,); number (m,): the k of the spring's name; material
    (m,): index into materials; welds (w, 2): particles; first_of_weld (n,): the first particle of each one's weld.
    corner [m] (c, 2) of terrain and zones, edge (e, 2): its ends; corner_item (c,), edge_item (e,): indices into items.
    """

    level: Level
    items: tuple[Item, ...]
    position: Floats
    mass: Floats
    radius: Floats
    pinned: Mask
    particle_item: Slots
    particle_a: Slots
    particle_b: Slots
    rest_length: Floats
    spring_item: Slots
    number: Slots
    material: Slots
    materials: tuple[str, ...]
    welds: Slots
    first_of_weld: Slots
    corner: Floats
    edge: Slots
    corner_item: Slots
    edge_item: Slots
    parts: _Parts = field(repr=False)

    @cached_property
    def collision(self) -> Collision:
        """Which particles collide with which."""
        surfaces = surfaces_of(self.level, self.parts.bodies.counts)
        return Collision(surfaces["group"], surfaces["collides"])

    @cached_property
    def _firsts(self) -> Slots:
        return np.cumsum([0, *self.parts.names.counts])

    @property
    def zone_start(self) -> int:
        """Index into `items` of the first zone; all that follow are zones."""
        return len(self.items) - len(self.level.zones)

    @property
    def terrain_start(self) -> int:
        """Index into `items` of the first piece of terrain."""
        return self.zone_start - len(self.level.terrain)

    def names(self, slot: int) -> str:
        """Name of a particle: `deck.20`, of a loose one its id."""
        index = int(self.particle_item[slot])
        kind, key = self.items[index]
        return f"{key}.{slot - int(self._firsts[index])}" if kind == "body" else str(key)

    def slot(self, name: str) -> int:
        """Index of the particle of that name. Raises LookupError."""
        return self.parts.names.layout.slot(name)

    def place(self, slot: int) -> tuple[float, float]:
        """Place [m] of a particle."""
        x, y = self.position[slot].tolist()
        return x, y

    def spring_name(self, spring: int) -> str:
        """Name of a spring: `deck:20`, of a loose one `:20`."""
        kind, key = self.items[int(self.spring_item[spring])]
        return f"{key}:{self.number[spring]}" if kind == "body" else f":{key}"

    def chosen(self, selection: Selection) -> Mask:
        """Which of `items` are selected (k,)."""
        mask = np.zeros(len(self.items), dtype=np.bool_)
        if len(selection) == len(self.items):
            mask[:] = True
            return mask
        index = self.parts.names.item_index
        mask[[index[item] for item in selection]] = True
        return mask

    def particles_of(self, selection: Selection) -> Mask:
        """Which particles (n,) belong to selected items, all of which the level has."""
        return self.chosen(selection)[self.particle_item]

    def springs_of(self, selection: Selection) -> Mask:
        """Which springs (m,) belong to selected items, all of which the level has."""
        return self.chosen(selection)[self.spring_item]

    def bounds(self, selection: Selection | None = None) -> Box | None:
        """Left, bottom, right, top [m] of a selection (None = all): particles, ends of springs, corners of outlines."""
        points, corners = self.position, self.corner
        if selection is not None:
            corners = corners[self.chosen(selection)[self.corner_item]]
            shown, springs = self.particles_of(selection), self.springs_of(selection)
            shown[self.particle_a[springs]] = True
            shown[self.particle_b[springs]] = True
            points = points[shown]
        points = np.concatenate([points, corners]) if len(corners) else points
        if not len(points):
            return None
        (left, bottom), (right, top) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        return left, bottom, right, top


def make_scene(level: Level, before: Scene | None = None) -> Scene:
    """Expand a sound level; before: the scene of another state of it, of which all that did not change is reused."""
    parts = _parts(level, before)
    bodies, loose, names, links = parts.bodies, parts.loose, parts.names, parts.links
    position = np.concatenate([bodies.position + np.repeat(parts.origin, bodies.counts, axis=0), loose.position])
    pinned = np.concatenate([bodies.pinned, loose.pinned])
    layout = names.layout if level.welds else None
    welds = [(layout.slot(a), layout.slot(b)) for a, b in level.welds] if layout else []
    first_of_weld = united(len(position), welds)
    if welds:
        position = position[first_of_weld]
        pinned = np.bincount(first_of_weld, weights=pinned, minlength=len(pinned))[first_of_weld] > 0
    placed = np.isnan(links.rest_length)
    lengths = np.where(placed, distances(position, links.ends), links.rest_length)
    pairs = np.concatenate([bodies.pairs, links.ends])
    numbers = np.arange(len(names.items), dtype=np.int64)
    of_bodies, owners = len(level.bodies), len(level.bodies) + len(level.particles)
    solid = owners + len(level.springs)
    ground = parts.ground
    used = np.array([links.materials.index(body.material) for body in level.bodies], dtype=np.int64)
    return Scene(
        level=level,
        items=names.items,
        position=position,
        mass=np.concatenate([bodies.mass, loose.mass]),
        radius=np.concatenate([np.repeat(_radii(level), bodies.counts), loose.radius]),
        pinned=pinned,
        particle_item=np.concatenate([np.repeat(numbers[:of_bodies], bodies.counts), numbers[of_bodies:owners]]),
        particle_a=pairs[:, 0],
        particle_b=pairs[:, 1],
        rest_length=np.concatenate([bodies.rest_length, lengths]),
        spring_item=np.concatenate([np.repeat(numbers[:of_bodies], bodies.spring_counts), numbers[owners:solid]]),
        number=np.concatenate([bodies.numbers, numbers[: len(level.springs)]]),
        material=np.concatenate([np.repeat(used, bodies.spring_counts), links.material]),
        materials=links.materials,
        welds=np.array(welds, dtype=np.int64).reshape(-1, 2),
        first_of_weld=first_of_weld,
        corner=ground.corner,
        edge=ground.edge,
        corner_item=np.repeat(numbers[solid:], ground.counts),
        edge_item=np.repeat(numbers[solid:], ground.edge_counts),
        parts=parts,
    )


def _radii(level: Level) -> Floats:
    """Radius [m] of the particles of each body (k,)."""
    radii = [body.particle_radius for body in level.bodies]
    return np.array([BODY_RADIUS if radius is None else radius for radius in radii], dtype=np.float64)


def _parts(level: Level, before: Scene | None) -> _Parts:
    if before is None:
        plan = kept_plan(level) or Plan(level)
        made, origin, forms = _shared(level, dict(zip(map(id, level.bodies), plan.bodies, strict=True)), {})
        bodies, loose = _joined(made), _loose(level)
        names = _Names(level, items_of(level), plan)
        return _Parts(bodies, origin, forms, loose, names, _links(level, names), _ground(level))
    old = before.parts
    bodies, origin, forms = old.bodies, old.origin, old.forms
    if level.bodies is not before.level.bodies:
        known = dict(zip(map(id, before.level.bodies), bodies.made, strict=True))
        made, origin, forms = _shared(level, known, forms)
        is_same = len(made) == len(bodies.made) and all(map(is_, made, bodies.made))
        bodies = bodies if is_same else _joined(made)
    loose = old.loose if level.particles is before.level.particles else _loose(level)
    same_names = old.names.serve(level, bodies.counts)
    names = old.names if same_names else _Names(level, items_of(level), Plan(level, bodies.made))
    same_links = same_names and level.springs is before.level.springs and level.materials is before.level.materials
    links = old.links if same_links else _links(level, names)
    is_same_ground = level.terrain is before.level.terrain and level.zones is before.level.zones
    ground = old.ground if is_same_ground else _ground(level)
    return _Parts(bodies, origin, forms, loose, names, links, ground)


def _joined(made: list[Expansion[Any]]) -> _Joined:
    counts = [each.form_count[0] for each in made]
    firsts = np.cumsum([0, *counts]).tolist()
    none = np.zeros((0, 2), dtype=np.int64)
    return _Joined(
        made=made,
        counts=counts,
        position=np.concatenate([np.zeros((0, 2)), *(_about_origin(each) for each in made)]),
        mass=np.concatenate([np.zeros(0), *(each.mass for each in made)]),
        pinned=np.concatenate([np.zeros(0, dtype=np.bool_), *(each.pinned for each in made)]),
        pairs=np.concatenate([none, *(each.pairs + first for each, first in zip(made, firsts, strict=False))]),
        numbers=np.concatenate([none[:, 0], *(each.numbers for each in made)]),
        rest_length=np.concatenate([np.zeros(0), *(_lengths_about_origin(each) for each in made)]),
        spring_counts=[len(each.pairs) for each in made],
    )


def _about_origin(made: Expansion[Any]) -> Floats:
    return made.local_form[0] if made.body.pose is None else made.position


def _lengths_about_origin(made: Expansion[Any]) -> Floats:
    # Of a form that bodies share, the same whichever of them was expanded first.
    return made.rest_length if _form_key(made.body) is None else distances(made.local_form[0], made.pairs)


def _shared(
    level: Level, known: dict[int, Expansion[Any]], old_forms: dict[tuple[Any, ...], Expansion[Any]]
) -> tuple[list[Expansion[Any]], Floats, dict[tuple[Any, ...], Expansion[Any]]]:
    """Expansions of the bodies and their origins [m] (k, 2); a form is shared by all bodies that have it.

    known: expansions by the identity of the body, which are taken over, as are the old forms.
    """
    forms: dict[tuple[Any, ...], Expansion[Any]] = {}
    made, origin = [], []
    for body in level.bodies:
        key = _form_key(body)
        if key is None:
            made.append(known.get(id(body)) or expansion(body))
            origin.append((0.0, 0.0))
            continue
        if key not in forms:
            forms[key] = old_forms.get(key) or known.get(id(body)) or expansion(body)
        made.append(forms[key])
        origin.append(body.__dict__["position"])
    return made, np.array(origin, dtype=np.float64).reshape(-1, 2), forms


def _form_key(body: AnyBody) -> tuple[Any, ...] | None:
    """Key of a body's form: all its fields but its place; None where a move alters more than one point."""
    if "position" not in body.__dict__ or body.pose is not None:
        return None
    return type(body), *(value for name, value in body.__dict__.items() if name not in _PLACED)


def _loose(level: Level) -> _Loose:
    rows = [particle.__dict__ for particle in level.particles]
    return _Loose(
        position=positions(level.particles),
        mass=np.fromiter(map(itemgetter("mass"), rows), np.float64, len(rows)),
        radius=np.fromiter(map(itemgetter("radius"), rows), np.float64, len(rows)),
        pinned=np.fromiter(map(itemgetter("pinned"), rows), np.bool_, len(rows)),
    )


def positions(particles: Sequence[ParticleDef]) -> Floats:
    """Places of loose particles [m] (n, 2)."""
    places = chain.from_iterable([particle.__dict__["position"] for particle in particles])
    return np.fromiter(places, np.float64, 2 * len(particles)).reshape(-1, 2)


def _links(level: Level, names: _Names) -> _Links:
    materials = tuple({DEFAULT_MATERIAL: None} | dict.fromkeys(level.materials))
    index = {name: number for number, name in enumerate(materials)}
    slots = [(names.layout.slot(spring.a), names.layout.slot(spring.b)) for spring in level.springs]
    lengths = (spring.given_length for spring in level.springs)
    rest = [np.nan if length is None else length for length in lengths]
    return _Links(
        ends=np.array(slots, dtype=np.int64).reshape(-1, 2),
        rest_length=np.array(rest, dtype=np.float64),
        material=np.array([index[spring.material] for spring in level.springs], dtype=np.int64),
        materials=materials,
    )


def _ground(level: Level) -> _Ground:
    corners = [np.array(piece.polyline or piece.polygon, dtype=np.float64) for piece in level.terrain]
    corners += map(outline_of, level.zones)
    counts = [len(points) for points in corners]
    closed = [*(piece.polygon is not None for piece in level.terrain), *(True for _ in level.zones)]
    edges = [np.zeros((0, 2), dtype=np.int64)]
    first = 0
    for count, is_closed in zip(counts, closed, strict=True):
        along = np.arange(first, first + count, dtype=np.int64)
        edges.append(np.stack([along, np.roll(along, -1)], axis=1)[: count if is_closed else count - 1])
        first += count
    return _Ground(
        corner=np.concatenate([np.zeros((0, 2)), *corners]),
        counts=counts,
        edge=np.concatenate(edges),
        edge_counts=[len(edge) for edge in edges[1:]],
    )


def outline_of(zone: ZoneDef) -> NDArray[np.float64]:
    """Corners [m] (k, 2) of a zone, in order; of a circle many."""
    if zone.box is not None:
        left, bottom, right, top = zone.box
        return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
    if zone.circle is not None:
        x, y, radius = zone.circle
        turn = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
        return np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])
    return np.array(zone.polygon, dtype=np.float64).reshape(-1, 2)


class SceneActuators(NamedTuple):
    """Springs that are muscles, one for each body of them; hydraulics; hubs with motors, and inner radii [m]."""

    muscles: list[int]
    hydraulics: list[tuple[int, HydraulicDef]]
    motors: list[tuple[int, float, MotorDef]]


def scene_actuators(scene: Scene) -> SceneActuators:
    """Motors, muscles and hydraulics of a scene."""
    level = scene.level
    found = SceneActuators([], [], [])
    for index, body in enumerate(level.bodies):
        if body.drive is not None:
            start, end = np.searchsorted(scene.spring_item, [index, index + 1]).tolist()
            if start < end:
                found.muscles.append(_middle(scene, start, end))
        if isinstance(body, WheelDef) and body.motor is not None:
            found.motors.append((scene.slot(f"{body.id}.hub"), body.radius - body.thickness, body.motor))
    first = len(scene.rest_length) - len(level.springs)
    for index, spring in enumerate(level.springs, first):
        if spring.drive is not None:
            found.muscles.append(index)
        if spring.hydraulic is not None:
            found.hydraulics.append((index, spring.hydraulic))
    return found


def driven_items(scene: Scene) -> Iterator[Item]:
    """Items that move by themselves: muscles, and wheels with a motor that runs from the start."""
    level = scene.level
    running = {part.name for part in actuators(level) if part.start_value}
    for body in level.bodies:
        if (body.drive is not None and body.drive.amplitude) or body.id in running:
            yield Item("body", body.id)
    for index, spring in enumerate(level.springs):
        if spring.drive is not None and spring.drive.amplitude:
            yield Item("spring", index)


def _middle(scene: Scene, start: int, end: int) -> int:
    """The spring of a range that lies nearest to the middle of all of them."""
    a, b = scene.particle_a[start:end], scene.particle_b[start:end]
    middles = (scene.position[a] + scene.position[b]) / 2.0
    apart = middles - middles.mean(axis=0)
    return start + int(np.argmin(np.sum(apart * apart, axis=1)))
