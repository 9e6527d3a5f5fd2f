"""`sandbox edit`."""

from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand, WindowOptions, optional_argument
from sandbox.cli.base.inputs import Refused


@dataclass(frozen=True, kw_only=True)
class EditOptions(WindowOptions):
    """Options of `edit`: the level, and the window's."""

    level: str | None = optional_argument(str, "LEVEL")


def edit(options: EditOptions) -> int:
    """Open the editor. Raises Refused where there is no display."""
    from sandbox.app.base.display import has_display

    if not has_display():
        raise Refused("the editor needs a display; without one, edit the level's JSON and try `sandbox check`")
    from sandbox.app.base.display import StartRequest
    from sandbox.app.window.opening import open_app

    def find() -> StartRequest:
        return StartRequest(edit=options.level or "")

    return open_app(find, scale=options.scale, theme=options.theme, says_states=options.states)


COMMAND = Subcommand("edit", "open the level editor: a level, or an empty sheet", EditOptions, edit)
