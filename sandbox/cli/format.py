"""`sandbox format`."""

import sys
from dataclasses import dataclass
from pathlib import Path

from sandbox.cli.base.command import Subcommand, argument
from sandbox.cli.base.inputs import EXIT_OK, Refused


@dataclass(frozen=True, kw_only=True)
class FormatOptions:
    """Options of `format`: the file."""

    file: Path = argument(Path, "FILE")


def rewrite(options: FormatOptions) -> int:
    """Write a level file again. Raises Refused."""
    from sandbox.level.reading.files import LevelError, read_level, write_level

    try:
        warning = write_level(read_level(options.file), options.file)
    except LevelError as error:
        raise Refused(*error.faults) from None
    if warning:
        print(warning, file=sys.stderr)
    return EXIT_OK


COMMAND = Subcommand("format", "rewrite a level file in its canonical form", FormatOptions, rewrite)
