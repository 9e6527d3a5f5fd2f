"""The clipboard of the editor: parts and whole levels as JSON text."""

import json

import pygame
import pytest

from sandbox.app.edit.clipboard import Clipboard
from sandbox.level.document.canonical import level_text
from sandbox.level.format.look import BodyLook
from sandbox.level.format.picture import Picture
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.jelly import JellyDef
from sandbox.level.reading.files import parse_level
from sandbox.level.reading.pictures import pictures_of
from tests.app.conftest import small_level
from tests.support.worn import four

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


@pytest.fixture
def driver(edit):
    driver = edit(small_level())
    pygame.scrap.put_text("")
    return driver


def ids(driver):
    return [body.id for body in driver.editor.document.level.bodies]


def test_a_copy_is_json_on_the_systems_clipboard_and_is_pasted_at_the_pointer(driver):
    driver.click_at(1, 2)
    driver.key(pygame.K_c, CTRL)
    assert isinstance(json.loads(pygame.scrap.get_text()), dict)
    driver.move(driver.at(3, 3))
    driver.key(pygame.K_v, CTRL)
    assert ids(driver) == ["rope", "pair", "pair 2"]
    left, bottom, right, top = driver.editor.selection_box
    assert ((left + right) / 2, (bottom + top) / 2) == pytest.approx((3, 3), abs=driver.editor.grid)


def test_cut_takes_away_what_paste_brings_back(driver):
    driver.click_at(1, 2)
    driver.key(pygame.K_x, CTRL)
    assert ids(driver) == ["rope"]
    driver.key(pygame.K_v, CTRL)
    assert ids(driver) == ["rope", "pair"]


def test_the_whole_level_is_copied_as_a_file_would_hold_it(driver):
    driver.key(pygame.K_c, CTRL | SHIFT)
    assert parse_level(pygame.scrap.get_text().encode(), "clipboard") == driver.editor.document.level


def test_a_whole_level_is_pasted_as_parts_or_as_a_level_of_its_own(driver):
    pygame.scrap.put_text(level_text(small_level(name="Guest")))
    driver.key(pygame.K_v, CTRL)
    driver.choose("Paste as parts of this level")
    assert len(ids(driver)) == 4
    driver.key(pygame.K_v, CTRL)
    driver.choose("Open as a new level")
    driver.choose("Discard the changes")
    assert driver.editor.document.level.name == "Guest"


@pytest.mark.parametrize("text", ["", "hello", "{", "[1, 2]", '{"format": "spring-sandbox/level"}', "9" * 5000])
def test_what_is_no_level_is_refused_with_a_line(driver, text):
    pygame.scrap.put_text(text)
    driver.key(pygame.K_v, CTRL)
    assert ids(driver) == ["rope", "pair"] and driver.notices


def test_copying_nothing_is_said(driver):
    driver.key(pygame.K_c, CTRL)
    assert any("Nothing is selected" in text for text in driver.notices)


def test_pictures_go_along_from_level_to_level(driver, monkeypatch):
    monkeypatch.setattr(Clipboard, "pictures", {})
    hat = Picture("hat.png", four((8, 8)))
    look = BodyLook(picture=hat)
    level = small_level(name="Guest")
    jelly = JellyDef(type="jelly", id="head", shape={"box": (1.0, 1.0)}, spacing=0.5, look=look)
    pygame.scrap.put_text(level_text(replaced(level, bodies=(jelly,))))
    driver.key(pygame.K_v, CTRL)
    driver.choose("Paste as parts of this level")
    assert pictures_of(driver.editor.document.level) == {}
    driver.key(pygame.K_z, CTRL)
    monkeypatch.setattr(Clipboard, "pictures", {"hat.png": hat})
    driver.key(pygame.K_v, CTRL)
    driver.choose("Paste as parts of this level")
    assert pictures_of(driver.editor.document.level)["hat.png"].data == hat.data
