"""What commands read: levels and recordings; and how they end."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.session.replay.recording import Replay

EXIT_OK, EXIT_FAILED, EXIT_REFUSED, EXIT_INTERRUPTED = 0, 1, 2, 130
# The reader of what is printed has gone, as `head` does: what shells give of a program that a closed pipe ends.
EXIT_UNREAD = 141


class Refused(Exception):
    """A request that cannot be carried out; faults: one line each."""

    def __init__(self, *faults: str) -> None:
        super().__init__(*faults)
        self.faults = faults


def level_of(name: str) -> "Level":
    """A level file, or a shipped level of that name. Raises Refused."""
    from sandbox.level.reading.files import LevelError, load_level

    try:
        return load_level(name)
    except LevelError as error:
        raise Refused(*error.faults) from None


def require_address(text: str) -> None:
    """Raises Refused where a text is no address of a site."""
    from sandbox.app.site.index_page import is_address

    if not is_address(text):
        raise Refused(f"--address: {text} is no address of a site, such as https://example.org/toys")


def is_scene(name: str) -> bool:
    """Whether a file's first bytes are a scene's."""
    from sandbox.session.scene import begins_as_scene

    try:
        return begins_as_scene(name)
    except (OSError, ValueError):
        return False


def recording_of(name: str, partial: bool = False, retold: bool = False) -> "Replay":
    """A recording, of a file or of a link; partial: also one that is cut off; retold: or of another physics version.

    Raises Refused.
    """
    from sandbox.session.replay.link import is_link, replay_of
    from sandbox.session.replay.reader import read_replay
    from sandbox.session.replay.recording import ReplayError

    try:
        return replay_of(name) if is_link(name) else read_replay(name, partial, retold)
    except ReplayError as error:
        raise Refused(*error.faults) from None


def is_replay(name: str) -> bool:
    """Whether a file's first bytes are a recording's, or a link's letters; anything else is taken for a level."""
    from sandbox.session.replay.link import is_link
    from sandbox.session.replay.reader import begins_as_replay

    try:
        return is_link(name) or begins_as_replay(name)
    except OSError:
        return False


def level_or_replay(name: str, retold: bool = False) -> "tuple[Level, Replay | None]":
    """What a file holds: a level, or a replay and the level that it is of; retold: as for that. Raises Refused."""
    import sys

    from sandbox.level.reading.pictures import lacking

    replay = recording_of(name, retold=retold) if is_replay(name) else None
    if replay and (line := lacking(replay.level)):
        print(line, file=sys.stderr)
    return (replay.level if replay else level_of(name)), replay
