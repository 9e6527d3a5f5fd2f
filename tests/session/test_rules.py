"""Rules: when they fire, what their actions do, and that they follow from the state alone."""

import json
import random

import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import state_hash, take
from sandbox.replay import read_replay, verify
from sandbox.session.commands import CutSprings, Grab, MoveGrab, Release
from sandbox.session.outcome import outcome
from sandbox.session.session import Session
from tests.support import rules_level

BALL = {"id": "ball", "position": [0, 0], "radius": 0.1}


def still(**parts):
    """A session of a level without gravity, with a ball at the origin."""
    data = {"format": "spring-sandbox/level", "version": 3, "name": "still", "settings": {"gravity": [0, 0]}}
    return Session(parse_level(json.dumps(data | {"particles": [BALL]} | parts).encode(), "still"))


def run(session, ticks):
    for _ in range(ticks):
        session.advance()
    return session.world


def rule(name, when, *then, **fields):
    return {"id": name, "when": when, "then": list(then) or [{"say": name}], **fields}


NOW = {"time": 0.0}


def test_a_rule_whose_question_holds_from_the_start_fires_at_the_end_of_the_first_tick():
    world = run(still(rules=[rule("now", NOW)]), 3)
    assert (world.rule_first.tolist(), world.rule_fired.tolist()) == ([1], [1])


@pytest.mark.parametrize(("seconds", "tick"), [(0.0, 1), (0.5, 31), (1.0, 61)])
def test_a_rule_fires_once_its_question_has_held_for_so_long(seconds, tick):
    world = run(still(rules=[rule("held", NOW, for_seconds=seconds)]), 70)
    assert (world.rule_first.tolist(), world.rule_fired.tolist()) == ([tick], [1])


def test_actions_act_from_the_next_tick_on_so_that_a_chain_takes_a_tick_a_link():
    # The last link stands first in the file.
    counters = [{"id": "a"}, {"id": "b"}]
    rules = [
        rule("third", {"counter": "b", "at_least": 1}),
        rule("second", {"counter": "a", "at_least": 1}, {"count": "b"}),
        rule("first", NOW, {"count": "a"}, for_seconds=0.5),
    ]
    world = run(still(counters=counters, rules=rules), 40)
    assert world.rule_first.tolist() == [33, 32, 31]


def test_two_rules_that_set_each_other_off_take_a_tick_a_round():
    swings = [
        rule("up", {"counter": "a", "at_most": 0}, {"count": "a"}),
        rule("down", {"counter": "a", "at_least": 1}, {"count": "a", "by": -1}),
    ]
    world = run(still(counters=[{"id": "a"}], rules=swings), 120)
    assert world.rule_fired.tolist() == [60, 60]


def test_a_rule_of_once_acts_once_and_others_each_time_that_their_question_holds_anew():
    bounce = {"position": [0, 0.5], "velocity": [0, -3], "restitution": 1.0}
    touching = {"touches": ["ball", "walls"]}
    session = still(
        particles=[BALL | bounce],
        walls={"box": [-1, 0, 1, 1]},
        counters=[{"id": "hits"}],
        rules=[rule("each", touching, {"count": "hits"}), rule("one", touching, once=True)],
    )
    world = run(session, 240)
    assert world.rule_fired[1] == 1 and world.rule_fired[0] == world.counter[0] > 5


@pytest.mark.parametrize("speed", [5.0, 33.0, 97.0, 1000.0])
def test_nothing_is_so_fast_that_it_crosses_a_zone_unseen(speed):
    shapes = [{"box": [4.9, -1, 5.1, 1]}, {"circle": [5, 0, 0.1]}, {"polygon": [[4.9, -1], [5.1, 0], [4.9, 1]]}]
    zones = [{"id": f"z{k}", **shape} for k, shape in enumerate(shapes)]
    rules = [rule(f"r{k}", {"crosses": f"z{k}", "particle": "ball"}) for k in range(3)]
    session = still(particles=[BALL | {"velocity": [speed, 0]}], zones=zones, rules=rules)
    world = run(session, 80)
    assert world.rule_fired.tolist() == [1, 1, 1]
    assert all(abs(first - 60 * 5.0 / speed) <= 3 for first in world.rule_first)


def test_the_whole_body_must_be_inside_a_zone():
    bodies = [{"id": "line", "type": "rope", "start": [-1, 0], "end": [1, 0], "segments": 2}]
    zones = [{"id": "all", "box": [-2, -1, 2, 1]}, {"id": "part", "box": [0.5, -1, 2, 1]}]
    rules = [rule(each["id"], {"metric": "inside", "body": "line", "zone": each["id"]}) for each in zones]
    assert run(still(bodies=bodies, zones=zones, rules=rules), 2).rule_fired.tolist() == [1, 0]


def test_every_kind_of_rule_fires_in_the_level_that_has_them():
    session = Session(rules_level.answering())
    rules_level.run(session)
    fired = {rule.id: int(session.world.rule_fired[k]) for k, rule in enumerate(session.level.rules)}
    assert fired.pop("lost") == 0 and all(fired.values()), fired
    found = outcome(session.level, session.world)
    assert (found.is_won, found.text, found.stars) == (True, "In!", 2)


def test_the_outcome_that_came_first_counts_and_of_two_in_a_tick_the_first_in_the_file():
    endings = [
        rule("late", {"time": 0.5}, {"win": "late"}),
        rule("a", NOW, {"fail": "a"}),
        rule("b", NOW, {"win": "b"}),
    ]
    session = still(rules=endings)
    assert outcome(session.level, session.world) is None
    run(session, 60)
    assert outcome(session.level, session.world).text == "a"


@pytest.mark.parametrize(("bounds", "stars"), [((1.0, 0.4), 2), ((0.2, 0.1), 1), ((2, 1), 3)])
def test_stars_are_earned_by_the_time_of_the_win(bounds, stars):
    win = {"win": "", "stars": {"second": bounds[0], "third": bounds[1]}}
    session = still(rules=[rule("goal", {"time": 0.5}, win)])
    run(session, 60)
    assert outcome(session.level, session.world).stars == stars


def test_stars_by_a_counter_are_those_of_the_moment_of_the_win():
    win = {"win": "", "stars": {"counter": "score", "second": 2, "third": 5}}
    rules = [rule("goal", {"time": 0.5}, win), rule("more", {"time": 0.7}, {"count": "score", "by": 9})]
    session = still(counters=[{"id": "score", "start": 3}], rules=rules)
    run(session, 60)
    assert session.world.counter.tolist() == [12.0]
    assert outcome(session.level, session.world).stars == 2


def test_an_action_on_what_is_gone_does_nothing():
    bodies = [{"id": "line", "type": "rope", "start": [-1, 0], "end": [1, 0], "segments": 2}]
    cuts = [rule(str(k), {"time": 0.1 * k}, {"cut": "line"}, {"unpin": "ball"}) for k in range(1, 4)]
    session = still(bodies=bodies, rules=cuts)
    session.submit(CutSprings((0,)))
    world = run(session, 60)
    assert not world.spring_active[:2].any() and not session.messages


def random_run(level, seed, ticks=168):
    """A run with random hands, and its hash at each tick."""
    chance, session = random.Random(seed), Session(level)
    hashes = {}
    for _ in range(ticks):
        tick = session.tick
        for command in rules_level.hands(tick):
            session.submit(command)
        if tick % 40 == 10:
            session.submit(Grab(0, session.world.particle_slot("ball"), (0.0, 3.0)), gesture := session.new_gesture())
        if tick % 40 in range(11, 30):
            session.submit(MoveGrab(0, (chance.uniform(-2, 2), chance.uniform(1, 5))), gesture)
        if tick % 40 == 30:
            session.submit(Release(0), gesture)
        if tick == 100:
            session.submit(CutSprings((chance.randrange(5),)))
        session.advance()
        hashes[session.tick] = state_hash(session.world)
    return session, hashes


@pytest.mark.parametrize("seed", range(6))
def test_undo_redo_and_seek_lead_to_the_same_bits(seed):
    session, hashes = random_run(rules_level.answering(), seed)
    last = session.tick
    for _ in range(3):
        session.undo()
    session.apply_pending()
    for _ in range(3):
        session.redo()
    session.apply_pending()
    assert state_hash(session.world) == hashes[last]
    chance = random.Random(seed)
    for tick in chance.sample(range(1, last), 12):
        session.seek(tick)
        if tick % 40 not in range(10, 31) and tick not in (rules_level.KEY_DOWN, rules_level.KEY_UP, 100):
            assert state_hash(session.world) == hashes[tick], tick


def test_a_run_goes_on_from_any_snapshot_to_the_same_bits():
    level = rules_level.answering()
    whole = Session(level)
    starts, hashes = [], []
    while whole.tick < rules_level.TICKS:
        if whole.tick % 17 == 0:
            starts.append(take(whole.world))
        rules_level.run(whole, whole.tick + 1)
        hashes.append(state_hash(whole.world))
    for start in starts:
        session = Session(level, start=start)
        rules_level.run(session)
        assert state_hash(session.world) == hashes[-1], start.tick


def test_a_recording_holds_what_a_person_did_and_nothing_of_the_rules(tmp_path):
    session = Session(rules_level.answering())
    session.record_to(tmp_path / "run.replay.gz")
    rules_level.run(session)
    session.stop_recording()
    replay = read_replay(tmp_path / "run.replay.gz")
    assert [line.record["type"] for line in replay.script] == ["hold_key", "hold_key"]
    assert verify(replay) is None
