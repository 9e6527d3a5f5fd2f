"""RunHistory: what was done in a run, what counts of it, and the states that are kept; it never steps a world."""

import bisect
from dataclasses import dataclass, field, fields, replace
from typing import Any

from sandbox.physics.snapshot import take
from sandbox.physics.world import World
from sandbox.session.commands import Command, Redo, Undo
from sandbox.session.commands.records import ScriptLine
from sandbox.session.events.moments import Moments, until
from sandbox.session.keyframes import Keyframe, Keyframes
from sandbox.session.log import Branch, LogEntry, Reached, ReachedStates

# Ends of the run that are kept when another one begins in the past, newest last.
BRANCH_LIMIT = 9


@dataclass
class RunHistory:
    """The history of one run. A copy has the same log entries, and is not changed with it.

    log: everything that was applied, Undo and Redo too. entries: those of each gesture. timeline: the commands that
    count, in order, without undone gestures, Undo and Redo. done: gestures that count, by the order of their first
    command. undone: gestures that do not; redoable: those of them that Redo makes again, last first. hindered:
    gestures of which a command has or had no effect. last_tick: the furthest tick reached. next_order: of the next
    entry. reached: states kept for undo and redo. moments: what happened in which tick. branches: how the run went on
    before it was changed in the past. scripted: the next line of the script.
    """

    keyframes: Keyframes
    last_tick: int = 0
    scripted: ScriptLine | None = None
    log: list[LogEntry] = field(default_factory=list)
    entries: dict[int, list[LogEntry]] = field(default_factory=dict)
    timeline: list[LogEntry] = field(default_factory=list)
    done: list[int] = field(default_factory=list)
    undone: set[int] = field(default_factory=set)
    redoable: list[int] = field(default_factory=list)
    hindered: set[int] = field(default_factory=set)
    last_gesture: int = 0
    next_order: int = 0
    reached: ReachedStates = field(default_factory=ReachedStates)
    moments: Moments = field(default_factory=dict)
    branches: list[Branch] = field(default_factory=list)

    def copy(self) -> "RunHistory":
        """The history as it is now."""
        return replace(self, **{each.name: _copied(getattr(self, each.name)) for each in fields(self)})

    # Gestures and commands.

    def new_gesture(self) -> int:
        """A gesture number that is higher than all before."""
        self.last_gesture += 1
        return self.last_gesture

    def begin(self, gesture: int) -> None:
        """Count a gesture that has no command yet; nothing can be redone after it."""
        if gesture not in self.entries:
            self.done.append(gesture)
            self.redoable.clear()

    def note(self, command: Command, gesture: int, world: World, implied: bool = False) -> None:
        """Enter a command that was applied to a world at its present tick, or that an Undo implies."""
        self.enter(LogEntry(self.next_order, world.tick, gesture, command, implied=implied))
        if not isinstance(command, (Undo, Redo)):
            self.keyframes.note_command(world, self.next_order)

    def enter(self, entry: LogEntry) -> None:
        """Enter a command."""
        self.next_order += 1
        self.log.append(entry)
        if not isinstance(entry.command, (Undo, Redo)):
            self.entries.setdefault(entry.gesture, []).append(entry)
            self.timeline.append(entry)

    def begun(self, tick: int) -> list[LogEntry]:
        """The last beginning of each thing that can go on, such as a hand that holds, until a tick."""
        begun = {
            key: entry
            for entry in self.timeline
            if entry.tick <= tick and entry.in_effect and (key := entry.command.begins()) is not None
        }
        return list(begun.values())

    def until(self, tick: int) -> list[LogEntry]:
        """The commands that lead from the level's start to a tick; in the past without undone ones."""
        if tick == self.last_tick:
            return [entry for entry in self.log if not entry.implied]
        return [entry for entry in self.timeline if entry.tick <= tick and entry.in_effect]

    # Undo and redo.

    def last_in_effect(self, tick: int) -> int | None:
        """The gesture whose first command with an effect is the last until a tick; None: there is none."""
        sound = (gesture for gesture in reversed(self.done) if gesture not in self.hindered)
        chosen = next((gesture for gesture in sound if self.entries[gesture][0].tick <= tick), None)
        found = [] if chosen is None else [(self._first_order(chosen), chosen)]
        for gesture in self.hindered - self.undone:
            orders = [each.order for each in self.entries[gesture] if each.in_effect and each.tick <= tick]
            found += [(orders[0], gesture)] if orders else []
        return max(found)[1] if found else None

    def take_back(self, gesture: int) -> int:
        """Count a gesture no longer; the order from which on the timeline is another."""
        first = self._first_order(gesture)
        del self.done[bisect.bisect_left(self.done, first, key=self._first_order)]
        self.undone.add(gesture)
        self.redoable.append(gesture)
        at = self.place(first)
        self.timeline[at:] = [entry for entry in self.timeline[at:] if entry.gesture != gesture]
        return first

    def make_again(self) -> tuple[LogEntry, bool]:
        """Count the gesture again that was undone last: its first entry, and whether it is the end of the timeline."""
        gesture = self.redoable.pop()
        self.undone.remove(gesture)
        bisect.insort(self.done, gesture, key=self._first_order)
        at = self.place(self._first_order(gesture))
        after = self.timeline[at:]
        self.timeline[at:] = sorted([*after, *self.entries[gesture]], key=_order)
        return self.entries[gesture][0], not after

    def _first_order(self, gesture: int) -> int:
        return self.entries[gesture][0].order

    # Kept states.

    def keep_reached(self, world: World) -> None:
        """Keep the present state at the end of the run: an undo of the next command, or a redo, leads through it."""
        if world.tick < self.last_tick:
            return
        idle = [entry for gesture in self.hindered for entry in self.entries[gesture] if not entry.in_effect]
        self.reached.keep(Reached(list(self.timeline), idle, dict(self.moments), take(world)))

    def drop_states_after(self, order: int, tick: int) -> None:
        """Drop the states that no longer hold, as the timeline is another from an order on.

        Where the run was in a state before that lies nearer to a tick than any other, that becomes a keyframe.
        """
        self.keyframes.drop_after(order)
        nearest = self.keyframes.before(tick)
        reached = self.reached.last_of(self.timeline, tick)
        if reached is not None and (reached.state.tick, len(reached.history)) > (
            nearest.tick,
            self.place(nearest.order),
        ):
            reached.tell_effects()
            self.moments = dict(reached.moments)
            self.keyframes.keep(Keyframe(self.order_at(len(reached.history)), reached.state, between=True))
        else:
            self.forget_moments(nearest.tick)

    def forget_moments(self, tick: int) -> None:
        """Forget what happened after a tick."""
        self.moments = until(self.moments, tick)

    # Places in the timeline.

    def place(self, order: int) -> int:
        """The index in the timeline of the first command of an order or a later one."""
        return bisect.bisect_left(self.timeline, order, key=_order)

    def first_of(self, tick: int) -> int:
        """The index in the timeline of the first command of a tick or a later one."""
        return bisect.bisect_left(self.timeline, tick, key=lambda entry: entry.tick)

    def order_at(self, place: int) -> int:
        """The order of the command at an index in the timeline, or of the next one to come."""
        return self.timeline[place].order if place < len(self.timeline) else self.next_order

    # Other futures.

    def drop_future(self, tick: int) -> None:
        """Make a tick the end of the history, after `seek` went back to it; keep what followed as a branch."""
        if tick == self.last_tick:
            return
        self._keep_branch(tick)
        self._go_by(self.until(tick), tick)
        self.keyframes.drop_beyond(tick)
        self.forget_moments(tick)

    def return_to(self, branch: Branch) -> int:
        """Take a branch as the future, and keep the present one as a branch; the tick at which the two part."""
        common = 0
        for ours, theirs in zip(self.timeline, branch.history, strict=False):
            if ours is not theirs:
                break
            common += 1
        following = [*self.timeline[common : common + 1], *branch.history[common : common + 1]]
        tick = min(self.last_tick, branch.last_tick, *(entry.tick for entry in following))
        self.branches.remove(branch)
        if self.last_tick > tick:
            self._keep_branch(tick)
        self._go_by(list(branch.history), branch.last_tick)
        self.keyframes.drop_after(min((entry.order for entry in following), default=self.next_order))
        self.keyframes.drop_beyond(tick)
        self.moments = dict(branch.moments)
        return tick

    def onward(self, first: Keyframe) -> "RunHistory":
        """A history of its own from a keyframe on, for another run of the same commands."""
        result = RunHistory(self.keyframes.onward(first), self.last_tick)
        result._take_over([replace(entry) for entry in self.timeline if entry.order >= first.order])
        result.next_order = self.next_order
        return result

    def _keep_branch(self, tick: int) -> None:
        """Keep how the run goes on after a tick."""
        history = tuple(entry for entry in self.timeline if entry.in_effect)
        self.branches.append(Branch(tick, history, self.last_tick, dict(self.moments)))
        del self.branches[:-BRANCH_LIMIT]

    def _go_by(self, history: list[LogEntry], last_tick: int) -> None:
        """Make these entries all that ever was, up to a tick; nothing is undone, and the script is over."""
        self._take_over(history)
        self.undone.clear()
        self.hindered.clear()
        self.redoable.clear()
        self.last_tick = last_tick
        self.scripted = None

    def _take_over(self, history: list[LogEntry]) -> None:
        """Make these entries all that ever was."""
        self.timeline, self.log, self.entries = history, list(history), {}
        for entry in history:
            entry.implied = False
            self.entries.setdefault(entry.gesture, []).append(entry)
        self.done = list(self.entries)


def _order(entry: LogEntry) -> int:
    return entry.order


def _copied(value: Any) -> Any:
    """A copy of a value that changes in place, such as the lists in a dictionary; other values as they are."""
    if isinstance(value, dict):
        return {key: _copied(each) for key, each in value.items()}
    return value.copy() if hasattr(value, "copy") else value
