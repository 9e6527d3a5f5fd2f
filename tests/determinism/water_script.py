"""Prints a hash a tick of a level with water, in which everything that floats is dropped, driven, cut and pinned.

python water_script.py SOLVER TICKS
"""

import sys

from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from tests.support.pools import jelly, pool, water_world

solver, ticks = sys.argv[1], int(sys.argv[2])
box = jelly((1.0, 0.5), 0.3, 0.3, 0.4, 0.6, angle=0.3, velocity=[0.5, -3.0])
ring = {"type": "ring", "id": "ring", "radius": 0.4, "segments": 8, "position": [2.0, 0.3], "particle_mass": 0.3}
wheel = ring | {
    "type": "wheel",
    "id": "wheel",
    "position": [4.0, 0.0],
    "thickness": 0.1,
    "motor": {"speed": 3.0, "torque": 5.0},
}
rope = {"type": "rope", "id": "rope", "start": [-4.0, 0.4], "end": [-2.0, 0.0], "segments": 6, "particle_mass": 0.05}
world = water_world(
    [pool((-6.0, -3.0, 6.0, 0.0), flow=[0.4, 0.1]), pool((0.0, -5.0, 9.0, -0.5), density=3.0) | {"id": "other"}],
    settings={"solver": solver, "substeps": 2 if solver == "iterative" else "auto"},
    materials=box["materials"],
    contacts={},
    bodies=[*box["bodies"], ring, wheel, rope],
    particles=[
        {"id": f"disc {k}", "position": [0.3 * k - 1.0, 1.0], "radius": 0.1, "mass": 0.1 + 0.1 * k} for k in range(5)
    ],
)
for tick in range(ticks):
    if tick == ticks // 4:
        world.cut([3, 4, 5])
        world.pin(0)
    if tick == ticks // 2:
        world.hold(0, world.particle_slot("ring.0"), (1.0, 1.0))
        world.unpin(0)
    step(world)
    print(state_hash(world))
