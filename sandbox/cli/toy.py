"""`sandbox toy`."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.base.command import LookOptions, Subcommand, option, optional_argument
from sandbox.cli.base.inputs import EXIT_OK, Refused, level_of
from sandbox.terminal import seconds, tell

if TYPE_CHECKING:
    from sandbox.level.document.model import Level


@dataclass(frozen=True, kw_only=True)
class ToyOptions(LookOptions):
    """Options of `toy`: the level, and the window's."""

    level: str | None = optional_argument(str, "LEVEL", "a level file or a shipped level's name")
    record: Path | None = option(Path, metavar="FILE", help="write a replay; .gz compresses")
    seconds: float | None = option(seconds, help="close it after this many seconds")


def play_toy(options: ToyOptions) -> int:
    """Play a level in a small window that stays on top. Raises Refused where there is no display."""
    from sandbox.app.base.display import has_display

    if not has_display():
        raise Refused("the desk toy needs a display; `sandbox run` plays a level without one")
    from sandbox.app.toy.toy_start import USUAL, run_toy

    def find() -> "Level":
        return level_of(options.level or USUAL)

    run_toy(find, lambda line: tell([line]), options.record, options.seconds, options.scale, options.theme)
    return EXIT_OK


COMMAND = Subcommand(
    "toy", "play a level in a small window that stays on top and feels how it is moved", ToyOptions, play_toy
)
