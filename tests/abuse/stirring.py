"""Heaps that a hand stirs: how deep bodies lie in each other afterwards, and what their springs hold.

Run by hand: python -m tests.abuse.stirring [--all] [--solver NAME] [--pictures FOLDER]. --all: six materials,
three speeds, ten seeds each, which takes hours; else one seed each of three materials.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np
import pygame

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.renderer import Renderer
from sandbox.physics.snapshot import take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.world import World
from tests.support.limits import Limits
from tests.support.stirring import heap, stir

SAMPLE = ((0.1, 0.5), (0.5, 0.9), (0.9, 0.99))
ALL = ((0.02, 0.1), (0.05, 0.3), *SAMPLE, (0.99, 0.99))
SPEEDS = (5.0, 20.0, 80.0)


def draw(world: World, path: Path) -> None:
    """Draw a heap into a PNG file."""
    snapshot = take(world)
    surface, camera = pygame.Surface((900, 760), 0, 32), Camera(viewport=(0, 0, 900, 760))
    camera.fit((-3.4, -0.2, 3.4, 5.2))
    Renderer(1.0).draw(surface, camera, snapshot, snapshot, 1.0)
    pygame.image.save(surface, str(path))


def main(arguments: list[str] | None = None) -> int:
    """Print a line a run, then what was to be shown; 1 where that is not."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--seeds", type=int)
    parser.add_argument("--solver", choices=SOLVERS, default="direct")
    parser.add_argument("--pictures", type=Path)
    given = parser.parse_args(arguments)
    runs = []
    for stiffness, damping in ALL if given.all else SAMPLE:
        for speed in SPEEDS:
            for seed in range(given.seeds or (10 if given.all else 1)):
                began = time.process_time()
                found = stir(heap(stiffness, damping, seed, given.solver), speed, seed)
                runs.append(found)
                print(
                    f"Cs {stiffness:4} Cd {damping:4} {speed:2.0f} m/s seed {seed}: deepest {found.deepest:5.2f} "
                    f"radii, {found.lines} crossings of lines, springs {found.springs:5.2f} of before, most energy "
                    f"{found.gain:.4f}, kinetic {found.kinetic:.1e} J{', STAYS' if found.stays else ''}  "
                    f"{time.process_time() - began:.1f} s",
                    flush=True,
                )
                if given.pictures:
                    draw(found.world, given.pictures / f"heap-{stiffness}-{damping}-{speed:.0f}-{seed}.png")
    deepest, springs = np.array([run.deepest for run in runs]), np.array([run.springs for run in runs])
    limits = Limits()
    limits.at_most("deepest overlap [radii]", deepest.max(), 1.5)
    limits.at_most("share of runs with one above 1 radius", np.mean(deepest > 1.0), 0.1)
    limits.at_most("runs that leave lines crossing", sum(run.lines > 0 for run in runs), 0)
    limits.at_most("runs in which a pair stays overlapped", sum(run.stays for run in runs), 0)
    limits.at_most("most energy of springs, of that before", springs.max(), 4.0)
    limits.at_most("share of runs with more than twice", np.mean(springs > 2.0), 0.05)
    limits.at_most("most energy after the release, of that at it", max(run.gain for run in runs), 1.001)
    return int(limits.broken)


if __name__ == "__main__":
    sys.exit(main())
