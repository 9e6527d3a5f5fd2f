"""`sandbox check`."""

import json
import sys
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.base.command import Subcommand, arguments, flag, option
from sandbox.cli.base.inputs import EXIT_FAILED, EXIT_OK, EXIT_REFUSED, Refused
from sandbox.processors import cores
from sandbox.terminal import Progress, count, processes, tell

if TYPE_CHECKING:
    from sandbox.session.checking import LevelReport

# A process that checks levels takes as long to start as a few levels take; fewer for each are not worth one.
LEVELS_PER_PROCESS = 4


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """Options of `check`: levels, and the form of the report."""

    levels: list[str] = arguments(str, "LEVEL")
    prove: bool = flag("only run the solution beside each level, and say whether it wins; also for folders")
    look: bool = flag("with --prove: where none wins, look for a way for 60 s, and keep it as the solution")
    json: bool = flag("print one JSON object a level")
    rollback: int | None = option(
        count, metavar="N", help="let random hands play 10 s, go back N ticks at each, by a snapshot, and compare"
    )
    processes: int | None = option(
        processes, metavar="N", help="check this many at a time; default: by cores and levels"
    )


def check(options: CheckOptions) -> int:
    """Check levels, one after another as they were named, or prove them. Raises Refused."""
    from sandbox.session.checking import check_levels

    if options.prove:
        return _prove(options)
    if options.look:
        raise Refused("--look belongs to --prove")
    worst, names = EXIT_OK, options.levels
    at_once = min(options.processes or max(1, min(cores(), len(names) // LEVELS_PER_PROCESS)), len(names))
    with Progress(len(names), "level") as bar, closing(check_levels(names, at_once, options.rollback)) as reports:
        for found in reports:
            worst = max(worst, _tell(found, options, bar))
    return worst


def _tell(found: "LevelReport", options: CheckOptions, bar: Progress) -> int:
    """Print a report; the exit code that it stands for."""
    with bar.aside():
        for line in [json.dumps(found.data)] if options.json else found.lines:
            print(line)
        sys.stdout.flush()
        if not options.json:
            tell(found.faults)
    bar.update()
    return EXIT_REFUSED if found.faults else EXIT_OK if found.passed else EXIT_FAILED


def _prove(options: CheckOptions) -> int:
    """Run the solutions of levels, and of those in folders."""
    from sandbox.session.checking import proved_level

    names, worst, won, asking = list[str](), EXIT_OK, 0, 0
    for name in options.levels:
        names += sorted(str(path) for path in Path(name).glob("*.json")) if Path(name).is_dir() else [name]
    with Progress(len(names), "level") as bar:
        for name in names:
            slices = proved_level(name, options.look)
            try:
                while True:
                    bar.note(f"{Path(name).stem} {100.0 * next(slices):.0f} %")
            except StopIteration as end:
                found = end.value
            except OSError as error:
                raise Refused(f"{name}: its solution cannot be kept: {error.strerror or error}") from None
            if found is not None:
                worst = max(worst, _tell(found, options, bar))
                won, asking = won + found.passed, asking + 1
    if not options.json:
        print(f"{won} of {asking} won by their solutions")
    return worst


COMMAND = Subcommand("check", "validate levels, report their stability, run the checks they carry", CheckOptions, check)
