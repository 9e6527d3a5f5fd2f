"""Whatever value an argument of a Session's method is given, it raises and names it, or the run goes on."""

import pytest

from sandbox import Session, build_world, contacts, outlines, run_checks, state_hash, step
from sandbox.session.commands import CommandError, Pin
from tests.support.bad_values import BAD, RAISED, bad_calls, called, public_methods
from tests.support.rope_level import rope_level

METHODS = public_methods(Session)


def right(session, folder):
    """Right values of each argument."""
    path = folder / "run.replay.jsonl"
    return {
        "adopt": {"state": session.snapshot()},
        "attempt": {"record": {"type": "pin", "particle": "rope.4"}, "gesture": 5},
        "come_to": {"state": session.snapshot(), "lines": []},
        "do": {"command": "pin", "gesture": 5, "particle": "rope.4"},
        "keyframes": {"first": 0, "last": 3},
        "record_to": {"path": path, "state_ticks": 30},
        "retold": {"tick": 3},
        "return_to": {"branch": session.branches[0]},
        "save_to": {"path": path},
        "seek": {"tick": 3},
        "step_again": {"state": session.keyframes(0, 0)[0]},
        "submit": {"command": Pin(4), "gesture": 5},
    }


def ran():
    """A run that has another end than it had first."""
    session = Session(rope_level())
    for _ in range(6):
        session.advance()
    session.seek(3)
    session.do(Pin(5))
    for _ in range(3):
        session.advance()
    return session


def told(session):
    """All that a run would tell of itself."""
    return state_hash(session.world), session.last_tick, session.gestures, session.branches, session.messages


def test_each_method_of_the_class_is_tried(tmp_path):
    assert METHODS.keys() == right(ran(), tmp_path).keys()


@pytest.mark.parametrize("method", METHODS)
def test_each_argument_raises_by_name_and_changes_nothing_or_the_run_goes_on(method, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    session = ran()
    called(session, method, right(session, tmp_path)[method])
    session = ran()
    for argument, value, act in bad_calls(method, METHODS[method], right(session, tmp_path)[method]):
        before = told(session)
        try:
            act(session)
        except CommandError as error:
            assert str(error) and told(session) == before, f"{argument} = {value!r:.60}"
        except (OSError, *RAISED) as error:
            assert argument in str(error) or isinstance(error, OSError), f"{argument} = {value!r:.60}: {error!r}"
            assert told(session) == before, f"{argument} = {value!r:.60}: {error!r}"
        else:
            session.stop_recording()
            session.advance()
            session = ran()


@pytest.mark.parametrize("argument", ["level", "script", "start"])
def test_a_session_of_nothing_is_refused_by_name(argument):
    for value in BAD:
        given = {"level": rope_level(), argument: value}
        try:
            Session(**given).advance()
        except RAISED as error:
            assert argument in str(error).lower(), f"{argument} = {value!r:.60}: {error!r}"


@pytest.mark.parametrize(
    ("function", "argument"),
    [(step, "world"), (contacts, "world"), (outlines, "world"), (build_world, "level"), (run_checks, "level")],
)
def test_functions_of_a_world_or_a_level_say_what_is_none(function, argument):
    for value in BAD:
        with pytest.raises(ValueError, match=f"^{argument} "):
            function(value)
