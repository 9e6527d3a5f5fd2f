"""`sandbox toy`."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.command import Commands, add_command, add_look_options
from sandbox.cli.inputs import EXIT_OK, Refused, level_of
from sandbox.terminal import seconds, tell

if TYPE_CHECKING:
    from sandbox.level.document.model import Level


def add(commands: Commands) -> None:
    """The command."""
    text = "play a level in a small window that stays on top and feels how it is moved"
    parser = add_command(commands, "toy", play_toy, text)
    parser.add_argument("level", nargs="?", metavar="LEVEL", help="a level file or a shipped level's name")
    parser.add_argument("--record", type=Path, metavar="FILE", help="write a replay; .gz compresses")
    parser.add_argument("--seconds", type=seconds, help="close it after this many seconds")
    add_look_options(parser)


def play_toy(options: argparse.Namespace) -> int:
    """Play a level in a small window that stays on top. Raises Refused where there is no display."""
    from sandbox.app.base.display import has_display

    if not has_display():
        raise Refused("the desk toy needs a display; `sandbox run` plays a level without one")
    from sandbox.app.toy.toy_start import USUAL, run_toy

    def find() -> "Level":
        return level_of(options.level or USUAL)

    run_toy(find, lambda line: tell([line]), options.record, options.seconds, options.scale, options.theme)
    return EXIT_OK
