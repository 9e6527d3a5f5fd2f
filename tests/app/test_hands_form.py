"""What hands may do, by ticks and numbers on the page Level."""

import pytest

from tests.app.conftest import small_level
from tests.support.form_maker import Maker


@pytest.fixture
def maker(edit):
    return lambda **changes: Maker(edit(small_level(**changes)), "level")


def test_hands_are_ticked_by_mouse_given_numbers_and_told_apart_in_the_history(maker):
    made = maker()
    made.press("hands.may nothing")
    for deed in ("add", "cut", "grab"):
        made.press(f"hands.may.{deed} yes")
    made.press("hands.may.grab yes")
    made.type("hands.at_most.add 0", "3")
    made.type("hands.at_most.cut 0", "2000")
    hands = made.file().hands
    assert hands.may == ("cut", "add") and hands.budgets == {"add": 3}
    assert any("Cut at most: 2000 is outside 0 to 1000" in notice for notice in made.driver.notices)
    assert made.driver.editor.history.labels[-1] == "Hands: add parts at most"
    made.press("hands.bodies pick")
    made.driver.click_at(2, 0)
    made.driver.frames(2)
    assert made.file().hands.bodies == ("rope",)


def test_goal_and_hands_come_before_time_and_solver_which_is_folded_until_it_is_wanted(maker):
    made = maker()
    fields = list(made.page.form.properties)
    assert fields.index("goal") == 1 and fields.index("hands.may") < fields.index("contacts")
    assert "substeps" not in fields
    made.press("fold Time and solver")
    assert "substeps" in made.page.form.properties
