"""Session: one run of a level: ticks, commands, the log, undo, time travel. No wall clock."""

import bisect
import itertools
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.physics.snapshot import Snapshot, restore, take
from sandbox.physics.step import step
from sandbox.session.breaks import break_lines
from sandbox.session.commands import Command, CommandError, Redo, Undo, apply
from sandbox.session.commands.adding import name_added
from sandbox.session.commands.records import ScriptLine, from_record, to_record
from sandbox.session.keyframes import Keyframe, Keyframes
from sandbox.session.log import Branch, LogEntry, Reached, ReachedStates
from sandbox.session.replay.format import STATE_TICKS
from sandbox.session.replay.writer import Recorder
from sandbox.session.whole import Interrupted, whole

# Ends of the run that are kept when another one begins in the past, newest last.
BRANCH_LIMIT = 9
# Ticks between two calls of `progress` while re-stepping: few, as a tick of a full world takes a tenth of a second.
PROGRESS_TICKS = 4
# What undoing and the like change of a session.
HISTORY = (
    "_log", "_entries", "_timeline", "_done", "_undone", "_redoable", "_last_gesture", "_last_tick", "_next_order",
    "_hindered", "_keyframes", "_reached", "_breaks", "_branches", "_scripted",
)  # fmt: skip


class Session:
    """A level being run.

    Commands are applied at tick boundaries: `submit` queues, `advance` applies what is due and steps once. Every
    command belongs to a gesture (a drag from grab to release, one slider drag), the unit of undo. A script feeds
    recorded commands at their ticks; a scripted command that cannot be applied raises CommandError, a submitted one
    leaves a line in `messages`. `start` continues from a snapshot of this level's world instead of its beginning.
    progress: called with ticks done and ticks in all while ticks are stepped again. Where it raises Interrupted, what
    they were stepped for passes that on and changes nothing; a script ends that asked for it.
    """

    def __init__(self, level: Level, script: Iterable[ScriptLine] = (), start: Snapshot | None = None) -> None:
        self.level = level
        self.world = build_world(level)
        if start is not None:
            restore(self.world, start)
            name_added(self.world)
        self.messages: list[str] = []
        self.progress: Callable[[int, int], None] | None = None
        self._script = iter(script)
        self._scripted = next((line for line in self._script if line.tick >= self.tick), None)
        self._pending: deque[tuple[Command, int]] = deque()
        # All that was applied, Undo and Redo too; the entries of each gesture; and history as it now stands, in order:
        # without undone gestures, and without Undo and Redo.
        self._log: list[LogEntry] = []
        self._entries: dict[int, list[LogEntry]] = {}
        self._timeline: list[LogEntry] = []
        # Gestures that count, by the order of their first command.
        self._done: list[int] = []
        self._undone: set[int] = set()
        self._redoable: list[int] = []
        self._last_gesture = 0
        self._last_tick = self.tick
        self._next_order = 0
        # Gestures of which a command has or had no effect.
        self._hindered: set[int] = set()
        self._keyframes = Keyframes(Keyframe(0, take(self.world)))
        self._reached = ReachedStates()
        self._breaks: set[int] = set()
        self._branches: list[Branch] = []
        self._recorder: Recorder | None = None

    @property
    def tick(self) -> int:
        """Ticks since the level's start."""
        return self.world.tick

    @property
    def last_tick(self) -> int:
        """The furthest tick reached; `seek` goes up to here."""
        return self._last_tick

    @property
    def can_undo(self) -> bool:
        """Whether there is a gesture to take back."""
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        """Whether there is an undone gesture to make again, here at the end of the run."""
        return bool(self._redoable) and self.tick == self._last_tick

    @property
    def scripted(self) -> bool:
        """Whether a script still has commands to give."""
        return self._scripted is not None

    @property
    def recording(self) -> Path | None:
        """The file that this run is being recorded to."""
        return None if self._recorder is None else self._recorder.path

    def snapshot(self) -> Snapshot:
        """A read-only copy of the present state."""
        return take(self.world)

    def new_gesture(self) -> int:
        """A gesture number of one's own, higher than all before."""
        self._last_gesture += 1
        return self._last_gesture

    def submit(self, command: Command, gesture: int | None = None) -> None:
        """Queue a command for this tick boundary; without a gesture number it is a gesture of its own."""
        self._pending.append((command, self.new_gesture() if gesture is None else gesture))

    def undo(self) -> None:
        """Queue the undoing of the last gesture."""
        self.submit(Undo())

    def redo(self) -> None:
        """Queue the redoing of the gesture undone last."""
        self.submit(Redo())

    def apply_pending(self) -> bool:
        """Apply what is due at this tick boundary without stepping: the script's commands, then those submitted.

        Whether anything was due.
        """
        due = bool(self._pending)
        while self._scripted is not None and self._scripted.tick == self.tick == self._last_tick:
            due = True
            line, self._scripted = self._scripted, next(self._script, None)
            try:
                self._apply(from_record(line.record, self.world), line.gesture)
            except Interrupted:
                self._scripted = None
                raise
            except CommandError as error:
                raise CommandError("\n".join(f"line {line.line}: {fault}" for fault in error.faults)) from None
        while self._pending:
            command, gesture = self._pending.popleft()
            try:
                self._apply(command, gesture)
            except CommandError as error:
                self.messages.extend(error.faults)
            else:
                self._scripted = None
        return due

    def advance(self) -> None:
        """One tick: apply what is due, then step. In the past that `seek` reached, the logged commands follow again."""
        self.apply_pending()
        if self.tick < self._last_tick:
            self._follow(self._first_of(self.tick + 1), self.tick + 1)
            return
        self._step(self._next_order)
        self._last_tick = self.tick
        self.messages.extend(str(hit) for hit in self.world.contained)
        self.messages.extend(break_lines(self.world))
        if self._recorder is not None:
            self._record(self._recorder.write_tick, self.world)

    def seek(self, tick: int) -> None:
        """Go to a tick that was reached before, 0..last_tick; a command submitted there starts a new future from it.

        Raises ValueError out of that range, or while recording.
        """
        if not self._keyframes.first.tick <= tick <= self._last_tick:
            raise ValueError(f"tick {tick} is outside {self._keyframes.first.tick}..{self._last_tick}")
        if self._recorder is not None:
            raise ValueError("stop the recording before going back in time")
        with self._whole(()):
            self._rewind(tick, sought=True)

    def kept_before(self, tick: int) -> int:
        """The last tick up to a tick whose state is kept: from there `seek` steps again."""
        return self._keyframes.before(tick).tick

    def adopt(self, state: Snapshot) -> None:
        """Be at a state that a recording of this very run holds, and keep it: what lies between is not stepped.

        Ahead of the last tick, the script's commands until there count as carried out. Of what lies between the state
        and the last tick, nothing may be undone, or be an undoing. Raises CommandError, with nothing changed, where a
        command names what is not there.
        """
        before = take(self.world)
        self._put_back(state)
        if self.tick > self._last_tick:
            try:
                self._pass_script()
            except CommandError:
                self._put_back(before)
                raise
        self._keyframes.insert(Keyframe(self._order_at(self._first_of(self.tick)), take(self.world)))

    def _pass_script(self) -> None:
        """Enter the script's commands before this tick into history, which a state already holds."""
        lines = []
        while self._scripted is not None and self._scripted.tick < self.tick:
            lines.append(self._scripted)
            self._scripted = next(self._script, None)
        try:
            commands = [from_record(line.record, self.world) for line in lines]
        except CommandError:
            self._script = itertools.chain([*lines, *filter(None, [self._scripted])], self._script)
            self._scripted = next(self._script, None)
            raise
        for line, command in zip(lines, commands, strict=True):
            if line.gesture in self._undone:
                continue
            if line.gesture not in self._entries:
                self._done.append(line.gesture)
                self._redoable.clear()
            self._last_gesture = max(self._last_gesture, line.gesture)
            self._enter(LogEntry(self._next_order, line.tick, line.gesture, command))
        self._last_tick = self.tick

    def retold(self, tick: int) -> "Session":
        """A run of its own with the same history, at the last keyframe at or before a tick; `advance` follows it from
        there to the last tick. Neither run changes the other.
        """
        first = self._keyframes.before(tick)
        twin = Session(self.level, start=first.snapshot)
        twin._keyframes = self._keyframes.onward(first)
        twin._take_over([replace(entry) for entry in self._timeline if entry.order >= first.order])
        twin._next_order, twin._last_tick = self._next_order, self._last_tick
        twin._follow(0, first.tick)
        return twin

    def keyframes(self, first: int, last: int) -> list[Snapshot]:
        """The states of ticks first..last that are kept, a few each second or less."""
        return [kept.snapshot for kept in self._keyframes if first <= kept.tick <= last]

    @property
    def breaks(self) -> tuple[int, ...]:
        """The ticks in which springs broke, in order."""
        return tuple(sorted(self._breaks))

    @property
    def gestures(self) -> tuple[LogEntry, ...]:
        """The first command of each gesture that counts, in order."""
        return tuple(self._entries[gesture][0] for gesture in self._done)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """How the run went on before it was changed in the past; see `return_to`."""
        return tuple(self._branches)

    def going(self) -> list[Command]:
        """The commands that end what is going on now, as a hand that holds or a part that is driven."""
        endings = (entry.command.ending(self.world) for entry in self._begun())
        return [ending for ending in endings if ending is not None]

    def _begun(self) -> list[LogEntry]:
        """What began last of each thing that can go on, until now."""
        begun = {
            key: entry
            for entry in self._timeline
            if entry.tick <= self.tick and entry.in_effect and (key := entry.command.begins()) is not None
        }
        return list(begun.values())

    def record_to(self, path: Path, state_ticks: int = STATE_TICKS) -> None:
        """Record this run to a file, from the level's start: what was played until now is played again into it.

        state_ticks: from one stored state to the next; from each the recording can be verified, and each takes room.
        Overwrites the file. Raises OSError where it cannot be written, ValueError for a run that began in the middle.
        """
        self.stop_recording()
        twin = self._recorded(path, state_ticks)
        self._drop_future()
        self._recorder = twin._recorder

    def save_to(self, path: Path) -> Path | None:
        """Write the run up to the present tick as a recording of its own; this run stays as it is, what follows too.

        Its file, or None where its end cannot be written. Overwrites the file. Raises as `record_to` does.
        """
        twin = self._recorded(path, STATE_TICKS)
        saved = twin.stop_recording()
        self.messages.extend(twin.messages)
        return saved

    def _recorded(self, path: Path, state_ticks: int) -> "Session":
        """A run of its own that did all that was done until now, with the recording that it is still making of that."""
        if self._keyframes.first.tick > 0:
            raise ValueError("only a run from the level's start can be recorded")
        twin = Session(self.level)
        twin._recorder = Recorder(path, self.level, twin.world, state_ticks)
        if self.progress is not None:
            tell = self.progress
            twin.progress = lambda *_: tell(twin.last_tick, self.tick)
        try:
            for entry in self._until_now():
                self._catch_up(twin, entry.tick)
                twin._apply(entry.command, entry.gesture)
            self._catch_up(twin, self.tick)
        except BaseException as error:
            twin.abandon_recording()
            if isinstance(error, Interrupted):
                with suppress(OSError):
                    path.unlink()
            raise
        self.messages.extend(twin.messages)
        twin.messages.clear()
        return twin

    def _until_now(self) -> list[LogEntry]:
        """The commands that lead from the level's start to the present tick; in the past without what is undone."""
        if self.tick == self._last_tick:
            return [entry for entry in self._log if not entry.implied]
        return [entry for entry in self._timeline if entry.tick <= self.tick and entry.in_effect]

    def _catch_up(self, twin: "Session", tick: int) -> None:
        while twin.tick < tick:
            twin.advance()
            self._report_progress(twin.tick, self.tick)

    def stop_recording(self) -> Path | None:
        """Write the recording's last line and return its path; None where there is none or it cannot be written."""
        recorder, self._recorder = self._recorder, None
        if recorder is None:
            return None
        try:
            recorder.finish(self.world)
        except OSError as error:
            self.messages.append(f"{recorder.path}: the end of the recording could not be written: {error.strerror}")
            return None
        return recorder.path

    def abandon_recording(self) -> None:
        """Close the recording without its last line, as a crash would leave it."""
        recorder, self._recorder = self._recorder, None
        if recorder is not None:
            recorder.abandon()

    def _record(self, write: Callable[..., None], *what: Any) -> None:
        try:
            write(*what)
        except OSError as error:
            self.messages.append(f"{self.recording}: recording stopped at tick {self.tick}: {error.strerror}")
            self.abandon_recording()

    def _apply(self, command: Command, gesture: int) -> None:
        """Apply a command now, log it and record it. Raises CommandError and changes nothing where it cannot be."""
        if gesture in self._undone:
            return
        tick = self.tick
        if isinstance(command, Undo):
            with self._whole():
                self._undo()
        elif isinstance(command, Redo):
            with self._whole():
                self._redo()
        else:
            if gesture not in self._entries and not self._reached.has(tick):
                self._keep_reached()
            apply(self.world, command)
            self._drop_future()
            if gesture not in self._entries:
                self._done.append(gesture)
                self._redoable.clear()
        self._last_gesture = max(self._last_gesture, gesture)
        self._note(command, gesture)
        if self._recorder is not None:
            self._record(self._recorder.write_command, tick, gesture, to_record(command, self.world))

    def _note(self, command: Command, gesture: int, implied: bool = False) -> None:
        """Enter a command that was applied, or is implied by what is, into the log."""
        self._enter(LogEntry(self._next_order, self.tick, gesture, command, implied=implied))
        if not isinstance(command, (Undo, Redo)):
            self._keyframes.note_command(self.world, self._next_order)

    def _enter(self, entry: LogEntry) -> None:
        self._next_order += 1
        self._log.append(entry)
        if not isinstance(entry.command, (Undo, Redo)):
            self._entries.setdefault(entry.gesture, []).append(entry)
            self._timeline.append(entry)

    def _whole(self, names: tuple[str, ...] = HISTORY) -> AbstractContextManager[None]:
        """Do something to these attributes whole, or where `progress` gives it up not at all."""
        if self.progress is None:
            # Nothing gives it up; a copy of a long history takes milliseconds.
            return nullcontext()
        return whole(self, names, partial(self._put_back, take(self.world)), self._log if names else ())

    def _put_back(self, state: Snapshot) -> None:
        restore(self.world, state)
        name_added(self.world)

    # Undo and time travel: restore the nearest earlier keyframe and step again with the commands that still count.

    def _undo(self) -> None:
        if self._keyframes.first.tick > 0:
            raise CommandError(f"undo reaches back before tick {self._keyframes.first.tick}, where this run began")
        gesture = self._last_in_effect()
        if gesture is None:
            raise CommandError("nothing to undo")
        self._drop_future()
        self._keep_reached()
        self._let_go(gesture)
        first = self._first_order(gesture)
        del self._done[bisect.bisect_left(self._done, first, key=self._first_order)]
        self._undone.add(gesture)
        self._redoable.append(gesture)
        at = bisect.bisect_left(self._timeline, first, key=_order)
        self._timeline[at:] = [entry for entry in self._timeline[at:] if entry.gesture != gesture]
        self._step_again_from(first)

    def _last_in_effect(self) -> int | None:
        """The gesture whose first command that has an effect is the last of all until now."""
        sound = (gesture for gesture in reversed(self._done) if gesture not in self._hindered)
        chosen = next((gesture for gesture in sound if self._entries[gesture][0].tick <= self.tick), None)
        found = [] if chosen is None else [(self._first_order(chosen), chosen)]
        for gesture in self._hindered - self._undone:
            orders = [each.order for each in self._entries[gesture] if each.in_effect and each.tick <= self.tick]
            found += [(orders[0], gesture)] if orders else []
        return max(found)[1] if found else None

    def _first_order(self, gesture: int) -> int:
        return self._entries[gesture][0].order

    def _redo(self) -> None:
        if not self._redoable:
            raise CommandError("nothing to redo")
        if self.tick < self._last_tick:
            raise CommandError(f"redo works at the end of the run: go to tick {self._last_tick} first")
        self._keep_reached()
        gesture = self._redoable.pop()
        self._undone.remove(gesture)
        entries, first = self._entries[gesture], self._first_order(gesture)
        bisect.insort(self._done, gesture, key=self._first_order)
        at = bisect.bisect_left(self._timeline, first, key=_order)
        after = self._timeline[at:]
        self._timeline[at:] = sorted([*after, *entries], key=_order)
        if not after and entries[0].tick == self.tick:
            # All else is as it was when it was made first; states that were kept since are without it.
            self._keyframes.drop_after(first)
            self._follow(at, self.tick)
        else:
            self._step_again_from(first)

    def _let_go(self, gesture: int) -> None:
        """End what a gesture began and is still going on, so that doing it again cannot leave it going for ever."""
        if all(entry.command.begins() is None for entry in self._entries[gesture]):
            return
        for entry in self._begun():
            ending = entry.command.ending(self.world)
            if entry.gesture == gesture and ending is not None:
                self._note(ending, gesture, implied=True)

    def _keep_reached(self) -> None:
        """Keep the present state: undoing what comes, or redoing what goes, leads through it."""
        if self.tick < self._last_tick:
            return
        idle = [entry for gesture in self._hindered for entry in self._entries[gesture] if not entry.in_effect]
        self._reached.keep(Reached(list(self._timeline), idle, frozenset(self._breaks), take(self.world)))

    def _step_again_from(self, order: int) -> None:
        """Come to the present tick once more, by history as it now stands, which is another from an order on."""
        tick = self.tick
        self._keyframes.drop_after(order)
        nearest = self._keyframes.before(tick)
        reached = self._reached.last_of(self._timeline, tick)
        if reached is not None and (reached.state.tick, len(reached.history)) > (nearest.tick, self._place(nearest)):
            reached.tell_effects()
            self._breaks = set(reached.breaks)
            self._keyframes.keep(Keyframe(self._order_at(len(reached.history)), reached.state, between=True))
        else:
            self._forget_breaks(nearest.tick)
        self._rewind(tick)

    def _place(self, keyframe: Keyframe) -> int:
        """Where in history that begins which a keyframe does not hold."""
        return bisect.bisect_left(self._timeline, keyframe.order, key=_order)

    def _rewind(self, tick: int, sought: bool = False) -> None:
        """Restore the last keyframe at or before a tick and follow history; sought: others near may be next."""
        keyframe = self._keyframes.before(tick)
        self._put_back(keyframe.snapshot)
        self._keyframes.note_return()
        self._follow(self._place(keyframe), tick, sought)

    def _first_of(self, tick: int) -> int:
        """Where in history the commands of a tick begin."""
        return bisect.bisect_left(self._timeline, tick, key=lambda entry: entry.tick)

    def _follow(self, place: int, tick: int, sought: bool = True) -> None:
        """Go on to a tick, carrying out history from a place in it on; sought: ticks on the way are kept a while."""
        start, history = self.tick, self._timeline
        while True:
            while place < len(history) and history[place].tick == self.tick:
                # What needed an undone gesture has no effect any more.
                try:
                    apply(self.world, history[place].command)
                    history[place].in_effect = True
                except CommandError:
                    history[place].in_effect = False
                    self._hindered.add(history[place].gesture)
                place += 1
                self._keyframes.note_command(self.world, self._order_at(place))
            if self.tick >= tick:
                return
            self._step(self._order_at(place))
            if sought:
                self._keyframes.note_passed(self.world, self._order_at(place), tick)
            self._report_progress(self.tick - start, tick - start)

    def _order_at(self, place: int) -> int:
        """The order of the command at a place in history, or of the next one to come."""
        return self._timeline[place].order if place < len(self._timeline) else self._next_order

    def _drop_future(self) -> None:
        """Make the present tick the end of history, after `seek` went back; what followed is kept as a branch."""
        if self.tick == self._last_tick:
            return
        self._keep_branch(self.tick)
        self._go_by(self._until_now(), self.tick)
        self._keyframes.drop_beyond(self.tick)
        self._forget_breaks(self.tick)

    def _keep_branch(self, tick: int) -> None:
        """Keep how the run goes on after a tick."""
        history = tuple(entry for entry in self._timeline if entry.in_effect)
        self._branches.append(Branch(tick, history, self._last_tick, frozenset(self._breaks)))
        del self._branches[:-BRANCH_LIMIT]

    def return_to(self, branch: Branch) -> None:
        """Go to where a branch begins, with it as what follows; what followed until now becomes a branch in its place.

        Raises ValueError while recording, and for a branch that is not one of this run's.
        """
        if self._recorder is not None:
            raise ValueError("stop the recording before going back in time")
        if branch not in self._branches:
            raise ValueError("that branch is gone: only the last ones are kept")
        with self._whole():
            self._return_to(branch)

    def _return_to(self, branch: Branch) -> None:
        common = 0
        for ours, theirs in zip(self._timeline, branch.history, strict=False):
            if ours is not theirs:
                break
            common += 1
        following = [*self._timeline[common : common + 1], *branch.history[common : common + 1]]
        tick = min(self._last_tick, branch.last_tick, *(entry.tick for entry in following))
        self._branches.remove(branch)
        if self._last_tick > tick:
            self._keep_branch(tick)
        self._go_by(list(branch.history), branch.last_tick)
        self._keyframes.drop_after(min((entry.order for entry in following), default=self._next_order))
        self._keyframes.drop_beyond(tick)
        self._breaks = set(branch.breaks)
        self._rewind(tick)

    def _go_by(self, history: list[LogEntry], last_tick: int) -> None:
        """Make these entries all that ever was, up to a tick; nothing is undone."""
        self._take_over(history)
        self._undone.clear()
        self._hindered.clear()
        self._redoable.clear()
        self._last_tick = last_tick
        self._scripted = None

    def _forget_breaks(self, tick: int) -> None:
        self._breaks = {each for each in self._breaks if each <= tick}

    def _take_over(self, history: list[LogEntry]) -> None:
        """Make these entries all that ever was."""
        self._timeline, self._log, self._entries = history, list(history), {}
        for entry in history:
            entry.implied = False
            self._entries.setdefault(entry.gesture, []).append(entry)
        self._done = list(self._entries)

    def _step(self, order: int) -> None:
        """One tick; order: of the next command to come."""
        self.world.contained.clear()
        step(self.world)
        if len(self.world.broken):
            self._breaks.add(self.tick)
        self._keyframes.note_tick(self.world, order)

    def _report_progress(self, done: int, total: int) -> None:
        if self.progress is not None and done % PROGRESS_TICKS == 0:
            self.progress(done, total)


def _order(entry: LogEntry) -> int:
    return entry.order
