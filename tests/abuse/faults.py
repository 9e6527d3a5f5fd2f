"""Faults of one ulp in recordings of a minute: each named exactly, tick, array and index, and how soon.

Run by hand: python -m tests.abuse.faults [--all] [--seed 1]. Each is put into a random value of a random array after a
random tick of a golden. Exit code 1 where a fault is not named, or takes longer than two plain verifications and two
seconds of CPU.
"""

import argparse
import random
import sys
import time
from collections.abc import Callable

import numpy as np

from sandbox.physics.state import BY_STORED
from sandbox.physics.world import World
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay
from tests.determinism.golden import SHORTER, golden_names, golden_path
from tests.support.limits import Limits

# Arrays of numbers that every tick hands on to the next.
ARRAYS = ("position", "velocity", "mass", "rest_length", "slow_velocity", "energy_bank", "tension")
TIMES, MORE = 2.0, 2.0


def seconds(act: Callable[[], object]) -> tuple[float, object]:
    """CPU time that it takes, and what comes of it."""
    start = time.process_time()
    result = act()
    return time.process_time() - start, result


def main(arguments: list[str] | None = None) -> int:
    """Try many."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="a hundred, not five")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    chance, count = random.Random(given.seed), 100 if given.all else 5
    names = [name for name in golden_names() if name not in SHORTER]
    limits, named, slowest = Limits(), 0, 0.0
    for number in range(count):
        replay = read_replay(golden_path(names[number % len(names)]))
        plain, equal = seconds(lambda replay=replay: verify(replay))
        assert equal is None
        wanted, took, found = one(replay, chance)
        named += str(found).startswith(wanted)
        if not str(found).startswith(wanted):
            print(f"{replay.source}: put {wanted}, named {found}")
        slowest = max(slowest, took / (TIMES * plain + MORE))
    limits.at_least("faults named by tick, array and index", named, count)
    limits.at_most("longest, in parts of two plain verifications and 2 s", slowest, 1.0)
    return int(limits.broken)


def one(replay: Replay, chance: random.Random) -> tuple[str, float, object]:
    """A fault: how it has to be told, the CPU time until it is [s], and what was told."""
    tick, array, share = chance.randrange(1, replay.ticks + 1), chance.choice(ARRAYS), chance.random()
    places: list[str] = []

    def disturb(world: World) -> None:
        if world.tick == tick:
            values = getattr(world, BY_STORED[array].name)
            index = np.unravel_index(int(share * values.size), values.shape)
            values[index] = np.nextafter(values[index], np.inf)
            places.append(f"tick {tick}: {array}[{', '.join(str(int(part)) for part in index)}]")

    took, found = seconds(lambda: verify(replay, on_tick=disturb))
    return places[0], took, found


if __name__ == "__main__":
    sys.exit(main())
