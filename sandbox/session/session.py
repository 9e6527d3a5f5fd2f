"""Session: one run of a level: ticks, commands, the log, undo, time travel. No wall clock."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sandbox.level.build.build_world import build_world
from sandbox.level.format.model import Level
from sandbox.physics.snapshot import Snapshot, restore, take
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.session.commands import Command, CommandError, Redo, Undo, apply
from sandbox.session.commands.adding import name_added
from sandbox.session.commands.records import ScriptLine, from_record, to_record
from sandbox.session.replay.format import STATE_TICKS
from sandbox.session.replay.writer import Recorder

KEYFRAME_TICKS = 60
# Memory for keyframes [bytes]; beyond it every other one goes, and undo re-steps twice as far.
KEYFRAME_BUDGET = 256 * 2**20
# Ticks between two calls of `progress` while re-stepping.
PROGRESS_TICKS = 120
# Of more springs that break in one tick the message says how many they are, not their names.
MOST_NAMED = 3


@dataclass
class LogEntry:
    """A command that was applied at a tick, before that tick's step.

    in_effect: False while the command cannot be carried out because what it needed is undone. implied: the end of a
    drag or drive that an Undo brings about by itself, so that a recording of that Undo does not hold it.
    """

    tick: int
    gesture: int
    command: Command
    in_effect: bool = True
    implied: bool = False


class Session:
    """A level being run.

    Commands are applied at tick boundaries: `submit` queues, `advance` applies what is due and steps once. Every
    command belongs to a gesture (a drag from grab to release, one slider drag), the unit of undo. A script feeds
    recorded commands at their ticks; a scripted command that cannot be applied raises CommandError, a submitted one
    leaves a line in `messages`. `start` continues from a snapshot of this level's world instead of its beginning.
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
        self._pending: list[tuple[Command, int]] = []
        self._log: list[LogEntry] = []
        self._done: set[int] = set()
        self._undone: set[int] = set()
        self._redoable: list[int] = []
        self._last_gesture = 0
        self._last_tick = self.tick
        self._keyframes = [take(self.world)]
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
            except CommandError as error:
                raise CommandError(f"line {line.line}: {error}") from None
        while self._pending:
            command, gesture = self._pending.pop(0)
            try:
                self._apply(command, gesture)
            except CommandError as error:
                self.messages.append(str(error))
            else:
                self._scripted = None
        return due

    def advance(self) -> None:
        """One tick: apply what is due, then step. In the past that `seek` reached, the logged commands follow again."""
        self.apply_pending()
        if self.tick < self._last_tick:
            self._follow([entry for entry in self._effective_log() if entry.tick == self.tick + 1], self.tick + 1)
            return
        self._step()
        self._last_tick = self.tick
        self.messages.extend(str(hit) for hit in self.world.contained)
        self.messages.extend(_break_lines(self.world))
        if self._recorder is not None:
            self._record(self._recorder.write_tick, self.world)

    def seek(self, tick: int) -> None:
        """Go to a tick that was reached before, 0..last_tick; a command submitted there starts a new future from it.

        Raises ValueError out of that range, or while recording.
        """
        if not self._keyframes[0].tick <= tick <= self._last_tick:
            raise ValueError(f"tick {tick} is outside {self._keyframes[0].tick}..{self._last_tick}")
        if self._recorder is not None:
            raise ValueError("stop the recording before going back in time")
        self._rewind(tick, tick)

    def retold(self, tick: int) -> "Session":
        """A run of its own with the same history, at the last keyframe at or before a tick; `advance` follows it from
        there to the last tick. Neither run changes the other.
        """
        first = self._keyframe_before(tick)
        twin = Session(self.level, start=first)
        twin._keyframes = [kept for kept in self._keyframes if kept.tick >= first.tick]
        twin._log = [replace(entry) for entry in self._effective_log() if entry.tick >= first.tick]
        twin._last_tick = self._last_tick
        twin._follow([entry for entry in twin._log if entry.tick == first.tick], first.tick)
        return twin

    def keyframes(self, first: int, last: int) -> list[Snapshot]:
        """The states of ticks first..last that are kept, a few each second or less."""
        return [kept for kept in self._keyframes if first <= kept.tick <= last]

    def record_to(self, path: Path, state_ticks: int = STATE_TICKS) -> None:
        """Record this run to a file, from the level's start: what was played until now is played again into it.

        state_ticks: from one stored state to the next; from each the recording can be verified, and each takes room.
        Overwrites the file. Raises OSError where it cannot be written, ValueError for a run that began in the middle.
        """
        if self._keyframes[0].tick > 0:
            raise ValueError("only a run from the level's start can be recorded")
        self.stop_recording()
        twin = Session(self.level)
        twin._recorder = Recorder(path, self.level, twin.world, state_ticks)
        self._drop_future()
        try:
            for entry in self._log:
                if entry.implied:
                    continue
                self._catch_up(twin, entry.tick)
                twin._apply(entry.command, entry.gesture)
            self._catch_up(twin, self.tick)
        except BaseException:
            twin.abandon_recording()
            raise
        self._recorder = twin._recorder
        self.messages.extend(twin.messages)

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
            self._undo()
        elif isinstance(command, Redo):
            self._redo()
        else:
            apply(self.world, command)
            self._drop_future()
            if gesture not in self._done:
                self._done.add(gesture)
                self._redoable.clear()
        self._last_gesture = max(self._last_gesture, gesture)
        self._log.append(LogEntry(tick, gesture, command))
        if self._recorder is not None:
            self._record(self._recorder.write_command, tick, gesture, to_record(command, self.world))

    # Undo and time travel: restore the nearest earlier keyframe and step again with the commands that still count.

    def _undo(self) -> None:
        if self._keyframes[0].tick > 0:
            raise CommandError(f"undo reaches back before tick {self._keyframes[0].tick}, where this run began")
        past = [entry.gesture for entry in self._effective_log() if entry.tick <= self.tick and entry.in_effect]
        if not past:
            raise CommandError("nothing to undo")
        self._drop_future()
        gesture = list(dict.fromkeys(past))[-1]
        self._let_go(gesture)
        self._done.remove(gesture)
        self._undone.add(gesture)
        self._redoable.append(gesture)
        self._step_again_from(gesture)

    def _redo(self) -> None:
        if not self._redoable:
            raise CommandError("nothing to redo")
        if self.tick < self._last_tick:
            raise CommandError(f"redo works at the end of the run: go to tick {self._last_tick} first")
        gesture = self._redoable.pop()
        self._undone.remove(gesture)
        self._done.add(gesture)
        self._step_again_from(gesture)

    def _let_go(self, gesture: int) -> None:
        """End what a gesture began and is still going on, so that doing it again cannot leave it going for ever."""
        going = {
            begun: (entry.gesture, entry.command)
            for entry in self._effective_log()
            if entry.in_effect and (begun := entry.command.begins()) is not None
        }
        for owner, command in going.values():
            ending = command.ending(self.world)
            if owner == gesture and ending is not None:
                self._log.append(LogEntry(self.tick, gesture, ending, implied=True))

    def _step_again_from(self, gesture: int) -> None:
        first = next(entry.tick for entry in self._log if entry.gesture == gesture)
        while self._keyframes[-1].tick > first:
            self._keyframes.pop()
        self._rewind(first, self.tick)

    def _rewind(self, back_to: int, tick: int) -> None:
        """Restore the last keyframe at or before a tick and follow the log to another."""
        keyframe = self._keyframe_before(back_to)
        restore(self.world, keyframe)
        name_added(self.world)
        self._follow([entry for entry in self._effective_log() if keyframe.tick <= entry.tick <= tick], tick)

    def _keyframe_before(self, tick: int) -> Snapshot:
        return next(kept for kept in reversed(self._keyframes) if kept.tick <= tick)

    def _follow(self, log: list[LogEntry], tick: int) -> None:
        start, done = self.tick, 0
        while True:
            while done < len(log) and log[done].tick == self.tick:
                # What needed an undone gesture has no effect any more.
                try:
                    apply(self.world, log[done].command)
                    log[done].in_effect = True
                except CommandError:
                    log[done].in_effect = False
                done += 1
            if self.tick >= tick:
                return
            self._step()
            self._report_progress(self.tick - start, tick - start)

    def _effective_log(self) -> list[LogEntry]:
        """The log as history now stands: without undone gestures, and without Undo and Redo themselves."""
        return [
            entry
            for entry in self._log
            if entry.gesture not in self._undone and not isinstance(entry.command, (Undo, Redo))
        ]

    def _drop_future(self) -> None:
        """Make the present tick the end of history, after `seek` went back."""
        if self.tick == self._last_tick:
            return
        self._log = [entry for entry in self._effective_log() if entry.tick <= self.tick and entry.in_effect]
        for entry in self._log:
            entry.implied = False
        self._done = {entry.gesture for entry in self._log}
        self._undone.clear()
        self._redoable.clear()
        self._keyframes = [keyframe for keyframe in self._keyframes if keyframe.tick <= self.tick]
        self._last_tick = self.tick
        self._scripted = None

    def _step(self) -> None:
        self.world.contained.clear()
        step(self.world)
        if self.tick % KEYFRAME_TICKS == 0 and self._keyframes[-1].tick < self.tick:
            self._keep_keyframe()

    def _keep_keyframe(self) -> None:
        self._keyframes.append(take(self.world))
        size = sum(array.nbytes for array in self._keyframes[-1].arrays.values())
        if size * len(self._keyframes) > KEYFRAME_BUDGET and len(self._keyframes) > 2:
            del self._keyframes[1::2]

    def _report_progress(self, done: int, total: int) -> None:
        if self.progress is not None and done % PROGRESS_TICKS == 0:
            self.progress(done, total)


def _break_lines(world: World) -> list[str]:
    """One line about the springs that broke in the last tick, or none."""
    broken = world.broken.tolist()
    if not broken:
        return []
    if len(broken) > MOST_NAMED:
        return [f"tick {world.tick}: {len(broken)} springs broke"]
    names = [world.spring_names[slot] for slot in broken]
    listed = names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
    return [f"tick {world.tick}: {listed} broke"]
