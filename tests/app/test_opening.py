"""The window with words, while the rest is imported."""

import pygame
import pytest

from sandbox.app.base.display import Display, StartRequest
from sandbox.app.draw.colours import BACKGROUND, TEXT
from sandbox.app.window.opening import open_app
from tests.app.conftest import small_level


@pytest.fixture
def pictures(monkeypatch, documents):
    """What the window has shown so far."""
    shown = []

    def flip(display):
        shown.append(display.surface.copy())

    monkeypatch.setattr(Display, "flip", flip)
    return shown


def test_words_are_in_the_window_before_anything_is_looked_for(pictures, capsys):
    found = []

    def find():
        colours = {tuple(pictures[0].get_at((x, y)))[:3] for x in range(400, 880) for y in range(280, 340)}
        found.append(colours)
        return StartRequest(small_level())

    assert open_app(find, profile=True, seconds=0.0) == 0
    assert {tuple(BACKGROUND), tuple(TEXT)} <= found[0]
    assert "words in the window: after" in capsys.readouterr().out


def test_the_words_can_be_read_in_the_theme_that_was_chosen(pictures):
    assert open_app(lambda: StartRequest(small_level()), seconds=0.0, theme="light") == 0
    background, text = tuple(BACKGROUND), tuple(TEXT)
    seen = [
        {tuple(picture.get_at((x, y)))[:3] for x in range(400, 880) for y in range(280, 340)}
        for picture in pictures
        if all(tuple(picture.get_at((5, y)))[:3] == background for y in (5, picture.get_height() - 5))
    ]
    assert seen and all(text in colours for colours in seen)


def test_a_fault_closes_the_window_and_is_raised(pictures, monkeypatch):
    closed = []
    monkeypatch.setattr(Display, "close", lambda display: closed.append(display))

    def find():
        raise FileNotFoundError("nothing there")

    with pytest.raises(FileNotFoundError, match="nothing there"):
        open_app(find)
    assert len(closed) == 1


def test_closing_the_window_early_ends_the_program(pictures, monkeypatch):
    monkeypatch.setattr("sandbox.app.window.app.run_app", lambda *_: pytest.fail("the app was opened"))
    pygame.display.init()
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    assert open_app(lambda: StartRequest(small_level())) == 0


def test_keys_pressed_while_the_words_are_shown_reach_the_app(pictures, monkeypatch):
    seen = []

    def find():
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_h, mod=0, unicode="h", scancode=0))
        return StartRequest(small_level())

    monkeypatch.setattr("sandbox.app.window.app.run_app", lambda *_: seen.extend(pygame.event.get(pygame.KEYDOWN)))
    assert open_app(find) == 0
    assert [event.key for event in seen] == [pygame.K_h]
