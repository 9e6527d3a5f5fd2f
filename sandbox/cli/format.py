"""`sandbox format`."""

import argparse
import sys
from pathlib import Path

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_OK, Refused


def add(commands: Commands) -> None:
    """The command."""
    parser = add_command(commands, "format", rewrite, "rewrite a level file in its canonical form")
    parser.add_argument("file", type=Path, metavar="FILE")


def rewrite(options: argparse.Namespace) -> int:
    """Write a level file again. Raises Refused."""
    from sandbox.level.reading.files import LevelError, read_level, write_level

    try:
        warning = write_level(read_level(options.file), options.file)
    except LevelError as error:
        raise Refused(*error.faults) from None
    if warning:
        print(warning, file=sys.stderr)
    return EXIT_OK
