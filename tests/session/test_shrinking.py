"""Failing recordings become small, and the failure stays the same one."""

import json
import signal

import numpy as np
import pytest

import sandbox.session.session as session_module
from sandbox.cli import main
from sandbox.level.reading.files import level_data
from sandbox.physics.step import step
from sandbox.replay import (
    CheckFails,
    Crashes,
    Diverges,
    EnergyGrows,
    FailureError,
    IsLost,
    Leaves,
    find_failure,
    read_replay,
    verify,
)
from sandbox.session.commands import Grab, MoveGrab, Pin, Push, Release, SetGravity
from sandbox.session.commands.records import ScriptLine
from sandbox.session.compare.rollback import RandomHands
from sandbox.session.session import Session
from sandbox.session.shrink.passes import Play
from sandbox.session.shrink.shrinker import Shrinker, shrinker_against, shrinker_of
from tests.support.interrupts import interrupts
from tests.support.planted import CASES, edited
from tests.support.rope_level import rope_level
from tests.support.wholes import some_and_whole
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

# A gesture of these is the cause; some need a second one.
MOST_GESTURES = 3
# Cases of every run of tests.
QUICK = (5, 6, 9)
LOW = [{"name": "high", "metric": "y", "particle": "rope.end", "always": [0, 20], "at_least": -7.0}]


def shrunk(shrinker, processes=1):
    for _ in shrinker.steps(processes):
        pass
    return shrinker.smallest


@pytest.fixture
def recorded(tmp_path):
    """A function that records a rope of which random hands drag, and pull it down late in the run."""

    def record(name="walk.replay.gz", level=None, ticks=500, act=None):
        session = Session(level or rope_level(checks=LOW))
        session.record_to(tmp_path / name)
        hands = RandomHands(session, 5)
        while session.tick < ticks:
            if act is not None:
                act(session)
            elif session.tick == 400:
                session.submit(Push((4.0, -4.0), 9.0, (0.0, -400.0)))
            hands.act()
            session.advance()
        assert session.stop_recording()
        return tmp_path / name

    return record


@pytest.mark.parametrize(
    "number",
    some_and_whole(QUICK, range(len(CASES))),
    ids=lambda number: f"{number} {CASES[number].name}",
)
def test_of_a_minute_of_random_play_the_gestures_are_left_that_cause_the_failure(number, tmp_path):
    case = CASES[number]
    failure = case.failure(case.record(tmp_path / "run.replay.gz"))
    shrinker = shrinker_of(read_replay(tmp_path / "run.replay.gz"), failure)
    assert shrinker.seen is not None and len(shrinker.original.gestures) > 30
    same = shrinker.seen.failure
    smallest = shrunk(shrinker)
    assert len(smallest.gestures) <= MOST_GESTURES and len(smallest.lines) <= 3 * MOST_GESTURES
    assert shrinker.seen.failure == same and Shrinker(shrinker.level, smallest, same).seen == shrinker.seen
    for gesture in smallest.gestures:
        assert Shrinker(shrinker.level, smallest.without_gestures({gesture}), same).seen is None


@pytest.mark.whole_world
def test_any_number_of_processes_finds_the_same(tmp_path):
    case = CASES[8]
    failure = case.failure(case.record(tmp_path / "run.replay.gz"))
    replay = read_replay(tmp_path / "run.replay.gz")
    assert shrunk(shrinker_of(replay, failure), 1).key == shrunk(shrinker_of(replay, failure), 2).key


def test_undone_gestures_and_undoing_go(recorded):
    def act(session):
        if session.tick % 40 == 5:
            session.submit(Pin(5 + session.tick // 100))
        if session.tick % 40 == 15:
            session.undo()
        if session.tick % 80 == 25:
            session.redo()
        if session.tick == 460:
            session.submit(SetGravity((0.0, -300.0)))

    path = recorded(act=act)
    smallest = shrunk(shrinker_of(read_replay(path), CheckFails("high")))
    assert len(smallest.lines) == 1 and smallest.lines[0].record["type"] not in ("undo", "redo")


def test_moves_are_thinned_and_numbers_rounded(recorded):
    def act(session):
        if session.tick == 100:
            session.submit(Grab(3, session.world.particle_slot("rope.end"), (5.4321, 0.0987), 812.3456), 77)
        if 100 < session.tick < 200:
            session.submit(MoveGrab(3, (5.4321, 0.0987 - 0.11 * (session.tick - 100))), 77)
        if session.tick == 200:
            session.submit(Release(3), 77)

    smallest = shrunk(shrinker_of(read_replay(recorded(act=act)), CheckFails("high")))
    assert len(smallest.gestures) == 1 and len(smallest.lines) <= 2
    for line in smallest.lines:
        assert all(number == round(number, 2) for number in line.record["target"])
    assert smallest.ticks < 100


def test_a_divergence_stays_in_its_array(recorded):
    level = rope_level()
    other = edited(level, materials__rubber={"stiffness": 0.05, "damping": 0.1, "tension_limit": 0.9})
    path = recorded(level=level, act=lambda session: session.submit(Push((1.0, 3.0), 4.0, (900.0, 0.0)))
                    if session.tick == 300 else None)  # fmt: skip
    shrinker = shrinker_of(read_replay(path), Diverges(other))
    assert shrinker.seen.failure.array == "spring_active"
    smallest = shrunk(shrinker)
    assert len(smallest.gestures) <= 1 and shrinker.seen.failure.array == "spring_active"
    assert find_failure(read_replay(path), Diverges(level)) is None
    assert "from where it is on the other level" in str(find_failure(read_replay(path), Diverges(other, apart=0.5)))


def test_an_exception_is_a_failure_of_its_place(recorded, monkeypatch):
    path = recorded()

    def breaks(world):
        if float(np.max(np.abs(world.velocity))) > 25.0:
            raise ZeroDivisionError("too fast")
        step(world)

    monkeypatch.setattr(session_module, "step", breaks)
    shrinker = shrinker_of(read_replay(path), Crashes())
    assert str(shrinker.seen.failure) == "it crashes: ZeroDivisionError in breaks"
    smallest = shrunk(shrinker)
    assert len(smallest.gestures) == 1 and smallest.ticks < 400
    assert find_failure(read_replay(path), Crashes("KeyError in breaks")) is None


def test_energy_that_comes_from_nothing_is_found_and_a_hand_that_works_is_none(recorded, monkeypatch):
    path = recorded()
    assert find_failure(read_replay(path), EnergyGrows(100.0)) is None

    def pushes(world):
        step(world)
        if world.position[world.particle_slot("rope.end"), 1] < -5.8:
            world.velocity[world.particle_slot("rope.end"), 0] += 30.0

    monkeypatch.setattr(session_module, "step", pushes)
    shrinker = shrinker_of(read_replay(path), EnergyGrows(100.0))
    assert "by itself" in str(shrinker.seen)
    assert len(shrunk(shrinker).gestures) <= 1


def test_what_a_level_has_not_is_said(recorded):
    replay = read_replay(recorded(ticks=10))
    for failure, words in (
        (CheckFails("deep"), 'there is no check "deep"; it has "high"'),
        (Leaves(), "no view"),
        (IsLost(), "no rule of the level loses it"),
    ):
        with pytest.raises(FailureError, match=words):
            find_failure(replay, failure)


def test_the_command_line_writes_a_recording_and_a_test_that_fails_until_the_level_is_mended(
    recorded, tmp_path, monkeypatch, capsys, pytester
):
    path = recorded()
    monkeypatch.chdir(tmp_path)
    level = rope_level(checks=LOW)
    (tmp_path / "levels").mkdir()
    file = tmp_path / "levels" / "rope.json"
    file.write_text(json.dumps(level_data(level)))
    assert main(["shrink", path.name, "--processes", "1"]) == 0
    told = capsys.readouterr().out
    assert 'the check "high" fails' in told and "to    1 gesture, 1 command" in told
    assert "the test runs on levels/rope.json" in told
    smallest = read_replay(tmp_path / "walk.smallest.replay.gz")
    assert verify(smallest) is None and len(smallest.script) == 1
    test = [*LOADED, tmp_path / "test_walk_smallest.py"]
    failed = pytester.runpytest_inprocess(*test)
    assert failed.ret == 1 and "high: FAILS: y of rope.end" in failed.stdout.str()
    file.write_text(file.read_text().replace("-7.0", "-1000.0"))
    assert pytester.runpytest_inprocess(*test).ret == 0


def test_an_interrupt_keeps_the_smallest_until_then(recorded, tmp_path, monkeypatch, capsys):
    path = recorded()
    whole = Shrinker.steps

    def interrupted(self, processes=1):
        for number, _ in enumerate(whole(self, processes)):
            yield
            if number == 3:
                raise KeyboardInterrupt

    monkeypatch.setattr(Shrinker, "steps", interrupted)
    with interrupts(signal.default_int_handler):
        assert main(["shrink", str(path), "--json", "--processes", "1"]) == 130
    told = json.loads(capsys.readouterr().out)
    assert told["interrupted"] and told["to"]["gestures"] < told["from"]["gestures"]
    assert len(read_replay(tmp_path / "walk.smallest.replay.gz").script) == told["to"]["commands"]


def test_what_does_not_fail_is_refused_with_what_was_looked_for(recorded, capsys):
    path = recorded(ticks=100, level=rope_level(checks=LOW))
    assert main(["shrink", str(path)]) == 2
    told = capsys.readouterr().err
    assert 'the check "high" fails' in told and "it ends after" in told and "measures until 20 s" in told
    assert main(["shrink", str(path), "--crash", "--lost"]) == 2
    assert main(["shrink", str(path), "--apart", "1"]) == 2
    assert main(["shrink", str(path), "-o", "x.json"]) == 2
    assert "one failure at a time" in capsys.readouterr().err


def test_a_play_says_where_it_parts_from_another():
    lines = tuple(ScriptLine(tick, tick, {"type": "pin", "particle": f"rope.{tick}"}, 1) for tick in (0, 10, 20))
    play, shorter = Play(lines, 50), Play(lines[:2], 50)
    assert play.parting(shorter) == 20 and play.parting(play) is None
    assert [line.tick for line in play.without_ticks(5, 10).lines] == [0, 5, 10]
    assert play.without_ticks(5, 10).parting(play) == 5
    assert shorter.size < play.without_ticks(5, 10).size < play.size


def test_what_leaves_a_box_stays_the_same_thing_on_the_same_side(recorded, tmp_path, capsys):
    def act(session):
        if session.tick == 20:
            session.submit(Push((4.0, 0.0), 3.0, (900.0, 0.0)))
        if session.tick == 80:
            session.submit(SetGravity((-30.0, 0.0)))

    path = recorded(act=act, ticks=200)
    assert find_failure(read_replay(path), Leaves((-1.5, -99.0, 5.6, 99.0), "soft")).failure.side == "left"
    assert main(["shrink", str(path), "--leaves=-1.5,-99,5.6,99", "--processes", "1"]) == 0
    told = capsys.readouterr().out
    seen = find_failure(read_replay(path), Leaves((-1.5, -99.0, 5.6, 99.0)))
    assert f"\n  in the recording: {seen}\n" in told and f"{seen.failure.thing} leaves the box" in told
    smallest = find_failure(read_replay(tmp_path / "walk.smallest.replay.gz"), Leaves((-1.5, -99.0, 5.6, 99.0)))
    assert smallest.failure == seen.failure
    assert f'"{seen.failure.thing}", side="{seen.failure.side}")' in (tmp_path / "test_walk_smallest.py").read_text()


def test_the_rule_that_loses_stays_the_same(tmp_path):
    rules = [
        {"id": side, "when": {"metric": "x", "particle": "rope.end", bound: at}, "then": [{"fail": side}]}
        for side, bound, at in (("right", "at_least", 5.51), ("left", "at_most", 4.0))
    ]
    level = rope_level(rules=rules)
    session = Session(level)
    session.record_to(tmp_path / "run.replay.gz")
    session.submit(SetGravity((200.0, -9.81)))
    for _ in range(200):
        session.advance()
        if session.tick == 60:
            session.submit(SetGravity((-50.0, 0.0)))
    session.stop_recording()
    shrinker = shrinker_of(read_replay(tmp_path / "run.replay.gz"), IsLost())
    assert shrinker.seen.failure == IsLost("right") and "right" in str(shrinker.seen.failure)
    smallest = shrunk(shrinker)
    assert shrinker.seen.failure == IsLost("right") and len(smallest.lines) == 1
    # By itself the rope falls to the left.
    assert Shrinker(level, Play((), 200), IsLost()).seen.failure == IsLost("left")


def test_on_an_edited_level_it_shrinks_to_what_people_see(recorded, tmp_path, capsys):
    def act(session):
        if session.tick == 100:
            session.submit(Push((1.0, 3.0), 4.0, (900.0, 0.0)))

    path = recorded(level=rope_level(), ticks=200, act=act)
    weaker = edited(rope_level(), materials__rubber={"stiffness": 0.05, "damping": 0.1, "tension_limit": 2.0})
    (tmp_path / "weaker.json").write_text(json.dumps(level_data(weaker)))
    assert main(["shrink", str(path), "--against", str(tmp_path / "weaker.json"), "--processes", "1"]) == 0
    told = capsys.readouterr().out
    assert "a particle comes more than 0.001 m away from where it is on the other level" in told
    assert "  in the recording: tick " in told and '"type": "push"' in told
    # What nobody sees is told in its first bit.
    other = edited(rope_level(), materials__rubber={"stiffness": 0.05, "damping": 0.1 + 1e-12})
    assert shrinker_against(read_replay(path), other).seen.failure.apart is None
