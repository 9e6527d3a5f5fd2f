"""Log of a run: the commands with their ticks, and some states with the history that led to them."""

from collections import deque
from dataclasses import dataclass

from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command
from sandbox.session.events.moments import Moments

# States that are kept by their history: what an undo steps from and what a redo comes to, of some three gestures. Fewer
# make undoing to and fro step more ticks again, more take memory.
REACHED_KEPT = 6


@dataclass
class LogEntry:
    """A command that was applied at a tick, before that tick's step.

    order: its place among all entries ever. in_effect: False while the command cannot be carried out, since a command
    that it needs is undone. implied: the end of a drag or drive that an Undo brings about by itself, so that a
    recording of that Undo does not hold it.
    """

    order: int
    tick: int
    gesture: int
    command: Command
    in_effect: bool = True
    implied: bool = False


@dataclass(frozen=True, eq=False)
class Branch:
    """How a run went on from a tick (0..) before something else was done there; see Session.return_to.

    history: its commands from the beginning; last_tick: how far it went; moments: what happened in its ticks.
    """

    tick: int
    history: tuple[LogEntry, ...]
    last_tick: int
    moments: Moments


@dataclass(frozen=True, eq=False)
class Reached:
    """A state that a run had when this was its whole history. idle: the entries of it that had no effect.

    moments: what happened until then.
    """

    history: list[LogEntry]
    idle: list[LogEntry]
    moments: Moments
    state: Snapshot

    def leads_to(self, history: list[LogEntry], tick: int) -> bool:
        """Whether a run of this history, at a tick, was in this state on its way."""
        count, here = len(self.history), self.state.tick
        if here > tick or history[:count] != self.history:
            return False
        return count == len(history) or history[count].tick >= here

    def tell_effects(self) -> None:
        """Set of each command of the history whether it had an effect."""
        for entry in self.history:
            entry.in_effect = True
        for entry in self.idle:
            entry.in_effect = False


class ReachedStates:
    """The last such states of a run: undo and redo lead back to them."""

    def __init__(self) -> None:
        self._kept: deque[Reached] = deque(maxlen=REACHED_KEPT)

    def copy(self) -> "ReachedStates":
        """The same ones."""
        result = ReachedStates()
        result._kept = self._kept.copy()
        return result

    def has(self, tick: int) -> bool:
        """Whether the last one is of a tick."""
        return bool(self._kept) and self._kept[-1].state.tick == tick

    def keep(self, reached: Reached) -> None:
        """Keep one, in place of the oldest."""
        self._kept.append(reached)

    def last_of(self, history: list[LogEntry], tick: int) -> Reached | None:
        """The last one that a run of this history was in on its way to a tick."""
        found = [each for each in self._kept if each.leads_to(history, tick)]
        return max(found, key=lambda each: (each.state.tick, len(each.history)), default=None)
