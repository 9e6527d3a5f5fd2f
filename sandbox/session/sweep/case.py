"""One run of a sweep, and its measurements."""

import math
from collections.abc import Sequence
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
from sandbox.session.sweep.grid import CD, CS, SweepError, SweepRequest, Value, case_level

# Whatever is faster [m/s] has blown up: nothing that a person builds gets there.
FASTEST = 1e4


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
