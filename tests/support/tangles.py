"""Random worlds for what follows from topology: anything joined to anything, some of it pinned, cut or held."""

import numpy as np

from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.marks import LAW_HOOKE, LAW_NISSEN
from sandbox.physics.settings import WorldSettings
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.world import World


def tangle(seed: int, count: int = 40) -> World:
    """Particles with random springs, edges of all kinds, areas, bends, pins and two hands, over some terrain."""
    generator = np.random.default_rng(seed)
    world = World(WorldSettings(solver="direct"))
    world.add_particles(
        [f"p.{k}" for k in range(count)],
        generator.uniform(-1.0, 1.0, (count, 2)),
        pinned=generator.random(count) < 0.2,
        owner=generator.integers(-3, 4, count),
        collides=1,
    )
    springs = 2 * count
    a = generator.integers(0, count, springs)
    b = (a + generator.integers(1, count, springs)) % count
    world.add_springs(
        [f"s.{k}" for k in range(springs)], a, b, edge=generator.integers(0, 4, springs),
        law=np.where(generator.random(springs) < 0.1, LAW_HOOKE, LAW_NISSEN),
    )  # fmt: skip
    for kind, size, number in ((AREA, 3, count), (BEND, 3, 5), (AREA, 5, 3)):
        corners = [generator.choice(count, size, replace=False) for _ in range(number)]
        world.add_constraints(kind, np.array(corners))
    # Triangles that share sides, some with their form turned over.
    fan = [[0, k, k + 1] for k in range(1, 8)]
    world.add_constraints(AREA, fan, form=generator.uniform(-1.0, 1.0, (len(fan), 3, 2)))
    world.terrain = make_terrain([
        Chain([[-2.0, -1.0], [0.0, -1.2], [2.0, -1.0]]), Chain([[0.0, -2.0], [1.0, -2.0], [0.5, -1.5]], kind="solid"),
    ])  # fmt: skip
    for hand in range(2):
        held = int(generator.integers(count))
        if world.inverse_mass[held] > 0.0:
            world.hold(hand, held, (0.0, 0.0))
    if world.is_held(1):
        world.release(1)
    world.cut(generator.choice(springs, springs // 8, replace=False).tolist())
    return world
