"""`sandbox page`."""

import argparse
from pathlib import Path

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_OK, Refused, level_or_replay
from sandbox.cli.pages import PAGE


def add(commands: Commands) -> None:
    """The command."""
    does = "write a page that plays a level, or a recording that can be taken over, in any browser"
    parser = add_command(commands, "page", page, does)
    parser.add_argument("level", metavar="LEVEL|REPLAY")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.html")


def page(options: argparse.Namespace) -> int:
    """Write the page, and tell how large it is. Raises Refused."""
    from sandbox.app.share.playing import page_of
    from sandbox.level.format.writing import write_file
    from sandbox.session.commands import CommandError

    if options.output.suffix.lower() != PAGE:
        raise Refused(f"{options.output}: end the name in {PAGE}")
    level, replay = level_or_replay(options.level)
    try:
        text = page_of(level, replay.script if replay else (), replay.ticks if replay else None)
    except CommandError as error:
        raise Refused(*(f"{options.level}: {fault}" for fault in error.faults)) from None
    write_file(options.output, text.encode())
    print(f"{options.output}: {len(text.encode()) / 1000:.0f} kB")
    return EXIT_OK
