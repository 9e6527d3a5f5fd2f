"""`sandbox show`."""

from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand, argument
from sandbox.cli.base.inputs import EXIT_OK, recording_of


@dataclass(frozen=True, kw_only=True)
class ShowOptions:
    """Options of `show`: the recording."""

    file: str = argument(str, "FILE", "a recording, also one of another physics version, or one that is cut off")


def show(options: ShowOptions) -> int:
    """Print a recording as text. Raises Refused."""
    from sandbox.session.replay.recording import recording_text

    print(recording_text(recording_of(options.file, partial=True, retold=True)), end="")
    return EXIT_OK


COMMAND = Subcommand("show", "print a recording as text: its level and commands, for reviews", ShowOptions, show)
