"""A command: its parser below that of the program, and what several of them take."""

import argparse
from collections.abc import Callable
from typing import Any

from sandbox.terminal import count, scale, seconds

# What argparse gives for `add_subparsers`; its type has no public name.
Commands = Any


def add_command(
    commands: Commands, name: str, action: Callable[[argparse.Namespace], int], text: str
) -> argparse.ArgumentParser:
    """The parser of a command, whose action returns an exit code; text: what it does."""
    parser: argparse.ArgumentParser = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
    parser.set_defaults(action=action)
    return parser


def add_look_options(app: argparse.ArgumentParser) -> None:
    """How the widgets look."""
    app.add_argument("--scale", type=scale, help="size of the widgets, 0.5 to 4; default: as in the settings")
    app.add_argument("--theme", choices=("dark", "light", "system"), help="for this time; default: as in the settings")


def add_window_options(app: argparse.ArgumentParser) -> None:
    """What the app's own window takes."""
    add_look_options(app)
    text = "say in the window's title what happens, for programs that follow it"
    app.add_argument("--states", action="store_true", help=text)


def add_length_options(run: argparse.ArgumentParser, text: str) -> None:
    """How long a run is, in one of two units; text: of what, and how long without them."""
    length = run.add_mutually_exclusive_group()
    length.add_argument("--seconds", type=seconds, help=f"simulated time{text}")
    length.add_argument("--ticks", type=count, help="the same, in ticks")
