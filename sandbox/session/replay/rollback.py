"""Rollback: at every tick a run goes back some ticks, by a snapshot, and comes to the same bits once more.

A state that no snapshot holds shows here: what it does is not undone with the rest.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sandbox.level.document.model import Level
from sandbox.physics.snapshot import Snapshot, canonical_bytes
from sandbox.physics.state import BY_STORED
from sandbox.session.commands import CommandError, Redo, Undo
from sandbox.session.random_hands import RandomHands
from sandbox.session.replay.divergence import Divergence, first_difference
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session

# How long random hands play a level [s].
HANDS_SECONDS = 10.0


@dataclass(frozen=True)
class RolledBack:
    """What came of it. back, ticks: how far it went back, and how often; commands: how many were carried out.

    found: the first difference, None: there is none.
    """

    back: int
    ticks: int
    commands: int
    found: Divergence | None

    def __str__(self) -> str:
        if self.found is not None:
            return f"DIVERGES at {self.found}"
        return f"equal again from {self.back} ticks before each of {self.ticks:,}, with {self.commands} commands"


class Rollback:
    """Goes back by so many ticks at every tick of a session, and compares."""

    def __init__(self, session: Session, back: int) -> None:
        self._session = session
        # A state for each of the last ticks, the present one last.
        self._states: deque[Snapshot] = deque([session.snapshot()], maxlen=back + 1)
        self._seen = len(session.history.log)

    def look(self) -> Divergence | None:
        """After a tick: go back as far as states are kept, come here again, and compare.

        An undo or redo has made another past: states before it are forgotten.
        """
        session = self._session
        log = session.history.log[self._seen :]
        self._seen = len(session.history.log)
        present = session.snapshot()
        if any(isinstance(entry.command, (Undo, Redo)) for entry in log):
            self._states.clear()
            self._states.append(present)
            return None
        self._states.append(present)
        first = self._states[0]
        session.step_again(first)
        return self._differing(present, first.tick)

    def _differing(self, wanted: Snapshot, start: int) -> Divergence | None:
        world = self._session.world
        for stored, column in BY_STORED.items():
            expected, found = getattr(wanted, column.name), getattr(world, column.name)
            if expected.tobytes() == found.tobytes() or canonical_bytes(expected) == canonical_bytes(found):
                continue
            told = first_difference(world.tick, stored, expected, world)
            return replace(told, note=f"stepped again from tick {start}")
        if wanted.settings != world.settings:
            return Divergence(
                world.tick, "settings", None, str(wanted.settings), str(world.settings), note=f"again from tick {start}"
            )
        return None


def roll_back(
    replay: Replay, back: int, level: Level | None = None, progress: Callable[[int, int], None] | None = None
) -> RolledBack:
    """Run a recording's commands, on its level or on another, and go back at every tick. Raises ReplayError."""
    if back > replay.ticks:
        raise ReplayError(f"{replay.source}: a run of {replay.ticks} ticks does not go back {back} ticks")
    session = Session(level or replay.level, script=replay.script)
    try:
        return _rolled_back(session, replay.ticks, back, None, progress)
    except CommandError as error:
        raise ReplayError(*(f"{replay.source}: {fault}" for fault in error.faults)) from None


def roll_back_level(
    level: Level, back: int, seed: int = 0, progress: Callable[[int, int], None] | None = None
) -> RolledBack:
    """Let random hands play a level for 10 s, and go back at every tick."""
    session = Session(level)
    hands = RandomHands(session, seed)
    return _rolled_back(session, round(HANDS_SECONDS * level.settings.tick_rate), back, hands, progress)


def _rolled_back(
    session: Session,
    ticks: int,
    back: int,
    hands: RandomHands | None,
    progress: Callable[[int, int], None] | None,
) -> RolledBack:
    rollback = Rollback(session, back)
    found = None
    with np.errstate(over="ignore", invalid="ignore"):
        while session.tick < ticks and found is None:
            if hands is not None:
                hands.act()
            session.advance()
            found = rollback.look()
            if progress is not None:
                progress(session.tick, ticks)
    return RolledBack(back, session.tick, len(session.history.log), found)
