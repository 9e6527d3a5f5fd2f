"""The history of a run is one object: a copy holds all of it, and what is given up leaves it as it was."""

from dataclasses import fields

import pytest

from sandbox.level.reading.files import load_level
from sandbox.session.commands import Pin, Unpin
from sandbox.session.run_history import RunHistory
from sandbox.session.session import Session
from sandbox.session.transaction import Interrupted


@pytest.fixture
def session():
    """A run with gestures that count, one that is undone, a branch, and a few keyframes."""
    made = Session(load_level("rope"))
    rope = made.world.particle_slot("rope.5")
    for command in (Pin(rope), Unpin(rope), Pin(rope)):
        made.submit(command)
        for _ in range(70):
            made.advance()
    made.seek(100)
    made.submit(Pin(rope + 1))
    for _ in range(30):
        made.advance()
    made.undo()
    made.advance()
    return made


def contents(history):
    """Every field, as values that can be compared; of states only their place."""
    found = {each.name: getattr(history, each.name) for each in fields(history)}
    found["keyframes"] = [(kept.order, kept.tick) for kept in history.keyframes]
    found["reached"] = len(history.reached._kept)
    return {name: value.copy() if hasattr(value, "copy") else value for name, value in found.items()}


def test_a_copy_has_every_field_and_changes_of_the_run_do_not_reach_it(session):
    assert session.history.done and session.history.undone and session.history.branches
    copy = session.history.copy()
    before = contents(copy)
    assert before == contents(session.history)
    session.redo()
    session.advance()
    session.submit(Unpin(session.world.particle_slot("rope.5")))
    session.advance()
    assert contents(copy) == before != contents(session.history)


def test_no_field_that_changes_in_place_is_shared_with_a_copy(session):
    history = session.history
    copy = history.copy()
    shared = [each.name for each in fields(RunHistory) if getattr(copy, each.name) is getattr(history, each.name)]
    assert set(shared) <= {"last_tick", "last_gesture", "next_order", "scripted"}
    assert all(copy.entries[gesture] is not history.entries[gesture] for gesture in history.entries)


def test_an_undo_that_is_given_up_leaves_every_field_as_it_was(session):
    def give_up(done, total):
        raise Interrupted

    before = contents(session.history)
    state = session.snapshot().position.copy()
    session.progress = give_up
    session.undo()
    with pytest.raises(Interrupted):
        session.apply_pending()
    session.progress = None
    after = contents(session.history)
    # The number of a gesture that was given out is not given out again.
    assert after.pop("last_gesture") >= before.pop("last_gesture")
    assert after == before and (session.snapshot().position == state).all()
