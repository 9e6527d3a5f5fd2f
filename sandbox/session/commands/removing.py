"""Bodies are removed."""

from dataclasses import dataclass

import numpy as np

from sandbox.level.format.level_error import suggestion
from sandbox.level.format.quantities import Name
from sandbox.physics.arrays import Slots
from sandbox.physics.kits.removing import BODY, HANGING, remove_particles
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot

ONE_OF_TWO = "say body, or particle: one of the two"


@dataclass(frozen=True)
class Remove(Command):
    """Take out a body by its name, or a particle with everything that springs join to it.

    body: its springs, and its particles that no spring of others holds. particle: it, and whatever springs and areas
    join to it by way of particles that are not pinned, with the pinned ones that nothing else holds then.
    """

    type = "remove"
    body: Name | None = None
    particle: ParticleSlot | None = None

    def carry_out(self, world: World, giver: int) -> None:
        if (self.body is None) == (self.particle is None):
            raise CommandError(ONE_OF_TWO)
        if self.particle is not None:
            remove_particles(world, [self.particle], way=HANGING, giver=giver)
        else:
            remove_particles(world, *_parts_of(world, str(self.body)), way=BODY, giver=giver)


def _parts_of(world: World, body: str) -> tuple[Slots, Slots]:
    """Active particles and springs of a body by name. Raises CommandError."""
    bodies = dict.fromkeys(name.partition(mark)[0] for mark, names in _names(world) for name in names if mark in name)
    for added in ("+", "+hand", ""):
        bodies.pop(added, None)
    if body not in bodies:
        raise CommandError(f"there is no body {body!r:.80}" + suggestion(body, bodies))
    found = []
    for (mark, names), active in zip(_names(world), (world.particle_active, world.spring_active), strict=True):
        named = [slot for slot, name in enumerate(names) if name.startswith(body + mark) and active[slot]]
        found.append(np.array(named, dtype=np.int64))
    if not any(map(len, found)):
        raise CommandError(f"{body} is removed already")
    return found[0], found[1]


def _names(world: World) -> tuple[tuple[str, list[str]], tuple[str, list[str]]]:
    return (".", world.particle_names), (":", world.spring_names)
