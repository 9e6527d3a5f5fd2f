"""`sandbox check`."""

import json
import sys
from contextlib import closing
from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand, arguments, flag, option
from sandbox.cli.base.inputs import EXIT_FAILED, EXIT_OK, EXIT_REFUSED
from sandbox.processors import cores
from sandbox.terminal import Progress, count, processes, tell

# A process that checks levels takes as long to start as a few levels take; fewer for each are not worth one.
LEVELS_PER_PROCESS = 4


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """Options of `check`: levels, and the form of the report."""

    levels: list[str] = arguments(str, "LEVEL")
    json: bool = flag("print one JSON object a level")
    rollback: int | None = option(
        count, metavar="N", help="let random hands play 10 s, go back N ticks at each, by a snapshot, and compare"
    )
    processes: int | None = option(
        processes, metavar="N", help="check this many at a time; default: by cores and levels"
    )


def check(options: CheckOptions) -> int:
    """Check levels, one after another as they were named."""
    from sandbox.session.checking import check_levels

    worst = EXIT_OK
    names = options.levels
    at_once = min(options.processes or max(1, min(cores(), len(names) // LEVELS_PER_PROCESS)), len(names))
    with Progress(len(names), "level") as bar, closing(check_levels(names, at_once, options.rollback)) as reports:
        for found in reports:
            with bar.aside():
                for line in [json.dumps(found.data)] if options.json else found.lines:
                    print(line)
                sys.stdout.flush()
                if not options.json:
                    tell(found.faults)
            worst = max(worst, EXIT_REFUSED if found.faults else EXIT_OK if found.passed else EXIT_FAILED)
            bar.update()
    return worst


COMMAND = Subcommand("check", "validate levels, report their stability, run the checks they carry", CheckOptions, check)
