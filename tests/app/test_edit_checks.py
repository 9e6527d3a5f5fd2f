"""The page of checks by mouse: metrics by their words, things picked on the sheet, keys that are held."""

import pygame
import pytest

from sandbox.level.reading.files import load_level
from tests.app.conftest import small_level


def metric_row(page, label):
    return next(k for k, row in enumerate(page.form.pickers["metric"].rows) if row.text == label)


def pick_button(page, field):
    return page.form._named[f"{field} pick"]


def test_a_check_is_made_by_mouse_with_the_body_and_the_box_picked_on_the_sheet(edit):
    driver = edit(small_level())
    driver.editor.side.choose("checks")
    driver.frames(2)
    page = driver.editor.side.page
    driver.click_widget(page.buttons[0])
    driver.frames(2)
    page.form._pick("metric", metric_row(page, "inside a box"))
    driver.frames(2)
    driver.click_widget(pick_button(page, "body"))
    assert "body" in driver.editor.pointer_tool.hint
    driver.click_at(2, 0)
    driver.frames(2)
    driver.click_widget(pick_button(page, "box"))
    driver.drag((-1, -1), (3, 1), (6, 2))
    driver.frames(2)
    check = driver.editor.document.level.checks[-1]
    assert check.body == "rope" and check.box == pytest.approx((-1.0, -1.0, 6.0, 2.0), abs=0.01)
    assert (check.at_least, check.at_most) == (0.0, None)
    assert driver.editor.view.shown_box == check.box
    # The pick is over: a click selects again.
    driver.click_at(1, 2)
    assert {item.key for item in driver.editor.document.selection} == {"pair"}
    driver.editor.side.choose("level")
    driver.frames(2)
    assert driver.editor.view.shown_box is None


def test_escape_gives_a_pick_up_and_a_click_beside_everything_says_so(edit):
    driver = edit(small_level())
    driver.editor.side.choose("checks")
    driver.frames(2)
    page = driver.editor.side.page
    driver.click_widget(page.buttons[0])
    page.form._pick("metric", metric_row(page, "x"))
    driver.frames(2)
    before = driver.editor.document.level
    driver.click_widget(pick_button(page, "particle"))
    driver.click_at(-1, -1)
    assert any("no particle there" in notice for notice in driver.notices)
    driver.key(pygame.K_ESCAPE)
    driver.frames(1)
    assert driver.editor.document.level is before and "particle" not in driver.editor.pointer_tool.hint


def test_a_check_that_fails_without_hands_says_so_and_holds_once_it_holds_the_key(edit):
    driver = edit(load_level("suspension_car"))
    driver.editor.side.choose("checks")
    driver.frames(2)
    page = driver.editor.side.page
    driver.click_widget(page.buttons[0])
    page.form._pick("metric", metric_row(page, "x"))
    driver.frames(2)
    page.form._set("body", "car")
    page.form._type("at_least", 0, "14")
    page.form._set("when", "eventually")
    driver.frames(2)
    for axis, text in enumerate(("0", "12")):
        page.form._type("span", axis, text)
    driver.frames(2)

    def run():
        page._run()
        page.trial.wait()
        driver.frames(2)
        return page.list.rows[-1].detail

    assert "Nobody pressed a key" in run()
    page.form._press_object("hold")
    driver.frames(2)
    page.form._press_key("hold.0.key", "d")
    driver.frames(2)
    assert run().startswith("holds") and "D from 0 to 12 s" in page.list.rows[-1].detail
    page.form._press_key("hold.0.key", None)
    driver.frames(2)
    assert driver.editor.document.level.checks[-1].hold == ()
