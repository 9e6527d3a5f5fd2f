"""`sandbox take-home`."""

from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand, argument, option, option_or
from sandbox.cli.base.inputs import EXIT_OK, Refused, level_of


@dataclass(frozen=True, kw_only=True)
class TakeHomeOptions:
    """Options of `take-home`: the body, and the engine."""

    level: str = argument(str, "LEVEL")
    body: str | None = option(str, metavar="ID", help="which body; default: the first that has springs")
    to: str = option_or(
        "all",
        str,
        metavar="NAME",
        help="article (the loop in every language), csharp, gdscript, cpp, javascript, python, box2d, unity, godot, "
        "rapier, pymunk, chipmunk; default: all numbers, no programs",
    )


def take_home(options: TakeHomeOptions) -> int:
    """Print a body's numbers for another engine. Raises Refused."""
    from sandbox.export.engines import NoSuchBody
    from sandbox.export.take_home import TARGETS, take_home_text
    from sandbox.level.format.level_error import shown, suggestion

    if options.to not in TARGETS:
        hint = suggestion(options.to, TARGETS) or f"; there are {', '.join(TARGETS)}"
        raise Refused(f"--to {options.to}: there is nothing called {shown(options.to)}{hint}")
    level = level_of(options.level)
    try:
        print(take_home_text(level, options.body, options.to), end="")
    except NoSuchBody as error:
        raise Refused(f"{options.level}: {error}") from None
    return EXIT_OK


COMMAND = Subcommand(
    "take-home", "print a body's springs as your own loop or another engine takes them", TakeHomeOptions, take_home
)
