"""Playback: the run on the screen: a session, the clock that drives it and the two snapshots that are drawn."""

import time
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Protocol, Self

import numpy as np

from sandbox.app.base.loop import TickClock
from sandbox.app.run.followers import Activity, Breaks, Fired, Stopped
from sandbox.app.run.travel import Travel
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.document.model import Level
from sandbox.physics.analysis.energy import Dissipation
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.step import precompute
from sandbox.session.commands import (
    Command,
    CommandError,
    Redo,
    SetCoefficients,
    SetFirmness,
    SetGravity,
    SetInflation,
    Undo,
)
from sandbox.session.log import Branch, break_lines
from sandbox.session.outcome import outcome, outcome_text
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.scene import RunScene, SceneTaker
from sandbox.session.session import Session
from sandbox.session.transaction import Interrupted
from sandbox.session.tuning import tuning_of
from sandbox.tools.tool import Response

# Wall time [s] that the ticks of one frame may take; the ticks beyond it are lost and the run falls behind real time,
# but the window goes on answering.
TICK_BUDGET = 0.05
# What is set here comes about in this time [s], rather than at once: in half of it a heap of soft jellies that is made
# rigid leaps as high as its bodies are.
RAMPED = (SetCoefficients, SetFirmness, SetGravity, SetInflation)
RAMP_TIME = 1.25
# Frames without a tick after something has joined the run: the one that adds it, and the one that lays out its ticks.
FRAMES_TO_JOIN = 2
# What stood for so long [s] before an undo, or before another command in the past, is kept.
LOOKED_AT = 1.0
# What is said where playing a run again was given up.
GIVEN_UP = "Cancelled. The run did not change."


class Listener(Protocol):
    """A follower of every tick of a run; it reads and never writes."""

    def hear(self, world: LevelWorld) -> None:
        """Take in the world after a tick."""
        ...

    def forget(self) -> None:
        """Compare the next tick with nothing that was before, as the history is another one."""
        ...


class Playback:
    """A level being played, or a replay being watched; `previous` and `current` are what the renderer draws between.

    first: the scene that it goes on from. cut: is told how the run stands before some of its history is cut off.
    """

    def __init__(
        self, level: Level, replay: Replay | None = None, start: Snapshot | None = None, first: RunScene | None = None
    ) -> None:
        self.session = first.session() if first else Session(level, replay.script if replay else (), start)
        self.first = first
        self.cut: Callable[[RunScene], None] = lambda scene: None
        self._taker = SceneTaker(self.session)
        # How the run stands at its end, while it is in its past.
        self._end: RunScene | None = None
        # How long the last undo or redo is ago [s]: what stood for a moment between two of them is not kept.
        self._stood = LOOKED_AT
        self.level = level
        self.replay = replay
        self.clock = TickClock()
        self.dissipation = Dissipation()
        self.breaks = Breaks(level)
        self.stopped = Stopped()
        self.fired = Fired(level)
        # Whether it pauses where it is won or lost.
        self.pauses_at_end = False
        self.activity = Activity()
        self.behind = False
        self.verdict = ""
        self.messages: list[str] = []
        self.listener: Listener | None = None
        self.current = self.previous = self.session.snapshot()
        self.travel = Travel(self.session, replay)
        self._equal = True
        self._taken_over = False
        self._passed_over = False
        self._submitted = False
        # Frames that what joins a run takes for itself.
        self._making_room = 0
        # Grows with every command of the person's that was applied.
        self.revision = 0

    @property
    def has_pending(self) -> bool:
        """Whether commands wait that `apply_pending` has not applied yet."""
        return self._submitted

    @property
    def watching(self) -> bool:
        """Whether a replay's commands are still to come."""
        return self.replay is not None and not self._taken_over

    @property
    def moves(self) -> bool:
        """Whether time passes in it, or it is on its way to another tick."""
        return not self.clock.paused or self.clock.single_steps > 0 or self._submitted or self.travel.target is not None

    @property
    def outcome(self) -> str:
        """The verdict on a replay that was watched, while the run is at its end or no longer follows it; else ""."""
        return self.verdict if self._taken_over or self.session.tick == self.length else ""

    @property
    def length(self) -> int:
        """The last tick that `seek` can reach."""
        return self.travel.length(self.watching)

    def reset(self, kept: Collection[type[Command]] = ()) -> Self:
        """Go back to the beginning of the level or replay, at the same speed; kept: kinds of TUNING that stay set."""
        fresh = type(self)(self.level, self.replay)
        fresh.clock = replace(self.clock, speed=abs(self.clock.speed), accumulator=0.0, single_steps=0)
        fresh.travel.bookmarks, fresh.travel.span = self.travel.bookmarks, self.travel.span
        commands = [] if self.replay is not None else tuning_of(self.session, kept)
        if commands:
            gesture = fresh.session.new_gesture()
            for command in commands:
                fresh.session.submit(command, gesture)
            fresh.session.apply_pending()
            # What was set of a thing that joined later cannot be set yet.
            fresh.session.take_messages()
            fresh.first = fresh._taker.take()
            fresh.current = fresh.previous = fresh.session.snapshot()
        return fresh

    def scene(self) -> RunScene | None:
        """How the run stands at its end; None: nothing was done in it, or nothing since the scene that it began as."""
        if self.watching:
            return None
        self.apply_pending()
        scene = self._end if self.session.tick < self.session.last_tick else self._taker.take()
        if scene is None or not scene.script:
            return None
        return None if self.first is not None and self.first.is_done_by(scene.script) else scene

    def present_scene(self) -> RunScene:
        """How the run stands on the screen."""
        self.apply_pending()
        return self._taker.take()

    def _tell_cut(self) -> None:
        self.apply_pending()
        has_stood, self._stood = self._stood >= LOOKED_AT, 0.0
        scene = self.scene() if has_stood else None
        if scene is not None:
            self.cut(scene)

    def submit(self, command: Command, gesture: int | None = None) -> None:
        """Queue a command of the person's; while a replay is watched, or in the past, the person takes over from it."""
        session = self.session
        is_past = session.tick < session.last_tick
        if (self.watching or is_past) and not self._submitted:
            gesture = session.new_gesture() if gesture is None else gesture
            self._end_what_goes_on(gesture)
        if self.watching:
            self.take_over()
        if is_past and not self._submitted:
            self._tell_cut()
            self.messages.append("The run goes on from here. Shift+Y goes back to the old one.")
        if self.clock.speed < 0.0:
            self.clock.speed, self.clock.accumulator = 1.0, 0.0
        self.travel.target = None
        self._submitted = True
        if isinstance(command, (Undo, Redo)):
            self.stopped = Stopped()
            if self.listener is not None:
                self.listener.forget()
        session.submit(self._taking_time(command), gesture)

    def _taking_time(self, command: Command) -> Command:
        """The command; one of RAMPED without a duration gets the usual one."""
        if not isinstance(command, RAMPED) or command.duration:
            return command
        return replace(command, duration=round(RAMP_TIME * self.session.world.settings.tick_rate))

    def respond(self, response: Response) -> None:
        """Queue a tool's commands, and show its line."""
        for command, gesture in response.submissions:
            self.submit(command, gesture)
        if response.message:
            self.messages.append(response.message)

    def submit_undo(self) -> None:
        """Undo the last gesture, also one of this frame."""
        self._tell_cut()
        self._submit_if(self.session.can_undo, Undo(), "There is nothing to undo.")

    def submit_redo(self) -> None:
        """Make the gesture again that was undone last, also in this frame."""
        self._tell_cut()
        self._submit_if(self.session.can_redo, Redo(), "There is nothing to redo.")

    def _submit_if(self, possible: bool, command: Command, otherwise: str) -> None:
        if possible:
            self.submit(command)
        else:
            self.messages.append(otherwise)

    def toggle_pause(self) -> None:
        """Pause, or go on; at the end of a replay the run goes on from there."""
        if self.clock.paused and self.watching and self.verdict and self.session.tick == self.length:
            self._end_what_goes_on(self.session.new_gesture())
            self.take_over()
        self.travel.target = None
        self.clock.paused = not self.clock.paused

    def _end_what_goes_on(self, gesture: int) -> None:
        """Release hands and stop drives whose commands are not followed any further."""
        for ending in self.session.going():
            self.session.submit(ending, gesture)

    def take_over(self) -> None:
        """Stop following the replay: from here the person plays."""
        self._taken_over = True
        self.verdict = f"You took over at tick {self.session.tick}"
        self.messages.append(f"{self.verdict}: the run no longer follows the recording.")

    def seek(self, tick: int) -> None:
        """Go to a tick, as near as there is one; a replay that has not been there yet goes on from its stored
        state nearest before it, and hurries on from there.

        While the run is recorded it stays where it is, with a message.
        """
        session = self.session
        tick = min(max(tick, 0), self.length)
        if session.recording is not None:
            self.messages.append("Stop the recording before you go back in time.")
            self.clock.speed = abs(self.clock.speed)
            return
        self.apply_pending()
        if session.tick == session.last_tick:
            self._end = self._taker.take()
        here = session.snapshot()
        self._jump(tick)
        self.travel.target = tick if tick > session.last_tick else None
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                session.seek(min(tick, session.last_tick))
        except Interrupted:
            if session.tick != here.tick:
                session.adopt(here)
            self.travel.target, self.clock.paused = None, True
            self.messages.append(GIVEN_UP)
        self.clock.accumulator = 0.0
        self.revision += 1
        if self.listener is not None:
            self.listener.forget()
        self.current = self.previous = session.snapshot()

    def _jump(self, tick: int) -> None:
        """Take the replay's stored state that is nearest before a tick, where that shortens the way."""
        stored = self.travel.stored_before(tick) if self.watching else None
        if stored is None:
            return
        assert self.replay is not None
        ahead = stored > self.session.last_tick
        # A state that is damaged is come to tick by tick.
        with suppress(ReplayError, CommandError):
            self.session.adopt(self.replay.state(stored))
            self._passed_over = self._passed_over or ahead

    def begin_again_from(self, tick: int) -> bool:
        """Go back to a tick and on from there, whatever followed, which is kept as a branch; whether it went there."""
        if self.session.recording is not None:
            self.messages.append("Stop the recording before you go back in time.")
            return False
        self._tell_cut()
        self.seek(tick)
        if self.session.tick != tick:
            return False
        self._end_what_goes_on(self.session.new_gesture())
        self.session.history.drop_future(self.session.tick)
        return True

    def return_to(self, branch: Branch) -> None:
        """Go back to where a branch begins, with it as what follows."""
        if self.session.recording is not None:
            self.messages.append("Stop the recording before you go back in time.")
            return
        self._tell_cut()
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                self.session.return_to(branch)
        except Interrupted:
            self.messages.append(GIVEN_UP)
            return
        self._taken_over = True
        self.seek(branch.tick)

    def apply_pending(self) -> None:
        """Apply what was submitted, also while paused, and show it at once."""
        submitted, self._submitted = self._submitted, False
        joined = self.session.world.joined
        try:
            self.session.apply_pending()
        except CommandError as error:
            self._give_up(error)
        except Interrupted:
            self._stop_short()
        if len(self.session.world.joined) > len(joined):
            self._making_room = FRAMES_TO_JOIN
        if submitted:
            self.revision += 1
            self.current = self.session.snapshot()
            if len(self.previous.mass) != len(self.current.mass) or self.clock.paused:
                self.previous = self.current
        self._drain()

    def record_to(self, path: Path) -> Path:
        """Record from here on, and what was until now; in a replay's past the person takes over from it.

        The file's path. Raises OSError where it cannot be written.
        """
        self.apply_pending()
        is_past = self.session.tick < self.session.last_tick
        self.session.record_to(path)
        if self.watching and is_past:
            self.take_over()
        return path

    def save_to(self, path: Path) -> Path | None:
        """Write what was until now into a file, and leave the run as it is; see Session.save_to."""
        self.apply_pending()
        return self.session.save_to(path)

    def stop_recording(self) -> Path | None:
        """End a recording, with all that was submitted until now in it; its file, None where none was being made."""
        self.apply_pending()
        return self.session.stop_recording()

    def advance(self, frame_time: float) -> int:
        """Let frame_time [s] of wall time pass; returns the ticks that were made."""
        self._stood += frame_time
        if self._making_room and not self.clock.paused:
            self._make_room()
            return 0
        due = self.clock.ticks(frame_time, self.session.world.settings.tick_rate)
        if self.travel.target is not None:
            return self._hurry(self.travel.target)
        if due < 0:
            return self._go_back(-due)
        started, done = time.perf_counter(), 0
        self.behind = False
        while done < due and not self._at_replays_end():
            turn = self.travel.turns_at(self.session.tick, backward=False)
            if turn is not None and self.session.recording is None:
                self.seek(turn)
            if done == due - 1:
                self.previous = self.session.snapshot()
            if not self._tick():
                break
            done += 1
            if self.pauses_at_end and self.fired.ended and not self.watching:
                self.clock.paused, self.clock.accumulator = True, 0.0
                self.previous = self.session.snapshot()
                break
            if done < due and time.perf_counter() - started > TICK_BUDGET:
                self.behind = True
                self.clock.accumulator = 0.0
                self.previous = self.session.snapshot()
                break
        if done:
            self.current = self.session.snapshot()
            if len(self.previous.mass) != len(self.current.mass):
                self.previous = self.current
        self._drain()
        return done

    def _make_room(self) -> None:
        """Do one part a frame of what joining takes: adding and drawing bodies, what their ticks need, a tick."""
        self._making_room -= 1
        if self._making_room == 0:
            precompute(self.session.world)

    def _hurry(self, target: int) -> int:
        """Make as many ticks towards a tick as a frame has time for."""
        started, done = time.perf_counter(), 0
        self._jump(target)
        while self.session.tick < target and time.perf_counter() - started < TICK_BUDGET and self._tick():
            done += 1
        if self.session.tick >= target or not self.watching:
            self.travel.target = None
        self.current = self.previous = self.session.snapshot()
        self._drain()
        return done

    def _go_back(self, ticks: int) -> int:
        """Play backwards; pauses at the beginning."""
        tick = self.session.tick
        turn = self.travel.turns_at(tick, backward=True)
        self.seek(tick - ticks if turn is None else turn)
        if self.session.tick == 0 and turn is None:
            self.clock.paused, self.clock.speed = True, 1.0
        self._drain()
        return 0

    def _tick(self) -> bool:
        is_new = self.session.tick == self.session.last_tick
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                self.session.apply_pending()
                self.dissipation.before(self.session.world)
                self.session.advance()
                self.dissipation.after(self.session.world)
                self._note_events()
                if self.listener is not None and self.travel.target is None:
                    self.listener.hear(self.session.world)
        except CommandError as error:
            self._give_up(error)
            return False
        except Interrupted:
            self._stop_short()
            return False
        if self.watching and is_new:
            self._compare()
        return True

    def _note_events(self) -> None:
        """Take the lines of breaks and stops in place of the session's messages."""
        world, events = self.session.world, self.session.events
        # Of a past that is played again the session says nothing.
        said = {*break_lines(world), *map(str, world.contained)}
        events[:] = [line for line in events if line not in said]
        self.breaks.note(world)
        self.stopped.note(world)
        if self.travel.target is None:
            self.fired.note(world)

    def _compare(self) -> None:
        assert self.replay is not None
        tick = self.session.tick
        if self._equal and tick <= self.replay.ticks:
            self._equal = self.replay.fits(self.session.world)
            if not self._equal:
                self.messages.append(f"The run differs from the recording at tick {tick}; `sandbox replay` says where.")

    def _at_replays_end(self) -> bool:
        if not self.watching:
            return False
        assert self.replay is not None
        if self.session.tick < self.replay.ticks:
            return False
        if self.verdict:
            self.clock.paused = True
            return True
        cut = " (the file is cut off there)" if self.replay.end_hash is None else ""
        whole = "some were passed over, all others" if self._passed_over else self.replay.compared
        compared = f"verified: {whole} equal bit for bit" if self._equal else "NOT equal to the recording"
        ended = outcome(self.level, self.session.world)
        said = "" if ended is None else f", {outcome_text(ended, self.level.settings.tick_rate)}"
        self._end_watching(f"{self.replay.ticks:,} ticks{cut}, {compared}{said}")
        return True

    def _end_watching(self, how: str) -> None:
        self.verdict = f"End of the recording: {how}"
        self.clock.paused = True
        self.messages.append(self.verdict)

    def _give_up(self, error: CommandError) -> None:
        self._end_watching(f"the recording holds a command that cannot be carried out: {error}")
        self._taken_over = True

    def _stop_short(self) -> None:
        """Follow a replay no further, as an undo or redo was given up."""
        # What was submitted after it still waits.
        self._submitted = True
        if self.watching:
            self.take_over()
        else:
            self.messages.append(GIVEN_UP)

    def _drain(self) -> None:
        self.messages.extend(self.session.take_messages())


def interpolated(previous: Snapshot, current: Snapshot, alpha: float) -> np.ndarray:
    """Positions [m] (n, 2) between two snapshots; those of the current one where they cannot be paired."""
    if previous is current or len(previous.mass) != len(current.mass):
        return current.position
    with np.errstate(over="ignore", invalid="ignore"):
        return previous.position + (current.position - previous.position) * alpha
