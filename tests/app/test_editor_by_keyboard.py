"""The editor by keyboard alone: menus, names, drawing, rules, play; and the open file, which is watched."""

import json

import pygame

from sandbox.editor.items import Item
from sandbox.level.document.canonical import level_text
from sandbox.session.outcome import outcome
from tests.app.conftest import small_level

# What keyboards send for the key beside the right Ctrl.
MENU = 0x40000065
CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


def test_f2_asks_for_another_name_of_the_one_thing_that_is_selected(edit):
    driver = edit(small_level())
    driver.editor.select(frozenset([Item("body", "rope"), Item("body", "pair")]))
    driver.key(pygame.K_F2)
    assert any("Select one thing, or one group" in notice for notice in driver.notices)
    driver.editor.select(frozenset([Item("body", "rope")]))
    driver.key(pygame.K_F2)
    driver.key(pygame.K_a, CTRL)
    driver.type("cord")
    driver.key(pygame.K_RETURN)
    assert [body.id for body in driver.editor.document.level.bodies] == ["cord", "pair"]
    assert driver.editor.document.selection == {Item("body", "cord")}


def test_the_menu_key_and_shift_f10_open_the_menu_of_the_selection_or_of_what_is_at_the_cursor(edit):
    driver = edit(small_level())
    chosen = frozenset([Item("body", "rope"), Item("body", "pair")])
    driver.editor.select(chosen)
    for key, mod in ((MENU, 0), (pygame.K_F10, SHIFT)):
        driver.key(key, mod)
        rows = [row.text for row in driver.app.ui.focus.rows]
        assert "Duplicate" in rows and driver.editor.document.selection == chosen
        driver.key(pygame.K_ESCAPE)
    driver.key(MENU)
    while driver.app.ui.focus.rows[driver.app.ui.focus._cursor or 0].text != "Group":
        driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
    assert len({body.group for body in driver.editor.document.level.bodies} - {None}) == 1
    driver.editor.select(frozenset())
    driver.key(MENU)
    assert "Select everything" in [row.text for row in driver.app.ui.focus.rows]


def test_a_level_is_drawn_given_a_goal_and_won_by_keyboard_alone(edit):
    driver = edit()
    driver.key(pygame.K_n, CTRL)
    # The first Enter shows the cursor, the second draws there.
    driver.key(pygame.K_a)
    driver.key(pygame.K_RETURN)
    assert driver.editor.cursor is not None and not driver.editor.document.level.particles
    driver.key(pygame.K_RETURN)
    assert len(driver.editor.document.level.particles) == 1
    driver.key(pygame.K_z, SHIFT)
    across, down, up = [pygame.K_RIGHT] * 4, [(pygame.K_DOWN, SHIFT)] * 2, [(pygame.K_UP, SHIFT)]
    for steps in ([pygame.K_LEFT] * 2 + down, across, up, [pygame.K_LEFT] * 4, down):
        for step in steps:
            driver.key(*(step if isinstance(step, tuple) else (step,)))
        driver.key(pygame.K_RETURN)
    assert len(driver.editor.document.level.zones) == 1, driver.notices
    driver.key(pygame.K_ESCAPE)
    while driver.editor.side.tab != "rules":
        driver.key(pygame.K_TAB, CTRL)
    while getattr(driver.app.ui.focus, "text", "") != "Add":
        driver.key(pygame.K_TAB)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_RETURN)
    (rule,) = driver.editor.document.level.rules
    assert rule.then[0].win
    while "once yes" not in focused(driver):
        driver.key(pygame.K_TAB)
    driver.key(pygame.K_SPACE)
    assert driver.editor.document.level.rules[0].once
    driver.key(pygame.K_e)
    driver.frames(120)
    won = outcome(driver.playback.session.level, driver.world)
    assert won is not None and won.is_won


def focused(driver):
    named = driver.editor.side.page.form._named
    return [name for name, widget in named.items() if widget is driver.app.ui.focus]


def test_a_file_that_another_program_writes_is_told_of_while_the_window_has_the_keyboard(edit, tmp_path):
    path = tmp_path / "level.json"
    path.write_text(level_text(small_level()))
    driver = edit(small_level())
    driver.app.documents.open(path)
    driver.frames(2)
    path.write_text(level_text(small_level(name="Other", zones=[{"id": "here", "box": [0, 0, 1, 1]}])))
    driver.frames(180)
    assert driver.app.ui.has_sheet
    driver.choose("Read it again")
    driver.frames(2)
    assert driver.editor.document.level.name == "Other"
    assert json.loads(path.read_text())["name"] == "Other"
    # It is said once; nothing that rules named went.
    driver.frames(180)
    assert not driver.app.ui.has_sheet
