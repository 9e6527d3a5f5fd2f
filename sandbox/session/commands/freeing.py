"""Bodies that are stuck in others are freed."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.physics.arena import NO_ARENA
from sandbox.physics.changing.freeing import IS_PINNED, NO_PLACE, NOTHING_TOUCHES, free
from sandbox.physics.jit import bundle
from sandbox.physics.state import good_of, state_of
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot

_WHY_NOT = {
    NOTHING_TOUCHES: "nothing touches anything here: there is nothing to free",
    IS_PINNED: "the body of {} is pinned: unpin it to free it",
    NO_PLACE: "there is no free place for the body of {} near by",
}


@dataclass(frozen=True)
class Free(Command):
    """Move the body of a particle to the nearest place where it touches nothing, at rest.

    The body is what springs join to the particle; if it is one solid body it gets its own form back.
    """

    type = "free"
    particle: ParticleSlot

    def carry_out(self, world: World) -> None:
        arena = np.zeros(1, np.int64)
        while (reason := free(world.derived(_lend, of_hands=False), arena, self.particle)) == NO_ARENA:
            arena = np.zeros(int(arena[0]), np.int64)
        if reason in _WHY_NOT:
            raise CommandError(_WHY_NOT[reason].format(world.particle_names[self.particle]))


def _lend(world: World) -> Any:
    return bundle((state_of(world), good_of(world)))
