"""Every shipped level with a goal is won in a page by what people do there: by mouse and keys, and by fingers alone."""

from itertools import product
from pathlib import Path

import pytest

from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.page.start import is_done_by_pages
from sandbox.replay import read_replay, verify
from sandbox.session.solution import solution_of
from tests.page.browser import Browser
from tests.page.deeds import ByFinger, ByMouse, Player
from tests.page.levels import level_page
from tests.page.opened import opened, saved
from tests.page.pointing import text
from tests.solutions import SOLUTIONS
from tests.support.wholes import some_and_whole

PHONE = {"width": 390, "height": 844, "is_phone": True}
# The words of the menu for what a solution gives in hertz, in order.
WORDS = {"squeeze": ["jelly", "firm"], "egg_drop": ["soft"]}
# How long a level goes on after the last deed at most [s].
AFTER = 60.0

# One that is won by a menu, and one by what is drawn.
SOME = ((ByFinger, "egg_drop"), (ByMouse, "bridge_budget"))


@pytest.mark.slow
@pytest.mark.parametrize(("by", "level"), some_and_whole(SOME, product((ByMouse, ByFinger), SOLUTIONS)))
def test_a_level_is_won_in_a_page_by_what_its_solution_does(
    browser: Browser, tmp_path: Path, by: type[Player], level: str
) -> None:
    tab = opened(browser, tmp_path, level_page(level), **(PHONE if by is ByFinger else {}))
    player, rate = by(tab, WORDS.get(level, [])), tab.evaluate("page.toy.rate")
    lines = [
        (round(time * rate), number, record) for number, each in enumerate(SOLUTIONS[level]) for time, record in each
    ]
    lines.sort(key=lambda line: line[:2])
    for tick, _, record in lines:
        if player.until(tick) is None:
            player.do(record)
    player.until(lines[-1][0] + AFTER * rate)
    is_won, stars = tab.evaluate("[page.toy.outcome?.isWon, page.toy.outcome?.stars]")
    assert is_won and text(tab, "#end-card h2") == "Won"
    assert tab.evaluate("document.querySelectorAll('#end-card .star.earned').length") == stars > 0
    assert tab.faults == []
    assert verify(read_replay(saved(tab, tmp_path))) is None


def test_every_level_with_a_goal_has_a_solution_of_what_pages_carry_out() -> None:
    paths = [path for path in shipped_levels() if load_level(path.stem).goal]
    assert {path.stem for path in paths} == set(SOLUTIONS)
    for path in paths:
        types = {line.record["type"] for line in read_replay(solution_of(path)).script}
        assert not [name for name in types if not is_done_by_pages(name)]
