"""Dividing: what was made without some of its springs falls into the pieces that a cut would leave."""

from collections.abc import Sequence

import numpy as np

from sandbox.physics.command import carry_out, lend
from sandbox.physics.state import good_of, state_of
from sandbox.physics.world import World


def part_bodies(world: World, springs: Sequence[int]) -> None:
    """Make bodies of the pieces of soft bodies that lack springs; springs: one that each of them has.

    Raises IndexError for a spring that is not there or not in use.
    """
    pointer = lend(state_of(world), good_of(world), np.array(world.settings.numbers, np.float64))
    carry_out(pointer, "part_bodies", {"springs": springs}, world)
    world.topology_version += 1
