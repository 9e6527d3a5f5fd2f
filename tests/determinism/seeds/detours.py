"""The way `undone`: a session that now and then goes back, and comes to the same bits again."""

import itertools
import random
from collections import deque
from pathlib import Path

from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import Command, Redo, SetGravity, Undo
from sandbox.session.commands.records import from_record
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.determinism.seeds.difference import Arrays, Differs, Watch, arrays_of, first_bit, first_of_two, kept_arrays

# How likely a tick has a detour; how far back and how long it goes [ticks]; gestures that it undoes at most.
DETOURS, FAR, LONG, GESTURES = 0.3, 30, 5, 3
# Gestures of a detour are numbered from here, beyond those of a recording.
FOREIGN = 10**9


def undone(watch: Watch, seed: int, folder: Path) -> None:
    """Run a recording's commands with detours; save the run, read and verify it. Raises Differs."""
    run = Detours(watch, seed)
    while run.session.tick < watch.replay.ticks:
        run.advance()
    path = run.session.save_to(folder / f"{seed}.undone.replay.gz")
    assert path is not None, run.session.messages
    saved = read_replay(path)
    path.unlink()
    watch.checks += saved.ticks
    divergence = verify(saved)
    if divergence is None and saved.end_hash != watch.replay.end_hash:
        divergence = first_bit(watch.replay, saved.ticks, arrays_of(saved.state(saved.ticks)))
    if divergence is not None:
        raise Differs(divergence)


class Detours:
    """A session that is given a recording's commands, and goes back between them by a random choice of the seed."""

    def __init__(self, watch: Watch, seed: int) -> None:
        self.watch = watch
        self.session = Session(watch.replay.level)
        self.lines = deque(watch.replay.script)
        self.chance = random.Random(f"detours {seed}")
        self.gestures = itertools.count(FOREIGN)

    def advance(self) -> None:
        """A tick with its commands, and a detour before its step, perhaps, or in its place. Raises Differs."""
        session, tick = self.session, self.session.tick
        while self.lines and self.lines[0].tick == session.tick:
            line = self.lines.popleft()
            session.submit(from_record(line.record, session.world), line.gesture)
            session.apply_pending()
        if self.chance.random() < DETOURS:
            self.chance.choice([self._undo_and_redo, self._redo_later, self._go_back, self._branch])()
        if session.tick == tick:
            session.advance()
            self.watch.see(session.world)

    def _is_over(self) -> bool:
        """Whether there is a gesture to undo, of which nothing goes on: an undo would end that for good."""
        history, tick = self.session.history, self.session.tick
        gesture = history.last_in_effect(tick)
        begun = [entry for entry in history.begun(tick) if entry.gesture == gesture]
        return gesture is not None and all(entry.command.ending(self.session.world) is None for entry in begun)

    def _undo_and_redo(self) -> None:
        before, undone = self._kept(), 0
        while undone < self.chance.randint(1, GESTURES) and self._is_over():
            self._do(Undo())
            undone += 1
        for _ in range(undone):
            self._do(Redo())
        self._compare(before)

    def _redo_later(self) -> None:
        session, watch = self.session, self.watch
        end = min(session.tick + LONG, self.lines[0].tick if self.lines else watch.replay.ticks, watch.replay.ticks)
        if end == session.tick or not self._is_over() or watch.is_due(session.tick, end):
            return
        self._do(Undo())
        while session.tick < end:
            session.advance()
        self._do(Redo())
        watch.see(session.world)

    def _go_back(self) -> None:
        session, before, tick = self.session, self._kept(), self.session.tick
        session.seek(self.chance.randint(max(tick - FAR, 0), tick))
        if self.chance.random() < 0.5:
            session.seek(tick)
        while session.tick < tick:
            session.advance()
        self._compare(before)

    def _branch(self) -> None:
        # A branch keeps nothing to redo, and no command that had no effect.
        session, tick = self.session, self.session.tick
        redone = any(line.record["type"] == "redo" for line in self.lines)
        if redone or session.history.hindered or not tick:
            return
        before = self._kept()
        session.seek(self.chance.randint(max(tick - FAR, 0), tick - 1))
        self._do(SetGravity((0.5, 7.0)))
        for _ in range(self.chance.randint(1, LONG)):
            session.advance()
        session.return_to(session.branches[-1])
        session.seek(session.last_tick)
        self._compare(before)

    def _do(self, command: Command) -> None:
        self.session.submit(command, next(self.gestures))
        self.session.apply_pending()

    def _kept(self) -> tuple[str, Arrays]:
        return state_hash(self.session.world), kept_arrays(self.session.world)

    def _compare(self, before: tuple[str, Arrays]) -> None:
        self.watch.checks += 1
        if state_hash(self.session.world) != before[0]:
            raise Differs(first_of_two(before[1], self.session.world))
