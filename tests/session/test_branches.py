import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.physics.snapshot import state_hash, take
from sandbox.physics.step import step
from sandbox.session.commands import CutSprings, Grab, MoveGrab, Pin, Release, SetCoefficients
from sandbox.session.run_history import KEYFRAME_TICKS, Keyframe, Keyframes
from sandbox.session.session import Session
from tests.session.test_breaks_and_drives import busy_level
from tests.support.rope_level import rope_level


@pytest.fixture
def session() -> Session:
    return Session(rope_level())


def _advance(session: Session, ticks: int) -> None:
    for _ in range(ticks):
        session.advance()


def _drag(session: Session) -> None:
    """A particle is held for 30 ticks."""
    gesture = session.new_gesture()
    session.submit(Grab(0, 6, (3.0, 1.0)), gesture)
    for tick in range(30):
        session.submit(MoveGrab(0, (3.0, 1.0 + 0.05 * tick)), gesture)
        session.advance()
    session.submit(Release(0), gesture)


def test_what_followed_is_a_branch_that_can_be_returned_to(session):
    _drag(session)
    _advance(session, 100)
    first = state_hash(session.world)
    session.seek(40)
    session.submit(Pin(4))
    _advance(session, 90)
    second = state_hash(session.world)
    (branch,) = session.branches
    assert (branch.tick, branch.last_tick) == (40, 130)
    session.return_to(branch)
    assert (session.tick, session.last_tick) == (40, 130)
    _advance(session, 90)
    assert state_hash(session.world) == first
    (other,) = session.branches
    session.return_to(other)
    session.seek(session.last_tick)
    assert state_hash(session.world) == second
    session.undo()
    session.apply_pending()
    assert session.world.inverse_mass[4] > 0.0


def test_branches_that_fork_from_branches_all_stay_what_they_were(session):
    ends = {}
    for number, back in enumerate((0, 70, 20, 45, 10)):
        session.seek(min(back, session.last_tick))
        session.submit(Pin(3 + number) if number else Pin(8))
        _advance(session, 100)
        ends[session.last_tick] = state_hash(session.world)
    for _ in range(3):
        for branch in session.branches:
            session.return_to(branch)
            session.seek(session.last_tick)
            assert state_hash(session.world) == ends[session.last_tick]


def test_a_branch_that_is_no_longer_kept_is_refused(session):
    _advance(session, 5)
    for _ in range(12):
        session.seek(2)
        session.submit(SetCoefficients(0.5))
        _advance(session, 2)
    oldest = session.branches[0]
    session.seek(2)
    session.submit(SetCoefficients(0.6))
    session.apply_pending()
    with pytest.raises(ValueError, match="branch is gone"):
        session.return_to(oldest)


def test_what_goes_on_in_the_past_has_commands_that_end_it(session):
    _drag(session)
    _advance(session, 10)
    session.seek(15)
    assert session.going() == [Release(0)]
    session.seek(session.last_tick)
    assert session.going() == []


def test_going_back_tick_by_tick_steps_a_span_again_once(session, monkeypatch):
    hashes = []
    for _ in range(130):
        hashes.append(state_hash(session.world))
        session.advance()
    steps = []
    monkeypatch.setattr("sandbox.session.session.step", lambda world, real=step: (steps.append(1), real(world)))
    for tick in range(119, 60, -1):
        session.seek(tick)
        assert state_hash(session.world) == hashes[tick]
    assert len(steps) == 59


def test_keyframes_keep_once_what_does_not_change():
    world = build_world(rope_level())
    frames = Keyframes(Keyframe(0, take(world)))
    for _ in range(KEYFRAME_TICKS):
        step(world)
    frames.note_tick(world, 0)
    first, second = frames
    assert second.snapshot.arrays["rest_length"] is first.snapshot.arrays["rest_length"]
    assert second.snapshot.arrays["position"] is not first.snapshot.arrays["position"]


def test_the_ticks_in_which_springs_broke_follow_history():
    session = Session(busy_level())
    _advance(session, 240)
    ticks = session.breaks
    assert ticks
    session.seek(ticks[0] - 1)
    assert session.breaks == ticks
    session.submit(CutSprings(tuple(range(4))))
    session.apply_pending()
    assert session.breaks == ()
    session.return_to(session.branches[0])
    assert session.breaks == ticks
