"""One run of a sweep, and its measurements."""

import logging
import math
from collections.abc import Collection, Generator, Sequence
from concurrent.futures import as_completed
from contextlib import ExitStack
from typing import Any

import numpy as np

from sandbox.level.checks import STILL
from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.analysis.query import load_bearing, shown_particles, shown_springs, strain
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.check_run import CheckRun, CheckWatch, check_runs
from sandbox.session.commands import SetCoefficients
from sandbox.session.session import Session
from sandbox.session.sweep.grid import CD, CS, SweepError, SweepGrid, SweepRequest, Value, case_level
from sandbox.session.worker_pool import interrupts_ignored, worker_pool

# Whatever is faster [m/s] has blown up: nothing that a person builds gets there.
FASTEST = 1e4
# The address that stands for a cluster of this machine, for as long as the sweep takes.
LOCAL = "local"
# How long a scheduler may take to answer [s], and how often a run is begun again whose worker was lost.
PATIENCE, RETRIES = 30.0, 10


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


def missing_points(grid: SweepGrid, known: Collection[int]) -> list[int]:
    """Numbers of the points that are not known, in order."""
    return sorted(set(range(grid.runs)) - set(known))


def run_case(request: SweepRequest, case: Sequence[Value]) -> list[Any]:
    """Run one point of a sweep; its figures, and 1 or 0 for each check. Raises SweepError."""
    if request.physics_version != PHYSICS_VERSION:
        raise SweepError(f"a process has physics version {PHYSICS_VERSION}, this one {request.physics_version}")
    level = case_level(request.level, request.columns, case)
    values = dict(zip(request.columns, case, strict=True))
    first, *others = check_runs(level)
    held: dict[int, int] = {}
    figures = _measured(first, request, values, held)
    for run in others:
        _set_coefficients(run.session, values, request.material)
        with np.errstate(over="ignore", invalid="ignore"):
            while _looked(run, held).waiting:
                run.advance()
    finite = [None if isinstance(each, float) and not math.isfinite(each) else each for each in figures]
    return [*finite, *(held[number] for number in sorted(held))]


def _looked(run: CheckRun, held: dict[int, int]) -> CheckWatch:
    """Look at a tick of a run, and note the checks that are decided."""
    held.update((number, int(result.passed)) for number, result in run.watch.look())
    return run.watch


def _measured(run: CheckRun, request: SweepRequest, values: dict[str, Value], held: dict[int, int]) -> list[Any]:
    """The figures of a run without keys."""
    world = run.session.world
    _set_coefficients(run.session, values, request.material)
    most_strain, settled, blew_up = 0.0, 0, False
    with np.errstate(over="ignore", invalid="ignore"):
        start = highest = total_energy(world)
        while True:
            watch = _looked(run, held)
            speed = _fastest(world)
            blew_up = blew_up or bool(world.contained) or not speed < FASTEST
            most_strain = max(most_strain, float(np.max(np.abs(strain(world))[load_bearing(world)], initial=0.0)))
            highest = max(highest, total_energy(world))
            settled = world.tick + 1 if not speed <= STILL else settled
            if world.tick >= request.ticks and not watch.waiting:
                break
            run.advance()
    settle_time = round(settled / world.settings.tick_rate, 9) if settled <= world.tick else None
    return [settle_time, most_strain, highest - start, _broken(world), int(blew_up)]


def _set_coefficients(session: Session, values: dict[str, Value], material: str | None) -> None:
    cs, cd = (float(values[name]) if name in values else None for name in (CS, CD))
    if cs is None and cd is None:
        return
    names = list(session.world.material_names)
    if material is not None and material not in names:
        raise SweepError(f"there is no material {material!r}; there are: {', '.join(names)}")
    number = None if material is None else names.index(material)
    session.submit(SetCoefficients(stiffness=cs, damping=cd, material=number))
    session.apply_pending()
    if session.refusals:
        raise SweepError(session.refusals[0])


def _fastest(world: World) -> float:
    speed = np.sqrt(np.sum(world.velocity[shown_particles(world)] ** 2, axis=1))
    return float(np.max(speed, initial=0.0))


def _broken(world: World) -> int:
    hands = sum(world.is_grab_spring(slot) for slot in range(world.spring_count))
    return int(world.spring_count - hands - np.count_nonzero(shown_springs(world)))
