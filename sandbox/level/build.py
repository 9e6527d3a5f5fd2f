"""build_world(level): definitions expanded in file order into the slots of a World."""

import numpy as np
from numpy.typing import NDArray

from sandbox.level.bodies import RingDef
from sandbox.level.elements import areas, bending, bends
from sandbox.level.expansion import Expansion, expansion
from sandbox.level.layout import Layout
from sandbox.level.limits import BODY_RADIUS, DEFAULT_MATERIAL
from sandbox.level.model import HookeMaterial, Level, Material, NissenMaterial
from sandbox.level.validate import check_level
from sandbox.level.welds import welded
from sandbox.physics.elements import AREA, BEND
from sandbox.physics.settings import WorldSettings
from sandbox.physics.slots import OWN_MATERIAL
from sandbox.physics.world import LAW_HOOKE, LAW_NISSEN, World

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
    world.reserve_hands()
    _add_elements(world, layout, level, bodies, slots, materials)
    return world


def _add_particles(world: World, level: Level, bodies: list[Expansion], slots: Slots, stays: NDArray[np.bool_]) -> None:
    """Add the particles that stay (bool, one per particle before welds); slots: which of them each becomes."""
    loose = level.particles
    names = [f"{body.id}.{k}" for body, made in zip(level.bodies, bodies, strict=True) for k in range(len(made.mass))]
    radius = np.array([BODY_RADIUS] * len(names) + [particle.radius for particle in loose], dtype=np.float64)
    names += [particle.id for particle in loose]
    position = np.array([p.position for p in loose], dtype=np.float64).reshape(-1, 2)
    velocity = np.array([p.velocity for p in loose], dtype=np.float64).reshape(-1, 2)
    mass = np.array([p.mass for p in loose], dtype=np.float64)
    pinned = np.array([p.pinned for p in loose], dtype=np.bool_)
    position = np.concatenate([*(body.position for body in bodies), position])
    velocity = np.concatenate([*(body.velocity for body in bodies), velocity])
    mass = np.concatenate([*(body.mass for body in bodies), mass])
    pinned = np.concatenate([*(body.pinned for body in bodies), pinned])
    kept, gone = np.flatnonzero(stays), np.flatnonzero(~stays).tolist()
    for slot in gone:
        first = kept[slots[slot]]
        both = mass[first] + mass[slot]
        velocity[first] = (mass[first] * velocity[first] + mass[slot] * velocity[slot]) / both
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
    given = np.array([np.nan if s.rest_length is None else s.rest_length for s in loose], dtype=np.float64)
    used = [np.full(len(expanded.pairs), index[body.material]) for body, expanded in made]
    material = np.concatenate([*used, np.array([index[s.material] for s in loose], dtype=np.int64)]).astype(np.int64)
    pairs = slots[np.concatenate([*ends, between])]
    world.add_springs(
        names + [f":{number}" for number in range(len(loose))],
        pairs[:, 0],
        pairs[:, 1],
        rest_length=np.concatenate([*(expanded.rest_length for expanded in bodies), given]) + 0.0,
        material=material,
        **coefficients(material, materials),
    )


def _add_elements(
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
            world.add_elements(
                AREA, particles[polygons], form=form[polygons], inflation=inflation,
                stiffness=material.stiffness + 0.0, damping=material.damping + 0.0, material=index[body.material],
            )  # fmt: skip
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
