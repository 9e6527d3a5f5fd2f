"""`sandbox prepare`."""

import argparse

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_OK, Refused, level_of
from sandbox.terminal import Progress, count


def add(commands: Commands) -> None:
    """The command."""
    parser = add_command(commands, "prepare", prepare, "compile the physics, as the first start would")
    parser.add_argument("level", nargs="?", metavar="LEVEL", help="only what this level needs")
    parser.add_argument("--processes", type=count, metavar="N", help="at a time; default: one a processor, at most 4")


def prepare(options: argparse.Namespace) -> int:
    """Compile what is not compiled yet. Raises Refused."""
    level = level_of(options.level) if options.level else None
    from sandbox.app.kernels.compiling import GROUPS, compile_all, note_prepared, usual_processes

    groups = GROUPS if level is None or level.has_contacts else GROUPS[:1]
    solvers = None if level is None else (level.settings.solver,)
    with Progress(0, "kernel") as bar:
        succeeded = compile_all(options.processes or usual_processes(), groups, solvers, bar.show)
    if not succeeded:
        raise Refused("numba cannot compile everything here; `sandbox play` tries again and says why")
    if level is None:
        note_prepared()
    print("the physics is compiled" if level is None else f"all that {level.name} needs is compiled")
    return EXIT_OK
