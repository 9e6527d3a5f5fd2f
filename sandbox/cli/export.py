"""`sandbox export`."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_OK, Refused, level_of

if TYPE_CHECKING:
    from sandbox.level.document.model import Level

FORMS = ("flat", "svg", "pymunk")


def add(commands: Commands) -> None:
    """The command."""
    parser = add_command(commands, "export", export, "write a level as data, a picture or a program for other engines")
    parser.add_argument("level", nargs="?", metavar="LEVEL")
    text = "flat: particles and springs as JSON; svg: a picture; pymunk: a Python program that runs it; default flat"
    parser.add_argument("--to", choices=FORMS, default="flat", help=text)
    parser.add_argument("--schema", action="store_true", help="print the JSON Schema of flat levels instead")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT", help="where to; default: it is printed")


def export(options: argparse.Namespace) -> int:
    """Write what was asked for, or print it. Raises Refused."""
    from sandbox.export.flat_model import flat_schema

    if options.schema == (options.level is not None):
        raise Refused("name a level, or say --schema: one of the two")
    text = json.dumps(flat_schema(), indent=2) + "\n" if options.schema else _text(level_of(options.level), options.to)
    if options.output is None:
        print(text, end="")
    else:
        options.output.write_text(text, encoding="utf-8", newline="\n")
        print(f"{options.output}: {len(text.encode()) / 1000:.1f} kB")
    return EXIT_OK


def _text(level: "Level", form: str) -> str:
    from sandbox.export.flat import flat, flat_text
    from sandbox.export.pymunk_program import pymunk_program
    from sandbox.export.svg import svg

    made = flat(level)
    if form == "svg":
        return svg(made)
    return flat_text(made) if form == "flat" else pymunk_program(made)
