"""How much sooner a sweep of 400 runs of the rope is over in two processes than in one, and what the pool itself costs.

Wall time counts what else the machine does: run it alone. The ratio of processor times, one process to two, holds on a
machine that is shared as well: what two spend beyond one is the start of the second, and the talk between them.
"""

import os
import sys
import time

import numpy as np

from sandbox.level.reading.files import load_level
from sandbox.session.sweep.grid import SweepGrid
from sandbox.session.sweep.running import swept

SIDE, SECONDS = 20, 10.0


def spent() -> float:
    """Processor time [s] of this process and of those that it has waited for."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def measure(grid: SweepGrid, processes: int) -> tuple[float, float, list[object]]:
    """Wall and processor time [s] of a sweep, and its rows."""
    wall, processor = time.perf_counter(), spent()
    rows = sorted(swept(grid, [], processes))
    return time.perf_counter() - wall, spent() - processor, rows


def main(side: int) -> None:
    """Print times of both, and how many times sooner two are ready; the first run loads kernels and is not counted."""
    level = load_level("rope")
    cs = tuple(float(f"{value:.9g}") for value in np.geomspace(0.001, 1.0, side))
    cd = tuple(float(f"{value:.9g}") for value in np.linspace(0.0, 1.0, side))
    grid = SweepGrid(level, {"cs": cs, "cd": cd}, round(SECONDS * level.settings.tick_rate))
    measure(SweepGrid(level, {"cs": cs[:1], "cd": cd[:1]}, 60), 1)
    (wall, processor, rows), (wall_two, processor_two, rows_two) = measure(grid, 1), measure(grid, 2)
    assert rows == rows_two
    print(f"| {grid.runs} runs of the rope | wall [s] | processor [s] |\n|---|---|---|")
    print(f"| one process | {wall:.1f} | {processor:.1f} |\n| two | {wall_two:.1f} | {processor_two:.1f} |\n")
    print(f"two are ready {wall / wall_two:.2f} times sooner (at least 1.7 wanted)")
    print(f"by processor time {2.0 * processor / processor_two:.2f} times, were both cores theirs alone")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else SIDE)
