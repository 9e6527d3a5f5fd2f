"""The table of a sweep as CSV: a row for every run, in the order of the grid."""

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sandbox.level.document.model import Level
from sandbox.session.sweep.grid import FIGURES, SweepError, SweepGrid, Value

# More characters are no table of a sweep that can be run.
LONGEST_TABLE = 100_000_000

Rows = Mapping[int, Sequence[Any]]


def table_text(grid: SweepGrid, rows: Rows) -> str:
    """The table of all rows by number; what there is none of is empty."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(grid.header)
    for number, case in enumerate(grid.cases):
        writer.writerow([*case, *rows[number], grid.seconds, grid.digest])
    return file.getvalue()


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
