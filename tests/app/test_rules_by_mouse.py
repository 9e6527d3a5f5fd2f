"""The form of a rule by mouse alone: stars, several questions, and what is kept as a word of it changes."""

import pygame
import pytest

from sandbox.editor.items import Item
from sandbox.editor.rule_text import rule_text
from sandbox.session.outcome import outcome
from tests.app.conftest import small_level
from tests.support.form_maker import Maker

BALLS = [{"id": f"ball {k}", "position": [k, 1.0], "radius": 0.2} for k in (1, 2, 3)]
GOAL = {
    "id": "goal", "when": {"metric": "inside", "particle": "ball 1", "zone": "basket"}, "then": [{"win": "In!"}],
}  # fmt: skip
PARTS = {
    "terrain": [{"id": "floor", "polyline": [[-3, -2], [7, -2]]}],
    "zones": [{"id": "basket", "box": [0.5, 0.5, 3.5, 1.5]}],
    "particles": BALLS, "counters": [{"id": "score"}], "hands": {"at_most": {"add": 3}}, "rules": [GOAL],
}  # fmt: skip


@pytest.fixture
def maker(edit):
    return lambda **changes: Maker(edit(small_level(**{**PARTS, **changes})), "rules")


def test_stars_are_earned_by_time_by_a_counter_and_by_parts_left(maker):
    made = maker()
    made.choose("then.0.stars", "by time")
    made.type("then.0.stars.second 0", "20")
    made.type("then.0.stars.third 0", "8")
    stars = made.file().rules[0].then[0].stars
    assert (stars.counter, stars.second, stars.third) == (None, 20.0, 8.0)
    for name in ("score", "Parts left"):
        made.choose("then.0.stars", name)
        stars = made.file().rules[0].then[0].stars
        assert (stars.counter, stars.second, stars.third) == (name, 1.0, 2.0), made.driver.notices
    assert any("3 stars from" in str(each.about) for each in made.page.form.properties.values())
    made.choose("then.0.stars", "three for each win")
    assert made.file().rules[0].then[0].stars is None
    assert made.driver.editor.history.labels[-1] == "Rule goal: stars"


def test_a_win_in_play_earns_the_stars_that_the_form_gave(maker):
    made = maker()
    made.choose("then.0.stars", "by time")
    made.type("then.0.stars.third 0", "0.0001")
    made.driver.key(pygame.K_e)
    made.driver.frames(30)
    assert outcome(made.driver.playback.session.level, made.driver.world).stars == 2


def test_a_look_at_what_else_a_rule_could_do_keeps_its_words_and_says_that_stars_go(maker):
    made = maker()
    made.choose("then.0.stars", "by time")
    for text in ("lose", "say", "win"):
        made.choose("then.0", text)
    action = made.rules[0].then[0]
    assert (action.win, action.stars) == ("In!", None)
    assert any("the stars went with the win" in notice.lower() for notice in made.driver.notices)
    made.choose("then.0", "pin")
    made.driver.editor.edit("Other", lambda document: made.page.form.properties["then.0.pin"].set(document, "ball 3"))
    made.driver.frames(2)
    made.choose("then.0", "unpin")
    assert made.rules[0].then[0].unpin == "ball 3"


def test_questions_that_ask_others_are_built_changed_and_taken_apart(maker):
    made = maker()
    made.press("ask")
    made.choose("1.asks", "touches")
    made.choose("1.touches.0", "ball 2")
    made.choose("1.touches.1", "floor")
    made.choose("asks", "one of these holds")
    made.choose("0.asks", "all of these hold")
    made.choose("0.0.subject", "ball 3")
    text = "When (ball 3 is inside basket) or ball 2 touches floor: win \N{LEFT DOUBLE QUOTATION MARK}In!"
    assert rule_text(made.file().rules[0]).startswith(text)
    made.choose("0.asks", "is inside")
    made.press("1.many remove")
    assert rule_text(made.file().rules[0]).startswith("When ball 3 is inside basket: win")


def test_every_question_of_a_file_is_shown_by_words_to_change_and_none_as_grey_text(maker):
    when = {"all": [{"touches": ["ball 1", "floor"]}, {"none": [{"key": "g"}, {"any": [{"time": 3.0}]}]}]}
    made = maker(rules=[{**GOAL, "when": when}])
    assert not [each.field for each in made.page.form.properties.values() if not each.editable]
    made.type("1.1.0.time 0", "4")
    changed = {"all": [when["all"][0], {"none": [{"key": "g"}, {"any": [{"time": 4.0}]}]}]}
    assert made.file().rules == maker(rules=[{**GOAL, "when": changed}]).file().rules


def test_a_rule_names_several_things_that_are_selected_typed_and_picked(maker):
    made = maker()
    made.driver.editor.select(frozenset(Item("particle", f"ball {k}") for k in (1, 2)))
    made.press("many all_of")
    assert made.file().rules[0].when.all_of == ("ball 1", "ball 2")
    made.press("several pick")
    made.driver.click_at(3, 1)
    made.driver.frames(2)
    made.press("several pick")
    made.driver.click_at(1, 1)
    made.driver.frames(2)
    assert made.file().rules[0].when.all_of == ("ball 2", "ball 3")
    made.choose("asks", "touches")
    made.choose("touches.1", "floor")
    made.type("several 0", "ball 1, rope")
    assert rule_text(made.file().rules[0]).startswith("When all of ball 1, rope touches floor: win")
    made.type("several 0", "bell 1")
    assert any('there is no body, loose particle or group "bell 1"' in notice for notice in made.driver.notices)
    made.press("many each_of")
    assert made.rules[0].once and made.page.form.properties["once"].about.title == "Once for each"
    made.press("many one")
    assert made.file().rules[0].when.touches == ("ball 1", "floor")


def test_three_selected_balls_are_counted_once_each_by_two_clicks_and_the_third_wins(maker):
    """The finding: three balls on a belt took three rules, and two that bobbed won."""
    made = maker(rules=[], zones=[{"id": "basket", "box": [0.0, -2.0, 6.0, -1.2]}], settings={"gravity": [0.0, -9.8]},
                 particles=[{**ball, "restitution": 0.8} for ball in BALLS])  # fmt: skip
    made.driver.editor.select(frozenset(Item("particle", f"ball {k}") for k in (1, 2, 3)))
    made.driver.click_widget(made.page.buttons["Add"])
    made.driver.frames(2)
    made.driver.choose("Count each of ball 1, ball 2, ball 3 once in basket")
    made.driver.key(pygame.K_e)
    made.driver.frames(240)
    assert made.driver.world.counter[0] == 3.0
    made.driver.key(pygame.K_e)
    made.driver.frames(240)
    row = made.page.list.rows[0]
    assert row.text.startswith("When each of ball 1, ball 2, ball 3 crosses basket: score +1")
    assert row.detail.count(",") == 2 and row.detail.startswith("count: fired at")


def test_a_group_that_is_selected_whole_is_named_by_its_name(maker):
    made = maker(particles=[{**ball, "group": "trio"} for ball in BALLS])
    made.driver.click_at(1, 1)
    made.press("many any_of")
    assert made.file().rules[0].when.any_of == ("trio",)


def test_a_click_on_a_line_opens_its_rule_and_the_next_folds_it_and_arrows_go_on(maker):
    rules = [{**GOAL, "id": f"goal {k}", "for_seconds": k / 10.0} for k in range(12)]
    made = maker(rules=rules)

    def click_line(lines, row):
        made.page._area.scroll_to(lines.place.top + lines._tops[row] - 60)
        made.driver.frames(2)
        made.driver.click((lines.rect.left + 40, lines.rect.top + lines._tops[row] + 10))
        made.driver.frames(2)

    assert len(made.page.rows) == 12 and "0.subject" not in made.page.form.properties
    click_line(made.page._rest, 4)
    assert made.page.chosen == 5 and made.page.form.properties["id"].value == "goal 5"
    made.driver.key(pygame.K_DOWN)
    assert made.page.form.properties["id"].value == "goal 6" and made.page.list.chosen == 6
    made.press("fold Then")
    made.driver.frames(2)
    assert made.page._rest.place.top == made.page._ui.px(made.page.form.end)
    assert made.page.tail.buttons["counter"].rect.top > made.page._rest.rect.bottom
    click_line(made.page.list, 6)
    assert made.page.chosen == -1 and not made.page.form.properties and len(made.page.list.rows) == 12
    click_line(made.page.list, 2)
    assert made.page.form.properties["id"].value == "goal 2"
    made.driver.click_widget(made.page.buttons["Duplicate"])
    made.driver.frames(2)
    assert made.page.form.properties["id"].value == "goal 12"
    assert [rule.for_seconds for rule in made.file().rules[2:5]] == [0.2, 0.2, 0.3]
    made.driver.click_widget(made.page.buttons["Delete"])
    made.driver.frames(2)
    assert len(made.rules) == 12 and made.page.chosen == 3
