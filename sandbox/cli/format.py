"""`sandbox format`."""

import sys
from dataclasses import dataclass
from pathlib import Path

from sandbox.cli.base.command import Subcommand, arguments
from sandbox.cli.base.inputs import EXIT_OK, Refused


@dataclass(frozen=True, kw_only=True)
class FormatOptions:
    """Options of `format`: the files."""

    files: list[Path] = arguments(Path, "FILE")


def rewrite(options: FormatOptions) -> int:
    """Write level files again, those that can be read. Raises Refused."""
    from sandbox.level.reading.files import LevelError, read_level, write_level

    faults: list[str] = []
    for file in options.files:
        try:
            warning = write_level(read_level(file), file)
        except LevelError as error:
            faults += error.faults
        else:
            if warning:
                print(warning, file=sys.stderr)
    if faults:
        raise Refused(*faults)
    return EXIT_OK


COMMAND = Subcommand("format", "rewrite level files in their canonical form", FormatOptions, rewrite)
