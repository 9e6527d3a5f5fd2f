"""`sandbox resume`."""

import argparse

from sandbox.cli.command import Commands, add_command, add_length_options
from sandbox.cli.inputs import EXIT_OK, Refused, recording_of
from sandbox.terminal import Progress, interrupted_between_ticks


def add(commands: Commands) -> None:
    """The command."""
    parser = add_command(commands, "resume", resume_file, "go on with a recording that was cut off, and make it whole")
    parser.add_argument("file", metavar="FILE")
    add_length_options(parser, " in all; default: up to where it was cut off")


def resume_file(options: argparse.Namespace) -> int:
    """Make a recording whole. Raises Refused."""
    from sandbox.session.commands import CommandError
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.replay.resume import resume

    try:
        whole = recording_of(options.file)
    except Refused:
        replay = recording_of(options.file, partial=True)
    else:
        raise Refused(f"{options.file}: is whole, {whole.ticks} ticks: there is nothing to resume")
    rate = replay.level.settings.tick_rate
    ticks = options.ticks or (replay.ticks if options.seconds is None else round(options.seconds * rate))
    if ticks < replay.ticks:
        raise Refused(f"{options.file}: has {replay.ticks} ticks already; --seconds and --ticks are of the whole run")
    try:
        with interrupted_between_ticks() as look_up, Progress(ticks) as bar:

            def show(tick: int) -> None:
                bar.update(tick - bar.done)
                look_up()

            resume(replay, ticks, show)
    except (CommandError, ReplayError) as error:
        raise Refused(*error.faults) from None
    print(f"{options.file}: whole, {ticks} ticks, {ticks - replay.ticks} of them new")
    return EXIT_OK
