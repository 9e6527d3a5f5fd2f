"""RunHistory: what was done in a run, what counts of it, and the states that are kept; it never steps a world."""

import bisect
from collections import deque
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, field, fields, replace
from typing import Any

from sandbox.physics.snapshot import Snapshot, take
from sandbox.physics.world import World
from sandbox.session.commands import Command, Redo, Undo
from sandbox.session.commands.records import ScriptLine
from sandbox.session.log import Branch, EventsByTick, LogEntry, Reached, ReachedStates, until

KEYFRAME_TICKS = 60
# Commands of one tick after which its state is kept as well, until the next keyframe, so that undoing the last of
# thousands does not carry out all the others again: this many, and this many more for each particle, as keeping takes
# longer then. Lower keeps more, higher undoes slower.
KEYFRAME_COMMANDS, COMMANDS_PER_PARTICLE = 4, 0.004
# Memory for keyframes [bytes]; beyond it every other one goes, and going back re-steps twice as far.
KEYFRAME_BUDGET = 128 * 2**20
# Ends of the run that are kept when another one begins in the past, newest last.
BRANCH_LIMIT = 9


@dataclass(frozen=True)
class Keyframe:
    """The state of a tick once all commands of an order below this one are applied; between: of some of that tick."""

    order: int
    snapshot: Snapshot
    between: bool = False

    @property
    def tick(self) -> int:
        """Ticks since the level's start."""
        return self.snapshot.tick


class Keyframes:
    """The states that are kept, in order, at least the first one; what did not change between two is kept once."""

    def __init__(self, first: Keyframe) -> None:
        self._kept = [first]
        self._size = _own_size(first, None)
        # Ticks between two keyframes, twice as many each time that the budget is used up.
        self._spacing = KEYFRAME_TICKS
        # Ticks on the way to the last one sought: going back tick by tick steps a span again once only.
        self._passed: deque[Keyframe] = deque(maxlen=KEYFRAME_TICKS)
        self._unkept = 0

    def __len__(self) -> int:
        return len(self._kept)

    def __iter__(self) -> Iterator[Keyframe]:
        return iter(self._kept)

    @property
    def first(self) -> Keyframe:
        """The state in which the run began."""
        return self._kept[0]

    def copy(self) -> "Keyframes":
        """A copy that keeps the same states."""
        result = copy(self)
        result._kept, result._passed = self._kept.copy(), self._passed.copy()
        return result

    def before(self, tick: int) -> Keyframe:
        """The last keyframe at or before a tick."""
        found = self._kept[bisect.bisect_right(self._kept, tick, key=_tick) - 1]
        return max((each for each in self._passed if found.tick < each.tick <= tick), key=_tick, default=found)

    def note_tick(self, world: World, order: int) -> None:
        """Keep a tick that was reached where it is time to; order: of the next command to come."""
        self._unkept = 0
        if world.tick % self._spacing == 0 and self._kept[-1].tick < world.tick:
            if any(kept.between for kept in self._kept):
                self._set([kept for kept in self._kept if not kept.between])
            self.keep(Keyframe(order, take(world)))
        elif world.tick % self._spacing == 0 and self._lacks(world.tick):
            self.insert(Keyframe(order, take(world)))

    def _lacks(self, tick: int) -> bool:
        """Whether a tick lies in a gap that was passed over, not between two that are as near as usual."""
        place = bisect.bisect_right(self._kept, tick, key=_tick)
        return self._kept[place - 1].tick < tick and self._kept[place].tick - self._kept[place - 1].tick > self._spacing

    def insert(self, keyframe: Keyframe) -> None:
        """Keep a state of a tick between others."""
        place = bisect.bisect_right(self._kept, keyframe.tick, key=_tick)
        self._set([*self._kept[:place], _sharing(keyframe, self._kept[place - 1]), *self._kept[place:]])

    def keep(self, keyframe: Keyframe) -> None:
        """Keep a state behind all others."""
        self._unkept = 0
        keyframe = _sharing(keyframe, self._kept[-1])
        self._size += _own_size(keyframe, self._kept[-1])
        self._kept.append(keyframe)
        while self._size > KEYFRAME_BUDGET and len(self._kept) > 2:
            self._thin()

    def note_passed(self, world: World, order: int, target: int) -> None:
        """Keep a tick shortly before the one sought for a while, as the next one sought may be among these."""
        if target - world.tick < KEYFRAME_TICKS:
            before = self._passed[-1] if self._passed else self._kept[-1]
            self._passed.append(_sharing(Keyframe(order, take(world)), before))

    def note_command(self, world: World, order: int) -> None:
        """Keep the state after a command where enough of this tick have been applied; order: of the next to come."""
        self._unkept += 1
        enough = KEYFRAME_COMMANDS + COMMANDS_PER_PARTICLE * world.particle_count
        # In the past that was sought, later ones are kept already.
        if self._unkept >= enough and self._kept[-1].order < order:
            self.keep(Keyframe(order, take(world), between=True))

    def note_return(self) -> None:
        """Note that the world has gone back to a kept state."""
        self._unkept = 0

    def drop_after(self, order: int) -> None:
        """Forget the states after a command of this order or a later one."""
        self._drop([kept for kept in self._kept if kept.order <= order])

    def drop_beyond(self, tick: int) -> None:
        """Forget the keyframes of later ticks."""
        self._drop([kept for kept in self._kept if kept.tick <= tick])

    def onward(self, first: Keyframe) -> "Keyframes":
        """The keyframes from one of them on."""
        result = Keyframes(first)
        result._spacing = self._spacing
        result._set([first, *(kept for kept in self._kept if kept.order >= first.order and kept.tick > first.tick)])
        return result

    def _drop(self, kept: list[Keyframe]) -> None:
        self._passed.clear()
        if len(kept) < len(self._kept):
            self._set(kept)

    def _thin(self) -> None:
        """Drop every other keyframe; of those between the commands of one tick first."""
        first = next((place for place, kept in enumerate(self._kept) if kept.between), 1)
        if not self._kept[first].between:
            self._spacing *= 2
        self._set(self._kept[:first] + self._kept[first + 1 :: 2])

    def _set(self, kept: list[Keyframe]) -> None:
        self._kept = kept
        self._size = sum(_own_size(each, kept[place - 1] if place else None) for place, each in enumerate(kept))


def _sharing(keyframe: Keyframe, before: Keyframe) -> Keyframe:
    """A keyframe that has the arrays of the one before where they are equal."""
    present, earlier = keyframe.snapshot.arrays, before.snapshot.arrays
    arrays = {
        name: earlier[name] if array is earlier[name] or array.tobytes() == earlier[name].tobytes() else array
        for name, array in present.items()
    }
    return replace(keyframe, snapshot=replace(keyframe.snapshot, arrays=arrays))


def _own_size(keyframe: Keyframe, before: Keyframe | None) -> int:
    """What a keyframe needs [bytes] beside the one before it."""
    earlier = {} if before is None else before.snapshot.arrays
    return sum(array.nbytes for name, array in keyframe.snapshot.arrays.items() if earlier.get(name) is not array)


def _tick(keyframe: Keyframe) -> int:
    return keyframe.tick


@dataclass
class RunHistory:
    """The history of one run. A copy has the same log entries, and is not changed with it.

    log: everything that was applied, Undo and Redo too. entries: those of each gesture. timeline: the commands that
    count, in order, without undone gestures, Undo and Redo. done: gestures that count, by the order of their first
    command. undone: gestures that do not; redoable: those of them that Redo makes again, last first. hindered:
    gestures of which a command has or had no effect. last_tick: the furthest tick reached. next_order: of the next
    entry. reached: states kept for undo and redo. tick_events: what happened in which tick. branches: how the run went
    on before it was changed in the past. scripted: the next line of the script.
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
    tick_events: EventsByTick = field(default_factory=dict)
    branches: list[Branch] = field(default_factory=list)

    def copy(self) -> "RunHistory":
        """A copy of the history."""
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
        """Of each thing that goes on, such as a hand that holds, its last beginning until a tick."""
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
        ineffective = [entry for gesture in self.hindered for entry in self.entries[gesture] if not entry.in_effect]
        self.reached.keep(Reached(list(self.timeline), ineffective, dict(self.tick_events), take(world)))

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
            self.tick_events = dict(reached.tick_events)
            self.keyframes.keep(Keyframe(self.order_at(len(reached.history)), reached.state, between=True))
        else:
            self.forget_tick_events(nearest.tick)

    def forget_tick_events(self, tick: int) -> None:
        """Forget the events after a tick."""
        self.tick_events = until(self.tick_events, tick)

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
        self.forget_tick_events(tick)

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
        self.tick_events = dict(branch.tick_events)
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
        self.branches.append(Branch(tick, history, self.last_tick, dict(self.tick_events)))
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
        """Replace the whole history by these entries."""
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
