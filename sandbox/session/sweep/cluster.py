"""Running the points of a sweep by dask's distributed scheduler, on as many machines as it has."""

import logging
from collections.abc import Collection, Generator
from contextlib import ExitStack
from typing import Any

from sandbox.session.sweep.case import run_case
from sandbox.session.sweep.grid import SweepError, SweepGrid
from sandbox.session.sweep.pool import missing_points
from sandbox.session.worker_pool import interrupts_ignored

# The address that stands for a cluster of this machine, for as long as the sweep takes.
LOCAL = "local"
# How long a scheduler may take to answer [s], and how often a run is begun again whose worker was lost.
PATIENCE, RETRIES = 30.0, 10


def swept_by_dask(
    grid: SweepGrid, known: Collection[int], address: str, workers: int
) -> Generator[tuple[int, list[Any]], None, None]:
    """Run the points that are not known; number and row of each as it ends, in any order, each once.

    address: of a scheduler, or "local" for a cluster of `workers` processes. Other workers run the points of a lost
    worker. Close it if not all are wanted. Raises SweepError, OSError where no scheduler answers, ImportError without
    dask.
    """
    from distributed import Client, Future, LocalCluster, as_completed
    from distributed.scheduler import KilledWorker

    missing = missing_points(grid, known)
    if not missing:
        return
    with ExitStack() as stack:
        try:
            with interrupts_ignored():
                target: Any = address
                if address == LOCAL:
                    # It tells of every worker that is lost, which is no fault of the sweep.
                    target = stack.enter_context(
                        LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None,
                                     silence_logs=logging.CRITICAL)
                    )  # fmt: skip
                client = stack.enter_context(Client(target, timeout=PATIENCE, set_as_default=False))
        except (OSError, TimeoutError, ValueError) as error:
            raise OSError(0, f"no scheduler of dask answers ({error})", address) from None
        # Keys of this sweep alone: another one's rows are never taken for these.
        numbers: dict[Future, int] = {
            client.submit(run_case, grid.request, grid.cases[number], pure=False, retries=RETRIES): number
            for number in missing
        }
        try:
            for done in as_completed(list(numbers), loop=client.loop):
                yield numbers.pop(done), done.result()
                done.release()
        except KilledWorker as error:
            raise OSError(0, f"workers of dask were lost again and again ({error})", address) from None
        except ModuleNotFoundError as error:
            raise SweepError(f"a worker of dask lacks what the sweep needs: {error}") from None
        finally:
            client.cancel(list(numbers))
