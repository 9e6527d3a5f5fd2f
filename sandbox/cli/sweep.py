"""`sandbox sweep`: a level over a grid of settings."""

import json
import math
from collections.abc import Generator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.base.command import Subcommand, argument, flag, needed_option, option, option_or, repeated_option
from sandbox.cli.base.inputs import EXIT_INTERRUPTED, EXIT_OK, Refused, level_of
from sandbox.processors import cores
from sandbox.terminal import Progress, processes, seconds, tell

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.session.sweep.grid import Rows, SweepGrid, Value

SWEEP_SECONDS = 10.0
MOST_RUNS = 100_000
TABLE, MAP = ".csv", ".png"


@dataclass(frozen=True, kw_only=True)
class SweepOptions:
    """Options of `sweep`: the grid, how to run it, and where results go."""

    level: str = argument(str, "LEVEL")
    cs: str | None = option(str, metavar="A:B:N[:log]", help="Cs: N values from A to B, or a,b,..")
    cd: str | None = option(str, metavar="A:B:N[:log]", help="Cd, likewise")
    material: str | None = option(str, metavar="NAME", help="whose springs have them; default: all")
    solver: str | None = option(str, help="names with commas between, or all")
    substeps: str | None = option(str, help="numbers with commas between, and auto")
    set: list[str] = repeated_option(str, metavar="FIELD=VALUES", help="any field of the level: deck.height=0.1:1:5")
    seconds: float = option_or(SWEEP_SECONDS, seconds, help="simulated time of each run; default 10")
    measure: str | None = option(str, metavar="NAMES", help="what the map shows, with commas between; default: all")
    processes: int | None = option(processes, metavar="N", help="at a time; default: one a processor")
    dask: str | None = option(
        str, metavar="ADDRESS", help="run by the scheduler of dask there; local: by one of this machine"
    )
    fresh: bool = flag("run again what is known already")
    output: Path = needed_option(Path, "-o", metavar="OUT.csv|png", help="table; or map, with the table beside")


def sweep(options: SweepOptions) -> int:
    """Run the grid, write its table, and draw its map where that is wanted."""
    from sandbox.session.sweep.grid import SweepError

    kind = options.output.suffix.lower()
    if kind not in (TABLE, MAP):
        raise Refused(f"{options.output}: end the name in .csv, for a table, or in .png, for a map")
    if options.measure and kind != MAP:
        raise Refused("--measure: is of a map; end the name of -o in .png")
    _require(options, kind)
    try:
        grid = _grid(options)
        panels = _panels(grid, options) if kind == MAP else []
        table = options.output.with_suffix(TABLE) if kind == MAP else options.output
        rows = None if options.fresh else _known(table, grid, kind == MAP)
        if rows is None:
            rows = _run(table, grid, options)
            if rows is None:
                return EXIT_INTERRUPTED
            print(f"{table}: {grid.runs} runs")
        else:
            tell([f"{table}: holds these {grid.runs} runs already; --fresh runs them again"])
    except SweepError as error:
        raise Refused(str(error)) from None
    if kind == MAP:
        from sandbox.app.panel.sweeps.sweep_chart import draw_map

        draw_map(grid, rows, panels, options.output)
        print(f"{options.output}: {len(panels)} measures")
    return EXIT_OK


def _require(options: SweepOptions, kind: str) -> None:
    from sandbox.app.film.kinds import Missing, require_module

    try:
        if kind == MAP:
            require_module("a map", "matplotlib", "matplotlib")
        if options.dask:
            require_module("--dask", "distributed", "dask and distributed", "sweep")
    except Missing as missing:
        raise Refused(str(missing)) from None


def _grid(options: SweepOptions) -> "SweepGrid":
    """The grid that is asked for. Raises Refused and SweepError."""
    from sandbox.session.sweep.grid import SweepGrid, case_level

    level = level_of(options.level)
    columns = _columns(options, level)
    runs = math.prod(map(len, columns.values()))
    if not columns:
        raise Refused("nothing varies: give --cs, --cd, --solver, --substeps or --set")
    if runs > MOST_RUNS:
        raise Refused(f"{runs:,} runs: at most {MOST_RUNS:,} are possible; take coarser steps")
    for name, values in columns.items():
        for value in values:
            case_level(level, [name], [value])
    ticks = max(1, round(options.seconds * level.settings.tick_rate))
    return SweepGrid(level, columns, ticks, options.material)


def _panels(grid: "SweepGrid", options: SweepOptions) -> list[str]:
    """The measures that the map shows. Raises Refused where it cannot."""
    from sandbox.session.sweep.sweep_map import MOST_MAPS, panel_count

    if not {"cs", "cd"} <= set(grid.columns):
        raise Refused("a map has Cs across and Cd up: give --cs and --cd, or end the name in .csv")
    measures = options.measure.split(",") if options.measure else grid.figures
    for name in measures:
        if name not in grid.figures:
            raise Refused(f"--measure: there is no {name!r}; there are: {', '.join(grid.figures)}")
    maps = panel_count(grid) * len(measures)
    if maps > MOST_MAPS:
        raise Refused(f"{maps} maps in one picture: at most {MOST_MAPS} can be read; choose some with --measure")
    return measures


def _known(table: Path, grid: "SweepGrid", is_beside: bool) -> "Rows | None":
    """The rows of a table that holds this very sweep; is_beside: it is not what was named. Raises Refused."""
    from sandbox.session.sweep.grid import SweepError, read_table

    if not table.is_file():
        return None
    try:
        found, rows = read_table(table, grid.level, (grid.material,))
        if found == grid:
            return rows
    except (SweepError, UnicodeDecodeError):
        pass
    if is_beside:
        raise Refused(f"{table}: would be written over, but is not of this sweep; move it, or start over with --fresh")
    return None


def _run(table: Path, grid: "SweepGrid", options: SweepOptions) -> "Rows | None":
    """Run what is not known yet and write the table; its rows, None where it was interrupted. Raises SweepError."""
    from sandbox.session.sweep.grid import Journal

    journal = Journal(table, grid, options.fresh)
    if journal.replaced:
        tell([f"{journal.path}: was of another level or grid; all runs start over"])
    if journal.rows:
        tell([f"{len(journal.rows)} of {grid.runs} runs are known already; --fresh runs them again"])
    try:
        with Progress(grid.runs, "run") as bar, closing(_rows(grid, journal.rows, options)) as rows:
            bar.update(len(journal.rows))
            for number, row in rows:
                journal.add(number, row)
                bar.update()
    except KeyboardInterrupt:
        tell([f"{len(journal.rows)} of {grid.runs} runs are done; the same command goes on from there"])
        return None
    journal.finish()
    return journal.rows


def _rows(grid: "SweepGrid", known: "Rows", options: SweepOptions) -> Generator[tuple[int, list[Any]], None, None]:
    workers = min(options.processes or cores(), grid.runs)
    if options.dask:
        from sandbox.session.sweep.running import swept_by_dask

        return swept_by_dask(grid, list(known), options.dask, workers)
    from sandbox.session.sweep.running import swept

    return swept(grid, list(known), workers)


def _columns(options: SweepOptions, level: "Level") -> "dict[str, tuple[Value, ...]]":
    """The values of every column, Cs and Cd last. Raises Refused."""
    from sandbox.session.level_edits import field_place

    columns: dict[str, tuple[Value, ...]] = {}
    if options.solver:
        from sandbox.physics.solvers import SOLVERS

        columns["settings.solver"] = tuple(SOLVERS) if options.solver == "all" else tuple(options.solver.split(","))
    if options.substeps:
        columns["settings.substeps"] = values_of("--substeps", options.substeps)
    for text in options.set:
        field, sign, value_text = text.partition("=")
        if not sign:
            raise Refused(f"--set: {text!r}: write FIELD=A:B:N, or FIELD=a,b,..")
        columns[field_place(level, field)] = values_of("--set", value_text)
    for name, typed in (("cs", options.cs), ("cd", options.cd)):
        if typed:
            values = values_of(f"--{name}", typed)
            if not all(isinstance(value, float | int) and 0.0 <= value <= 1.0 for value in values):
                raise Refused(f"--{name}: {typed!r}: Cs and Cd lie between 0 and 1")
            columns[name] = tuple(map(float, values))
    return columns


def values_of(option: str, text: str) -> tuple[float | int | str, ...]:
    """The values of "A:B:N", "A:B:N:log" or "a,b,..". Raises Refused."""
    parts = text.split(":")
    if len(parts) == 1:
        return tuple(_value(part) for part in text.split(","))
    scale = parts.pop() if len(parts) == 4 and parts[-1] in ("log", "linear") else "linear"
    try:
        first, last, count = float(parts[0]), float(parts[1]), int(parts[2])
        if len(parts) != 3 or count < 1 or not (math.isfinite(first) and math.isfinite(last)):
            raise ValueError
        if scale == "log" and not (first > 0.0 and last > 0.0):
            raise Refused(f"{option}: {text!r}: a logarithmic scale has values above 0")
    except (ValueError, IndexError):
        raise Refused(f"{option}: {text!r}: write A:B:N with N values from A to B, A:B:N:log, or a,b,..") from None
    shares = [k / (count - 1) if count > 1 else 0.0 for k in range(count)]
    # Ends are the very numbers that were typed.
    inner = [first * (last / first) ** s if scale == "log" else first + (last - first) * s for s in shares]
    values = [float(f"{value:.9g}") for value in [*inner[:-1], last if count > 1 else first]]
    # Whole steps between whole numbers are whole numbers: segments, substeps.
    is_whole = not set(text) & set(".eE") and all(value.is_integer() for value in values)
    return tuple(int(value) for value in values) if is_whole else tuple(values)


def _value(text: str) -> float | int | str:
    try:
        value = json.loads(text)
    except ValueError:
        return text
    return value if type(value) in (int, float, str) else text


COMMAND = Subcommand("sweep", "run a level over a grid of settings into a table", SweepOptions, sweep)
