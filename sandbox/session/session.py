"""Session: one run of a level: ticks, commands, the log, undo, time travel. No wall clock."""

import itertools
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext, suppress
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.physics.arrays import Floats
from sandbox.physics.keeping.arguments import all_of_kind, of_kind, text, whole, whole_from
from sandbox.physics.marks import LONGEST_RAMP
from sandbox.physics.snapshot import Snapshot, restore, take
from sandbox.physics.step import step
from sandbox.session.actions import RuleActions
from sandbox.session.commands import Command, CommandError, Redo, Undo, apply
from sandbox.session.commands.adding import name_added
from sandbox.session.commands.records import ScriptLine, from_record, to_record
from sandbox.session.log import Branch, LogEntry, break_lines, note_tick_events
from sandbox.session.replay.format import STATE_TICKS
from sandbox.session.replay.recording import Recorder
from sandbox.session.run_history import Keyframe, Keyframes, RunHistory
from sandbox.session.transaction import Interrupted, all_or_nothing

# Ticks between two calls of `progress` while re-stepping: few, as a tick of a full world takes a tenth of a second.
PROGRESS_TICKS = 4

# The highest number of a gesture: files hold no more digits.
MOST_GESTURE = 2**53

Recorded = TypeVar("Recorded")


class Session:
    """A level being run.

    Commands are applied at tick boundaries: `submit` queues, `advance` applies what is due and steps once. Every
    command belongs to a gesture (a drag from grab to release, one slider drag), the unit of undo. A script feeds
    recorded commands at their ticks; a scripted command that cannot be applied raises CommandError, a submitted one
    leaves a line in `refusals`; `do` applies one at once, and raises. `start` continues from a snapshot of this level's
    world instead of its beginning; one of another level raises ValueError.
    progress: called with ticks done and ticks in all while ticks are stepped again. Where it raises Interrupted, what
    they were stepped for passes that on and changes nothing; a script ends that asked for it.
    refusals: what could not be done, a line each: commands, and writing the recording. events: what happened by itself:
    springs that broke, what was stopped as it left the world's bounds. Who reads them may clear them.
    """

    def __init__(self, level: Level, script: Iterable[ScriptLine] = (), start: Snapshot | None = None) -> None:
        if not isinstance(level, Level):
            raise TypeError(f"a Session is of a Level, not of {level!r}; load_level reads a file or a shipped level")
        self.level = level
        self.world = build_world(level)
        self._actions = RuleActions(level, self.world)
        origin = self.world.origin.copy()
        if start is not None:
            self._put_back(self._own("start", start, origin))
        self.refusals: list[str] = []
        self.events: list[str] = []
        self.progress: Callable[[int, int], None] | None = None
        self._script = all_of_kind("script", script, ScriptLine)
        self.history = RunHistory(Keyframes(Keyframe(0, take(self.world))), self.tick)
        self.history.scripted = next((line for line in self._script if line.tick >= self.tick), None)
        self._pending: deque[tuple[Command, int]] = deque()
        self._recorder: Recorder | None = None

    def __repr__(self) -> str:
        """The session in a line."""
        past = f" of {self.last_tick}" if self.tick < self.last_tick else ""
        recorded = "" if self.recording is None else f", recorded to {self.recording}"
        count = len(self.history.done)
        gestures = f"{count} gesture" if count == 1 else f"{count} gestures"
        return f"<Session of {self.level.name!r} at tick {self.tick}{past}: {gestures}{recorded}>"

    @property
    def messages(self) -> tuple[str, ...]:
        """Refusals, then events."""
        return (*self.refusals, *self.events)

    def take_messages(self) -> tuple[str, ...]:
        """The messages, which are then told and forgotten."""
        messages = self.messages
        self.refusals.clear()
        self.events.clear()
        return messages

    @property
    def tick(self) -> int:
        """Ticks since the level's start."""
        return self.world.tick

    @property
    def last_tick(self) -> int:
        """The furthest tick reached; `seek` goes up to here."""
        return self.history.last_tick

    @property
    def can_undo(self) -> bool:
        """Whether a gesture can be undone."""
        return bool(self.history.done)

    @property
    def can_redo(self) -> bool:
        """Whether there is an undone gesture to make again, here at the end of the run."""
        return bool(self.history.redoable) and self.tick == self.history.last_tick

    @property
    def recording(self) -> Path | None:
        """The file to which this run is recorded."""
        return None if self._recorder is None else self._recorder.path

    def snapshot(self) -> Snapshot:
        """A read-only copy of the present state."""
        return take(self.world)

    def new_gesture(self) -> int:
        """A new number for a gesture, higher than all before."""
        return self.history.new_gesture()

    def submit(self, command: Command, gesture: int | None = None) -> None:
        """Queue a command for this tick boundary; without a gesture number it is a gesture of its own.

        Where it cannot be carried out then, it leaves a line in `refusals`. Raises TypeError for what is no command.
        """
        if not isinstance(command, Command):
            raise TypeError(f"submit takes a command, such as Grab(...), not {command!r}; do takes a record or a type")
        self._pending.append((command, self._gesture(gesture)))

    def do(self, command: Command | dict[str, Any] | str, gesture: int | None = None, **fields: Any) -> Command:
        """Apply a command now, before the next step: one, its record, or its type in files with its fields.

            session.do("grab", grab=0, particle="rope.end", target=(1.0, 2.0))

        What was submitted before is applied first. Returns the command with slots in place of names. Raises
        CommandError, with nothing changed, where it cannot be carried out.
        """
        number = self._gesture(gesture)
        self.apply_pending()
        if not isinstance(command, Command):
            record = {"type": command, **fields} if isinstance(command, str) else command
            command = from_record(record, self.world)
        elif fields:
            raise TypeError(f"fields belong to a command's type, as in do({command.type!r}, ...)")
        applied = self._apply(command, number)
        self.history.scripted = None
        return applied

    def attempt(self, record: dict[str, Any], gesture: int) -> bool:
        """Carry a command of a script out before the next tick; whether that was possible."""
        refusals, gesture = len(self.refusals), self._gesture(gesture)
        try:
            command = from_record(record, self.world)
        except CommandError:
            return False
        self.submit(command, gesture)
        self.apply_pending()
        return len(self.refusals) == refusals

    def undo(self) -> None:
        """Queue the undoing of the last gesture."""
        self.submit(Undo())

    def redo(self) -> None:
        """Queue the redoing of the gesture undone last."""
        self.submit(Redo())

    def apply_pending(self) -> bool:
        """Apply what is due at this tick boundary without stepping: the script's commands, then those submitted.

        True: something was due.
        """
        self._note_written()
        due = bool(self._pending)
        while self.history.scripted is not None and self.history.scripted.tick == self.tick == self.history.last_tick:
            due = True
            line, self.history.scripted = self.history.scripted, next(self._script, None)
            try:
                self._apply(from_record(line.record, self.world), line.gesture)
            except Interrupted:
                self.history.scripted = None
                raise
            except CommandError as error:
                raise CommandError("\n".join(f"line {line.line}: {fault}" for fault in error.faults)) from None
        while self._pending:
            command, gesture = self._pending.popleft()
            try:
                self._apply(command, gesture)
            except CommandError as error:
                self.refusals.extend(error.faults)
            else:
                self.history.scripted = None
        return due

    def _note_written(self) -> None:
        """Write into a recording what a program has changed in the world past the commands."""
        if self._recorder is None:
            return
        written = self._record(self._recorder.note_written, self.world)
        if written is not None:
            self.refusals.append(f"this run's recording will not verify: {written}")

    def advance(self) -> None:
        """One tick: apply what is due, then step. In the past that `seek` reached, the logged commands follow again."""
        self.apply_pending()
        if self.tick < self.history.last_tick:
            self._follow(self.history.first_of(self.tick + 1), self.tick + 1)
            return
        self._step(self.history.next_order)
        self.history.last_tick = self.tick
        self.events.extend(str(hit) for hit in self.world.contained)
        self.events.extend(break_lines(self.world))
        if self._recorder is not None:
            self._record(self._recorder.write_tick, self.world)

    def seek(self, tick: int) -> None:
        """Go to a tick that was reached before, 0..last_tick; a command submitted there starts a new future from it.

        Raises ValueError out of that range, or while recording.
        """
        if not self.history.keyframes.first.tick <= whole("tick", tick) <= self.history.last_tick:
            raise ValueError(f"tick {tick} is outside {self.history.keyframes.first.tick}..{self.history.last_tick}")
        if self._recorder is not None:
            raise ValueError("stop the recording before going back in time")
        with self._all_or_nothing(changes_history=False):
            self._rewind(tick, sought=True)

    def adopt(self, state: Snapshot) -> None:
        """Go to a state that a recording of this very run holds, without stepping there, and keep it.

        After the last tick, the script's commands until there count as carried out. No command between the state and
        the last tick may be undone, or be an undo. Raises CommandError, with nothing changed, where a command names
        what is not there.
        """
        before = take(self.world)
        self._put_back(self._own("state", state))
        if self.tick > self.history.last_tick:
            try:
                self._pass_script()
            except CommandError:
                self._put_back(before)
                raise
        self.history.keyframes.insert(
            Keyframe(self.history.order_at(self.history.first_of(self.tick)), take(self.world))
        )

    def _pass_script(self) -> None:
        """Enter the script's commands before this tick into history, which a state already holds."""
        lines = []
        while self.history.scripted is not None and self.history.scripted.tick < self.tick:
            lines.append(self.history.scripted)
            self.history.scripted = next(self._script, None)
        try:
            commands = [from_record(line.record, self.world) for line in lines]
        except CommandError:
            self._script = itertools.chain([*lines, *filter(None, [self.history.scripted])], self._script)
            self.history.scripted = next(self._script, None)
            raise
        self._enter(lines, commands)

    def _enter(self, lines: Iterable[ScriptLine], commands: Iterable[Command]) -> None:
        """Enter commands into history, whose effects the present state holds."""
        for line, command in zip(lines, commands, strict=True):
            if line.gesture in self.history.undone:
                continue
            self.history.begin(line.gesture)
            self.history.last_gesture = max(self.history.last_gesture, line.gesture)
            self.history.enter(LogEntry(self.history.next_order, line.tick, line.gesture, command))
        self.history.last_tick = self.tick

    def come_to(self, state: Snapshot, lines: Iterable[ScriptLine]) -> None:
        """Go on from the end of the run to a later state of it, without stepping there; lines: what led there.

        Raises CommandError where a command names what is not there.
        """
        lines = list(all_of_kind("lines", lines, ScriptLine))
        before = take(self.world)
        self._put_back(self._own("state", state))
        try:
            commands = [from_record(line.record, self.world) for line in lines]
        except CommandError:
            self._put_back(before)
            raise
        self._enter(lines, commands)
        self.history.keyframes.keep(Keyframe(self.history.next_order, take(self.world)))

    def step_again(self, state: Snapshot) -> None:
        """Go back to a state that this run had at a tick, before its commands, and step to the present tick once more.

        What comes of it is told by the world alone: no state is kept, and nothing is recorded.
        """
        tick = self.tick
        self._put_back(self._own("state", state))
        self.history.keyframes.note_return()
        self._follow(self.history.first_of(state.tick), tick, sought=False)

    def retold(self, tick: int) -> "Session":
        """A run of its own with the same history, at the last keyframe at or before a tick; `advance` follows it from
        there to the last tick. Neither run changes the other.
        """
        first = self.history.keyframes.before(whole("tick", tick))
        twin = Session(self.level, start=first.snapshot)
        twin.history = self.history.onward(first)
        twin._follow(0, first.tick)
        return twin

    def keyframes(self, first: int, last: int) -> list[Snapshot]:
        """The states of ticks first..last that are kept, a few each second or less."""
        first, last = whole("first", first), whole("last", last)
        return [kept.snapshot for kept in self.history.keyframes if first <= kept.tick <= last]

    @property
    def breaks(self) -> tuple[int, ...]:
        """The ticks in which springs broke, in order."""
        return tuple(sorted(tick for tick, kept in self.history.tick_events.items() if kept.broken))

    @property
    def gestures(self) -> tuple[LogEntry, ...]:
        """The first command of each gesture that counts, in order."""
        return tuple(self.history.entries[gesture][0] for gesture in self.history.done)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """How the run went on before it was changed in the past; see `return_to`."""
        return tuple(self.history.branches)

    def going(self) -> list[Command]:
        """The commands that end everything that goes on now, such as a hand that holds or a motor that is driven."""
        endings = (entry.command.ending(self.world) for entry in self.history.begun(self.tick))
        return [ending for ending in endings if ending is not None]

    def record_to(self, path: Path | str, state_ticks: int = STATE_TICKS) -> None:
        """Record this run to a file, from the level's start: the run until now is played again into it.

        state_ticks: from one stored state to the next; from each the recording can be verified, and each takes room.
        Overwrites the file. Raises OSError where it cannot be written, ValueError for a run that began in the middle.
        """
        whole_from("state_ticks", state_ticks, 1, LONGEST_RAMP)
        path = _path(path)
        self.stop_recording()
        twin = self._recorded(path, state_ticks)
        self.history.drop_future(self.tick)
        self._recorder = twin._recorder

    def save_to(self, path: Path | str) -> Path | None:
        """Write the run up to the present tick as a recording of its own; this run stays as it is, what follows too.

        Its file, or None where its end cannot be written. Overwrites the file. Raises as `record_to` does.
        """
        twin = self._recorded(_path(path), STATE_TICKS)
        saved = twin.stop_recording()
        self.refusals.extend(twin.refusals)
        return saved

    def _recorded(self, path: Path, state_ticks: int) -> "Session":
        """A run of its own that did all that was done until now, with the recording that it is still making of that."""
        if self.history.keyframes.first.tick > 0:
            raise ValueError("only a run from the level's start can be recorded")
        twin = Session(self.level)
        twin._recorder = Recorder(path, self.level, twin.world, state_ticks)
        if self.progress is not None:
            tell = self.progress
            twin.progress = lambda *_: tell(twin.last_tick, self.tick)
        try:
            for entry in self.history.until(self.tick):
                self._catch_up(twin, entry.tick)
                twin._apply(entry.command, entry.gesture)
            self._catch_up(twin, self.tick)
        except BaseException as error:
            twin.abandon_recording()
            if isinstance(error, Interrupted):
                with suppress(OSError):
                    path.unlink()
            raise
        self.refusals.extend(twin.refusals)
        twin.refusals.clear()
        return twin

    def _catch_up(self, twin: "Session", tick: int) -> None:
        while twin.tick < tick:
            twin.advance()
            self._report_progress(twin.tick, self.tick)

    def stop_recording(self) -> Path | None:
        """Write the recording's last line and return its path; None where there is none or it cannot be written."""
        self._note_written()
        recorder, self._recorder = self._recorder, None
        if recorder is None:
            return None
        try:
            recorder.finish(self.world)
        except OSError as error:
            self.refusals.append(f"{recorder.path}: the end of the recording could not be written: {error.strerror}")
            return None
        return recorder.path

    def abandon_recording(self) -> None:
        """Close the recording without its last line, as a crash would leave it."""
        recorder, self._recorder = self._recorder, None
        if recorder is not None:
            recorder.abandon()

    def _record(self, write: Callable[..., Recorded], *what: Any) -> Recorded | None:
        """The result of writing to the recording; None where it fails, which ends the recording."""
        try:
            return write(*what)
        except OSError as error:
            self.refusals.append(f"{self.recording}: recording stopped at tick {self.tick}: {error.strerror}")
            self.abandon_recording()
            return None

    def _apply(self, command: Command, gesture: int) -> Command:
        """Apply a command now, log it and record it; returns it with slots in place of names.

        Raises CommandError and changes nothing where it cannot be.
        """
        if gesture in self.history.undone:
            return command
        tick = self.tick
        if isinstance(command, Undo):
            with self._all_or_nothing():
                self._undo()
        elif isinstance(command, Redo):
            with self._all_or_nothing():
                self._redo()
        else:
            if gesture not in self.history.entries and not self.history.reached.has(tick):
                self.history.keep_reached(self.world)
            command = apply(self.world, command)
            self.history.drop_future(self.tick)
            self.history.begin(gesture)
        self.history.last_gesture = max(self.history.last_gesture, gesture)
        self.history.note(command, gesture, self.world)
        if self._recorder is not None:
            self._record(self._recorder.write_command, self.world, gesture, to_record(command, self.world))
        return command

    def _all_or_nothing(self, changes_history: bool = True) -> AbstractContextManager[None]:
        """Do something whole, or where `progress` gives it up not at all."""
        if self.progress is None:
            # Nothing gives it up; a copy of a long history takes milliseconds.
            return nullcontext()
        return all_or_nothing(self._checkpoint(changes_history))

    def _checkpoint(self, with_history: bool) -> Callable[[], None]:
        """A function that brings back the present state, and with_history the history as it is now."""
        state = take(self.world)
        history = self.history.copy() if with_history else None
        effects = [(entry, entry.in_effect, entry.implied) for entry in history.log] if history else []

        def restore_all() -> None:
            self.history = history or self.history
            for entry, in_effect, implied in effects:
                entry.in_effect, entry.implied = in_effect, implied
            self._put_back(state)

        return restore_all

    def _gesture(self, gesture: int | None) -> int:
        """A gesture's number, or a new one. Raises ValueError."""
        return self.new_gesture() if gesture is None else whole_from("gesture", gesture, 0, MOST_GESTURE)

    def _own(self, argument: str, state: Snapshot, origin: Floats | None = None) -> Snapshot:
        """A state of this level's world, whose particles begin at origin. Raises ValueError for another."""
        own = self.history.keyframes.first.snapshot.origin if origin is None else origin
        found = of_kind(argument, state, Snapshot).origin[: len(own)]
        # A clean cut moves where particles of its body begin.
        whole = ~np.isin(state.owner[: len(own)], state.owner[state.split_from >= 0])
        if found.shape != own.shape or not np.array_equal(found[whole], own[whole]):
            raise ValueError(f"{argument}: the snapshot is of another level than {self.level.name!r}")
        return state

    def _put_back(self, state: Snapshot) -> None:
        restore(self.world, state)
        name_added(self.world)

    # Undo and time travel: restore the nearest earlier keyframe and step again with the commands that still count.

    def _undo(self) -> None:
        history = self.history
        if history.keyframes.first.tick > 0:
            raise CommandError(f"undo reaches back before tick {history.keyframes.first.tick}, where this run began")
        gesture = history.last_in_effect(self.tick)
        if gesture is None:
            raise CommandError("nothing to undo")
        history.drop_future(self.tick)
        history.keep_reached(self.world)
        self._let_go(gesture)
        self._step_again_from(history.take_back(gesture))

    def _redo(self) -> None:
        history = self.history
        if not history.redoable:
            raise CommandError("nothing to redo")
        if self.tick < history.last_tick:
            raise CommandError(f"redo works at the end of the run: go to tick {history.last_tick} first")
        history.keep_reached(self.world)
        first, is_last = history.make_again()
        if is_last and first.tick == self.tick:
            # All else is as it was when it was made first; states that were kept since are without it.
            history.keyframes.drop_after(first.order)
            self._follow(history.place(first.order), self.tick)
        else:
            self._step_again_from(first.order)

    def _let_go(self, gesture: int) -> None:
        """End what a gesture began and is still going on, so that doing it again cannot leave it going for ever."""
        if all(entry.command.begins() is None for entry in self.history.entries[gesture]):
            return
        for entry in self.history.begun(self.tick):
            ending = entry.command.ending(self.world)
            if entry.gesture == gesture and ending is not None:
                self.history.note(ending, gesture, self.world, implied=True)

    def _step_again_from(self, order: int) -> None:
        """Come to the present tick once more, by the timeline as it is now, which is another from an order on."""
        tick = self.tick
        self.history.drop_states_after(order, tick)
        self._rewind(tick)

    def _rewind(self, tick: int, sought: bool = False) -> None:
        """Restore the last keyframe at or before a tick and follow history; sought: others near may be next."""
        keyframe = self.history.keyframes.before(tick)
        self._put_back(keyframe.snapshot)
        self.history.keyframes.note_return()
        self._follow(self.history.place(keyframe.order), tick, sought)

    def _follow(self, place: int, tick: int, sought: bool = True) -> None:
        """Go on to a tick, carrying out history from a place in it on; sought: ticks on the way are kept a while."""
        start, history = self.tick, self.history.timeline
        while True:
            while place < len(history) and history[place].tick == self.tick:
                # What needed an undone gesture has no effect any more.
                try:
                    apply(self.world, history[place].command)
                    history[place].in_effect = True
                except CommandError:
                    history[place].in_effect = False
                    self.history.hindered.add(history[place].gesture)
                place += 1
                self.history.keyframes.note_command(self.world, self.history.order_at(place))
            if self.tick >= tick:
                return
            self._step(self.history.order_at(place))
            if sought:
                self.history.keyframes.note_passed(self.world, self.history.order_at(place), tick)
            self._report_progress(self.tick - start, tick - start)

    def return_to(self, branch: Branch) -> None:
        """Go to where a branch begins, with it as what follows; what followed until now becomes a branch in its place.

        Raises ValueError while recording, and for a branch that is not one of this run's.
        """
        if self._recorder is not None:
            raise ValueError("stop the recording before going back in time")
        if of_kind("branch", branch, Branch) not in self.history.branches:
            raise ValueError("that branch is gone: only the last ones are kept")
        with self._all_or_nothing():
            self._rewind(self.history.return_to(branch))

    def _step(self, order: int) -> None:
        """Make one tick; order: that of the next command to come."""
        self.world.contained.clear()
        if self.level.rules:
            self._actions.act(self.world)
        step(self.world)
        note_tick_events(self.history.tick_events, self.world)
        self.history.keyframes.note_tick(self.world, order)

    def _report_progress(self, done: int, total: int) -> None:
        if self.progress is not None and done % PROGRESS_TICKS == 0:
            self.progress(done, total)


def _path(path: Path | str) -> Path:
    """A path, or a text that says one. Raises ValueError."""
    return path if isinstance(path, Path) else Path(text("path", path))
