"""`sandbox check`."""

import argparse
import json
import sys
from contextlib import closing

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_FAILED, EXIT_OK, EXIT_REFUSED
from sandbox.terminal import Progress, cores, processes, tell

# A process that checks levels takes as long to start as a few levels take; fewer for each are not worth one.
LEVELS_PER_PROCESS = 4


def add(commands: Commands) -> None:
    """The command."""
    parser = add_command(commands, "check", check, "validate levels, report their stability, run the checks they carry")
    parser.add_argument("levels", nargs="+", metavar="LEVEL")
    parser.add_argument("--json", action="store_true", help="print one JSON object a level")
    parser.add_argument(
        "--processes", type=processes, metavar="N", help="check this many at a time; default: by cores and levels"
    )


def check(options: argparse.Namespace) -> int:
    """Check levels, one after another as they were named."""
    from sandbox.session.checking import check_levels

    worst = EXIT_OK
    names = options.levels
    at_once = min(options.processes or max(1, min(cores(), len(names) // LEVELS_PER_PROCESS)), len(names))
    with Progress(len(names), "level") as bar, closing(check_levels(names, at_once)) as reports:
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
