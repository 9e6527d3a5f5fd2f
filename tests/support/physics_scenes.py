"""Worlds that several physics tests step, and the one place where tests scale down when kernels are interpreted."""

import itertools

import numpy as np

from sandbox.physics.jit import COMPILED
from sandbox.physics.settings import WorldSettings
from sandbox.physics.step import step
from sandbox.physics.world import World

STILL = (0.0, 0.0)


def scaled(compiled: int, interpreted: int) -> int:
    """A size or count of a test: the second where kernels are interpreted, some 100 times slower; never 0."""
    return compiled if COMPILED else interpreted


def network(points, springs, *, masses=1.0, pinned=(), stiffness=0.5, damping=0.9, **settings) -> World:
    """A world of points [m] (n, 2) and springs (pairs of slots), without gravity unless asked for."""
    world = World(WorldSettings(**{"gravity": STILL, "solver": "single_pass", **settings}))
    count = len(points)
    is_pinned = np.isin(np.arange(count), list(pinned))
    world.add_particles([f"p.{k}" for k in range(count)], np.reshape(points, (count, 2)), mass=masses, pinned=is_pinned)
    ends = np.reshape(np.asarray(springs, dtype=np.int64), (-1, 2))
    names = [f"p:{k}" for k in range(len(ends))]
    world.add_springs(names, ends[:, 0], ends[:, 1], stiffness=stiffness, damping=damping)
    return world


def rope(links=30, **options) -> World:
    """A horizontal rope of 1 m links, pinned at its start."""
    points = [(k, 0.0) for k in range(links + 1)]
    return network(points, [(k, k + 1) for k in range(links)], **{"pinned": (0,), **options})


def grid(columns=8, rows=8, *, diagonals=False, **options) -> World:
    """A grid of 1 m cells, with both diagonals or none, its top corners pinned."""
    points = [(x, y) for y in range(rows) for x in range(columns)]
    springs = []
    for x, y in itertools.product(range(columns), range(rows)):
        here = y * columns + x
        if x + 1 < columns:
            springs.append((here, here + 1))
        if y + 1 < rows:
            springs.append((here, here + columns))
        if diagonals and x + 1 < columns and y + 1 < rows:
            springs += [(here, here + columns + 1), (here + 1, here + columns)]
    return network(points, springs, **{"pinned": (columns * (rows - 1), columns * rows - 1), **options})


def grid_with_diagonals(**options) -> World:
    """A grid whose cells have both diagonals."""
    return grid(diagonals=True, **options)


def girder(cells=20, **options) -> World:
    """A beam two particles high with both diagonals in each cell, pinned at its left end."""
    return grid(cells + 1, 2, diagonals=True, **{"pinned": (0, cells + 1), **options})


SCENES = {"rope": rope, "grid": grid, "grid with diagonals": grid_with_diagonals, "girder": girder}


def random_graph(
    generator: np.random.Generator, *, particles=12, springs=24, pinned=0, decades=6.0, **options
) -> World:
    """Particles anywhere, springs between any two, masses from 10^-decades to 10^decades kg."""
    points = generator.uniform(-5.0, 5.0, (particles, 2))
    pairs = np.array(list(itertools.combinations(range(particles), 2)))
    chosen = generator.choice(len(pairs), size=min(springs, len(pairs)), replace=False)
    masses = 10.0 ** generator.uniform(-decades, decades, particles)
    return network(points, pairs[np.sort(chosen)], masses=masses, pinned=range(pinned), **options)


def run(world: World, ticks: int) -> World:
    """Step so many ticks; the same world."""
    for _ in range(ticks):
        step(world)
    return world


def lengths(world: World) -> np.ndarray:
    """Present length [m] of every spring."""
    separation = world.position[world.particle_b] - world.position[world.particle_a]
    return np.sqrt(np.sum(separation**2, axis=1))
