"""Every kernel of a tick is called once: so that it is known with which types, or that none is compiled later on."""

import numpy as np

from sandbox.physics.actuators import Actuators, Motors, Muscles
from sandbox.physics.analysis import lowest_mode
from sandbox.physics.collision.filter import TERRAIN_GROUP
from sandbox.physics.collision.outline import outline_of
from sandbox.physics.components import body_of
from sandbox.physics.constraints import AREA
from sandbox.physics.driving import drive_muscles
from sandbox.physics.pipeline.making import block_of
from sandbox.physics.pipeline.tick import find_broken
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.world import World


def call_every_kernel() -> None:
    """Call every kernel of a tick, on a world of a few particles; a tick is one kernel, whatever is in its world."""
    world, one = World(), np.zeros(1, dtype=np.int64)
    places = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    world.add_particles(["a", "b", "c"], places, group=TERRAIN_GROUP, collides=TERRAIN_GROUP)
    world.add_springs(["s", "t"], [0, 1], [1, 2])
    world.add_constraints(AREA, [[0, 1, 2]])
    motors = Motors(one, np.ones(1), np.ones(1), one, np.array([0, 1]), one + 1)
    world.terrain = make_terrain([Chain(places[:2])])
    world.fit(Actuators(("a",), Muscles(one, np.zeros(1), one + 2, np.zeros(1)), motors=motors), [1.0])
    drive_muscles(world, 0)
    step(world)
    find_broken(block_of(world).pointer)
    lowest_mode.precompile_modes()
    body_of(world, 0)
    outline_of(world)
    world.pin(0)
