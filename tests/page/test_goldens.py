"""Goldens that pages play. All of them: make goldens-everywhere."""

from pathlib import Path

import pytest

from sandbox.level.reading.files import shipped_levels
from sandbox.session.checking import solution_of
from tests.page.browser import Browser
from tests.page.goldens import played

SOLUTIONS = [path for path in map(solution_of, shipped_levels()) if path.exists()]
# Their rules act in the course of the run.
ACTING = ("basket_throw", "chain_of_events")
LONGER = ("catapult", "jelly_pile", "tumble_drum")


@pytest.mark.parametrize(
    "name", ["curtain", "wrecking_crane", *(pytest.param(name, marks=pytest.mark.whole_world) for name in LONGER)]
)
def test_a_page_plays_a_golden_bit_for_bit(browser: Browser, tmp_path: Path, name: str) -> None:
    assert played(browser, tmp_path, name).startswith("Verified")


@pytest.mark.parametrize(
    "solution",
    [
        pytest.param(path, marks=() if path.name.startswith(ACTING) else pytest.mark.whole_world, id=path.name)
        for path in SOLUTIONS
    ],
)
def test_a_page_plays_the_solution_of_a_level_whose_rules_act_bit_for_bit(
    browser: Browser, tmp_path: Path, solution: Path
) -> None:
    assert played(browser, tmp_path, solution, None).startswith("Verified")
