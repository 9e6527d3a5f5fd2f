"""What does a whole tick cost beside pymunk's? Run by hand: python tests/bench/iterative.py

`step(world)` of the iterative solver with 10 iterations against `space.step` with 10 iterations over the same springs
as PinJoints (those between two pinned particles left out of both), in turns on the same scene; prints Markdown and ends
with 1 where the median of the paired ratios is above 1.
"""

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import pymunk

from sandbox.physics.jit import COMPILED
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.physics_scenes import girder, grid_with_diagonals, rope

GRAVITY = (0.0, -9.81)
ITERATIONS = 10
SETTINGS = {
    "solver": "iterative", "iterations": ITERATIONS, "gravity": GRAVITY, "stiffness": 0.2, "damping": 1.0,
}  # fmt: skip
SCENES: dict[str, Callable[[], World]] = {
    "mesh 32x32 with diagonals": lambda: grid_with_diagonals(columns=32, rows=32, **SETTINGS),
    "girder of 200 cells": lambda: girder(cells=200, **SETTINGS),
    "rope of 100 links": lambda: rope(links=100, **SETTINGS),
}
ROUNDS = 15
TICKS = 20


def space_of(world: World) -> pymunk.Space:
    """The same particles as bodies without shapes, the same springs as pin joints."""
    space = pymunk.Space()
    space.iterations, space.gravity = ITERATIONS, GRAVITY
    bodies = []
    for slot in range(world.particle_count):
        pinned = world.inverse_mass[slot] == 0.0
        body = pymunk.Body(world.mass[slot], 1.0, pymunk.Body.STATIC if pinned else pymunk.Body.DYNAMIC)
        body.position = tuple(world.position[slot])
        bodies.append(body)
        space.add(body)
    for a, b in zip(world.particle_a, world.particle_b, strict=True):
        if world.inverse_mass[a] + world.inverse_mass[b] > 0.0:
            space.add(pymunk.PinJoint(bodies[a], bodies[b]))
    return space


def seconds(advance: Callable[[], None]) -> float:
    """Median time [s] of one call."""
    times = []
    for _ in range(TICKS):
        start = time.perf_counter()
        advance()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def compare(scene: Callable[[], World]) -> tuple[int, float, float, float]:
    """Springs, medians [s] of ours and pymunk's, and the median of their paired ratios."""
    world = scene()
    space, dt = space_of(world), 1.0 / world.settings.tick_rate
    step(world)
    pairs = [(seconds(lambda: step(world)), seconds(lambda: space.step(dt))) for _ in range(ROUNDS)]
    ours, theirs = (statistics.median(side) for side in zip(*pairs, strict=True))
    return world.spring_count, ours, theirs, statistics.median(one / other for one, other in pairs)


def main() -> int:
    """Compare every scene, print a table, and say whether the requirement is met."""
    if not COMPILED:
        sys.exit("kernels are interpreted here, and those are no match")
    print(f"A whole tick, {ITERATIONS} iterations; medians of {ROUNDS} turns of {TICKS} ticks\n")
    print("| scene | springs | ours, ms | pymunk, ms | ours / pymunk |\n|---|---|---|---|---|")
    worst = 0.0
    for name, scene in SCENES.items():
        springs, ours, theirs, ratio = compare(scene)
        worst = max(worst, ratio)
        print(f"| {name} | {springs} | {1e3 * ours:.4f} | {1e3 * theirs:.4f} | {ratio:.2f} |")
    print(f"\nworst ratio {worst:.2f}, required 1.00 at most")
    return 0 if worst <= 1.0 else 1


if __name__ == "__main__":
    sys.exit(main())
