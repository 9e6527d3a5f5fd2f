"""A replay that is watched goes by its stored states: soon, to the very bits, and what was passed over can be run."""

import pytest

import sandbox.session.session as session_module
from sandbox.app.run.playback import Playback
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from sandbox.session.commands import AddParticle, CutSprings, Grab, MoveGrab, Pin, Release, Unpin
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.format import decode_state
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.rope_level import rope_level

TICKS, STATE_TICKS = 600, 60
UNDONE_AT = 190


@pytest.fixture(scope="module")
def replay(tmp_path_factory):
    """A recording with hands, pins, a cut, a particle that was added, and in its first third an undo and a redo."""
    path = tmp_path_factory.mktemp("stored") / "run.replay.jsonl"
    session = Session(rope_level())
    session.record_to(path, STATE_TICKS)
    hand = session.new_gesture()
    deeds = {20: Pin(5), 150: Pin(8), 250: Unpin(5), 330: AddParticle((1.0, 1.0)), 400: CutSprings((7,))}
    while session.tick < TICKS:
        tick = session.tick
        if tick in deeds:
            session.submit(deeds[tick])
        if tick == UNDONE_AT:
            session.undo()
        if tick == UNDONE_AT + 5:
            session.redo()
        if tick == 100:
            session.submit(Grab(0, 9, (2.0, 1.0)), hand)
        elif tick == 500:
            session.submit(Release(0), hand)
        elif 100 < tick < 500 and tick % 7 == 0:
            session.submit(MoveGrab(0, (2.0 + 0.001 * tick, 1.0)), hand)
        session.advance()
    session.stop_recording()
    assert not session.messages
    return read_replay(path)


@pytest.fixture
def steps(monkeypatch):
    """The ticks that were stepped."""
    counted = []

    def counting(world):
        step(world)
        counted.append(world.tick)

    monkeypatch.setattr(session_module, "step", counting)
    return counted


def gone_to(playback: Playback, tick: int) -> None:
    playback.seek(tick)
    while playback.travel.target is not None:
        playback.advance(1 / 60)
    assert playback.session.tick == tick
    assert playback.replay.hashes[tick].fits(state_hash(playback.session.world))


def test_any_tick_is_come_to_from_the_stored_state_before_it_and_has_the_recorded_bits(replay, steps):
    playback = Playback(replay.level, replay)
    # Up to the undoing every tick is stepped; from there on only those behind a stored state.
    gone_to(playback, 365)
    # Ticks without commands of their own, which a run that goes there carries out and the recorded hash has not yet.
    for tick in (599, 480, 421, 305, 470, 130, 300, 600, 0, 246):
        before = len(steps)
        gone_to(playback, tick)
        assert len(steps) - before <= STATE_TICKS + 2, tick
    assert playback.session.last_tick == TICKS


def test_what_was_passed_over_keeps_its_commands_can_be_undone_and_changed(replay, tmp_path):
    playback = Playback(replay.level, replay)
    gone_to(playback, 590)
    session, whole = playback.session, Session(replay.level, script=replay.script)
    while whole.tick < 590:
        whole.advance()
    assert [entry.tick for entry in session.gestures] == [entry.tick for entry in whole.gestures]
    for each in (session, whole):
        each.undo()
        each.apply_pending()
    assert state_hash(session.world) == state_hash(whole.world)
    playback.take_over()
    gone = tmp_path / "changed.replay.jsonl"
    playback.seek(450)
    playback.submit(Pin(2))
    playback.apply_pending()
    session.record_to(gone)
    session.advance()
    session.stop_recording()
    changed = read_replay(gone)
    assert changed.ticks == 451 and verify(changed) is None


def test_the_verdict_does_not_speak_of_ticks_that_were_passed_over(replay):
    playback = Playback(replay.level, replay)
    gone_to(playback, 595)
    playback.clock.paused = False
    while not playback.verdict:
        playback.advance(1 / 60)
    assert "some were passed over, all others equal bit for bit" in playback.verdict


def without(replay, *names):
    """The state of tick 300, decoded from a file that does not have these arrays."""
    stored = replay.states[300]
    arrays = {name: text for name, text in stored.arrays.items() if name not in names}
    return decode_state(replay.level, 300, arrays, stored.settings, stored.joined)


def test_what_a_file_of_before_does_not_have_is_as_usual(replay):
    whole = without(replay)
    later = without(replay, "belt", "rolls", "slow_change", "setting_ticks")
    assert whole.arrays.keys() == later.arrays.keys()
    assert not later.belt.any() and later.rolls.all() and later.slow_change.shape == whole.velocity.shape
    assert state_hash(without(replay, "belt", "setting_ticks")) == state_hash(whole)


@pytest.mark.parametrize("names", [("mass",), ("hand_force", "hand_radius", "hand_strength")])
def test_a_state_without_what_none_goes_without_is_refused(replay, names):
    with pytest.raises(ValueError, match=r"state: (the arrays are|hand_strength, .* are not equally long)"):
        without(replay, *names)
