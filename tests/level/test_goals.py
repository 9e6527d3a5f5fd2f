"""Shipped levels that ask something: their solutions win them, and time alone does not."""

import pytest

from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.physics.jit import COMPILED
from sandbox.session.outcome import outcome
from sandbox.session.session import Session
from sandbox.session.solution import solution_of, try_goal
from tests.solutions import SOLUTIONS
from tests.support.wholes import some_and_whole

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")

GOALS = [path for path in shipped_levels() if read_level(path).has_goal]
PATIENCE = 60.0  # [s]
# A minute of these takes seconds.
DEAR = ("egg_drop", "chain_of_events")


def test_levels_with_a_goal_are_those_whose_solutions_can_be_recorded_again():
    assert {path.stem for path in GOALS} == set(SOLUTIONS)


@pytest.mark.parametrize("path", GOALS, ids=lambda path: path.stem)
def test_the_solution_of_a_level_wins_it_with_three_stars(path):
    level = read_level(path)
    assert level.goal and solution_of(path).exists()
    result = try_goal(level, path)
    assert result.passed and result.outcome.stars == 3, result.text


@pytest.mark.parametrize(
    "path", some_and_whole([path for path in GOALS if path.stem not in DEAR], GOALS), ids=lambda path: path.stem
)
def test_no_level_is_won_by_waiting(path):
    session = Session(read_level(path))
    while session.tick < PATIENCE * session.level.settings.tick_rate:
        session.advance()
    found = outcome(session.level, session.world)
    assert found is None or not found.is_won
