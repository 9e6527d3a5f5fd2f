"""How much faster than interpreted are compiled kernels? Run by hand: python tests/bench/kernels.py

A tick of the single pass over a 32x32 mesh with diagonals, compiled in this process and interpreted in another, in
turns; prints Markdown and ends with 1 where the median of the paired ratios is below 100.
"""

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from sandbox.physics.jit import COMPILED
from sandbox.physics.step import step
from tests.support.physics_scenes import grid_with_diagonals

SIDE = 32
PAIRS = 7
REQUIRED = 100.0


def seconds_per_tick(ticks: int) -> float:
    """Median time [s] of one tick of the mesh, in motion, kernels warm."""
    settings = {"solver": "single_pass", "stiffness": 0.1, "damping": 0.1, "gravity": (0.0, -9.81)}
    world, times = grid_with_diagonals(columns=SIDE, rows=SIDE, **settings), []
    step(world)
    for _ in range(ticks):
        start = time.perf_counter()
        step(world)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def interpreted_seconds() -> float:
    """The same in a process in which the same kernels run interpreted."""
    environment = {**os.environ, "SANDBOX_KERNELS": "interpreted"}
    command = [sys.executable, __file__, "--interpreted"]
    return float(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)


def main() -> int:
    """Compare, print a table, and say whether the requirement is met."""
    if "--interpreted" in sys.argv:
        print(seconds_per_tick(5))
        return 0
    if not COMPILED:
        sys.exit("kernels are interpreted here: there is nothing to compare")
    pairs = [(seconds_per_tick(200), interpreted_seconds()) for _ in range(PAIRS)]
    ratios = [slow / fast for fast, slow in pairs]
    springs = grid_with_diagonals(columns=SIDE, rows=SIDE).spring_count
    print(f"Ticks of the single pass, {SIDE}x{SIDE} mesh with diagonals, {springs} springs, medians of {PAIRS} pairs\n")
    print("| kernels | ms per tick |\n|---|---|")
    print(f"| compiled | {1e3 * statistics.median(fast for fast, _ in pairs):.4f} |")
    print(f"| interpreted | {1e3 * statistics.median(slow for _, slow in pairs):.2f} |")
    ratio = statistics.median(ratios)
    print(f"\nratio {ratio:.0f} ({min(ratios):.0f} to {max(ratios):.0f}), required {REQUIRED:.0f}")
    return 0 if ratio >= REQUIRED else 1


if __name__ == "__main__":
    sys.exit(main())
