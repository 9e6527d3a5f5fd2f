"""Options of a command as one typed object: each field says how it is written in the shell, and what it is then.

    @dataclass(frozen=True, kw_only=True)
    class ShakeOptions:
        level: str = argument(str, "LEVEL")
        seconds: float | None = option(seconds, help="for how long")
        quiet: bool = flag("print nothing")

The type of a field follows from the function that reads its text, so mypy finds a field that says otherwise, and an
attribute that no field declares. `parser.parse_args` gives a bare Namespace: it is read here alone.
"""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import field, fields
from typing import Any, TypeVar

T = TypeVar("T")


def _word(**given: Any) -> Any:
    """A field that is told by its place, with what argparse is to know of it."""
    return field(metadata={"names": None, "group": None, "given": given})


def _option(*names: str, group: str | None = None, **given: Any) -> Any:
    """A field that is told by a name; group: options of one group exclude each other."""
    return field(metadata={"names": names, "group": group, "given": given})


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
    """An option that has a value where it is left out."""
    found: T = _option(type=parse, default=default, metavar=metavar, help=help, choices=choices)
    return found


def needed_option(parse: Callable[[str], T], *names: str, metavar: str | None = None, help: str | None = None) -> T:
    """An option that must be there."""
    found: T = _option(*names, type=parse, required=True, metavar=metavar, help=help)
    return found


def repeated_option(parse: Callable[[str], T], metavar: str | None = None, help: str | None = None) -> list[T]:
    """An option that may be there several times."""
    found: list[T] = _option(type=parse, action="append", default=[], metavar=metavar, help=help)
    return found


def flag(help: str) -> bool:
    """An option without a value."""
    found: bool = _option(action="store_true", help=help)
    return found


def declare(parser: argparse.ArgumentParser, options: type[Any]) -> None:
    """Tell a parser of all fields of a class of options."""
    groups: dict[str | None, Any] = {None: parser}
    for each in fields(options):
        names, group, given = (each.metadata[key] for key in ("names", "group", "given"))
        if group not in groups:
            groups[group] = parser.add_mutually_exclusive_group()
        if names is None:
            groups[group].add_argument(each.name, **given)
        else:
            usual = () if any(name.startswith("--") for name in names) else (f"--{each.name.replace('_', '-')}",)
            groups[group].add_argument(*names, *usual, dest=each.name, **given)


def read(parsed: argparse.Namespace, options: type[T]) -> T:
    """What a parser that was told of these options has found."""
    return options(**{each.name: getattr(parsed, each.name) for each in fields(options)})  # type: ignore[arg-type]
