"""A random person at a session, beside a model that plays the commands in effect again from the start every time."""

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.level.reading.files import parse_level
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from sandbox.session.commands import (
    AddParticle,
    AddSpring,
    Command,
    CommandError,
    CutSprings,
    Grab,
    MoveGrab,
    Pin,
    Redo,
    Release,
    SetCoefficients,
    SetGravity,
    SetSolver,
    Undo,
    Unpin,
    apply,
)
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session
from sandbox.session.transaction import Interrupted
from tests.support.rope_level import rope_level
from tests.support.wholes import part_and_whole

EMPTY = parse_level(
    json.dumps(
        {"format": "spring-sandbox/level", "version": 3, "name": "Empty", "settings": {"solver": "single_pass"}}
    ).encode(),
    "test",
)

# How many random sessions whole-world tests make; more of them by hand: SESSION_EXAMPLES=3000.
EXAMPLES = int(os.environ.get("SESSION_EXAMPLES", "150"))

# Few slots, hands and places, so that commands meet each other; some of each are none that exist.
SLOTS = st.sampled_from([0, 1, 2, 3, 5, 11, 16, 17, 18, 27, 28, 29, 30, 400])
HANDS = st.sampled_from([0, 0, 1, 2, 12])
PLACES = st.sampled_from([(0.0, 0.0), (1.5, -2.0), (3, 1), (-4.0, 4.0), (float("nan"), 0.0), (1e9, 0.0)])
SHARES = st.sampled_from([0.0, 0.2, 0.7, 1.0, 1.2])
COMMANDS = st.one_of(
    st.builds(Grab, HANDS, SLOTS, PLACES),
    st.builds(MoveGrab, HANDS, PLACES),
    st.builds(Release, HANDS),
    st.builds(Pin, SLOTS),
    st.builds(Unpin, SLOTS),
    st.builds(CutSprings, st.lists(SLOTS, max_size=3).map(tuple)),
    st.builds(AddParticle, PLACES, mass=st.sampled_from([1.0, 30, -1.0])),
    st.builds(AddSpring, SLOTS, SLOTS, st.sampled_from([None, 0.0, 1.5])),
    st.builds(SetCoefficients, SHARES | st.none(), SHARES | st.none(), st.sampled_from([None, 0, 1, 2, 9])),
    st.builds(SetGravity, PLACES),
    st.builds(
        SetSolver,
        st.sampled_from([None, "single_pass", "iterative", "direct", "magic"]),
        substeps=st.integers(1, 4) | st.just("auto"),
    ),
)


@dataclass
class Entry:
    """A command that was carried out; idle while what it needs is undone."""

    tick: int
    gesture: int
    command: Command
    idle: bool = False


class Model:
    """What a session promises, in the plainest way: every change of history plays it again from the start."""

    def __init__(self, level: Level) -> None:
        self.level = level
        self.log: list[Entry] = []
        self.undone: list[int] = []
        self.ended: set[int] = set()
        self.last_tick = 0
        self.go(0)

    def standing(self) -> list[Entry]:
        return [entry for entry in self.log if entry.gesture not in self.undone]

    def go(self, tick: int) -> None:
        self.world = build_world(self.level)
        while True:
            for entry in self.standing():
                if entry.tick == self.world.tick:
                    entry.idle = not self._carried_out(entry.command)
            if self.world.tick == tick:
                return
            step(self.world)

    def advance(self) -> None:
        if self.world.tick < self.last_tick:
            self.go(self.world.tick + 1)
        else:
            step(self.world)
            self.last_tick += 1

    def obey(self, command: Command, gesture: int) -> None:
        if gesture in self.undone or gesture in self.ended:
            return
        if isinstance(command, Undo):
            self._undo()
        elif isinstance(command, Redo):
            self._redo()
        elif self._carried_out(command):
            self._drop_future()
            if gesture not in {entry.gesture for entry in self.standing()}:
                self.ended |= set(self.undone)
                self.log = self.standing()
                self.undone.clear()
            self.log.append(Entry(self.world.tick, gesture, command))

    def _carried_out(self, command: Command) -> bool:
        try:
            apply(self.world, command)
        except CommandError:
            return False
        return True

    def _undo(self) -> None:
        acted = [entry for entry in self.standing() if entry.tick <= self.world.tick and not entry.idle]
        if not acted:
            return
        self._drop_future()
        last = list(dict.fromkeys(entry.gesture for entry in acted))[-1]
        owners = {entry.command.grab: entry.gesture for entry in acted if isinstance(entry.command, Grab)}
        for hand, owner in owners.items():
            if owner == last and self.world.is_held(hand):
                self.log.append(Entry(self.world.tick, last, Release(hand)))
        self.undone.append(last)
        self.go(self.world.tick)

    def _redo(self) -> None:
        if self.undone and self.world.tick == self.last_tick:
            self.undone.pop()
            self.go(self.world.tick)

    def _drop_future(self) -> None:
        if self.world.tick < self.last_tick:
            self.log = [entry for entry in self.standing() if entry.tick <= self.world.tick and not entry.idle]
            self.undone.clear()
            self.ended.clear()
            self.last_tick = self.world.tick


def _interrupt(done: int, total: int) -> None:
    raise Interrupted


class SessionMachine(RuleBasedStateMachine):
    """Commands good and bad, gestures that overlap, undo, redo, time travel and recordings, in any order."""

    @initialize(level=st.sampled_from([rope_level(), EMPTY]))
    def begin(self, level: Level) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.level, self.session, self.model = level, Session(level), Model(level)
        self.acts: list[tuple[Command, int] | None] = []
        self.travelled = False
        self.files = 0

    def _flush(self) -> None:
        self.session.apply_pending()
        assert all("\n" not in message for message in self.session.messages)

    def _give(self, command: Command, gesture: int) -> None:
        self.acts.append((command, gesture))
        self.session.submit(command, gesture)
        self.model.obey(command, gesture)

    @rule(ticks=st.integers(1, 8))
    def advance(self, ticks: int) -> None:
        for _ in range(ticks):
            self.acts.append(None)
            self.session.advance()
            self.model.advance()

    @rule(command=COMMANDS, back=st.integers(0, 3), paused=st.booleans())
    def act(self, command: Command, back: int, paused: bool) -> None:
        newest = self.session.new_gesture()
        self._give(command, max(1, newest - 2 * back))
        if paused:
            self._flush()

    @rule(hand=st.integers(0, 2), slot=st.sampled_from([1, 5, 11, 16]), ticks=st.integers(1, 4), keep=st.booleans())
    def drag(self, hand: int, slot: int, ticks: int, keep: bool) -> None:
        gesture = self.session.new_gesture()
        self._give(Grab(hand, slot, (1.0, 1.0)), gesture)
        for tick in range(ticks):
            self._give(MoveGrab(hand, (1.0 + tick, 2.0)), gesture)
            self.advance(1)
        if not keep:
            self._give(Release(hand), gesture)

    @rule(command=st.sampled_from([Undo(), Undo(), Redo()]))
    def undo_or_redo(self, command: Command) -> None:
        self._give(command, self.session.new_gesture())
        self._flush()

    @rule(command=st.sampled_from([Undo(), Undo(), Redo()]), after=st.integers(1, 6))
    def give_up(self, command: Command, after: int) -> None:
        """Begin to undo or redo, and give it up after so many ticks, where it takes that many."""
        self._flush()
        session, gesture = self.session, self.session.new_gesture()

        def progress(done: int, total: int) -> None:
            if done == after:
                raise Interrupted

        session.progress = progress
        session.submit(command, gesture)
        try:
            session.apply_pending()
        except Interrupted:
            return
        finally:
            session.progress = None
        self.acts.append((command, gesture))
        self.model.obey(command, gesture)

    @precondition(lambda self: self.session.recording is None)
    @rule(share=st.floats(0.0, 1.0))
    def give_up_seeking(self, share: float) -> None:
        self._flush()
        tick, here = round(share * self.session.last_tick), self.session.tick
        self.session.progress = _interrupt
        try:
            self.session.seek(tick)
        except Interrupted:
            assert self.session.tick == here
        else:
            self.model.go(tick)
            self.travelled = True
        finally:
            self.session.progress = None

    @precondition(lambda self: self.session.recording is None)
    @rule(share=st.floats(0.0, 1.0))
    def seek(self, share: float) -> None:
        self._flush()
        tick = round(share * self.session.last_tick)
        self.session.seek(tick)
        self.model.go(tick)
        self.travelled = True

    @precondition(lambda self: self.session.recording is None)
    @rule(share=st.floats(0.0, 1.0))
    def seek_there_and_back(self, share: float) -> None:
        self._flush()
        here, before = self.session.tick, state_hash(self.session.world)
        self.session.seek(round(share * self.session.last_tick))
        self.session.seek(here)
        assert state_hash(self.session.world) == before

    @rule(beyond=st.sampled_from([-1, 0, 1]))
    def seek_nowhere(self, beyond: int) -> None:
        tick = -1 if beyond < 0 else self.session.last_tick + beyond
        if beyond or self.session.recording:
            with pytest.raises(ValueError, match=r"outside|stop the recording"):
                self.session.seek(tick)

    @rule(suffix=st.sampled_from(["jsonl", "gz"]))
    def record(self, suffix: str) -> None:
        self._flush()
        self._finish()
        self.files += 1
        self.session.record_to(Path(self.folder.name) / f"{self.files}.{suffix}", state_ticks=60)
        self.model._drop_future()

    @rule()
    def stop(self) -> None:
        self._flush()
        self._finish()

    def _finish(self) -> None:
        path = self.session.stop_recording()
        if path is None:
            return
        replay = read_replay(path)
        assert verify(replay) is None
        assert replay.end_hash == state_hash(self.session.world)
        for start in replay.states:
            try:
                assert verify(replay, start=start) is None
            except ReplayError as error:
                assert "undo reaches back" in str(error) or "nothing to redo" in str(error)

    @invariant()
    def the_session_is_where_the_model_is(self) -> None:
        self._flush()
        session, model = self.session, self.model
        assert (session.tick, session.last_tick) == (model.world.tick, model.last_tick)
        assert state_hash(session.world) == state_hash(model.world)
        assert session.world.particle_names == model.world.particle_names
        assert session.world.spring_names == model.world.spring_names
        assert session.can_redo == (bool(model.undone) and model.world.tick == model.last_tick)

    def teardown(self) -> None:
        if not hasattr(self, "folder"):
            return
        with self.folder:
            self.record("jsonl")
            late = self.session.stop_recording()
            assert late is not None
            replay = read_replay(late)
            assert verify(replay) is None
            assert replay.end_hash == state_hash(self.model.world)
            if not self.travelled:
                assert late.read_bytes() == self._recorded_early().read_bytes()

    def _recorded_early(self) -> Path:
        path = Path(self.folder.name) / "early.jsonl"
        session = Session(self.level)
        session.record_to(path, state_ticks=60)
        for act in self.acts:
            if act is None:
                session.advance()
            else:
                session.submit(*act)
        session.apply_pending()
        session.stop_recording()
        return path


@pytest.fixture(autouse=True)
def short_intervals(monkeypatch):
    """Keyframes and stored states every few ticks, and few of them kept, so that short runs meet them."""
    monkeypatch.setattr("sandbox.session.run_history.KEYFRAME_TICKS", 5)
    monkeypatch.setattr("sandbox.session.run_history.KEYFRAME_BUDGET", 25_000)
    monkeypatch.setattr("sandbox.session.replay.format.STATE_TICKS", 7)
    monkeypatch.setattr("sandbox.session.session.PROGRESS_TICKS", 1)


@pytest.mark.slow
@pytest.mark.parametrize("examples", part_and_whole(8, EXAMPLES))
def test_a_session_does_what_its_model_does(examples):
    run_state_machine_as_test(
        SessionMachine, settings=settings(max_examples=examples, stateful_step_count=30, deadline=None)
    )
