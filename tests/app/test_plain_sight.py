"""Nothing in plain sight fails: all pages, menus and fields, over all levels and all ready parts."""

import pygame
import pytest

from sandbox.editor.items import items_of
from sandbox.editor.storage.level_file import catalogue
from sandbox.level.checks import METRICS
from sandbox.level.reading.files import load_level, shipped_levels
from tests.support.wholes import some_and_whole

PARTS = {part.path.stem: part.level for part in catalogue() if not part.is_own}
LEVELS = [path.stem for path in shipped_levels()]
PAGES = ("properties", "objects", "materials", "parts", "level", "checks", "history", "findings")


def walk(driver, pages_by_keys=PAGES):
    """Show each page, with each of some things selected, turn the wheel over it, and go through some of them by Tab."""
    items = list(items_of(driver.editor.document.level))
    for page in PAGES:
        driver.editor.side.choose(page)
        for item in [None, *items[:: max(1, len(items) // 4)]]:
            driver.editor.select(frozenset() if item is None else frozenset([item]))
            driver.frames(1)
        driver.move(driver.editor.side.back.rect.center)
        for notches in (-3, 3):
            driver.post(pygame.MOUSEWHEEL, x=0, y=notches, precise_x=0.0, precise_y=float(notches))
        driver.frames(1)
        for _ in range(3 if page in pages_by_keys else 0):
            for key in 4 * (pygame.K_TAB, pygame.K_DOWN):
                driver.tap(key)
            driver.frames(1)
    driver.app.ui.blur()


@pytest.mark.parametrize("name", some_and_whole(list(PARTS)[::4], PARTS))
def test_every_page_shows_every_ready_part_and_all_of_its_materials(edit, name):
    driver = edit(PARTS[name])
    # A part's own are the fields of its bodies and of its materials: the others are gone through in levels.
    walk(driver, ("properties", "materials"))
    driver.editor.side.choose("materials")
    page = driver.editor.side.page
    for material in list(driver.editor.document.level.materials):
        names = [row.text for row in page.list.rows]
        page._choose(names.index(material))
        driver.frames(2)
        assert page.chosen == material


@pytest.mark.parametrize("name", LEVELS[::6])
def test_every_page_shows_every_level(edit, name):
    walk(edit(load_level(name)))


def open_metrics(edit):
    """The editor with a check, and the menu of its metrics open; the list of the menu."""
    driver = edit(load_level("rope"))
    driver.app.display.window.size = (1280, 720)
    driver.frames(2)
    driver.editor.side.choose("checks")
    driver.frames(2)
    picker = driver.editor.side.page.form.pickers["metric"]
    driver.press(picker.rect.center)
    driver.release(picker.rect.center)
    driver.frames(2)
    return driver, picker, driver.app.ui.focus


def test_the_wheel_scrolls_a_menu_and_the_last_metric_is_chosen_by_mouse(edit):
    driver, _, menu = open_metrics(edit)
    assert len(menu.rows) > 12
    driver.move(menu.rect.center)
    for _ in range(8):
        # A wheel is a button that is pressed as well.
        driver.post(pygame.MOUSEBUTTONDOWN, button=5, pos=menu.rect.center)
        driver.post(pygame.MOUSEBUTTONUP, button=5, pos=menu.rect.center)
        driver.post(pygame.MOUSEWHEEL, x=0, y=-1, precise_x=0.0, precise_y=-1.0)
        driver.frames(1)
    assert menu.is_there and menu._row_at((menu.rect.centerx, menu.rect.bottom - 8)) == len(menu.rows) - 1
    wanted = menu.rows[-1].text
    at = menu.rect.centerx, menu.rect.bottom - 8
    driver.press(at)
    driver.release(at)
    driver.frames(2)
    assert not menu.is_there and METRICS[driver.editor.document.level.checks[0].metric].label == wanted


def test_the_thumb_of_a_menu_scrolls_and_chooses_nothing(edit):
    driver, _, menu = open_metrics(edit)
    before = driver.editor.document.level
    top = menu.rect.right - 4, menu.rect.top + 6
    driver.press(top)
    driver.move((top[0], menu.rect.bottom - 4))
    driver.release((top[0], menu.rect.bottom - 4))
    driver.frames(1)
    assert menu.is_there and driver.editor.document.level is before
    assert menu._row_at((menu.rect.centerx, menu.rect.bottom - 8)) == len(menu.rows) - 1


def test_looks_of_materials_and_of_the_level_are_set_by_menus(edit):
    driver = edit(PARTS["windmill"])
    driver.editor.side.choose("materials")
    driver.frames(2)
    page = driver.editor.side.page
    page._choose([row.text for row in page.list.rows].index("wood"))
    driver.frames(2)
    assert page.form.properties["look.line"].value == "wood"
    page.form._set("look.skin", "rubber")
    driver.frames(2)
    assert driver.editor.document.level.materials["wood"].look.skin == "rubber"
    driver.editor.side.choose("level")
    driver.frames(2)
    form = driver.editor.side.page.form
    if driver.editor.document.level.look is None:
        driver.click_widget(form.buttons["look"])
        driver.frames(2)
    form._set("look.faces", False)
    driver.frames(2)
    assert driver.editor.document.level.look.faces is False
    assert "Look is not changed here." not in driver.notices
