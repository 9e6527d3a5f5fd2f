"""Drawings and maps of other programs, dropped on the window: a question, then jellies or ground in the sheet."""

import math
import threading

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


def test_a_file_that_is_opened_from_the_editors_gallery_is_a_level_of_its_own_and_seen(edit, tmp_path):
    driver = edit(small_level())
    before = driver.editor
    (tmp_path / "scene.json").write_bytes(rube())
    driver.key(pygame.K_o, pygame.KMOD_CTRL)
    assert driver.app.gallery is not None
    driver.choose("Open file")
    driver.frames(2)
    driver.type(str(tmp_path / "scene.json"))
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    driver.key(pygame.K_RETURN)
    close_page(driver)
    assert driver.app.gallery is None and driver.editor is not before
    assert driver.editor.document.level.name == "scene"
    assert before.document.level == small_level()


def wavy(count):
    """A drawing of so many outlines with fine edges, of which each takes a mesh."""

    def ring(x, y):
        turns = [k / 40 * math.tau for k in range(40)]
        places = [(x + (9 + math.sin(7 * t)) * math.cos(t), y + (9 + math.sin(7 * t)) * math.sin(t)) for t in turns]
        return "M" + "L".join(f"{a:.2f},{b:.2f}" for a, b in places) + "Z"

    paths = "".join(f'<path d="{ring(30 * (k % 6), 30 * (k // 6))}"/>' for k in range(count))
    return f'<svg xmlns="http://www.w3.org/2000/svg">{paths}</svg>'.encode()


@pytest.mark.parametrize("cancels", [True, False])
def test_what_takes_long_to_come_in_shows_a_bar_and_is_cancelled_by_escape(edit, tmp_path, monkeypatch, cancels):
    driver = edit(small_level())
    before, steps, bars = driver.editor.document.level, driver.editor.history.index, []

    def draw_bar(surface, ui, fraction, text, pointer):
        bars.append((fraction, text))
        if cancels:
            driver.post(pygame.KEYDOWN, key=pygame.K_ESCAPE, mod=0, unicode="", scancode=0)
        return pygame.Rect(0, 0, 0, 0)

    monkeypatch.setattr("sandbox.app.play.status._PATIENCE", 0.0)
    monkeypatch.setattr("sandbox.app.play.status._DRAWN_EVERY", 0.0)
    monkeypatch.setattr("sandbox.app.play.status.draw_work", draw_bar)
    # Another drawing each time, as what was found out of one is kept.
    count = 24 if cancels else 18
    drop(driver, tmp_path / "wavy.svg", wavy(count))
    driver.key(pygame.K_RETURN)
    close_page(driver)
    for thread in threading.enumerate():
        if thread.name == "brings in":
            thread.join(60.0)
            assert not thread.is_alive()
    assert bars and {text for _, text in bars} == {"Bringing in wavy.svg"}
    shares = [share for share, _ in bars]
    assert shares == sorted(shares) and shares[-1] <= 1.0
    came = driver.editor.document.level
    if cancels:
        assert came == before and driver.editor.history.index == steps
        assert any("Cancelled: nothing came in" in notice for notice in driver.notices)
    else:
        assert len(came.bodies) == len(before.bodies) + count and shares[-1] > 0.4
