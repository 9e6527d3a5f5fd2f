"""A run told again: what pictures of its past are drawn from."""

import pytest

from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import CutSprings, Grab, MoveGrab, Release
from sandbox.session.session import Session
from tests.support.rope_level import rope_level


def played(ticks: int) -> tuple[Session, list[str]]:
    """A run with a drag, a cut, and an undo of the cut; its hashes after each tick, as its history stands at last."""
    session = Session(rope_level())
    drag, cut = session.new_gesture(), session.new_gesture()
    for tick in range(ticks):
        if tick == 10:
            session.submit(Grab(0, 11, (3.0, 1.0)), drag)
        if 10 < tick < 90:
            session.submit(MoveGrab(0, (3.0, 1.0 + 0.02 * tick)), drag)
        if tick == 90:
            session.submit(Release(0), drag)
        if tick == 100:
            session.submit(CutSprings((3,)), cut)
        if tick == 130:
            session.undo()
        session.advance()
    straight, hashes = session.retold(0), []
    while straight.tick < ticks:
        straight.advance()
        hashes.append(state_hash(straight.world))
    return session, hashes


@pytest.mark.parametrize("first", [0, 70, 125])
def test_a_run_told_again_from_any_tick_has_the_bits_of_the_run(first):
    session, hashes = played(150)
    end = state_hash(session.world)
    assert hashes[-1] == end
    twin = session.retold(first)
    assert twin.tick <= first
    while twin.tick < 150:
        twin.advance()
        assert state_hash(twin.world) == hashes[twin.tick - 1]
    assert state_hash(session.world) == end


def test_neither_run_changes_the_other():
    session, hashes = played(70)
    twin = session.retold(0)
    session.submit(CutSprings((5,)))
    for _ in range(30):
        session.advance()
    assert twin.last_tick == 70
    end = state_hash(session.world)
    again = twin.retold(65)
    while again.tick < 70:
        again.advance()
    assert state_hash(again.world) == hashes[-1]
    assert state_hash(session.world) == end and session.can_undo
