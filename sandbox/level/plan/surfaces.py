"""Surfaces of a level: terrain, what collides with what, friction and belts, mounts of wheels, and water."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.document.model import ContactsDef, Level, Material, NissenMaterial, ParticleDef, ZoneDef
from sandbox.level.format.limits import BODY_RADIUS
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.expansion import NO_HULL, Expansion
from sandbox.level.kinds.wheel import WheelDef
from sandbox.physics.arrays import FloatRows, SlotRows
from sandbox.physics.constraints import TRIANGLE
from sandbox.physics.keeping.equipment import Surface
from sandbox.physics.marks import ALL_GROUPS, TERRAIN_GROUP
from sandbox.physics.terrain import NO_TERRAIN, Chain, Terrain, make_terrain
from sandbox.physics.water.displacers import NO_HULLS, NO_POOLS, Pool, pools_of

# Groups that exist in every level: of terrain and walls, and of bodies that name none.
TERRAIN_NAME, DEFAULT_GROUP = "terrain", "default"

Item = BodyDef | ParticleDef


def terrain_of(level: Level) -> Terrain:
    """The terrain of a level: its pieces in file order, then the walls."""
    usual = level.contacts or ContactsDef()

    def surface(value: float | None, otherwise: float) -> float:
        return otherwise if value is None else value + 0.0

    chains = [
        Chain(
            piece.polyline or piece.polygon or (),
            "line" if piece.polyline is not None else "solid",
            surface(piece.friction, usual.friction),
            surface(piece.restitution, usual.restitution),
            piece.belt + 0.0,
        )
        for piece in level.terrain
    ]
    if level.walls is not None:
        left, bottom, right, top = level.walls.box
        friction = surface(level.walls.friction, usual.friction)
        restitution = surface(level.walls.restitution, usual.restitution)
        corners = ((left, bottom), (right, bottom), (right, top), (left, top))
        chains.append(Chain(corners, "hollow", friction, restitution))
    return make_terrain(chains) if chains else NO_TERRAIN


def surfaces_of(level: Level, counts: Sequence[int]) -> dict[str, NDArray[Any]]:
    """Radius, friction, restitution, owner, group and collides of every particle (n,), as arguments of add_particles.

    counts: number of particles of each body. In a level without contacts nothing collides.
    """
    usual, bits = level.contacts or ContactsDef(), group_bits(level)
    sizes = [*counts, *([1] * len(level.particles))]
    rows: list[list[Any]] = []
    for index, (_, item) in enumerate(colliding_items(level)):
        if isinstance(item, ParticleDef):
            radius = item.radius
        else:
            radius = BODY_RADIUS if item.particle_radius is None else item.particle_radius
        rows.append(
            [
                radius + 0.0,
                usual.friction if item.friction is None else item.friction,
                usual.restitution if item.restitution is None else item.restitution,
                index,
                bits[item.collision_group or DEFAULT_GROUP],
                _touched(item, bits) if level.has_contacts else 0,
            ]
        )
    if level.has_contacts:
        _free_wheels(level, bits, rows)
    columns = list(zip(*rows, strict=True)) if rows else [()] * 6
    names = ("radius", "friction", "restitution", "owner", "group", "collides")
    kinds = (np.float64, np.float64, np.float64, np.int32, np.int64, np.int64)
    return {
        name: np.repeat(np.array(column, dtype=kind), sizes)
        for name, column, kind in zip(names, columns, kinds, strict=True)
    }


def _free_wheels(level: Level, bits: dict[str, int], rows: list[list[Any]]) -> None:
    """Give each wheel a collision group of its own, which its mount does not touch.

    rows: as in `surfaces_of`; group and collides are last.
    """
    for number, (wheel, mount) in enumerate(free_wheels(level)):
        named, own = bits[level.bodies[wheel].collision_group or DEFAULT_GROUP], TERRAIN_GROUP << len(bits) + number
        rows[wheel][-2] = own
        for index, row in enumerate(rows):
            # Everything that touched its named group still touches it.
            touches = row[-1] | own if row[-1] & named else row[-1] & ~own
            row[-1] = touches & ~own if index in mount else touches


def _touched(item: Item, bits: dict[str, int]) -> int:
    """The bits of the groups that a body or particle touches."""
    if isinstance(item.collides, bool):
        return ALL_GROUPS if item.collides else 0
    touched = 0
    for name in item.collides:
        touched |= bits[name]
    return touched


def surface_of(level: Level) -> Surface:
    """The surface of a particle that joins the running level: that of a particle with defaults."""
    if not level.has_contacts:
        return Surface()
    usual = level.contacts or ContactsDef()
    return Surface(usual.friction, usual.restitution, group_bits(level)[DEFAULT_GROUP], ALL_GROUPS)


def colliding_items(level: Level) -> Iterator[tuple[str, Item]]:
    """Every body and loose particle with its place in the file."""
    for part in ("bodies", "particles"):
        for index, item in enumerate(getattr(level, part)):
            yield f"{part}.{index}", item


def group_bits(level: Level) -> dict[str, int]:
    """The bits of the collision groups of a level, by name, in the order of the file."""
    named = (item.collision_group for _, item in colliding_items(level) if item.collision_group is not None)
    names = dict.fromkeys([TERRAIN_NAME, DEFAULT_GROUP, *named])
    return {name: TERRAIN_GROUP << number for number, name in enumerate(names)}


def free_wheels(level: Level) -> list[tuple[int, frozenset[int]]]:
    """Wheels that pass through their mounts, with their mounts, by index."""
    wheels = (index for index, body in enumerate(level.bodies) if isinstance(body, WheelDef) and not body.touches_mount)
    found = [(wheel, mount_of(level, wheel)) for wheel in wheels]
    return [(wheel, mount) for wheel, mount in found if mount]


def mount_of(level: Level, wheel: int) -> frozenset[int]:
    """The mount of a wheel, by index: bodies, then loose particles.

    It is everything that welds and loose springs join to the hub, directly or through others, without the wheel.
    """
    axle = level.bodies[wheel].id
    ids = [*(body.id for body in level.bodies), *(particle.id for particle in level.particles)]
    number = {name: index for index, name in enumerate(ids)}
    beside: dict[int, set[int]] = defaultdict(set)
    for first, second in (*level.welds, *((spring.a, spring.b) for spring in level.springs)):
        ends = [reference.partition(".")[::2] for reference in (first, second)]
        # A rim that is tied to something is not mounted on it.
        if all(part in ("hub", "0") for owner, part in ends if owner == axle):
            a, b = (number[owner] for owner, _ in ends)
            beside[a].add(b)
            beside[b].add(a)
    mount, waiting = {wheel}, [wheel]
    while waiting:
        new = beside[waiting.pop()] - mount
        mount |= new
        waiting += new
    return frozenset(mount - {wheel})


def zones_with_water(level: Level) -> list[ZoneDef]:
    """The zones that are pools of a level, in its order."""
    return [zone for zone in level.zones if zone.water is not None and zone.box is not None]


def water_of(level: Level) -> FloatRows:
    """The pools of a level, in the order of its zones."""
    pools = [
        Pool(zone.box, zone.water.density, zone.water.fast_drag, zone.water.slow_drag, zone.water.flow)
        for zone in zones_with_water(level)
        if zone.water is not None and zone.box is not None
    ]
    return pools_of(pools) if pools else NO_POOLS


def hulls_of(level: Level, bodies: Sequence[Expansion[Any]], materials: Mapping[str, Material]) -> SlotRows:
    """The hulls of a level's bodies, in file order, of those alone that have no triangles. Bodies may join later."""
    rows, first = [NO_HULLS], 0
    for number, (body, made) in enumerate(zip(level.bodies, bodies, strict=True)):
        hull = made.hull() if _needs_hull(made, materials[body.material]) else NO_HULL
        if np.isin(hull[:, 0], made.numbers).all():
            springs = first + np.searchsorted(made.numbers, hull[:, 0])
            rows.append(np.column_stack([np.full(len(hull), number), springs, hull[:, 1]]))
        first += len(made.pairs)
    return np.concatenate(rows)


def _needs_hull(made: Expansion[Any], material: Material) -> bool:
    """Whether a body displaces water by its outline: it has no triangles, and is no ring that keeps no area."""
    areas = made.area_constraints
    if not len(areas):
        return True
    keeps_areas = isinstance(material, NissenMaterial)
    return keeps_areas != (areas.shape[1] == TRIANGLE)
