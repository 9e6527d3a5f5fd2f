"""How the direct solver's time grows with its scenes. Run by hand: python -m tests.bench.costs

Each ratio is the median over pairs of ticks run in turns, so that both meet the same load of the machine; below it
the limit that the solver is held to.
"""

import itertools
import time
from collections.abc import Callable

import numpy as np

from sandbox.physics.driving import Actuators, Muscles
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.bench import scenes

PAIRS = 300
# Ticks of one block that are timed together: its tick is too short for the clock.
BATCH = 500


def seconds(action: Callable[[], object]) -> float:
    """Wall-clock time of a call [s]."""
    began = time.perf_counter()
    action()
    return time.perf_counter() - began


def settled(scene: scenes.Scene) -> World:
    """The scene after a second."""
    world = scene.world()
    for _ in range(60):
        step(world)
    return world


def median_ratio(large: Callable[[], object], small: Callable[[], object], pairs: int = PAIRS) -> float:
    """Median of the time of one call over that of another."""
    return float(np.median([seconds(large) / seconds(small) for _ in range(pairs)]))


def longer_rope() -> float:
    """A tick of a rope of 1000 links, in ticks of one of 100."""
    long, short = settled(scenes.rope(1000)), settled(scenes.rope(100))
    return median_ratio(lambda: step(long), lambda: step(short))


def more_blocks() -> float:
    """A tick of 500 separate blocks, in five hundred ticks of one."""
    many, one = settled(scenes.blocks(BATCH)), settled(scenes.blocks(1))
    return median_ratio(lambda: step(many), lambda: [step(one) for _ in range(BATCH)], pairs=PAIRS // 10)


def driven_pairs(count: int) -> World:
    """Separate pairs, each with a muscle of limited force."""
    world = World()
    left = np.column_stack([3.0 * np.arange(count), np.zeros(count)])
    world.add_particles([f"a{k}" for k in range(count)], left)
    world.add_particles([f"b{k}" for k in range(count)], left + np.array([1.0, 0.2]))
    first = np.arange(count)
    world.add_springs([f"s{k}" for k in range(count)], first, first + count)
    muscles = Muscles(
        first, np.full(count, 0.2), np.full(count, 40), np.zeros(count), force=np.full(count, 5.0)
    )  # fmt: skip
    world.fit(Actuators((), muscles), [])
    return world


def more_driven_pairs() -> float:
    """A tick of 800 separate pairs with a muscle of limited force, in ticks of 100."""
    many, few = driven_pairs(800), driven_pairs(100)
    return median_ratio(lambda: step(many), lambda: step(few))


def cut() -> float:
    """Cutting one spring of a 32x32 lattice, with the tick after it, in ticks without."""
    world = settled(scenes.lattice(32))
    springs = itertools.count(0, 40)

    def cut_and_step() -> None:
        world.cut([next(springs)])
        step(world)

    return median_ratio(cut_and_step, lambda: step(world), pairs=PAIRS // 4)


def main() -> None:
    """Print the ratios."""
    print("| cost | ratio | limit |\n|---|---|---|")
    for measure, limit in ((longer_rope, 12.0), (more_blocks, 1.5), (more_driven_pairs, 9.0), (cut, 5.0)):
        print(f"| {measure.__doc__} | {measure():.2f} | {limit:g} |", flush=True)


if __name__ == "__main__":
    main()
