"""ThingNames: which body, loose particle or piece of terrain each particle, spring and edge of a world belongs to."""

from dataclasses import dataclass

import numpy as np

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.rules.rule import WALLS
from sandbox.physics.arrays import Slots

# Particles that a command adds one by one are each a thing, and all have this before the dot.
_ADDED = "+"


@dataclass(frozen=True, eq=False)
class ThingNames:
    """Names of things by number: bodies and loose particles in the order of their slots, then terrain, then walls.

    of_particle (n,), of_spring (m,), of_terrain (e,): the number of the thing that a particle, a spring or an edge of
    terrain belongs to. A particle that bodies share by a weld is of the first.
    """

    names: tuple[str, ...]
    of_particle: Slots
    of_spring: Slots
    of_terrain: Slots

    @classmethod
    def of(cls, world: LevelWorld) -> "ThingNames":
        """Names of a world as it is now; kept until something joins it, leaves it or breaks."""
        return world.derived(_named, of_hands=False)


def thing_of(particle: str) -> str:
    """The body that a particle is of, by its name; a loose particle is a thing by itself."""
    body, _, _ = particle.partition(".")
    return particle if body == _ADDED else body


def thing_of_spring(spring: str) -> str:
    """The body that a spring is of, by its name; a loose spring is a thing by itself."""
    body, _, _ = spring.partition(":")
    return spring if body in ("", _ADDED) else body


def _named(world: LevelWorld) -> ThingNames:
    numbers: dict[str, int] = {}
    of_particle = [numbers.setdefault(thing_of(name), len(numbers)) for name in world.particle_names]
    of_spring = [numbers.setdefault(thing_of_spring(name), len(numbers)) for name in world.spring_names]
    names = (*numbers, *_terrain_names(world))
    return ThingNames(
        names, np.array(of_particle, np.int64), np.array(of_spring, np.int64), len(numbers) + world.terrain.chain
    )


def _terrain_names(world: LevelWorld) -> list[str]:
    """The names of the chains of a world's terrain."""
    return [*(piece.id for piece in world.level.terrain), *([WALLS] if world.level.walls is not None else [])]
