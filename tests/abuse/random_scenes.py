"""Random scenes that hands abuse for five seconds: what energy they have after the release.

Run by hand: python -m tests.abuse.random_scenes [--all] [--scenes N] [--first SEED] [--solver NAME] [--softest]
[--auto]. --all: 1,000 scenes, an hour. --auto: every tick chooses its substeps. Printed are the scenes kept in
tests/abuse/scenes, then those that have more energy than at their release, or grow by more than a twentieth of it
within a second.
"""

import argparse
import sys
import time

import numpy as np

from sandbox.physics.settings import AUTO
from sandbox.physics.solvers import SOLVERS
from tests.support.random_scenes import SCENES, energies, kept_scene, random_scene

AFTER = 180
# What rounding and the height of what falls within a step may add.
ROUNDING = 1e-3


def main(arguments: list[str] | None = None) -> int:
    """Print the figures; 1 where a scene of the direct solver gains energy, or one of another is no number."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--scenes", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--solver", choices=SOLVERS, default="direct")
    parser.add_argument("--softest", action="store_true")
    parser.add_argument("--auto", action="store_true")
    given = parser.parse_args(arguments)
    scenes = given.scenes or (1000 if given.all else 40)
    for path in sorted(SCENES.glob("*.json")):
        found = energies(*kept_scene(path.stem), AFTER)
        print(f"{path.stem}: most {found.over:.4f} of the release, grows by {found.growth:.4f} of it", flush=True)
    over, growth, failed, began = [], [], 0, time.process_time()
    for seed in range(given.first, given.first + scenes):
        world, drags = random_scene(seed, given.softest, given.solver, AUTO if given.auto else None)
        found = energies(world, drags, AFTER)
        over.append(found.over)
        growth.append(found.growth)
        finite, bounded = np.isfinite(found.total).all(), found.over <= 1.0 + ROUNDING and found.growth <= 0.05
        failed += not finite or (given.solver == "direct" and not bounded)
        if not (finite and bounded):
            print(
                f"scene {seed}: most {found.over:.4f}, grows by {found.growth:.4f}, {found.total[0]:.3g} J at the "
                f"release, {found.kinetic[0]:.3g} J of it kinetic",
                flush=True,
            )
    print(
        f"{len(over)} scenes: above the release {np.sum(np.array(over) > 1.0 + ROUNDING)}, at most {max(over):.4f} of "
        f"it; growing by a twentieth {np.sum(np.array(growth) > 0.05)}; {time.process_time() - began:.0f} s"
    )
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
