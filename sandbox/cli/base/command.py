"""A command: its name, its options and what it does; and options that several commands take."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from sandbox.cli.base.options import declare, flag, option, read
from sandbox.terminal import count, scale, seconds

Options = TypeVar("Options")
# The option group of two units for one length.
_LENGTH = "length"


@dataclass(frozen=True)
class Subcommand(Generic[Options]):
    """A command of the shell; text: what it does; action: gives an exit code, and may raise Refused."""

    name: str
    text: str
    options: type[Options]
    action: Callable[[Options], int]

    def add_to(self, commands: Any) -> None:
        """Add its parser to what `add_subparsers` gave, whose type has no public name."""
        text = self.text
        parser = commands.add_parser(self.name, help=text, description=text[0].upper() + text[1:] + ".")
        parser.set_defaults(command=self)
        declare(parser, self.options)

    def run(self, parsed: argparse.Namespace) -> int:
        """Carry it out, as its own parser has read it."""
        return self.action(read(parsed, self.options))


@dataclass(frozen=True, kw_only=True)
class LookOptions:
    """How the widgets look."""

    scale: float | None = option(scale, help="size of the widgets, 0.5 to 4; default: as in the settings")
    theme: str | None = option(
        str, choices=("dark", "light", "system"), help="for this time; default: as in the settings"
    )


@dataclass(frozen=True, kw_only=True)
class WindowOptions(LookOptions):
    """What the app's own window takes."""

    states: bool = flag("say in the window's title what happens, for programs that follow it")


def length_in_seconds(text: str) -> float | None:
    """How long a run is; text: of what, and how long without it."""
    return option(seconds, help=f"simulated time{text}", group=_LENGTH)


def length_in_ticks() -> int | None:
    """The same in another unit: one of the two may be given."""
    return option(count, help="the same, in ticks", group=_LENGTH)
