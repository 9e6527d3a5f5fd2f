"""Goldens that pages play. All of them: make goldens-everywhere."""

from pathlib import Path

import pytest

from sandbox.level.reading.files import shipped_levels
from sandbox.session.solution import solution_of
from tests.page.browser import Browser
from tests.page.goldens import played
from tests.support.wholes import some_and_whole

SOLUTIONS = [path for path in map(solution_of, shipped_levels()) if path.exists()]
# Its rules act in the course of the run.
ACTING = "basket_throw"


def _name(path: Path) -> str:
    return path.name


@pytest.mark.parametrize(
    "name", some_and_whole(("curtain",), ("curtain", "wrecking_crane", "catapult", "jelly_pile", "tumble_drum"))
)
def test_a_page_plays_a_golden_bit_for_bit(browser: Browser, tmp_path: Path, name: str) -> None:
    assert played(browser, tmp_path, name).startswith("Verified")


@pytest.mark.parametrize(
    "solution", some_and_whole([path for path in SOLUTIONS if path.name.startswith(ACTING)], SOLUTIONS), ids=_name
)
def test_a_page_plays_the_solution_of_a_level_whose_rules_act_bit_for_bit(
    browser: Browser, tmp_path: Path, solution: Path
) -> None:
    assert played(browser, tmp_path, solution, None).startswith("Verified")
