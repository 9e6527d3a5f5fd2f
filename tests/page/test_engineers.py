"""The solver is chosen in a page, under a fold of the panel, and the desktop has the same bits."""

from pathlib import Path

import pytest

from sandbox.replay import read_replay, verify
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import ALL_SHOWN, START_OVER, opened, saved
from tests.page.pointing import click, text

SETTINGS = "page.toy.world.settings()"
RECORDS = "page.toy.run.commands.map(({ record }) => record)"
SHOWN = "[...document.querySelectorAll('.engineers label')].filter((each) => each.offsetParent).map((each) => each.id)"

VALUES = "[...document.querySelectorAll('.engineers select, .engineers input')].map((each) => each.value)"


def _opened(browser: Browser, folder: Path, name: str) -> Tab:
    """A page that stands, with what engineers want unfolded."""
    tab = opened(browser, folder, level_page(name), width=1400, height=900)
    tab.evaluate(START_OVER)
    tab.evaluate(ALL_SHOWN)
    click(tab, "#tune")
    click(tab, ".engineers summary")
    return tab


def _chosen(tab: Tab, setting: str, key: str) -> None:
    """Choose by the first letter or digit of an option, as people do by keys."""
    tab.evaluate(f"document.querySelector('#{setting}-row select').focus()")
    tab.key(key)


def _typed(tab: Tab, setting: str, value: str) -> None:
    click(tab, f"#{setting}-row input")
    tab.evaluate(f"document.querySelector('#{setting}-row input').select()")
    for key in value:
        tab.key(key)
    click(tab, "#panel h2")


def test_a_person_chooses_solver_substeps_iterations_and_warm_start_and_the_desktop_follows(
    browser: Browser, tmp_path: Path
) -> None:
    tab = _opened(browser, tmp_path, "girder")
    before = tab.evaluate(VALUES)
    assert tab.evaluate(SHOWN) == ["solver-row", "substeps-row"]
    _chosen(tab, "solver", "i")
    assert tab.evaluate(SHOWN) == ["solver-row", "substeps-row", "iterations-row", "warm_start-row"]
    _typed(tab, "iterations", "25")
    _typed(tab, "warm_start", "0.75")
    _chosen(tab, "substeps", "8")
    tab.evaluate("for (let k = 0; k < 40; k++) page.toy.tick()")
    found = tab.evaluate(SETTINGS)
    assert [found[name] for name in ("solver", "iterations", "warm_start", "substeps")] == ["iterative", 25, 0.75, 8]
    assert verify(read_replay(saved(tab, tmp_path))) is None
    for _ in range(4):
        click(tab, "#undo")
    assert tab.evaluate(VALUES) == before
    assert tab.faults == []


def test_a_number_that_is_none_goes_back(browser: Browser, tmp_path: Path) -> None:
    tab = _opened(browser, tmp_path, "girder")
    _chosen(tab, "solver", "i")
    before = tab.evaluate(f"{SETTINGS}.iterations")
    for wrong in ("0", "2000", "2.5"):
        _typed(tab, "iterations", wrong)
        assert tab.evaluate("Number(document.querySelector('#iterations-row input').value)") == before
    assert len(tab.evaluate(RECORDS)) == 1


@pytest.mark.parametrize("setting", ["solver", "substeps"])
def test_a_solver_that_hands_may_not_choose_goes_back_and_the_panel_says_why(
    browser: Browser, tmp_path: Path, setting: str
) -> None:
    tab = _opened(browser, tmp_path, "pinball_score")
    shown = f"document.querySelector('#{setting}-row select').value"
    before = tab.evaluate(shown)
    _chosen(tab, setting, "s" if setting == "solver" else "6")
    assert tab.evaluate(shown) == before
    assert text(tab, "#refused").startswith("in this level hands may not ")
    assert tab.evaluate(RECORDS) == []
