"""Travel: where in its time a run is and can go: marks to jump to, a range that is played over and over."""

import bisect
import itertools
from dataclasses import dataclass

from sandbox.session.commands.records import script_of
from sandbox.session.event_log import listed, tick_events_of, user_actions
from sandbox.session.log import LogEntry
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session

# Shortest range that is played over and over [ticks].
SHORTEST_RANGE = 6


@dataclass(frozen=True)
class Mark:
    """A tick worth going to, and why in a word or two; kind: "command", "break", "goal", "bookmark" or "branch"."""

    tick: int
    kind: str
    label: str


class Travel:
    """The times of a run. bookmarks: ticks that the person marked. span: first and last tick of the range, or None;
    looping: whether it is played over and over. target: the tick that a replay is hurrying to, or None.
    """

    def __init__(self, session: Session, replay: Replay | None) -> None:
        self._session, self._replay = session, replay
        self.bookmarks: list[int] = []
        self.span: tuple[int, int] | None = None
        self.looping = False
        self.target: int | None = None
        # What the first commands of gestures did, by their orders.
        self._actions: dict[int, str] = {}

    def length(self, watching: bool) -> int:
        """The last tick that the time bar can reach; watching: whether the replay is followed to its end."""
        reached = self._session.last_tick
        return max(reached, self._replay.ticks) if watching and self._replay is not None else reached

    def stored_before(self, tick: int) -> int | None:
        """The tick of the replay's last stored state up to a tick, from which the way there is shorter than from what
        the run has kept; None where there is none, or where something is undone on the way to it.
        """
        if self._replay is None:
            return None
        reached = self._session.last_tick
        known = self._session.history.keyframes.before(min(tick, reached)).tick
        undoings = [line.tick for line in self._replay.script if line.record.get("type") in ("undo", "redo")]
        for stored in sorted((each for each in self._replay.states if known < each <= tick), reverse=True):
            first, last = min(stored, reached), max(stored, reached)
            if not any(first <= undoing <= last for undoing in undoings):
                return stored
        return None

    def marks(self) -> list[Mark]:
        """Marks of commands, breaks, goals, bookmarks and branches, in the order of their ticks."""
        session = self._session
        commands = [Mark(entry.tick, "command", self._action(entry)) for entry in session.gestures]
        breaks = []
        events = list(tick_events_of(session, session.last_tick))
        for tick, those in itertools.groupby((each for each in events if each.kind == "break"), lambda each: each.tick):
            broken = list(those)
            things = listed(each.names[0] for each in broken)
            text = broken[0].text if len(broken) == 1 else f"{len(broken)} springs of {things} broke"
            breaks.append(Mark(tick, "break", text))
        goals = [Mark(each.tick, "goal", each.text) for each in events if each.kind in ("win", "lose", "checkpoint")]
        bookmarks = [Mark(tick, "bookmark", "bookmark") for tick in self.bookmarks]
        branches = [Mark(branch.tick, "branch", "the run was changed there") for branch in session.branches]
        return sorted([*commands, *breaks, *goals, *bookmarks, *branches], key=lambda mark: mark.tick)

    def _action(self, entry: LogEntry) -> str:
        """The effect of a command, in words."""
        if entry.order not in self._actions:
            action = next(user_actions(script_of([entry], self._session.world)), None)
            self._actions[entry.order] = entry.command.type.replace("_", " ") if action is None else action.text
        return self._actions[entry.order]

    def mark_beside(self, tick: int, by: int) -> Mark | None:
        """The first mark after a tick (by 1), or the last before it (by -1)."""
        marks = self.marks()
        ticks = [mark.tick for mark in marks]
        place = bisect.bisect_right(ticks, tick) if by > 0 else bisect.bisect_left(ticks, tick) - 1
        return marks[place] if 0 <= place < len(marks) else None

    def toggle_bookmark(self, tick: int) -> bool:
        """Mark a tick, or no longer; whether it is marked now."""
        if tick in self.bookmarks:
            self.bookmarks.remove(tick)
        else:
            bisect.insort(self.bookmarks, tick)
        return tick in self.bookmarks

    def set_span(self, first: int, last: int) -> None:
        """Choose a range by its ends, in any order."""
        first, last = min(first, last), max(first, last)
        self.span = first, max(last, first + SHORTEST_RANGE)

    def turns_at(self, tick: int, backward: bool) -> int | None:
        """Where to go on from a tick that ends the range while it is looped; None: just on."""
        if not self.looping or self.span is None:
            return None
        first, last = self.span
        if backward:
            return last if tick <= first else None
        return first if tick >= last else None
