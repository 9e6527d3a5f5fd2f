"""SweepGrid: a level and the points of settings at which a sweep runs it."""

import contextlib
import csv
import hashlib
import io
import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.writing import write_file
from sandbox.level.reading.files import level_data, parse_level
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.level_edits import SILENT, with_value

# Columns that are Cs and Cd; all others are fields of the level.
CS, CD = "cs", "cd"
# What is measured of a run, before its checks.
FIGURES = ("settle_time", "max_strain", "energy_drift", "broken_springs", "blew_up")
Value = float | int | str
# More characters are no table of a sweep that can be run.
LONGEST_TABLE = 100_000_000


class SweepError(ValueError):
    """A sweep that cannot be run; one line."""


@dataclass(frozen=True)
class SweepRequest:
    """The sweep as a process gets it: the level as text, names of columns, ticks of a run.

    material: its springs have the Cs and Cd; None = all springs.
    """

    text: str
    columns: tuple[str, ...]
    ticks: int
    material: str | None
    physics_version: int = PHYSICS_VERSION

    @property
    def level(self) -> Level:
        """The level that is swept."""
        return _level(self.text)


@dataclass(frozen=True)
class SweepGrid:
    """A level and the values of every column, of which the last changes fastest; ticks of each run.

    material: name of that whose springs have the Cs and Cd of the grid; None = all springs.
    Raises SweepError where two points would be the same.
    """

    level: Level
    columns: Mapping[str, tuple[Value, ...]]
    ticks: int
    material: str | None = None
    request: SweepRequest = field(init=False, compare=False)

    def __post_init__(self) -> None:
        for name, values in self.columns.items():
            if len(set(values)) < len(values):
                raise SweepError(f"{name}: a value is given twice")
        text = json.dumps(level_data(self.level))
        object.__setattr__(self, "request", SweepRequest(text, tuple(self.columns), self.ticks, self.material))

    @property
    def runs(self) -> int:
        """Number of points."""
        return math.prod(map(len, self.columns.values()))

    @cached_property
    def cases(self) -> list[tuple[Value, ...]]:
        """The points, in order."""
        return list(itertools.product(*self.columns.values()))

    @property
    def figures(self) -> list[str]:
        """Names of the measures of each run."""
        return [*FIGURES, *(f"check: {check.name}" for check in self.level.checks)]

    @property
    def header(self) -> list[str]:
        """Names of the columns of the table."""
        return [*self.columns, *self.figures, "seconds", "level"]

    @property
    def seconds(self) -> float:
        """How long each run is [s]."""
        return self.ticks / self.level.settings.tick_rate

    @cached_property
    def digest(self) -> str:
        """A digest of a level without the swept fields and without looks."""
        level = case_level(self.level, tuple(self.columns), [values[0] for values in self.columns.values()])
        shown = set(SILENT) - {"checks"}
        data = {name: value for name, value in level_data(level).items() if name not in shown}
        text = json.dumps([data, self.material, PHYSICS_VERSION], sort_keys=True)
        return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


def case_level(level: Level, columns: Sequence[str], case: Sequence[Value]) -> Level:
    """The level of one point, but for Cs and Cd. Raises SweepError for a value that it cannot have."""
    try:
        for name, value in zip(columns, case, strict=True):
            if name not in (CS, CD):
                level = with_value(level, name, value)
    except LevelError as error:
        raise SweepError(f"{name} = {value}: {error.faults[0]}") from None
    return level


@lru_cache(maxsize=4)
def _level(text: str) -> Level:
    return parse_level(text.encode(), "the swept level")


Rows = Mapping[int, Sequence[Any]]


def read_table(path: Path, level: Level, materials: Sequence[str | None] = (None,)) -> tuple[SweepGrid, Rows]:
    """The sweep of a level that a table holds; materials: those whose Cs and Cd it may be of.

    Raises SweepError where it is none, or is of another level, and OSError.
    """
    header, lines = _lines(path)
    columns = header[: header.index(FIGURES[0])]
    values = {name: tuple(dict.fromkeys(_value(line[k]) for line in lines)) for k, name in enumerate(columns)}
    seconds, digest = float(lines[0][-2]), lines[0][-1]
    ticks = max(1, round(seconds * level.settings.tick_rate))
    for material in materials:
        try:
            grid = SweepGrid(level, values, ticks, material)
            is_of_level = grid.digest == digest
        except SweepError:
            # A place that the level does not have.
            is_of_level = False
        if is_of_level:
            return grid, _rows(path, grid, header, lines)
    raise SweepError(f"{path}: is a sweep of another level, or of this one before it was changed")


def _lines(path: Path) -> tuple[list[str], list[list[str]]]:
    with path.open(encoding="utf-8", newline="") as file:
        text = file.read(LONGEST_TABLE + 1)
    try:
        header, *lines = csv.reader(io.StringIO(text), strict=True)
        float(lines[0][-2])
        is_table = len(text) <= LONGEST_TABLE and FIGURES[0] in header and header[-2:] == ["seconds", "level"]
    except (ValueError, IndexError, csv.Error):
        is_table = False
    if not is_table or any(len(line) != len(header) for line in lines):
        raise SweepError(f"{path}: is no table of a sweep")
    return header, lines


def _rows(path: Path, grid: SweepGrid, header: list[str], lines: list[list[str]]) -> Rows:
    width = len(grid.columns)
    ends = [repr(grid.seconds), grid.digest]
    points = [tuple(map(_value, line[:width])) for line in lines]
    if header != grid.header or points != grid.cases or any(line[-2:] != ends for line in lines):
        raise SweepError(f"{path}: is not a whole sweep of one level, row by row")
    try:
        return {number: [_figure(cell) for cell in line[width:-2]] for number, line in enumerate(lines)}
    except ValueError:
        raise SweepError(f"{path}: has figures that are no numbers") from None


def _figure(cell: str) -> float | int | None:
    return None if cell == "" else int(cell) if cell.isdecimal() else float(cell)


def _value(cell: str) -> Value:
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell


def table_text(grid: SweepGrid, rows: Rows) -> str:
    """The table of all rows by number; what there is none of is empty."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(grid.header)
    for number, case in enumerate(grid.cases):
        writer.writerow([*case, *rows[number], grid.seconds, grid.digest])
    return file.getvalue()


class Journal:
    """The finished rows of a sweep, kept in a file beside its table until that is written.

    rows: by number; replaced: whether the file was of another level or grid, which is forgotten.
    fresh: forget what was there. Raises OSError.
    """

    def __init__(self, table: Path, grid: SweepGrid, fresh: bool = False) -> None:
        self.path = table.with_name(table.name + ".unfinished")
        self._table, self._grid = table, grid
        self.rows: dict[int, list[Any]] = {}
        self.replaced = False
        self._first = json.dumps({"level": grid.digest, "ticks": grid.ticks, "columns": dict(grid.columns),
                                  "figures": grid.figures})  # fmt: skip
        lines: list[str] = []
        if not fresh and self.path.exists():
            lines = self.path.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)
            self.replaced = bool(lines) and lines[0] != self._first + "\n"
        for line in [] if self.replaced else lines[1:]:
            # What was cut off in the middle of a line is no row.
            with contextlib.suppress(ValueError):
                number, row = json.loads(line)
                self.rows[number] = row
        self.save()

    def save(self) -> None:
        """Write the file again with all finished rows."""
        lines = [self._first, *(json.dumps([number, row]) for number, row in self.rows.items())]
        write_file(self.path, "".join(f"{line}\n" for line in lines).encode())

    def add(self, number: int, row: list[Any]) -> None:
        """Keep a row, on the disk too."""
        self.rows[number] = row
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps([number, row]) + "\n")

    def finish(self) -> None:
        """Write the table, rows in the order of the grid, and remove the journal."""
        write_file(self._table, table_text(self._grid, self.rows).encode())
        self.path.unlink(missing_ok=True)
