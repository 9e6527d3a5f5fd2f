"""StartRequest: what the program was started for."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.session.replay.recording import Replay


@dataclass(frozen=True)
class StartRequest:
    """What the app is to show first: a level (source: its file), a replay, or a file to edit, "" = an empty sheet."""

    level: "Level | None" = None
    replay: "Replay | None" = None
    source: Path | None = None
    edit: str | None = None
