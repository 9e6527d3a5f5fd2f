"""What a level lets hands do: all else is refused in one line, and what is counted is part of the state."""

import json

import pytest

from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.parse import parse_level
from sandbox.level.rules.player_limits import DEEDS, MEANINGS
from sandbox.physics.snapshot import state_hash
from sandbox.session.check_run import run_checks
from sandbox.session.commands import (
    COMMAND_TYPES,
    AddParticle,
    CommandError,
    CutSprings,
    Grab,
    Pin,
    Release,
    SetGravity,
    Unpin,
)
from sandbox.session.commands.records import ScriptLine
from sandbox.session.compare.comparison import verify
from sandbox.session.outcome import outcome
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session

LEVEL = {
    "format": "spring-sandbox/level",
    "version": 3,
    "name": "hands",
    "bodies": [
        {"id": "rope", "type": "rope", "start": [0, 5], "end": [3, 5], "segments": 3, "pin": ["start"]},
    ],
    "particles": [{"id": "ball", "position": [5, 5]}],
    "counters": [{"id": "score"}],
    "rules": [{"id": "cut", "when": {"time": 0.1}, "then": [{"cut": "rope:0"}, {"count": "score"}]}],
}


def level(**hands):
    return parse_level(json.dumps(LEVEL | {"hands": hands}).encode(), "hands")


def said(session, *commands):
    """The lines about commands that are given now."""
    session.take_messages()
    for command in commands:
        session.submit(command)
    session.advance()
    return list(session.messages)


def test_hands_are_refused_what_a_level_does_not_list_in_one_line():
    session = Session(level(may=["grab"]))
    ball = session.world.particle_slot("ball")
    assert said(session, Grab(0, ball, (5.0, 6.0))) == []
    assert said(session, Pin(ball), SetGravity((0.0, 0.0))) == [
        "in this level hands may not pin things or let them go", "in this level hands may not change gravity or air",
    ]  # fmt: skip
    assert session.world.inverse_mass[ball] > 0.0 and session.world.settings.gravity == (0.0, -9.81)


def test_what_is_counted_is_refused_once_none_is_left_and_an_undo_gives_it_back():
    session = Session(level(at_most={"add": 2}))
    assert said(session, AddParticle((0.0, 0.0)), AddParticle((1.0, 0.0))) == []
    assert said(session, AddParticle((2.0, 0.0))) == ["not enough parts left"]
    session.undo()
    assert said(session, AddParticle((2.0, 0.0)), AddParticle((3.0, 0.0))) == ["not enough parts left"]
    session.undo()
    session.advance()
    session.redo()
    assert said(session, AddParticle((3.0, 0.0))) == ["not enough parts left"]
    assert session.world.counter.tolist() == [0.0, 0.0]


def test_each_spring_that_is_cut_counts_and_letting_a_pin_go_does_not():
    session = Session(level(at_most={"cut": 2, "pin": 1}))
    ball = session.world.particle_slot("ball")
    assert said(session, CutSprings((0, 1, 2))) == ["not enough cuts left"]
    assert said(session, CutSprings((1, 1, 2)), Pin(ball), Unpin(ball)) == []
    assert said(session, Pin(ball)) == ["not enough pins left"]
    # What cannot be done takes nothing.
    session = Session(level(at_most={"pin": 1}))
    assert len(said(session, Unpin(ball))) == 1 and said(session, Pin(ball)) == []


def test_rules_do_what_hands_may_not_and_keep_their_counters():
    session = Session(level(may=[], at_most={}))
    while session.tick < 20:
        session.advance()
    assert not session.world.spring_active[0] and session.world.counter.tolist() == [1.0]


def test_a_script_is_refused_the_same_with_the_number_of_its_line():
    line = ScriptLine(0, 1, {"type": "pin", "particle": "ball"}, 7)
    with pytest.raises(CommandError, match="line 7: in this level hands may not pin things or let them go"):
        Session(level(may=["grab"]), [line]).advance()


def test_a_recording_holds_what_is_left_and_is_the_same_run(tmp_path):
    session = Session(level(at_most={"add": 3}))
    session.record_to(tmp_path / "run.replay.gz")
    said(session, AddParticle((0.0, 0.0)))
    while session.tick < 90:
        session.advance()
    session.stop_recording()
    replay = read_replay(tmp_path / "run.replay.gz")
    assert verify(replay) is None
    other = Session(level(at_most={"add": 4}))
    said(other, AddParticle((0.0, 0.0)))
    session.seek(1)
    assert state_hash(other.world) != state_hash(session.world)


def test_hands_touch_only_the_bodies_that_a_level_lists_and_what_they_add():
    session = Session(level(bodies=["ball"]))
    ball, start = session.world.particle_slot("ball"), session.world.particle_slot("rope.1")
    assert said(session, Pin(ball), AddParticle((0.0, 0.0))) == []
    assert said(session, Pin(session.world.particle_slot("+.0"))) == []
    assert said(session, Pin(start), CutSprings((1,))) == ['in this level hands may not touch "rope"'] * 2


def test_a_level_keeps_its_hands_when_it_is_written():
    given = level(may=["add", "grab"], bodies=["ball"], at_most={"add": 3})
    assert parse_level(level_text(given).encode(), "again") == given


def test_faults_of_hands_say_where_and_what_to_do():
    with pytest.raises(LevelError) as caught:
        level(may=["grab", "grab"], at_most={"add": 2})
    assert str(caught.value).splitlines() == [
        'hands: hands.may.1: "grab" is listed twice',
        'hands: hands.at_most.add: hands may not do that here; add "add" to may, or take this out',
    ]
    with pytest.raises(LevelError, match=r"hands\.may\.0"):
        level(may=["graab"])
    with pytest.raises(LevelError, match=r'hands\.bodies\.0: there is no body or particle "bal"; did you mean "ball"'):
        level(bodies=["bal"])


def test_every_word_stands_for_commands_and_every_command_but_keys_history_and_paint_has_one():
    meant = [kind for meaning in MEANINGS.values() for kind in meaning.commands]
    assert set(MEANINGS) == set(DEEDS) and len(meant) == len(set(meant))
    assert set(COMMAND_TYPES) - set(meant) == {"set_drive", "hold_key", "undo", "redo", "set_colour"}


def test_rules_and_checks_know_how_many_hands_hold_something():
    asked = [("one", {"metric": "held"}), ("two", {"metric": "held", "at_least": 2, "at_most": 2})]
    rules = [{"id": name, "when": when, "then": [{"count": name}]} for name, when in asked]
    checks = [{"name": "no hand", "metric": "held", "after": 0.1, "at_most": 0}]
    data = LEVEL | {"counters": [{"id": name} for name, _ in asked], "rules": rules, "checks": checks}
    session = Session(parse_level(json.dumps(data).encode(), "held"))
    ball, end = (session.world.particle_slot(name) for name in ("ball", "rope.end"))
    steps = ([], [Grab(0, ball, (5.0, 6.0))], [], [Grab(1, end, (3.0, 6.0))], [Release(1)], [Release(0)])
    counted = []
    for commands in steps:
        assert said(session, *commands) == []
        session.advance()
        counted.append(session.world.counter.tolist())
    assert counted == [[0, 0], [1, 0], [1, 0], [1, 1], [1, 1], [1, 1]]
    assert run_checks(session.level)[0].value == 0.0


def test_stars_go_by_what_hands_have_left():
    rules = [{"id": "win", "when": {"time": 0.1}, "then": [
        {"win": "Built", "stars": {"counter": "Parts left", "second": 1, "third": 2}}]}]  # fmt: skip
    limits = {"hands": {"may": ["add"], "at_most": {"add": 3}}}
    level = parse_level(json.dumps(LEVEL | {"rules": rules} | limits).encode(), "stars")
    earned = []
    for parts in range(4):
        session = Session(level)
        assert said(session, *(AddParticle((float(k), 0.0)) for k in range(parts))) == []
        while outcome(level, session.world) is None:
            session.advance()
        earned.append(outcome(level, session.world).stars)
    assert earned == [3, 3, 2, 1]


def test_a_counter_of_a_budget_that_is_not_there_is_a_fault():
    asks = {"id": "rule", "when": {"counter": "Parts left", "at_most": 0}, "then": [{"say": "None"}]}
    with pytest.raises(LevelError) as refused:
        parse_level(json.dumps(LEVEL | {"rules": [asks]}).encode(), "none")
    assert refused.value.faults == ['none: rules.0.when.counter: there is no counter "Parts left"']
