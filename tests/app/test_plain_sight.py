"""Nothing in plain sight fails: all pages, menus and fields, over all levels and all ready parts."""

import pygame
import pytest

from sandbox.editor.items import items_of
from sandbox.editor.storage.part_files import catalogue
from sandbox.level.format.files import load_level, shipped_levels

PARTS = {part.path.stem: part.level for part in catalogue() if not part.is_own}
LEVELS = [path.stem for path in shipped_levels()]
PAGES = ("properties", "materials", "parts", "level", "checks", "history", "findings")


def walk(driver):
    """Show each page, with each of some things selected, turn the wheel over it and go through it by Tab."""
    items = list(items_of(driver.editor.document.level))
    for page in PAGES:
        driver.editor.side.choose(page)
        for item in [None, *items[:: max(1, len(items) // 4)]]:
            driver.editor.select(frozenset() if item is None else frozenset([item]))
            driver.frames(1)
        driver.move(driver.editor.side.back.rect.center)
        for notches in (-3, 3):
            driver.post(pygame.MOUSEWHEEL, x=0, y=notches, precise_x=0.0, precise_y=float(notches))
        for _ in range(12):
            driver.key(pygame.K_TAB)
            driver.key(pygame.K_DOWN)
        driver.frames(1)
    driver.app.ui.blur()


@pytest.mark.parametrize("name", PARTS)
def test_every_page_shows_every_ready_part_and_all_of_its_materials(edit, name):
    driver = edit(PARTS[name])
    walk(driver)
    driver.editor.side.choose("materials")
    page = driver.editor.side.page
    for material in list(driver.editor.document.level.materials):
        driver.frames(1)
        names = [row.text for row in page.list.rows]
        page._choose(names.index(material))
        driver.frames(2)
        assert page.chosen == material


@pytest.mark.parametrize("name", LEVELS[::4])
def test_every_page_shows_every_level(edit, name):
    walk(edit(load_level(name)))
