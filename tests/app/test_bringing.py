"""Drawings and maps of other programs, dropped on the window: a question, then jellies or ground in the sheet."""

import pygame
import pytest

from tests.app.conftest import small_level
from tests.support.foreign_files import SVG, png, rube, samples, tiled


def drop(driver, path, data):
    path.write_bytes(data)
    driver.post(pygame.DROPFILE, file=str(path))
    driver.frames(2)
    assert driver.app.ui.has_sheet


def close_page(driver):
    """Close the page that says what was left out, if there is one."""
    driver.frames(2)
    if driver.app.ui.has_sheet:
        driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert not driver.app.ui.has_sheet


def kinds(level):
    return bool(level.bodies), bool(level.terrain)


@pytest.mark.parametrize("name", samples())
def test_a_dropped_file_opens_in_the_editor_as_is_usual_for_it(driver, tmp_path, name):
    drop(driver, tmp_path / name, samples()[name])
    driver.key(pygame.K_RETURN)
    close_page(driver)
    assert driver.app.mode == "edit"
    level = driver.editor.document.level
    assert level.name == "a"
    # Jellies that come alone have ground to stand on.
    assert kinds(level) == (name not in ("a.tmj", "a.tmx"), True)


def test_the_second_choice_makes_ground_of_a_drawing(driver, tmp_path):
    drop(driver, tmp_path / "a.svg", SVG)
    driver.key(pygame.K_TAB)
    driver.key(pygame.K_RETURN)
    close_page(driver)
    assert kinds(driver.editor.document.level) == (False, True)


def test_escape_brings_nothing_in(driver, tmp_path):
    before = driver.playback
    drop(driver, tmp_path / "a.svg", SVG)
    driver.key(pygame.K_ESCAPE)
    driver.frames(2)
    assert driver.playback is before and not driver.app.ui.has_sheet


@pytest.mark.parametrize(("name", "data"), [("a.svg", SVG), ("a.png", png()), ("a.tmj", tiled()), ("a.json", rube())])
def test_in_the_editor_it_comes_into_the_sheet_as_one_step_that_is_undone_at_once(edit, tmp_path, name, data):
    driver = edit(small_level())
    before, steps = driver.editor.document.level, driver.editor.history.index
    drop(driver, tmp_path / name, data)
    driver.key(pygame.K_RETURN)
    close_page(driver)
    level = driver.editor.document.level
    assert driver.editor.history.index == steps + 1
    assert len(level.bodies) + len(level.terrain) > len(before.bodies) + len(before.terrain)
    assert level.has_contacts and driver.editor.document.selection
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.editor.document.level == before


def test_what_cannot_come_in_is_said_in_a_line_and_nothing_changes(driver, tmp_path):
    before = driver.playback
    drop(driver, tmp_path / "a.svg", b'<svg xmlns="http://www.w3.org/2000/svg"><text>words</text></svg>')
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert driver.app.ui.has_sheet
    driver.key(pygame.K_RETURN)
    assert driver.playback is before and not driver.app.ui.has_sheet


def test_the_editor_that_is_begun_with_a_drawing_asks_what_it_is_to_become(edit, tmp_path):
    driver, path = edit(), tmp_path / "a.svg"
    path.write_bytes(SVG)
    driver.app.documents.begin(str(path))
    driver.frames(2)
    driver.key(pygame.K_RETURN)
    close_page(driver)
    assert len(driver.editor.document.level.bodies) == 3
