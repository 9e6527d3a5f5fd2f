"""build_world(level): definitions expanded in file order into the slots of a World."""

import numpy as np
from numpy.typing import NDArray

from sandbox.level.build.actuators import given_length, parts
from sandbox.level.build.expansion import Expansion, expansion
from sandbox.level.build.layout import Layout
from sandbox.level.build.welds import welded
from sandbox.level.faults.validate import check_level
from sandbox.level.format.drives import HydraulicDef, MotorDef
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.model import HookeMaterial, Level, Material, NissenMaterial
from sandbox.level.format.surfaces import surface_of, surfaces_of, terrain_of
from sandbox.level.kinds.bodies import RingDef
from sandbox.level.kinds.body_constraints import areas, bending, bends
from sandbox.level.kinds.outlines import edges
from sandbox.physics.actuators import NEVER, Driven, Hydraulics, Motors, Muscles, StrainLimits
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.driving import drive_muscles
from sandbox.physics.settings import WorldSettings
from sandbox.physics.world import LAW_HOOKE, LAW_NISSEN, OWN_MATERIAL, World

Slots = NDArray[np.int64]


def build_world(level: Level) -> World:
    """Build the world that a level describes.

    Particle slots: the particles of the bodies in file order, then the loose particles, of welded ones the first
    alone; spring slots: the springs of the bodies in file order, then the loose springs; then the slots of the hands.
    Materials: "default" first, then the level's in file order. Raises LevelError for a level that breaks a limit or
    refers to nothing.
    """
    check_level(level, f'level "{level.name}"')
    materials = {DEFAULT_MATERIAL: NissenMaterial(), **level.materials}
    world = World(WorldSettings(**dict(level.settings)), list(materials))
    bodies = [expansion(body) for body in level.bodies]
    layout = Layout(level, [len(body.mass) for body in bodies])
    firsts = welded(level, layout)
    stays = firsts == np.arange(len(firsts))
    slots = (np.cumsum(stays) - 1)[firsts]
    _add_particles(world, level, bodies, slots, stays)
    for name, slot in layout.second_names():
        world.name_particle(int(slots[slot]), name)
    _add_springs(world, layout, level, bodies, slots, materials)
    world.limits = strain_limits(materials)
    _fit(world, layout, level, bodies, slots)
    world.reserve_hands()
    add_elements(world, layout, level, bodies, slots, materials)
    world.terrain, world.surface = terrain_of(level), surface_of(level)
    return world


def _add_particles(world: World, level: Level, bodies: list[Expansion], slots: Slots, stays: NDArray[np.bool_]) -> None:
    """Add the particles that stay (bool, one per particle before welds); slots: which of them each becomes."""
    loose = level.particles
    names = [f"{body.id}.{k}" for body, made in zip(level.bodies, bodies, strict=True) for k in range(len(made.mass))]
    surfaces = surfaces_of(level, [len(made.mass) for made in bodies])
    radius = surfaces.pop("radius")
    names += [particle.id for particle in loose]
    position = np.array([p.position for p in loose], dtype=np.float64).reshape(-1, 2)
    velocity = np.array([p.velocity for p in loose], dtype=np.float64).reshape(-1, 2)
    mass = np.array([p.mass for p in loose], dtype=np.float64)
    pinned = np.array([p.pinned for p in loose], dtype=np.bool_)
    scale = np.array([p.gravity_scale for p in loose], dtype=np.float64)
    scales = [np.full(len(made.mass), body.gravity_scale) for body, made in zip(level.bodies, bodies, strict=True)]
    scale = np.concatenate([*scales, scale])
    position = np.concatenate([*(body.position for body in bodies), position])
    velocity = np.concatenate([*(body.velocity for body in bodies), velocity])
    mass = np.concatenate([*(body.mass for body in bodies), mass])
    pinned = np.concatenate([*(body.pinned for body in bodies), pinned])
    kept, gone = np.flatnonzero(stays), np.flatnonzero(~stays).tolist()
    for slot in gone:
        first = kept[slots[slot]]
        both = mass[first] + mass[slot]
        velocity[first] = (mass[first] * velocity[first] + mass[slot] * velocity[slot]) / both
        # What pulls at both pulls at the one; equal scales stay what they are, to the bit.
        if scale[first] != scale[slot]:
            scale[first] = (mass[first] * scale[first] + mass[slot] * scale[slot]) / both
        mass[first] = both
        radius[first] = max(radius[first], radius[slot])
        pinned[first] |= pinned[slot]
    # Adding 0.0 turns -0.0 into 0.0, so that a sign nobody sees cannot reach the state.
    world.add_particles(
        [names[slot] for slot in kept.tolist()],
        position[stays] + 0.0,
        velocity=velocity[stays] + 0.0,
        mass=mass[stays],
        radius=radius[stays] + 0.0,
        pinned=pinned[stays],
        gravity_scale=scale[stays] + 0.0,
        **{name: values[stays] for name, values in surfaces.items()},
    )
    for slot in gone:
        world.name_particle(int(slots[slot]), names[slot])


def _add_springs(
    world: World,
    layout: Layout,
    level: Level,
    bodies: list[Expansion],
    slots: Slots,
    materials: dict[str, Material],
) -> None:
    index = {name: number for number, name in enumerate(materials)}
    loose = level.springs
    made = list(zip(level.bodies, bodies, strict=True))
    names = [f"{body.id}:{number}" for body, expanded in made for number in expanded.numbers.tolist()]
    ends = [layout.owners[body.id].first + expanded.pairs for body, expanded in made]
    between = np.array([(layout.slot(s.a), layout.slot(s.b)) for s in loose], dtype=np.int64).reshape(-1, 2)
    lengths = [given_length(spring) for spring in loose]
    given = np.array([np.nan if length is None else length for length in lengths], dtype=np.float64)
    used = [np.full(len(expanded.pairs), index[body.material]) for body, expanded in made]
    material = np.concatenate([*used, np.array([index[s.material] for s in loose], dtype=np.int64)]).astype(np.int64)
    pairs = slots[np.concatenate([*ends, between])]
    # A loose spring joins bodies, and is in nobody's way.
    edge = np.concatenate([*(edges(body, expanded.pairs) for body, expanded in made), np.zeros(len(loose), np.int8)])
    world.add_springs(
        names + [f":{number}" for number in range(len(loose))],
        pairs[:, 0],
        pairs[:, 1],
        rest_length=np.concatenate([*(expanded.rest_length for expanded in bodies), given]) + 0.0,
        material=material,
        edge=edge if level.has_contacts else 0,
        **coefficients(material, materials),
    )


def strain_limits(materials: dict[str, Material]) -> StrainLimits:
    """The strains at which springs of each material break and yield."""

    def column(name: str) -> NDArray[np.float64]:
        values = [getattr(material, name) for material in materials.values()]
        return np.array([NEVER if value is None else value for value in values], dtype=np.float64)

    return StrainLimits(
        tension=column("tension_limit"),
        compression=column("compression_limit"),
        yielding=column("yield_strain"),
        yield_share=column("yield_limit"),
    )


def _fit(world: World, layout: Layout, level: Level, bodies: list[Expansion], slots: Slots) -> None:
    """Give the world its muscles, hydraulics and motors."""
    driven = parts(level)
    owners = [layout.owners[part.name] for part in driven if isinstance(part.drive, MotorDef)]
    motors = [part.drive for part in driven if isinstance(part.drive, MotorDef)]
    rims = [slots[owner.first + 1 : owner.first + owner.size] for owner in owners]
    turning = Motors(
        hub=slots[np.array([owner.first for owner in owners], dtype=np.int64)],
        speed=np.array([motor.speed for motor in motors], dtype=np.float64),
        torque=np.array([motor.torque for motor in motors], dtype=np.float64),
        part=np.arange(len(motors), dtype=np.int64),
        rim_start=np.cumsum([0, *map(len, rims)], dtype=np.int64),
        rim=np.concatenate([*rims, np.zeros(0, dtype=np.int64)]),
    )
    hydraulics = [part.drive for part in driven if isinstance(part.drive, HydraulicDef)]
    first_loose = sum(len(made.pairs) for made in bodies)
    holders = [part.owner for part in driven if isinstance(part.drive, HydraulicDef)]
    lifting = Hydraulics(
        spring=first_loose + np.array(holders, dtype=np.int64),
        shortest=np.array([hydraulic.shortest for hydraulic in hydraulics], dtype=np.float64),
        longest=np.array([hydraulic.longest for hydraulic in hydraulics], dtype=np.float64),
        rate=np.array([hydraulic.rate for hydraulic in hydraulics], dtype=np.float64),
        part=len(motors) + np.arange(len(hydraulics), dtype=np.int64),
    )
    names = tuple(part.name for part in driven)
    equipment = Driven(names, _muscles(level, bodies), lifting, turning)
    world.fit(equipment, [part.start_value for part in driven])
    drive_muscles(world, 0)


def _muscles(level: Level, bodies: list[Expansion]) -> Muscles:
    """The muscles of every spring, of the bodies in file order and then of the loose springs."""
    waves = [body.drive for body in level.bodies] + [spring.drive for spring in level.springs]
    counts = [len(made.pairs) for made in bodies] + [1] * len(level.springs)
    rows = [(0.0, 0, 0.0) if wave is None else (wave.amplitude, wave.period, wave.phase) for wave in waves]
    amplitude, period, phase = (np.repeat(column, counts) for column in np.array(rows).reshape(-1, 3).T)
    spring = np.flatnonzero(period)
    return Muscles(spring, amplitude[spring], period[spring].astype(np.int64), phase[spring])


def add_elements(
    world: World,
    layout: Layout,
    level: Level,
    bodies: list[Expansion],
    slots: Slots,
    materials: dict[str, Material],
) -> None:
    """Add what keeps areas and angles, body by body; at rest it is that of the body's form."""
    index = {name: number for number, name in enumerate(materials)}
    for body, made in zip(level.bodies, bodies, strict=True):
        material, bend = materials[body.material], bending(body)
        polygons = areas(body, made.pairs) if isinstance(material, NissenMaterial) else np.zeros((0, 3), dtype=np.int64)
        triples = bends(made.pairs) if bend is not None else np.zeros((0, 3), dtype=np.int64)
        if not len(polygons) and not len(triples):
            continue
        particles, form = slots[layout.owners[body.id].first :], made.form
        # Welds may have made one particle of two corners: nothing is left to keep.
        polygons, triples = (rows[_distinct(particles[rows])] for rows in (polygons, triples))
        if isinstance(material, NissenMaterial):
            inflation = body.inflation if isinstance(body, RingDef) and body.inflation is not None else 1.0
            first = world.add_elements(
                AREA, particles[polygons], form=form[polygons], inflation=inflation,
                stiffness=material.stiffness + 0.0, damping=material.damping + 0.0, material=index[body.material],
            )  # fmt: skip
            if len(polygons):
                world.name_areas(body.id, range(first, first + len(polygons)))
        if bend is not None:
            triples = triples[_has_links(form[triples])]
            world.add_elements(
                BEND, particles[triples], form=form[triples], stiffness=bend.stiffness + 0.0,
                damping=bend.damping + 0.0, material=OWN_MATERIAL,
            )  # fmt: skip


def _distinct(corners: Slots) -> NDArray[np.bool_]:
    return np.asarray((np.diff(np.sort(corners, axis=1), axis=1) != 0).all(axis=1))


def _has_links(places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether both links of each triple of places [m] (t, 3, 2) have a length, and so an angle."""
    return np.asarray((np.diff(places, axis=1) != 0.0).any(axis=2).all(axis=1))


def coefficients(material: NDArray[np.int64], materials: dict[str, Material]) -> dict[str, NDArray[np.generic]]:
    """Law and coefficients of every spring (m,), by the argument of World.add_springs that takes them."""
    rows = [_row(chosen) for chosen in materials.values()]
    law, stiffness, damping, k, c = (np.array(column)[material] for column in zip(*rows, strict=True))
    return {"law": law, "stiffness": stiffness, "damping": damping, "hooke_stiffness": k, "hooke_damping": c}


def _row(material: Material) -> tuple[int, float, float, float, float]:
    if isinstance(material, HookeMaterial):
        return LAW_HOOKE, 0.0, 0.0, material.k + 0.0, material.c + 0.0
    return LAW_NISSEN, material.stiffness + 0.0, material.damping + 0.0, 0.0, 0.0
