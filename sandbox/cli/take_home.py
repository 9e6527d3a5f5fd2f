"""`sandbox take-home`."""

import argparse

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_OK, Refused, level_of


def add(commands: Commands) -> None:
    """The command."""
    text = "print a body's springs as your own loop or another engine takes them"
    parser = add_command(commands, "take-home", take_home, text)
    parser.add_argument("level", metavar="LEVEL")
    parser.add_argument("--body", metavar="ID", help="which body; default: the first that has springs")
    parser.add_argument(
        "--to",
        default="all",
        metavar="NAME",
        help="article (the loop in every language), csharp, gdscript, cpp, javascript, python, box2d, unity, godot, "
        "rapier, pymunk, chipmunk; default: all numbers, no programs",
    )


def take_home(options: argparse.Namespace) -> int:
    """Print what a body takes home. Raises Refused."""
    from sandbox.export.chosen_body import NoSuchBody
    from sandbox.export.take_home_text import TARGETS, take_home_text
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
