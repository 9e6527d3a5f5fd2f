"""build_world(level): builds a LevelWorld, a world that knows its level, in the order of the file."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.document.model import Level, Material, NissenMaterial
from sandbox.level.faults.validate import check_level
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.plan.actuators import add_actuators
from sandbox.level.plan.materials import add_constraints, add_forms, coefficients, strain_limits
from sandbox.level.plan.plan import Plan
from sandbox.level.plan.rules import add_rules
from sandbox.level.plan.surfaces import hulls_of, surface_of, surfaces_of, terrain_of, water_of
from sandbox.physics.arrays import Slots
from sandbox.physics.keeping.arguments import of_kind
from sandbox.physics.keeping.equipment import Joined
from sandbox.physics.marks import NO_EDGE
from sandbox.physics.settings import WorldSettings
from sandbox.physics.state import ROLLING_RESISTANCE
from sandbox.physics.world import World


@dataclass(frozen=True, eq=False)
class JoinedLevel(Joined):
    """Bodies that joined a world together, and a level of them alone."""

    level: Level


class LevelWorld(World):
    """A world of a level, as `build_world` makes it.

    level: what it was built from. joined: what joined it since.
    """

    joined: tuple[JoinedLevel, ...]

    def __init__(self, level: Level) -> None:
        """A world with the settings of a level, still without particles."""
        materials = dict.fromkeys([DEFAULT_MATERIAL, *level.materials])
        super().__init__(WorldSettings(**dict(level.settings)), list(materials))
        self.level = level

    @property
    def materials(self) -> dict[str, Material]:
        """The materials of the level and of what joined it, by name; those that were there first go before."""
        known: dict[str, Material] = {}
        for level in (self.level, *(each.level for each in self.joined)):
            known = {**level.materials, **known}
        return known


def build_world(level: Level) -> LevelWorld:
    """Build the world that a level describes.

    Particle slots: the particles of the bodies in file order, then the loose particles; welded particles share the
    slot of the first. Spring slots: the springs of the bodies in file order, then the loose springs, then the hands.
    Materials: "default" first, then the level's in file order. Raises LevelError for a level that breaks a limit or
    names something that does not exist.
    """
    plan = check_level(of_kind("level", level, Level), f'level "{level.name}"')
    materials = {DEFAULT_MATERIAL: NissenMaterial(), **level.materials}
    world = LevelWorld(level)
    stays = plan.first_of_weld == np.arange(plan.layout.particle_count)
    slots = (np.cumsum(stays) - 1)[plan.first_of_weld]
    _add_particles(world, level, plan, slots, stays)
    for name, slot in plan.layout.second_names():
        world.name_particle(int(slots[slot]), name)
    _add_springs(world, level, plan, slots, materials)
    world.limits = strain_limits(materials)
    add_actuators(world, level, plan, slots)
    world.reserve_grabs()
    firsts = add_constraints(world, plan.layout, level, plan.bodies, slots, materials)
    _part_cut_bodies(world, level, plan)
    add_forms(world, level, plan.bodies, materials, firsts)
    world.terrain, world.surface = terrain_of(level), surface_of(level)
    world.water, world.hulls = water_of(level), hulls_of(level, plan.bodies, materials)
    add_rules(world, level, plan, slots)
    return world


def _part_cut_bodies(world: World, level: Level, plan: Plan) -> None:
    """Make several bodies of one that falls into pieces without its cut springs, as if it had been cut in a run."""
    first, springs = 0, []
    for body, made in zip(level.bodies, plan.bodies, strict=True):
        springs += [first] if body.cut and len(made.pairs) else []
        first += len(made.pairs)
    if springs:
        world.command("part_bodies", springs=springs)


def _add_particles(world: World, level: Level, plan: Plan, slots: Slots, stays: NDArray[np.bool_]) -> None:
    """Add the particles that stay (bool, one per particle before welds); slots: which of them each becomes."""
    loose, bodies = level.particles, plan.bodies
    names = [f"{body.id}.{k}" for body, made in zip(level.bodies, bodies, strict=True) for k in range(len(made.mass))]
    surfaces = surfaces_of(level, [len(made.mass) for made in bodies])
    radius = surfaces.pop("radius")
    names += [particle.id for particle in loose]
    position = np.array([p.position for p in loose], dtype=np.float64).reshape(-1, 2)
    velocity = np.array([p.velocity for p in loose], dtype=np.float64).reshape(-1, 2)
    mass = np.array([p.mass for p in loose], dtype=np.float64)
    pinned = np.array([p.pinned for p in loose], dtype=np.bool_)
    scale = np.array([p.gravity_scale for p in loose], dtype=np.float64)
    turning = _turning(level, sum(len(made.mass) for made in bodies))
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
        # The mean by mass; equal scales stay equal to the bit.
        if scale[first] != scale[slot]:
            scale[first] = (mass[first] * scale[first] + mass[slot] * scale[slot]) / both
        mass[first] = both
        radius[first] = max(radius[first], radius[slot])
        pinned[first] |= pinned[slot]
        turning["rolls"][first] &= turning["rolls"][slot]
        turning["rolling"][first] = max(turning["rolling"][first], turning["rolling"][slot])
    # Adding 0.0 turns -0.0 into 0.0, so that a sign nobody sees cannot reach the state.
    world.add_particles(
        [names[slot] for slot in kept.tolist()],
        position[stays] + 0.0,
        velocity=velocity[stays] + 0.0,
        mass=mass[stays],
        radius=radius[stays] + 0.0,
        pinned=pinned[stays],
        gravity_scale=scale[stays] + 0.0,
        **{name: values[stays] for name, values in (surfaces | turning).items()},
    )
    for slot in gone:
        world.name_particle(int(slots[slot]), names[slot])


def _turning(level: Level, particles: int) -> dict[str, NDArray[Any]]:
    """How every particle turns (n,), as arguments of add_particles; particles of bodies come first."""
    own = [(True, ROLLING_RESISTANCE, 0.0, 0.0)] * particles
    loose = [(p.rolls, p.rolling + 0.0, p.angle + 0.0, p.spin + 0.0) for p in level.particles]
    columns = zip(*(own + loose), strict=True) if own or loose else [()] * 4
    kinds = (np.bool_, np.float64, np.float64, np.float64)
    names = ("rolls", "rolling", "angle", "spin")
    return {name: np.array(column, kind) for name, column, kind in zip(names, columns, kinds, strict=True)}


def _add_springs(world: World, level: Level, plan: Plan, slots: Slots, materials: dict[str, Material]) -> None:
    index = {name: number for number, name in enumerate(materials)}
    loose, owners = level.springs, plan.layout.owners
    made = list(zip(level.bodies, plan.bodies, strict=True))
    names = [f"{body.id}:{number}" for body, expanded in made for number in expanded.numbers.tolist()]
    ends = [owners[body.id].first + expanded.pairs for body, expanded in made]
    lengths = [spring.given_length for spring in loose]
    loose_rest = np.array([np.nan if length is None else length for length in lengths], dtype=np.float64)
    used = [np.full(len(expanded.pairs), index[body.material]) for body, expanded in made]
    material = np.concatenate([*used, np.array([index[s.material] for s in loose], dtype=np.int64)]).astype(np.int64)
    pairs = slots[np.concatenate([*ends, plan.spring_ends])]
    # A loose spring joins bodies, and is in nobody's way.
    edges = [*(body.edges for body in plan.bodies), np.zeros(len(loose), np.int8)]
    edge = np.concatenate(edges) if level.has_contacts or level.has_water else np.zeros(len(pairs), np.int8)
    belts = np.repeat([*(body.belt + 0.0 for body in level.bodies), 0.0], [len(each) for each in edges])
    world.add_springs(
        names + [f":{number}" for number in range(len(loose))],
        pairs[:, 0],
        pairs[:, 1],
        rest_length=np.concatenate([*(expanded.rest_length for expanded in plan.bodies), loose_rest]) + 0.0,
        material=material,
        edge=edge,
        belt=np.where(edge != NO_EDGE, belts, 0.0),
        **coefficients(material, materials),
    )


def levels_of(joined: Iterable[Joined]) -> list[JoinedLevel]:
    """Levels that joined a world, as its snapshot keeps them."""
    return [each for each in joined if isinstance(each, JoinedLevel)]
