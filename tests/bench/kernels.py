"""How much faster than interpreted are compiled kernels? Run by hand: python tests/bench/kernels.py

The single pass of a 32x32 mesh with diagonals, compiled in this process and interpreted in another, in turns; prints
Markdown and ends with 1 where the median of the paired ratios is below 100.
"""

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from sandbox.physics.forces import Before
from sandbox.physics.jit import COMPILED
from sandbox.physics.solvers import single_pass
from sandbox.physics.step import step
from sandbox.physics.substeps import Substep, constraint_coefficients, substep_coefficients, substep_time
from tests.support.physics_scenes import grid_with_diagonals

SIDE = 32
PAIRS = 7
REQUIRED = 100.0


def seconds_per_pass(passes: int) -> float:
    """Median time [s] of one single pass over the mesh, in motion, kernels warm."""
    world = grid_with_diagonals(columns=SIDE, rows=SIDE, stiffness=0.1, damping=0.1, gravity=(0.0, -9.81))
    step(world)
    springs, elements = substep_coefficients(world), constraint_coefficients(world)
    h, times = substep_time(world.settings), []
    before = Before(world.velocity, world.rest_length)
    substep = Substep(h, 1, 1.0, springs, elements, before)
    for _ in range(passes):
        start = time.perf_counter()
        single_pass.solve(world, substep, None)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def interpreted_seconds() -> float:
    """The same in a process in which the same kernels run interpreted."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, __file__, "--interpreted"]
    return float(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)


def main() -> int:
    """Compare, print a table, and say whether the requirement is met."""
    if "--interpreted" in sys.argv:
        print(seconds_per_pass(5))
        return 0
    if not COMPILED:
        sys.exit("kernels are interpreted here: there is nothing to compare")
    pairs = [(seconds_per_pass(200), interpreted_seconds()) for _ in range(PAIRS)]
    ratios = [slow / fast for fast, slow in pairs]
    springs = grid_with_diagonals(columns=SIDE, rows=SIDE).spring_count
    print(f"Single pass, {SIDE}x{SIDE} mesh with diagonals, {springs} springs, medians of {PAIRS} pairs\n")
    print("| kernels | ms per pass |\n|---|---|")
    print(f"| compiled | {1e3 * statistics.median(fast for fast, _ in pairs):.4f} |")
    print(f"| interpreted | {1e3 * statistics.median(slow for _, slow in pairs):.2f} |")
    ratio = statistics.median(ratios)
    print(f"\nratio {ratio:.0f} ({min(ratios):.0f} to {max(ratios):.0f}), required {REQUIRED:.0f}")
    return 0 if ratio >= REQUIRED else 1


if __name__ == "__main__":
    sys.exit(main())
