"""`sandbox export`."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.base.command import Subcommand, flag, option, option_or, optional_argument
from sandbox.cli.base.inputs import EXIT_OK, Refused, level_of, recording_of

if TYPE_CHECKING:
    from sandbox.level.document.model import Level

COMMANDS = "commands"
FORMS = ("flat", "svg", "pymunk", COMMANDS)


@dataclass(frozen=True, kw_only=True)
class ExportOptions:
    """Options of `export`: the level, the form, and where it goes."""

    level: str | None = optional_argument(str, "LEVEL", "a level; with --to commands a recording")
    to: str = option_or(
        "flat",
        str,
        choices=FORMS,
        help="flat: particles and springs as JSON; svg: a picture; pymunk: a Python program that runs it; "
        "commands: those of a recording, as run --commands takes them; default flat",
    )
    schema: bool = flag("print the JSON Schema of flat levels instead")
    output: Path | None = option(Path, "-o", metavar="OUT", help="where to; default: it is printed")


def export(options: ExportOptions) -> int:
    """Write what was asked for, or print it. Raises Refused."""
    from sandbox.export.flat import flat_schema

    if options.schema == (options.level is not None):
        raise Refused("name a level, or say --schema: one of the two")
    if options.level is None:
        text = json.dumps(flat_schema(), indent=2) + "\n"
    else:
        text = _commands(options.level) if options.to == COMMANDS else _text(level_of(options.level), options.to)
    if options.output is None:
        print(text, end="")
    else:
        options.output.write_text(text, encoding="utf-8", newline="\n")
        print(f"{options.output}: {len(text.encode()) / 1000:.1f} kB")
    return EXIT_OK


def _commands(name: str) -> str:
    """The commands of a recording, also of another physics version. Raises Refused."""
    from sandbox.session.replay.recording import commands_text

    return commands_text(recording_of(name, retold=True))


def _text(level: "Level", form: str) -> str:
    from sandbox.export.flat import flat, flat_text, pymunk_program
    from sandbox.export.svg import svg

    made = flat(level)
    if form == "svg":
        return svg(made)
    return flat_text(made) if form == "flat" else pymunk_program(made)


COMMAND = Subcommand("export", "write a level as data, a picture or a program for other engines", ExportOptions, export)
