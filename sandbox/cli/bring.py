"""`sandbox bring`."""

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

from sandbox.cli.base.command import Subcommand, argument, needed_option, option
from sandbox.cli.base.inputs import EXIT_OK, Refused

# What --as and --width may be; the width in metres.
KINDS = ("jelly", "ground")
NARROWEST, WIDEST = 0.1, 10_000.0


def _width(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not NARROWEST <= value <= WIDEST:
        raise argparse.ArgumentTypeError(f"{text!r} is no width of {NARROWEST:g} to {WIDEST:,.0f} m")
    return value


@dataclass(frozen=True, kw_only=True)
class BringOptions:
    """Options of `bring`: the file, how to read it, and where the level goes."""

    file: Path = argument(Path, "FILE", "an SVG, a PNG with transparency, a Tiled map or a R.U.B.E. scene as JSON")
    output: Path = needed_option(Path, "-o", metavar="LEVEL.json")
    kind: str | None = option(
        str,
        "--as",
        choices=KINDS,
        help="what outlines become; default: of a drawing or picture jellies, of a map ground, of a scene what moves "
        "jellies and the rest ground",
    )
    width: float | None = option(
        _width,
        metavar="METRES",
        help="width of all of it; default: 10 m, of a map 1 m a tile, of a scene its own metres",
    )


def bring_in(options: BringOptions) -> int:
    """Make a level of a file of another program. Raises Refused."""
    import sys

    from sandbox.bring.bring import bring
    from sandbox.bring.making import with_floor
    from sandbox.level.reading.files import LevelError, write_level

    if options.output.exists() and options.output.resolve() == options.file.resolve():
        raise Refused(f"{options.output}: is the file that is brought in; name another")
    try:
        brought = bring(options.file, options.kind, options.width)  # type: ignore[arg-type]
        warning = write_level(with_floor(brought.level), options.output)
    except LevelError as error:
        raise Refused(*error.faults) from None
    if warning:
        print(warning, file=sys.stderr)
    print(f"{options.output}: {brought.said()}")
    return EXIT_OK


COMMAND = Subcommand("bring", "make a level of a drawing, a picture or a map", BringOptions, bring_in)
