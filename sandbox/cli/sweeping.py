"""`sandbox sweep`: a level over a grid of settings."""

import argparse
import json
import math
from contextlib import closing
from pathlib import Path

from sandbox.cli.inputs import EXIT_INTERRUPTED, EXIT_OK, Refused, level_of
from sandbox.terminal import Progress, cores, processes, seconds, tell

SWEEP_SECONDS = 10.0
MOST_RUNS = 100_000


def add_options(sweep: argparse.ArgumentParser) -> None:
    """Options of `sandbox sweep`."""
    sweep.add_argument("level", metavar="LEVEL")
    sweep.add_argument("--cs", metavar="A:B:N[:log]", help="Cs of all materials: N values from A to B, or a,b,..")
    sweep.add_argument("--cd", metavar="A:B:N[:log]", help="Cd of all materials, likewise")
    sweep.add_argument("--solver", help="names with commas between, or all")
    sweep.add_argument("--substeps", help="numbers with commas between")
    sweep.add_argument(
        "--set", action="append", default=[], metavar="FIELD=VALUES", help="any field: bodies.deck.height=0.1:1:5"
    )
    sweep.add_argument("--seconds", type=seconds, default=SWEEP_SECONDS, help="simulated time of each run; default 10")
    sweep.add_argument("--processes", type=processes, metavar="N", help="at a time; default: one a processor")
    sweep.add_argument("--fresh", action="store_true", help="begin anew where a sweep was interrupted")
    sweep.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.csv", help="where the table goes")


def sweep(options: argparse.Namespace) -> int:
    """Run the grid and write its table."""
    from sandbox.session.sweep import Journal, SweepError, SweepGrid, case_level, swept

    if options.output.suffix.lower() != ".csv":
        raise Refused(f"{options.output}: a table is CSV; end the name in .csv")
    level = level_of(options.level)
    grid = SweepGrid(level, _columns(options), max(1, round(options.seconds * level.settings.tick_rate)))
    runs = math.prod(map(len, grid.columns.values()))
    if not grid.columns:
        raise Refused("nothing varies: give --cs, --cd, --solver, --substeps or --set")
    if runs > MOST_RUNS:
        raise Refused(f"{runs:,} runs: at most {MOST_RUNS:,} are possible; take coarser steps")
    try:
        for name, values in grid.columns.items():
            for value in values:
                case_level(level, [name], [value])
        journal = Journal(options.output, grid, options.fresh)
        if journal.rows:
            tell([f"{len(journal.rows)} of {runs} runs are known already; --fresh runs them again"])
        rows = swept(grid, list(journal.rows), min(options.processes or cores(), runs))
        with Progress(runs, "run") as bar, closing(rows):
            bar.update(len(journal.rows))
            for number, row in rows:
                journal.add(number, row)
                bar.update()
    except SweepError as error:
        raise Refused(str(error)) from None
    except KeyboardInterrupt:
        tell([f"{len(journal.rows)} of {runs} runs are done; the same command goes on from there"])
        return EXIT_INTERRUPTED
    journal.finish(options.output, grid)
    print(f"{options.output}: {runs} runs")
    return EXIT_OK


def _columns(options: argparse.Namespace) -> dict[str, tuple[float | int | str, ...]]:
    """The values of every column, Cs and Cd last. Raises Refused."""
    columns: dict[str, tuple[float | int | str, ...]] = {}
    if options.solver:
        from sandbox.physics.solvers import SOLVERS

        columns["settings.solver"] = tuple(SOLVERS) if options.solver == "all" else tuple(options.solver.split(","))
    if options.substeps:
        columns["settings.substeps"] = values_of("--substeps", options.substeps)
    for text in options.set:
        name, sign, values = text.partition("=")
        if not sign:
            raise Refused(f"--set: {text!r}: write FIELD=A:B:N, or FIELD=a,b,..")
        columns[name] = values_of("--set", values)
    for name in ("cs", "cd"):
        given = getattr(options, name)
        if given:
            values = values_of(f"--{name}", given)
            if not all(isinstance(value, float | int) and 0.0 <= value <= 1.0 for value in values):
                raise Refused(f"--{name}: {given!r}: Cs and Cd lie between 0 and 1")
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
