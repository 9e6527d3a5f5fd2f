"""`sandbox edit`."""

import argparse

from sandbox.cli.command import Commands, add_command, add_window_options
from sandbox.cli.inputs import Refused


def add(commands: Commands) -> None:
    """The command."""
    parser = add_command(commands, "edit", edit, "open the level editor: a level, or an empty sheet")
    parser.add_argument("level", nargs="?", metavar="LEVEL")
    add_window_options(parser)


def edit(options: argparse.Namespace) -> int:
    """Open the editor. Raises Refused where there is no display."""
    from sandbox.app.base.display import has_display

    if not has_display():
        raise Refused("the editor needs a display; without one, edit the level's JSON and try `sandbox check`")
    from sandbox.app.base.start_request import StartRequest
    from sandbox.app.window.opening import open_app

    def find() -> StartRequest:
        return StartRequest(edit=options.level or "")

    return open_app(find, scale=options.scale, theme=options.theme, says_states=options.states)
