"""Looks in the editor: menus of names and colours in the panel, undone like every edit, and seen at once."""

import numpy as np
import pygame
import pytest

from sandbox.app.widgets.property_widgets import OTHER_COLOUR
from sandbox.editor.items import Item
from sandbox.level.format.look import BALLS, LINES, PALETTE, SKINS
from tests.app.conftest import small_level

BODIES = [{"type": "jelly", "id": "box", "shape": {"box": [2, 2]}, "spacing": 1.0, "position": [2, 0], "look": {}}]


@pytest.fixture
def looks(edit):
    driver = edit(small_level(bodies=BODIES, materials={}))
    driver.editor.select(frozenset([Item("body", "box")]))
    driver.frames(2)
    return driver


def form_of(driver):
    return driver.editor.side.page.form


def pick(driver, field, text):
    form = form_of(driver)
    index = [row.text for row in form.pickers[field].rows].index(text)
    form._pick(field, index)
    driver.frames(2)


def look(driver):
    return driver.editor.document.level.bodies[0].look


def test_every_name_of_the_format_is_in_a_menu_with_automatic_first(looks):
    pickers = form_of(looks).pickers
    for field, names in (("look.skin", SKINS), ("look.line", LINES), ("look.colour", PALETTE)):
        rows = [row.text for row in pickers[field].rows]
        assert rows[0] == pickers[field].shown.text == "automatic" and rows[1 : len(names) + 1] == list(names)
    assert pickers["look.colour"].rows[1].swatch is not None
    assert [row.text for row in pickers["look.face"].rows] == ["automatic", "yes", "no"]
    assert BALLS


def test_a_choice_is_written_seen_at_once_and_undone(looks):
    def pixels():
        return pygame.surfarray.array3d(looks.app.display.surface).astype(int)

    before = pixels()
    pick(looks, "look.skin", "brick")
    pick(looks, "look.face", "no")
    assert (look(looks).skin, look(looks).face) == ("brick", False)
    assert (np.abs(pixels() - before).max(axis=2) > 30).sum() > 200
    pick(looks, "look.colour", "lime")
    assert form_of(looks).pickers["look.colour"].shown.text == "lime"
    for _ in range(3):
        looks.key(pygame.K_z, pygame.KMOD_CTRL)
    looks.frames(2)
    assert look(looks).skin is None and look(looks).colour is None and look(looks).face is None


def test_automatic_takes_a_choice_back_and_another_colour_is_typed(looks):
    pick(looks, "look.skin", "stone")
    pick(looks, "look.skin", "automatic")
    assert look(looks).skin is None
    pick(looks, "look.colour", OTHER_COLOUR)
    assert looks.app.ui.has_sheet
    looks.key(pygame.K_ESCAPE)
    form_of(looks)._set("look.colour", "#102030")
    looks.frames(2)
    assert look(looks).colour == "#102030"
    shown = form_of(looks).pickers["look.colour"].shown
    assert shown.text == "#102030" and tuple(shown.swatch) == (16, 32, 48)
