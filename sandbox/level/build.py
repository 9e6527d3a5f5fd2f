"""build_world(level): definitions expanded in file order into the slots of a World."""

import numpy as np
from numpy.typing import NDArray

from sandbox.level.bodies import AnyBody, BridgeDef, MeshDef, RopeDef
from sandbox.level.layout import Layout
from sandbox.level.limits import BODY_RADIUS, DEFAULT_MATERIAL
from sandbox.level.model import HookeMaterial, Level, Material, NissenMaterial
from sandbox.level.shapes import Pairs, Points, expand
from sandbox.level.validate import check_level
from sandbox.physics.settings import WorldSettings
from sandbox.physics.world import LAW_HOOKE, LAW_NISSEN, World

Floats = NDArray[np.float64]
Expanded = tuple[AnyBody, Points, Pairs]


def build_world(level: Level) -> World:
    """Build the world that a level describes.

    Particle slots: the particles of the bodies in file order, then the loose particles; spring slots: the springs of
    the bodies in file order, then the loose springs; then the slots of the hands. Materials: "default" first, then
    the level's in file order. Raises LevelError for a level that breaks a limit or refers to nothing.
    """
    check_level(level, f'level "{level.name}"')
    materials = {DEFAULT_MATERIAL: NissenMaterial(), **level.materials}
    world = World(WorldSettings(**dict(level.settings)), list(materials))
    bodies = [(body, *expand(body)) for body in level.bodies]
    _add_particles(world, level, bodies)
    layout = Layout(level, [len(points) for _, points, _ in bodies])
    for name, slot in layout.end_names():
        world.name_particle(slot, name)
    _add_springs(world, layout, level, bodies, materials)
    world.reserve_hands()
    return world


def _add_particles(world: World, level: Level, bodies: list[Expanded]) -> None:
    loose = level.particles
    names = [f"{body.id}.{index}" for body, points, _ in bodies for index in range(len(points))]
    radii = [BODY_RADIUS] * len(names) + [particle.radius for particle in loose]
    position = [points for _, points, _ in bodies]
    velocity = [_velocities(body, len(points)) for body, points, _ in bodies]
    mass = [_masses(body, len(points)) for body, points, _ in bodies]
    pinned = [_pinned(body, len(points)) for body, points, _ in bodies]
    # Adding 0.0 turns -0.0 into 0.0, so that a sign nobody sees cannot reach the state.
    world.add_particles(
        names + [particle.id for particle in loose],
        np.concatenate([*position, np.array([p.position for p in loose], dtype=np.float64).reshape(-1, 2)]) + 0.0,
        velocity=np.concatenate([*velocity, np.array([p.velocity for p in loose]).reshape(-1, 2)]) + 0.0,
        mass=np.concatenate([*mass, np.array([p.mass for p in loose], dtype=np.float64)]),
        radius=np.array(radii, dtype=np.float64) + 0.0,
        pinned=np.concatenate([*pinned, np.array([p.pinned for p in loose], dtype=np.bool_)]),
    )


def _velocities(body: AnyBody, count: int) -> Floats:
    velocities = np.zeros((count, 2)) + np.array(body.velocity)
    if isinstance(body, MeshDef) and body.velocities is not None:
        velocities += np.array(body.velocities)
    return velocities


def _masses(body: AnyBody, count: int) -> Floats:
    if isinstance(body, MeshDef):
        return np.ones(count) if body.masses is None else np.array(body.masses, dtype=np.float64)
    masses = np.full(count, body.particle_mass)
    if isinstance(body, RopeDef) and body.end_mass is not None:
        masses[-1] = body.end_mass
    return masses


def _pinned(body: AnyBody, count: int) -> NDArray[np.bool_]:
    pinned = np.zeros(count, dtype=np.bool_)
    if isinstance(body, MeshDef):
        pinned[list(body.pinned)] = True
    elif isinstance(body, RopeDef | BridgeDef):
        row = body.segments + 1
        for end in body.pin:
            pinned[(0 if end == "start" else row - 1) :: row] = True
    return pinned


def _add_springs(
    world: World, layout: Layout, level: Level, bodies: list[Expanded], materials: dict[str, Material]
) -> None:
    index = {name: number for number, name in enumerate(materials)}
    loose = level.springs
    names = [f"{body.id}:{number}" for body, _, pairs in bodies for number in range(len(pairs))]
    first = [layout.owners[body.id].first for body, _, _ in bodies]
    ends = [pairs + start for (_, _, pairs), start in zip(bodies, first, strict=True)]
    between = np.array([(layout.slot(s.a), layout.slot(s.b)) for s in loose], dtype=np.int64).reshape(-1, 2)
    rest = [np.full(len(pairs), _rest_length(body)) for body, _, pairs in bodies]
    given = np.array([np.nan if s.rest_length is None else s.rest_length for s in loose], dtype=np.float64)
    used = [np.full(len(pairs), index[body.material]) for body, _, pairs in bodies]
    material = np.concatenate([*used, np.array([index[s.material] for s in loose], dtype=np.int64)]).astype(np.int64)
    pairs = np.concatenate([*ends, between])
    world.add_springs(
        names + [f":{number}" for number in range(len(loose))],
        pairs[:, 0],
        pairs[:, 1],
        rest_length=np.concatenate([*rest, given]) + 0.0,
        material=material,
        **_coefficients(material, materials),
    )


def _rest_length(body: AnyBody) -> float:
    """Rest length [m] that a body gives its springs; NaN = as placed."""
    given = body.rest_length if isinstance(body, RopeDef) else None
    return np.nan if given is None else given


def _coefficients(material: NDArray[np.int64], materials: dict[str, Material]) -> dict[str, NDArray[np.generic]]:
    """Law and coefficients of every spring (m,), by the argument of World.add_springs that takes them."""
    rows = [_row(chosen) for chosen in materials.values()]
    law, stiffness, damping, k, c = (np.array(column)[material] for column in zip(*rows, strict=True))
    return {"law": law, "stiffness": stiffness, "damping": damping, "hooke_stiffness": k, "hooke_damping": c}


def _row(material: Material) -> tuple[int, float, float, float, float]:
    if isinstance(material, HookeMaterial):
        return LAW_HOOKE, 0.0, 0.0, material.k + 0.0, material.c + 0.0
    return LAW_NISSEN, material.stiffness + 0.0, material.damping + 0.0, 0.0, 0.0
