"""Every kernel of a tick is called once: so that it is known with which types, or that none is compiled later on."""

import numpy as np

from sandbox.physics.actuators import Actuators, Hydraulics, Motors, Muscles, StrainLimits
from sandbox.physics.analysis import lowest_mode
from sandbox.physics.collision.close_edges import close_edges
from sandbox.physics.collision.filter import TERRAIN_GROUP
from sandbox.physics.collision.pinned_edges import pinned_edges
from sandbox.physics.components import body_of
from sandbox.physics.constraints import AREA
from sandbox.physics.settings import AUTO, WorldSettings
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.solvers.direct.layout import layout_of
from sandbox.physics.solvers.linear import parallel
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.world import World


def call_every_kernel() -> None:
    """Call every kernel of a tick with each solver, on worlds of a few particles."""
    for solver in SOLVERS:
        world = World(WorldSettings(solver=solver, substeps=AUTO, drag=1.0))
        world.add_particles(["a", "b", "c"], np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
        world.add_springs(["s", "t"], [0, 0], [1, 1], law=[0, 1])
        world.add_constraints(AREA, [[0, 1, 2]])
        world.limits = StrainLimits(np.ones(1), np.ones(1), np.ones(1), np.zeros(1))
        # Nothing acts on bodies from outside, then a motor does.
        step(world)
        one = np.zeros(1, dtype=np.int64)
        muscles = Muscles(one, np.zeros(1), one + 2, np.zeros(1))
        hydraulics = Hydraulics(one + 1, np.ones(1), np.ones(1), np.zeros(1), one)
        motors = Motors(one, np.ones(1), np.ones(1), one, np.array([0, 1]), one + 1)
        world.fit(Actuators(("a",), muscles, hydraulics, motors), [1.0])
        step(world)
        # Two free ones that touch, and two on a spring, out of their reach.
        places = np.array([[0.0, 0.0], [0.0, 0.0], [0.5, 0.0], [0.7, 0.0]])
        world.add_particles(["d", "e", "f", "g"], places, group=TERRAIN_GROUP, collides=TERRAIN_GROUP)
        world.add_springs(["u"], [5], [6])
        world.terrain = make_terrain([Chain([[-1.0, 0.0], [1.0, 0.0]])])
        step(world)
        # And a world of free ones alone, which takes a way of its own.
        free = World(world.settings)
        free.add_particles(["a", "b"], np.zeros((2, 2)), group=TERRAIN_GROUP, collides=TERRAIN_GROUP)
        step(free)
    # Those are too small to need a second thread.
    system = layout_of(world).system
    parallel.precompile_help(system.fronts, system.rows.delta_v)
    lowest_mode.precompile_modes()
    # Nor has any an edge, let alone one that is pinned at both ends.
    for particle in (0, 1):
        world.pin(particle)
    pinned_edges(world, np.array([0]), np.array([1]), np.array([0]))
    body_of(world, 0)
    close_edges(world.origin, np.array([0]), np.array([1]), np.zeros(2, np.int64), np.array([-1]))
