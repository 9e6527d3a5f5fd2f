"""Looking for a way: hands at random find one that wins, within what hands may do, and the level itself agrees."""

import random
from collections import deque

import pytest

from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.level.rules.player_limits import PlayerLimits
from sandbox.physics.jit import COMPILED
from sandbox.session.looking import Looking, changed
from sandbox.session.outcome import outcome
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from sandbox.session.solution import Proof, solution_of
from tests.session.test_earned_wins import DEEDS, KEYS
from tests.support.rules_level import answering

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")
# Of the processor [s]: no way is looked for so long.
ENOUGH = 600.0


def looked(level, script=(), ticks=0, seconds=ENOUGH):
    looking = Looking(level, script, ticks, seconds)
    deque(looking.work, 0)
    return looking


@pytest.mark.parametrize("name", ["squeeze", "catapult_practice"])
def test_a_way_is_found_from_nothing_and_wins_by_what_hands_may_do(name):
    level = load_level(name)
    looking = looked(level)
    assert looking.found is not None and 0.0 < looking.done < 1.0
    session = Session(level, script=looking.found.script)
    while session.tick < looking.found.ticks:
        session.advance()
    assert outcome(level, session.world) == looking.outcome and looking.outcome.is_won
    assert {line.record["type"] for line in looking.found.script} <= DEEDS[name] | KEYS
    assert Proof(level, looking.found).whole().passed


def test_a_way_is_the_same_each_time():
    first, second = (looked(load_level("catapult_practice")) for _ in range(2))
    assert first.found.script == second.found.script and first.runs == second.runs


def test_where_hands_may_do_nothing_and_nothing_wins_by_itself_none_is_found_and_the_time_is_over():
    level = replaced(load_level("basket_throw"), hands=PlayerLimits(may=()))
    looking = looked(level, seconds=0.3)
    assert looking.found is None and looking.done == 1.0 and looking.runs > 0


def shipped_solution(name):
    return read_replay(solution_of(next(path for path in shipped_levels() if path.stem == name)))


def test_a_solution_is_tried_first_as_it_is():
    level = load_level("squeeze")
    solution = shipped_solution("squeeze")
    looking = looked(level, solution.script, solution.ticks)
    records = [line.record for line in solution.script if line.tick <= looking.found.ticks]
    assert looking.runs == 1 and [line.record for line in looking.found.script] == records


def test_what_is_changed_of_a_script_can_be_played_on():
    solution = shipped_solution("basket_throw")
    chance, script, seen = random.Random(1), solution.script, set()
    for _ in range(60):
        script = changed(script, chance, 60) or solution.script
        assert all(line.tick >= 0 for line in script)
        assert [line.tick for line in script] == sorted(line.tick for line in script)
        seen.add(str(script))
    assert len(seen) > 50


def test_a_level_that_wins_by_itself_is_won_in_its_first_run():
    assert looked(answering()).runs == 1
