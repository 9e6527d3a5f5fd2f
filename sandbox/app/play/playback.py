"""Playback: the run on the screen: a session, the clock that drives it and the two snapshots that are drawn."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Protocol

import numpy as np

from sandbox.app.loop import TickClock
from sandbox.app.play.breaks import Breaks
from sandbox.level.format.model import Level
from sandbox.physics.energy import Dissipation
from sandbox.physics.snapshot import Snapshot, state_hash
from sandbox.physics.world import World
from sandbox.session.commands import Command, CommandError, Redo, Undo
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session, break_lines
from sandbox.tools.tool import Response

# Wall time [s] that the ticks of one frame may take; the ticks beyond it are lost and the run falls behind real time,
# but the window goes on answering.
TICK_BUDGET = 0.05


class Listener(Protocol):
    """Who is told of every tick of a run; it reads and never writes."""

    def hear(self, world: World) -> None:
        """Take in the world after a tick."""
        ...

    def forget(self) -> None:
        """Compare with nothing that was before: history is another."""
        ...


class Playback:
    """A level being played, or a replay being watched; `previous` and `current` are what the renderer draws between."""

    def __init__(self, level: Level, replay: Replay | None = None) -> None:
        self.session = Session(level, script=replay.script if replay else ())
        self.level = level
        self.replay = replay
        self.clock = TickClock()
        self.dissipation = Dissipation()
        self.breaks = Breaks()
        self.behind = False
        self.verdict = ""
        self.messages: list[str] = []
        self.listener: Listener | None = None
        self.current = self.previous = self.session.snapshot()
        self._equal = True
        self._submitted = False
        self._has_grown = False
        # Grows with every command of the person's that was applied.
        self.revision = 0

    @property
    def has_pending(self) -> bool:
        """Whether commands wait that `apply_pending` has not applied yet."""
        return self._submitted

    @property
    def watching(self) -> bool:
        """Whether a replay still decides what happens."""
        return self.replay is not None and not self.verdict

    def reset(self) -> "Playback":
        """The same level or replay from its beginning, at the same speed."""
        fresh = Playback(self.level, self.replay)
        fresh.clock = replace(self.clock, accumulator=0.0, single_steps=0)
        return fresh

    def submit(self, command: Command, gesture: int | None = None) -> None:
        """Queue a command of the person's; while a replay is watched, the person takes over from it."""
        if self.watching:
            self.take_over()
        self._submitted = True
        if self.listener is not None and isinstance(command, (Undo, Redo)):
            self.listener.forget()
        self.session.submit(command, gesture)

    def respond(self, response: Response) -> None:
        """Queue what a tool answered."""
        for command, gesture in response.submissions:
            self.submit(command, gesture)
        if response.message:
            self.messages.append(response.message)

    def submit_undo(self) -> None:
        """Take the last gesture back."""
        self._submit_if(self.session.can_undo, Undo(), "There is nothing to undo.")

    def submit_redo(self) -> None:
        """Make the gesture again that was undone last."""
        self._submit_if(self.session.can_redo, Redo(), "There is nothing to redo.")

    def _submit_if(self, possible: bool, command: Command, otherwise: str) -> None:
        if possible:
            self.submit(command)
        else:
            self.messages.append(otherwise)

    def toggle_pause(self) -> None:
        """Pause, or go on."""
        self.clock.paused = not self.clock.paused

    def take_over(self) -> None:
        """Stop following the replay: from here the person plays."""
        self.verdict = f"You took over at tick {self.session.tick}"
        self.messages.append(f"{self.verdict}: the recording is not followed any further.")

    def apply_pending(self) -> None:
        """Apply what was submitted, also while paused, and show it at once."""
        submitted, self._submitted = self._submitted, False
        joined = self.session.world.joined
        try:
            self.session.apply_pending()
        except CommandError as error:
            self._end_watching(f"the recording holds a command that cannot be carried out: {error}")
        self._has_grown = len(self.session.world.joined) > len(joined)
        if submitted:
            self.revision += 1
            self.current = self.session.snapshot()
            if len(self.previous.mass) != len(self.current.mass) or self.clock.paused:
                self.previous = self.current
        self._drain()

    def stop_recording(self) -> Path | None:
        """End a recording, with all that was submitted until now in it; its file, None where none was being made."""
        self.apply_pending()
        return self.session.stop_recording()

    def advance(self, frame_time: float) -> int:
        """Let frame_time [s] of wall time pass; returns the ticks that were made."""
        if self._has_grown and not self.clock.paused:
            # What joined has taken its time already, and so will drawing it: its first tick waits for the next frame.
            self._has_grown, self.clock.accumulator = False, self.clock.accumulator + frame_time * self.clock.speed
            return 0
        due = self.clock.ticks(frame_time, self.session.world.settings.tick_rate)
        started, done = time.perf_counter(), 0
        self.behind = False
        while done < due and not self._at_replays_end():
            if done == due - 1:
                self.previous = self.session.snapshot()
            if not self._tick():
                break
            done += 1
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

    def _tick(self) -> bool:
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                self.session.apply_pending()
                self.dissipation.before(self.session.world)
                self.session.advance()
                self.dissipation.after(self.session.world)
                self._note_breaks()
                if self.listener is not None:
                    self.listener.hear(self.session.world)
        except CommandError as error:
            self._end_watching(f"the recording holds a command that cannot be carried out: {error}")
            return False
        if self.watching:
            self._compare()
        return True

    def _note_breaks(self) -> None:
        """Tell what broke in words of its own, in place of the session's."""
        world = self.session.world
        for line in break_lines(world):
            self.session.messages.remove(line)
        self.breaks.note(world)

    def _compare(self) -> None:
        assert self.replay is not None
        tick = self.session.tick
        if self._equal and tick <= self.replay.ticks:
            self._equal = state_hash(self.session.world) == self.replay.hashes[tick].whole
            if not self._equal:
                self.messages.append(f"The run differs from the recording at tick {tick}; `sandbox replay` says where.")

    def _at_replays_end(self) -> bool:
        if not self.watching:
            return False
        assert self.replay is not None
        if self.session.tick < self.replay.ticks:
            return False
        cut = " (the file is cut off there)" if self.replay.end_hash is None else ""
        outcome = "verified: every tick equal bit for bit" if self._equal else "NOT equal to the recording"
        self._end_watching(f"{self.replay.ticks:,} ticks{cut}, {outcome}")
        return True

    def _end_watching(self, outcome: str) -> None:
        self.verdict = f"End of the replay: {outcome}"
        self.clock.paused = True
        self.messages.append(self.verdict)

    def _drain(self) -> None:
        self.messages.extend(self.session.messages)
        self.session.messages.clear()


def interpolated(previous: Snapshot, current: Snapshot, alpha: float) -> np.ndarray:
    """Positions [m] (n, 2) between two snapshots; those of the current one where they cannot be paired."""
    if previous is current or len(previous.mass) != len(current.mass):
        return current.position
    with np.errstate(over="ignore", invalid="ignore"):
        return previous.position + (current.position - previous.position) * alpha
