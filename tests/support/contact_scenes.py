"""Worlds in which things touch."""

import math

import numpy as np

from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.jelly import JellyDef
from sandbox.physics.marks import ALL_GROUPS, LINE
from sandbox.physics.settings import WorldSettings
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.world import World

BODIES = 2  # the bit of a group
FLOOR = Chain([(-50.0, 0.0), (50.0, 0.0)])
GROUND = Chain([(-50.0, -1.0), (50.0, -1.0), (50.0, 0.0), (-50.0, 0.0)], "solid")


def world(*chains: Chain, **settings) -> World:
    """An empty world with terrain."""
    empty = World(WorldSettings(**{"solver": "direct", **settings}))
    empty.terrain = make_terrain(chains)
    return empty


def add_discs(to: World, points, *, radius=0.1, friction=0.5, restitution=0.0, **options) -> int:
    """Loose discs; the first slot."""
    points = np.reshape(points, (-1, 2))
    names = [f"disc.{to.particle_count + k}" for k in range(len(points))]
    return to.add_particles(
        names, points, radius=radius, friction=friction, restitution=restitution, group=BODIES, collides=ALL_GROUPS,
        **options,
    )  # fmt: skip


def add_jelly(to: World, position, *, size=(0.9, 0.9), angle=0.0, stiffness=0.9, damping=0.99, velocity=(0.0, 0.0)):
    """A box of jelly of 0.1 m spacing and 1 kg particles; its slots."""
    body = JellyDef.model_validate(
        {"type": "jelly", "id": "j", "shape": {"box": size}, "position": position, "angle": angle, "spacing": 0.1}
    )
    made = expansion(body)
    points, pairs = made.form, made.pairs
    first = to.particle_count
    to.add_particles(
        [f"jelly.{first + k}" for k in range(len(points))], points, velocity=velocity, radius=0.025, friction=0.5,
        owner=first, group=BODIES, collides=ALL_GROUPS,
    )  # fmt: skip
    to.add_springs(
        [f"jelly:{to.spring_count + k}" for k in range(len(pairs))], pairs[:, 0] + first, pairs[:, 1] + first,
        stiffness=stiffness, damping=damping, edge=made.edges,
    )  # fmt: skip
    return slice(first, first + len(points))


def add_chain(to: World, generator: np.random.Generator, position, velocity, balls=5) -> slice:
    """Balls of unequal mass on a string, in any direction; their slots."""
    angle = generator.uniform(0.0, math.tau)
    along = 0.25 * np.arange(balls)[:, None] * np.array([math.cos(angle), math.sin(angle)])
    first = to.particle_count
    add_discs(
        to, np.asarray(position) + along, friction=0.3, restitution=0.3, mass=generator.uniform(0.2, 2.0, balls),
        velocity=velocity, owner=first,
    )  # fmt: skip
    a = first + np.arange(balls - 1)
    to.add_springs([f"chain:{k}" for k in a], a, a + 1, stiffness=0.9, damping=0.95, edge=LINE)
    return slice(first, first + balls)


def rugged(generator: np.random.Generator, kind="line", half=500.0):
    """Ground of random slopes, and the height of its surface as corners (k, 2)."""
    x = np.arange(-half, half + 1.0, 5.0)
    surface = np.stack([x, generator.uniform(-1.0, 1.0, len(x))], axis=1)
    if kind == "line":
        return Chain(surface, kind), surface
    return Chain([*surface.tolist(), (half, -20.0), (-half, -20.0)], kind), surface
