"""A fault of the program's own is written down and told; the work stays, and goes on."""

import pygame
import pytest

from sandbox.app.base.display import _guessed_scale
from sandbox.app.base.shortcuts import Shortcut, _combination, combination_of
from sandbox.app.window import files
from sandbox.app.window.failure import MOST, FrameGuard, reports_folder
from sandbox.app.window.input import by_place
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import load_level
from tests.app.conftest import small_level


def fail(driver, monkeypatch):
    """Let the next frame fail, and tell of it; the guard."""
    guard = FrameGuard(driver.app)
    with monkeypatch.context() as once:
        once.setattr(driver.app.status, "update", lambda frame_time: 1 / 0)
        try:
            driver.app.frame(1 / 60)
        except ZeroDivisionError as error:
            guard.take(error)
    return guard


@pytest.mark.parametrize("is_edited", [False, True])
def test_a_fault_is_kept_in_a_file_and_the_run_or_the_document_goes_on(open_app, edit, monkeypatch, is_edited):
    driver = edit(load_level("rope")) if is_edited else open_app(small_level())
    level = driver.editor.document.level if is_edited else None
    fail(driver, monkeypatch)
    (report,) = reports_folder().glob("*.txt")
    text = report.read_text(encoding="utf-8")
    assert "ZeroDivisionError" in text and "in frame" in text and "Spring Sandbox" in text
    driver.frames(2)
    assert driver.app.ui.has_sheet and driver.app.running
    driver.choose("Go on")
    driver.frames(5)
    assert not driver.app.ui.has_sheet
    if is_edited:
        assert driver.editor.document.level is level
    else:
        assert driver.world.tick > 3


def test_the_report_can_be_copied(open_app, monkeypatch):
    driver = open_app(small_level())
    guard = fail(driver, monkeypatch)
    driver.frames(1)
    driver.choose("Copy the report")
    assert any("clipboard" in notice for notice in driver.notices) and "ZeroDivisionError" in guard.report


def test_faults_without_an_end_end_the_program(open_app):
    guard = FrameGuard(open_app(small_level()).app)
    for _ in range(MOST - 1):
        guard.take(ValueError("again"))
    with pytest.raises(SystemExit, match=r"Your work is kept. A report is in .*txt"):
        guard.take(ValueError("again"))


def test_a_screen_that_cannot_be_laid_out_again_ends_the_program_in_one_line(open_app, monkeypatch):
    driver = open_app(small_level())
    guard = FrameGuard(driver.app)

    def fail() -> None:
        raise IndexError("no such body")

    monkeypatch.setattr(driver.app, "rebuild", fail)
    with pytest.raises(SystemExit, match=r"closes. Your work is kept. A report is in .*txt"):
        guard.take(ValueError("first"))
    assert "no such body" in guard.report


@pytest.mark.parametrize("letter", ["\u00df", "\u0149", "\u0131", "\u0130", "\u01f0", "\u00e4", "\u044f"])
def test_a_letter_of_any_alphabet_can_be_a_shortcut(letter):
    name = combination_of(ord(letter), 0)
    assert name is not None and _combination(name)[0] in (ord(letter), ord(letter.lower()[0]))


@pytest.mark.parametrize(
    ("key", "scancode", "expected"),
    [(0x44F, pygame.KSCAN_Z, pygame.K_z), (0x3C6, pygame.KSCAN_F, pygame.K_f), (0x5D0, pygame.KSCAN_T, pygame.K_t),
     (pygame.K_y, pygame.KSCAN_Z, pygame.K_y), (0xDF, pygame.KSCAN_MINUS, 0xDF),
     (pygame.K_LEFT, pygame.KSCAN_LEFT, pygame.K_LEFT), (0x451, pygame.KSCAN_GRAVE, 0x451)],
)  # fmt: skip
def test_keys_go_by_their_place_where_the_layout_has_no_latin_letter(key, scancode, expected):
    event = pygame.event.Event(pygame.KEYDOWN, key=key, scancode=scancode, mod=0, unicode="")
    assert by_place(event).key == expected


def test_a_cyrillic_layout_pauses_by_the_key_that_has_the_k(open_app):
    driver = open_app(small_level())
    driver.post(pygame.KEYDOWN, key=0x43B, scancode=pygame.KSCAN_K, mod=0, unicode="\u043b")
    driver.frames(2)
    assert driver.playback.clock.paused


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "x", ""])
def test_a_scale_that_is_no_number_is_passed_over(monkeypatch, value):
    monkeypatch.setenv("GDK_SCALE", value)
    monkeypatch.delenv("QT_SCALE_FACTOR", raising=False)
    assert _guessed_scale((1920, 1080)) == 1.0


@pytest.mark.parametrize("key", ["Alt+O", "SS", "Ctrl+", ""])
def test_a_key_that_is_none_is_refused_where_its_action_is_declared(key):
    with pytest.raises(ValueError, match=r"act: .* is no key"):
        Shortcut("act", ("A", key), "Act", "View")


@pytest.mark.parametrize("is_edited", [False, True])
def test_a_level_that_goes_while_its_name_is_typed_is_told_in_a_line(open_app, edit, monkeypatch, is_edited):
    driver = edit(load_level("rope")) if is_edited else open_app(small_level())
    mode = driver.app.mode
    driver.app.files.ask_to_open()
    driver.frames(2)
    driver.type("rope")
    real = files.load_level
    found = iter([real])

    def gone(name):
        reading = next(found, None)
        if reading is None:
            raise LevelError(name, [("", "cannot be read: it is not there")])
        return reading(name)

    told = []
    monkeypatch.setattr(files, "load_level", gone)
    monkeypatch.setattr(driver.app, "show_faults", lambda title, lines: told.append((title, lines)))
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert driver.app.mode == mode
    assert told == [("rope cannot be opened", ["rope: cannot be read: it is not there"])]
