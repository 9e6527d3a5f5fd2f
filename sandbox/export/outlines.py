"""Outlines of bodies: their rims as particles in order."""

import numpy as np

from sandbox.export.flat_model import FlatOutline
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.things.outlines import directed_loops, plain_lines
from sandbox.physics.collision.filter import SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.world import World


def outlines_of(world: World, body: BodyDef) -> tuple[FlatOutline, ...]:
    """The rims of a body of the world's level, with what is solid on the left; of a rope or a ring, its line.

    Nothing of a body whose springs are no rim, such as a truss.
    """
    made = expansion(body)
    pairs, edges = made.pairs, made.edges
    ways = np.concatenate([pairs[edges == SOLID_LEFT], pairs[edges == SOLID_RIGHT][:, ::-1]])
    found = list(directed_loops(ways.tolist()) if len(ways) else plain_lines(pairs.tolist()))
    slots = [world.particle_slot(f"{body.id}.{number}") for number in range(len(made.mass))]
    return tuple(
        FlatOutline(particles=tuple(slots[number] for number in numbers), closed=closed) for numbers, closed in found
    )
