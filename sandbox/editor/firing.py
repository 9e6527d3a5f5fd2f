"""Firing: when the rules of a level would have fired in a run that was played, stepped again with the same commands."""

from collections import deque
from collections.abc import Iterator

import numpy as np

from sandbox.editor.forecast import LARGEST
from sandbox.editor.slices import work_for
from sandbox.level.document.model import Level
from sandbox.session.commands import Command
from sandbox.session.session import Session

# No more of a run is stepped again [s].
LONGEST = 60.0

# What was done in a run: the tick, the gesture and the command of each, in order.
Deeds = list[tuple[int, int, Command]]


def deeds_of(run: Session) -> tuple[Deeds, int]:
    """What was done in a run and counts, and its last tick."""
    entries = [entry for entry in run.history.timeline if entry.in_effect and not entry.implied]
    return [(entry.tick, entry.gesture, entry.command) for entry in entries], run.last_tick


class Firing:
    """A run in work, a slice at a time; times: when each rule fired [s], by its id; fault: why it went no further."""

    def __init__(self, level: Level, deeds: Deeds, last_tick: int) -> None:
        self.level = level
        self.times: dict[str, list[float]] = {rule.id: [] for rule in level.rules}
        self.is_done = False
        self.fault = ""
        self._work = self._run(deque(deeds), last_tick)

    def advance(self, seconds: float) -> bool:
        """Work for about that long, at least one tick; whether it is done."""
        self.is_done = work_for(self._work, seconds)
        return self.is_done

    def _run(self, deeds: deque[tuple[int, int, Command]], last_tick: int) -> Iterator[None]:
        session = Session(self.level)
        rate, world = session.world.settings.tick_rate, session.world
        if len(world.position) > LARGEST:
            self.fault = "the level is too large to step the run again"
            return
        for _ in range(min(last_tick, round(LONGEST * rate))):
            while deeds and deeds[0][0] <= session.tick:
                _, gesture, command = deeds.popleft()
                session.submit(command, gesture)
            session.advance()
            for rule in np.flatnonzero(session.world.rule_last == session.tick).tolist():
                self.times[self.level.rules[rule].id].append(session.tick / rate)
            yield None
