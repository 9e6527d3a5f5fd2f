"""Log of a run: the commands with their ticks, some states with the history that led to them, and events of ticks.

Events of ticks are what the state after a tick does not tell: springs that broke, rules that fired, values taken back.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np

from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World
from sandbox.session.commands import Command

# States that are kept by their history: what an undo steps from and what a redo comes to, of some three gestures. Fewer
# make undoing to and fro step more ticks again, more take memory.
REACHED_KEPT = 6
# Ticks in which nothing but a rule fired are kept up to this many: one may fire in every other tick for hours.
MOST_FIRED = 10_000
# Of more springs that break in one tick the message says how many they are, not their names.
MOST_NAMED = 3


@dataclass(frozen=True)
class TickEvents:
    """Events of a tick that the state after it does not tell.

    broken: slots of springs; rules: of the level, by number; counters: their values, before what those rules do;
    frozen: names of what the quarantine froze.
    """

    broken: tuple[int, ...] = ()
    rules: tuple[int, ...] = ()
    counters: tuple[float, ...] = ()
    frozen: tuple[str, ...] = ()


# By the tick, in no order.
EventsByTick = dict[int, TickEvents]


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
    """A run as it went on from a tick (0..) before something else was done there; see Session.return_to.

    history: its commands from the beginning; last_tick: how far it went; tick_events: what happened in its ticks.
    """

    tick: int
    history: tuple[LogEntry, ...]
    last_tick: int
    tick_events: EventsByTick


@dataclass(frozen=True, eq=False)
class Reached:
    """A state that a run had when this was its whole history. ineffective: the entries of it that had no effect.

    tick_events: what happened until then.
    """

    history: list[LogEntry]
    ineffective: list[LogEntry]
    tick_events: EventsByTick
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
        for entry in self.ineffective:
            entry.in_effect = False


class ReachedStates:
    """The last states of a run: undo and redo lead back to them."""

    def __init__(self) -> None:
        self._kept: deque[Reached] = deque(maxlen=REACHED_KEPT)

    def copy(self) -> "ReachedStates":
        """A copy that keeps the same states."""
        result = ReachedStates()
        result._kept = self._kept.copy()
        return result

    def has(self, tick: int) -> bool:
        """Whether the last kept state is of a tick."""
        return bool(self._kept) and self._kept[-1].state.tick == tick

    def keep(self, reached: Reached) -> None:
        """Keep a state, in place of the oldest."""
        self._kept.append(reached)

    def last_of(self, history: list[LogEntry], tick: int) -> Reached | None:
        """The last kept state that a run of this history had on its way to a tick."""
        found = [each for each in self._kept if each.leads_to(history, tick)]
        return max(found, key=lambda each: (each.state.tick, len(each.history)), default=None)


def note_tick_events(tick_events: EventsByTick, world: World) -> None:
    """Take in the last tick of a world, in place of what was known of it; most ticks have nothing."""
    tick_events.pop(world.tick, None)
    fired = world.rule_last == world.tick if len(world.rule_last) else None
    rules = () if fired is None or not fired.any() else tuple(np.flatnonzero(fired).tolist())
    if not (len(world.broken) or rules or world.contained):
        return
    frozen = tuple(dict.fromkeys(hit.name for hit in world.contained if hit.frozen))
    found = TickEvents(tuple(world.broken.tolist()), rules, tuple(world.counter.tolist()) if rules else (), frozen)
    if found.broken or found.frozen or (rules and len(tick_events) < MOST_FIRED):
        tick_events[world.tick] = found


def until(tick_events: EventsByTick, tick: int) -> EventsByTick:
    """The events up to a tick."""
    return {each: found for each, found in tick_events.items() if each <= tick}


def break_lines(world: World) -> list[str]:
    """One line about the springs that broke in the last tick, or none."""
    broken = world.broken.tolist()
    if not broken:
        return []
    if len(broken) > MOST_NAMED:
        return [f"tick {world.tick}: {len(broken)} springs broke"]
    names = [world.spring_names[slot] for slot in broken]
    listed = names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
    return [f"tick {world.tick}: {listed} broke"]
