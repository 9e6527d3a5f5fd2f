"""The page of rules by mouse: templates, words from menus and from the sheet, dotted lines, what goes with what."""

import json

import pygame
import pytest

from sandbox.app.draw.colours import ZONE
from sandbox.app.edit.side.rules import RulesPage
from sandbox.editor.items import Item
from sandbox.editor.rule_text import rule_text
from sandbox.level.reading.parse import parse_level
from sandbox.session.outcome import outcome
from tests.app.conftest import small_level

PARTS = {
    "terrain": [{"id": "floor", "polyline": [[-3, -2], [7, -2]]}],
    "zones": [{"id": "basket", "box": [4.5, 2.0, 6.5, 3.5]}, {"id": "drain", "box": [-2.5, -3.0, 0.0, -2.2]}],
    "particles": [{"id": "ball", "position": [3.0, 1.0], "radius": 0.2}],
    "counters": [{"id": "score"}],
}
GOAL = {
    "id": "goal", "when": {"metric": "inside", "particle": "ball", "zone": "basket"}, "for_seconds": 0.5,
    "then": [{"win": "Done!"}],
}  # fmt: skip


@pytest.fixture
def page(edit):
    def made(**changes):
        driver = edit(small_level(**PARTS, **changes))
        driver.editor.side.choose("rules")
        driver.frames(2)
        assert isinstance(driver.editor.side.page, RulesPage)
        return driver, driver.editor.side.page

    return made


def texts(driver):
    return [rule_text(rule) for rule in driver.editor.document.level.rules]


def choose_row(page, field, text):
    rows = page.form.pickers[field].rows
    page.form._pick(field, next(k for k, row in enumerate(rows) if row.text == text))


def test_a_goal_is_added_by_a_template_with_the_zone_that_is_selected(page):
    driver, rules = page()
    driver.editor.select(frozenset([Item("zone", "basket")]))
    driver.click_widget(rules.buttons["Add"])
    driver.frames(2)
    # The first choice is marked.
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    words = "\N{LEFT DOUBLE QUOTATION MARK}Done!\N{RIGHT DOUBLE QUOTATION MARK}"
    assert texts(driver) == [f"When ball is inside basket for 0.5 s: win {words}"]
    assert rules.list.rows[0].text == texts(driver)[0]
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert texts(driver) == []


def test_words_of_a_rule_are_chosen_from_menus_and_picked_on_the_sheet(page):
    driver, rules = page(rules=[GOAL])
    choose_row(rules, "zone", "drain")
    driver.frames(2)
    assert driver.editor.document.level.rules[0].when.zone == "drain"
    driver.click_widget(rules.form._named["zone pick"])
    driver.click_at(5.5, 2.5)
    driver.frames(2)
    assert driver.editor.document.level.rules[0].when.zone == "basket"
    driver.click_widget(rules.form._named["subject pick"])
    driver.click_at(1, 0)
    driver.frames(2)
    when = driver.editor.document.level.rules[0].when
    assert (when.body, when.particle) == ("rope", None)


def test_every_question_and_every_action_can_be_asked_for_and_saved(page):
    driver, rules = page(rules=[GOAL])
    for label in ("crosses", "touches", "breaks", "counter is", "key is held", "time is over", "measures", "is inside"):
        choose_row(rules, "asks", label)
        driver.frames(2)
        assert rules.form.pickers["asks"].shown.text == label, driver.notices
    rules.form._press_object("more")
    driver.frames(2)
    assert len(driver.editor.document.level.rules[0].then) == 2
    for label in ("lose", "say", "count", "checkpoint", "cut", "pin", "unpin", "gravity", "wind", "win"):
        choose_row(rules, "then.1", label)
        driver.frames(2)
        assert rules.form.pickers["then.1"].shown.text == label, driver.notices
    for label, said in (("drive", "nothing is driven"), ("make soft", "no body here can be made soft")):
        choose_row(rules, "then.1", label)
        driver.frames(2)
        assert any(said in notice.lower() for notice in driver.notices)


def test_of_several_bodies_one_is_made_soft_that_can_be(page):
    jelly = {"type": "jelly", "id": "pudding", "shape": {"box": [1.0, 1.0]}, "position": [2.0, 3.0], "spacing": 0.5}
    rope = {"type": "rope", "id": "rope", "start": [0, 0], "end": [4, 0], "segments": 4}
    driver, rules = page(rules=[GOAL], bodies=[rope, jelly], settings={"solver": "direct"})
    choose_row(rules, "then.0", "make soft")
    driver.frames(2)
    action = driver.editor.document.level.rules[0].then[0]
    assert (action.body, action.sag) == ("pudding", 0.2), driver.notices


def test_every_metric_that_rules_ask_for_can_be_chosen(page):
    driver, rules = page(rules=[GOAL])
    choose_row(rules, "asks", "measures")
    driver.frames(2)
    labels = [row.text for row in rules.form.pickers["metric"].rows]
    for label in labels:
        choose_row(rules, "metric", label)
        driver.frames(2)
        assert rules.form.pickers["metric"].shown.text == label, driver.notices


def test_a_rule_with_several_questions_is_kept_as_another_field_of_it_changes(page):
    several = {"all": [{"touches": ["ball", "floor"]}, {"none": [{"key": "g"}]}]}
    driver, rules = page(rules=[{**GOAL, "when": several}])
    before = driver.editor.document.level.rules[0].when
    rules.form._set("for_seconds", 2.0)
    driver.frames(2)
    rule = driver.editor.document.level.rules[0]
    assert rule.when == before and rule.for_seconds == 2.0
    assert "ball touches floor and (none of this: key G is held)" in rules.list.rows[0].text


def test_counters_are_added_renamed_with_their_rules_and_deleted_with_them(page):
    count = {"id": "bump", "when": {"touches": ["ball"]}, "then": [{"count": "score", "by": 5.0}]}
    driver, rules = page(rules=[GOAL, count])
    rules.tail._set("counter.0.id", "points")
    driver.frames(2)
    assert driver.editor.document.level.rules[1].then[0].count == "points"
    rules.tail._press_object("counter")
    driver.frames(2)
    assert [each.id for each in driver.editor.document.level.counters] == ["points", "score"]
    rules.tail._remove("counter.0.id")
    driver.frames(2)
    assert [rule.id for rule in driver.editor.document.level.rules] == ["goal"]
    assert any("Rule bump went too" in notice for notice in driver.notices)


def test_deleting_a_zone_says_which_rules_went_and_undo_brings_them_back(page):
    driver, rules = page(rules=[GOAL])
    driver.editor.select(frozenset([Item("zone", "basket")]))
    driver.key(pygame.K_DELETE)
    driver.frames(2)
    assert driver.editor.document.level.rules == () and rules.list.rows == []
    assert any("Rule goal went too" in notice for notice in driver.notices)
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert [rule.id for rule in driver.editor.document.level.rules] == ["goal"]


def test_dots_lead_from_the_zone_of_the_chosen_rule_to_its_thing(page):
    driver, _ = page(rules=[GOAL])

    def dots():
        driver.frames(2)
        (x0, y0), (x1, y1) = (driver.editor.camera.to_pixels(place) for place in ((5.5, 2.75), (3.0, 1.0)))
        seen = driver.app.display.surface
        line = [(round(x0 + k / 200 * (x1 - x0)), round(y0 + k / 200 * (y1 - y0))) for k in range(200)]
        return sum(seen.get_at(place)[:3] == tuple(ZONE) for place in line)

    with_rule = dots()
    driver.editor.side.choose("level")
    assert with_rule > 20 > dots()
    driver.editor.select(frozenset([Item("zone", "basket")]))
    assert dots() > 20


def test_a_zone_is_drawn_moved_and_scaled_by_mouse(edit):
    driver = edit(small_level())
    driver.key(pygame.K_z, pygame.KMOD_SHIFT)
    assert driver.editor.tool == "zone"
    driver.drag((2, 1), (3, 2), (5, 3))
    (zone,) = driver.editor.document.level.zones
    assert zone.box == pytest.approx((2.0, 1.0, 5.0, 3.0), abs=0.01)
    driver.key(pygame.K_v)
    driver.click_at(4, 2.5)
    driver.drag((4, 2.5), (4, 3), (4, 3.5))
    (zone,) = driver.editor.document.level.zones
    assert zone.box == pytest.approx((2.0, 2.0, 5.0, 4.0), abs=0.01)
    driver.key(pygame.K_d, pygame.KMOD_CTRL)
    assert len(driver.editor.document.level.zones) == 2


GROUND_BASKET = {
    "format": "spring-sandbox/level", "version": 3, "name": "Fall", "view": [-4.0, -1.0, 4.0, 5.0],
    "terrain": [{"id": "floor", "polyline": [[-4, 0], [4, 0]]}],
    "zones": [{"id": "basket", "box": [-1.0, 0.0, 1.0, 1.0]}],
    "particles": [{"id": "ball", "position": [0.0, 3.0], "radius": 0.2}],
    "rules": [GOAL],
}  # fmt: skip


def test_after_a_run_the_page_says_when_rules_fired_and_when_changed_ones_would_have(edit):
    driver = edit(parse_level(json.dumps(GROUND_BASKET).encode(), "fall"))
    driver.editor.side.choose("rules")
    driver.frames(2)
    assert driver.editor.side.page.list.rows[0].detail == "goal"
    driver.key(pygame.K_e)
    driver.frames(180)
    world = driver.world
    won = int(world.rule_last[0]) / 60
    assert 0.5 < won < 3.0
    driver.key(pygame.K_e)
    driver.frames(120)
    page = driver.editor.side.page
    assert page.list.rows[0].detail == f"goal: fired at {won:.1f} s"
    page.form._set("for_seconds", 0.2)
    driver.frames(120)
    assert page.list.rows[0].detail == f"goal: fired at {won - 0.3:.1f} s"
    page.form._set("for_seconds", 30.0)
    driver.frames(120)
    assert page.list.rows[0].detail == "goal: would not fire with what hands did in the last run"


def test_a_level_with_ground_a_ball_a_basket_and_a_goal_is_made_by_mouse_and_won(edit):
    driver = edit()
    driver.key(pygame.K_d)
    for corner in ((-5, -2), (5, -2), (5, -2.8), (-5, -2.8), (-5, -2)):
        driver.click_at(*corner)
    driver.key(pygame.K_a)
    driver.editor.pointer_tool.drawing.set_option("radius", 0.3)
    driver.click_at(0, 2)
    driver.key(pygame.K_z, pygame.KMOD_SHIFT)
    driver.drag((-1, -2), (0, -1), (1, 0))
    driver.editor.side.choose("rules")
    driver.frames(2)
    driver.click_widget(driver.editor.side.page.buttons["Add"])
    driver.frames(2)
    driver.choose("Goal: particle is inside zone")
    driver.key(pygame.K_e)
    driver.frames(180)
    won = outcome(driver.playback.session.level, driver.world)
    assert won is not None and won.is_won
