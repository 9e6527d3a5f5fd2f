"""Sweeps: a level run once for every point of a grid of settings, in processes, taken up again where it was left."""

import itertools
import json
import math
import multiprocessing
import signal
from collections.abc import Generator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.level.checks import STILL
from sandbox.level.faults.level_error import LevelError
from sandbox.level.format.files import level_data, parse_level
from sandbox.level.format.model import Level
from sandbox.level.format.writing import write_file
from sandbox.physics.energy import gravity_energy, kinetic_energy, spring_energy
from sandbox.physics.query import load_bearing, shown_particles, shown_springs, strain
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.check_run import CheckWatch
from sandbox.session.commands import SetCoefficients
from sandbox.session.level_edits import with_value
from sandbox.session.session import Session

# Columns that are Cs and Cd, of all materials at once; all others are fields of the level.
CS, CD = "cs", "cd"
# What is measured of a run, before its checks.
FIGURES = ("settle_time", "max_strain", "energy_rise", "broken_springs", "blew_up")
# Whatever is faster [m/s] has blown up: nothing that a person builds gets there.
FASTEST = 1e4

Value = float | int | str


class SweepError(ValueError):
    """A sweep that cannot be run; one line."""


@dataclass(frozen=True)
class SweepGrid:
    """A level and the values of every column, of which the last changes fastest; ticks of each run."""

    level: Level
    columns: dict[str, tuple[Value, ...]]
    ticks: int
    _text: str = field(init=False, compare=False, default="")

    def __post_init__(self) -> None:
        object.__setattr__(self, "_text", json.dumps(level_data(self.level)))

    @property
    def cases(self) -> list[tuple[Value, ...]]:
        """The points, in order."""
        return list(itertools.product(*self.columns.values()))

    @property
    def header(self) -> list[str]:
        """Names of the columns of the table."""
        return [*self.columns, *FIGURES, *(f"check: {check.name}" for check in self.level.checks)]

    def request(self) -> dict[str, Any]:
        """What a journal must be of to go on with it."""
        return {"level": json.loads(self._text), "columns": {name: list(each) for name, each in self.columns.items()},
                "ticks": self.ticks, "physics_version": PHYSICS_VERSION}  # fmt: skip

    def row(self, case: Sequence[Value]) -> list[Any]:
        """Run one point; its figures, and 1 or 0 for each check. Raises SweepError."""
        return run_case(self._text, tuple(self.columns), tuple(case), self.ticks)


@lru_cache(maxsize=4)
def _level(text: str) -> Level:
    return parse_level(text.encode(), "the swept level")


def case_level(level: Level, columns: Sequence[str], case: Sequence[Value]) -> Level:
    """The level of one point, but for Cs and Cd. Raises SweepError for a value that it cannot have."""
    try:
        for name, value in zip(columns, case, strict=True):
            if name not in (CS, CD):
                level = with_value(level, name, value)
    except LevelError as error:
        raise SweepError(f"{name} = {value}: {error.faults[0]}") from None
    return level


def run_case(text: str, columns: tuple[str, ...], case: tuple[Value, ...], ticks: int) -> list[Any]:
    """Run the level of a text at one point of a grid. Raises SweepError."""
    level = case_level(_level(text), columns, case)
    values = dict(zip(columns, case, strict=True))
    session = Session(level)
    if CS in values or CD in values:
        cs, cd = (float(values[name]) if name in values else None for name in (CS, CD))
        session.submit(SetCoefficients(stiffness=cs, damping=cd))
        session.apply_pending()
        if session.messages:
            raise SweepError(session.messages[0])
    world, watch = session.world, CheckWatch(level, session.world)
    held: dict[int, int] = {}
    most_strain, settled, blew_up = 0.0, 0, False
    start = highest = _energy(world)
    with np.errstate(over="ignore", invalid="ignore"):
        while True:
            held.update((number, int(result.passed)) for number, result in watch.look())
            speed = _fastest(world)
            blew_up = blew_up or bool(world.contained) or not speed < FASTEST
            most_strain = max(most_strain, float(np.max(np.abs(strain(world))[load_bearing(world)], initial=0.0)))
            highest = max(highest, _energy(world))
            settled = world.tick + 1 if not speed <= STILL else settled
            if world.tick >= ticks and not watch.waiting:
                break
            session.advance()
    rate = world.settings.tick_rate
    figures = [
        round(settled / rate, 9) if settled <= world.tick else None, most_strain, highest - start, _broken(world),
        int(blew_up),
    ]  # fmt: skip
    finite = [None if isinstance(each, float) and not math.isfinite(each) else each for each in figures]
    return [*finite, *(held[number] for number in sorted(held))]


def _energy(world: World) -> float:
    return kinetic_energy(world) + spring_energy(world) + gravity_energy(world)


def _fastest(world: World) -> float:
    speed = np.sqrt(np.sum(world.velocity[shown_particles(world)] ** 2, axis=1))
    return float(np.max(speed, initial=0.0))


def _broken(world: World) -> int:
    hands = sum(world.is_grab_spring(slot) for slot in range(world.spring_count))
    return int(world.spring_count - hands - np.count_nonzero(shown_springs(world)))


class Journal:
    """The rows of a sweep that are known, kept in a file beside its table until that is written.

    rows: by number. fresh: forget what was there. Raises OSError, and SweepError for one of another sweep.
    """

    def __init__(self, table: Path, grid: SweepGrid, fresh: bool = False) -> None:
        self.path = table.with_name(table.name + ".unfinished")
        self.rows: dict[int, list[Any]] = {}
        request = json.dumps(grid.request())
        if fresh:
            self.path.unlink(missing_ok=True)
        lines = self.path.read_text(encoding="utf-8").splitlines(keepends=True) if self.path.exists() else []
        if lines and lines[0] != request + "\n":
            raise SweepError(f"{self.path}: is of another sweep; finish that, or begin anew with --fresh")
        whole = [request + "\n", *(line for line in lines[1:] if line.endswith("\n"))]
        for line in whole[1:]:
            number, row = json.loads(line)
            self.rows[number] = row
        # What was cut off in the middle of a line goes.
        write_file(self.path, "".join(whole).encode())

    def add(self, number: int, row: list[Any]) -> None:
        """Keep a row, on the disk too."""
        self.rows[number] = row
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps([number, row]) + "\n")

    def finish(self, table: Path, grid: SweepGrid) -> None:
        """Write the table, rows in the order of the grid, and remove the journal."""
        write_file(table, table_text(grid, self.rows).encode())
        self.path.unlink(missing_ok=True)


def table_text(grid: SweepGrid, rows: dict[int, list[Any]]) -> str:
    """The table as CSV; what there is none of is empty."""
    lines = [grid.header, *([*case, *rows[number]] for number, case in enumerate(grid.cases))]
    return "".join(",".join(map(_cell, line)) + "\n" for line in lines)


def _cell(value: Any) -> str:
    text = "" if value is None else value if isinstance(value, str) else repr(value)
    return '"' + text.replace('"', '""') + '"' if set(text) & set(',"\n') else text


def swept(grid: SweepGrid, known: Sequence[int], processes: int) -> Generator[tuple[int, list[Any]], None, None]:
    """Run the points that are not known; number and row of each as it ends, in whatever order.

    Close it if not all are wanted. Raises SweepError, and OSError where a process is gone.
    """
    cases = grid.cases
    missing = [number for number in range(len(cases)) if number not in set(known)]
    if processes == 1 or len(missing) < 2:
        for number in missing:
            yield number, grid.row(cases[number])
        return
    spawn = multiprocessing.get_context("spawn")
    workers = ProcessPoolExecutor(processes, spawn, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))
    try:
        numbers = {workers.submit(run_case, grid._text, tuple(grid.columns), cases[number], grid.ticks): number
                   for number in missing}  # fmt: skip
        for done in as_completed(numbers):
            yield numbers[done], done.result()
        workers.shutdown()
    except BrokenProcessPool:
        raise OSError(0, "a process of the sweep has ended before its time; is there memory for all?") from None
    except BaseException:
        workers.shutdown(wait=False, cancel_futures=True)
        for child in multiprocessing.active_children():
            child.terminate()
        raise
