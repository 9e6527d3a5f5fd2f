"""Running the points of a sweep in processes of this machine."""

from collections.abc import Collection, Generator
from concurrent.futures import as_completed
from typing import Any

from sandbox.session.sweep.case import run_case
from sandbox.session.sweep.grid import SweepGrid
from sandbox.session.worker_pool import interrupts_ignored, worker_pool


def missing_points(grid: SweepGrid, known: Collection[int]) -> list[int]:
    """Numbers of the points that are not known, in order."""
    return sorted(set(range(grid.runs)) - set(known))


def swept(grid: SweepGrid, known: Collection[int], processes: int) -> Generator[tuple[int, list[Any]], None, None]:
    """Run the unfinished points; number and row of each as it ends, in any order.

    Close it if not all are wanted. Raises SweepError, and OSError where a process is gone.
    """
    missing = missing_points(grid, known)
    if processes == 1 or len(missing) < 2:
        for number in missing:
            yield number, run_case(grid.request, grid.cases[number])
        return
    with worker_pool(processes) as workers:
        with interrupts_ignored():
            numbers = {workers.submit(run_case, grid.request, grid.cases[number]): number for number in missing}
        for done in as_completed(numbers):
            yield numbers[done], done.result()
