"""A command: its name, its options and what it does; and options that several commands take."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Generic, TypeVar

from sandbox.terminal import count, scale, seconds

# The option group of two units for one length.
_LENGTH = "length"


T = TypeVar("T")


Options = TypeVar("Options")


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
        """Run the subcommand with its parsed options."""
        return self.action(read(parsed, self.options))


def _word(**settings: Any) -> Any:
    """A field that is told by its place, with what argparse is to know of it."""
    return field(metadata={"names": None, "group": None, "given": settings})


def _option(*names: str, group: str | None = None, **settings: Any) -> Any:
    """A field that is told by a name; group: options of one group exclude each other."""
    return field(metadata={"names": names, "group": group, "given": settings})


def argument(parse: Callable[[str], T], metavar: str, help: str | None = None) -> T:
    """A word that must be there; parse: what reads it, and raises argparse.ArgumentTypeError."""
    found: T = _word(type=parse, metavar=metavar, help=help)
    return found


def optional_argument(parse: Callable[[str], T], metavar: str, help: str | None = None) -> T | None:
    """A word that may be left out."""
    found: T | None = _word(type=parse, metavar=metavar, help=help, nargs="?")
    return found


def arguments(parse: Callable[[str], T], metavar: str, help: str | None = None, at_least: int = 1) -> list[T]:
    """Words; at_least: 0 or 1."""
    found: list[T] = _word(type=parse, metavar=metavar, help=help, nargs="+" if at_least else "*")
    return found


def option(
    parse: Callable[[str], T],
    *names: str,
    metavar: str | None = None,
    help: str | None = None,
    choices: Sequence[T] | None = None,
    group: str | None = None,
) -> T | None:
    """An option that may be left out; names: how it is written, where that is not what the field is called."""
    found: T | None = _option(*names, type=parse, metavar=metavar, help=help, choices=choices, group=group)
    return found


def option_or(
    default: T,
    parse: Callable[[str], T],
    metavar: str | None = None,
    help: str | None = None,
    choices: Sequence[T] | None = None,
) -> T:
    """An option with a default."""
    found: T = _option(type=parse, default=default, metavar=metavar, help=help, choices=choices)
    return found


def needed_option(parse: Callable[[str], T], *names: str, metavar: str | None = None, help: str | None = None) -> T:
    """A required option."""
    found: T = _option(*names, type=parse, required=True, metavar=metavar, help=help)
    return found


def repeated_option(parse: Callable[[str], T], metavar: str | None = None, help: str | None = None) -> list[T]:
    """An option that may be given several times."""
    found: list[T] = _option(type=parse, action="append", default=[], metavar=metavar, help=help)
    return found


def flag(help: str) -> bool:
    """An option without a value."""
    found: bool = _option(action="store_true", help=help)
    return found


def declare(parser: argparse.ArgumentParser, options: type[Any]) -> None:
    """Declare all fields of a class of options to a parser."""
    groups: dict[str | None, Any] = {None: parser}
    for each in fields(options):
        names, group, settings = (each.metadata[key] for key in ("names", "group", "given"))
        if group not in groups:
            groups[group] = parser.add_mutually_exclusive_group()
        if names is None:
            groups[group].add_argument(each.name, **settings)
        else:
            usual = () if any(name.startswith("--") for name in names) else (f"--{each.name.replace('_', '-')}",)
            groups[group].add_argument(*names, *usual, dest=each.name, **settings)


def read(parsed: argparse.Namespace, options: type[T]) -> T:
    """The options of a dataclass from what its parser has read."""
    return options(**{each.name: getattr(parsed, each.name) for each in fields(options)})  # type: ignore[arg-type]


@dataclass(frozen=True, kw_only=True)
class LookOptions:
    """How the widgets look."""

    scale: float | None = option(scale, help="size of the widgets, 0.5 to 4; default: as in the settings")
    theme: str | None = option(
        str, choices=("dark", "light", "system"), help="for this time; default: as in the settings"
    )


@dataclass(frozen=True, kw_only=True)
class WindowOptions(LookOptions):
    """Options of the app's window."""

    states: bool = flag("say in the window's title what happens, for programs that follow it")


def length_in_seconds(text: str) -> float | None:
    """The option for the length of a run in seconds; text: of what, and how long without it."""
    return option(seconds, help=f"simulated time{text}", group=_LENGTH)


def length_in_ticks() -> int | None:
    """The option for the length of a run in ticks: it excludes that in seconds."""
    return option(count, help="the same, in ticks", group=_LENGTH)
