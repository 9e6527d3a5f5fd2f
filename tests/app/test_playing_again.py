"""Playing a long run again: its bar, and cancelling it."""

import pygame

from sandbox.app.play.status import draw_work
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import Pin

CTRL = pygame.KMOD_CTRL


def _cancel_while_it_is_played_again(driver, monkeypatch, post):
    """Let the bar be seen at once; post does what the person does as soon as it is there."""
    drawn = []

    def draw(*arguments):
        drawn.append(draw_work(*arguments))
        if len(drawn) == 1:
            post(drawn[0])
        return drawn[0]

    monkeypatch.setattr("sandbox.app.play.status._PATIENCE", 0.0)
    monkeypatch.setattr("sandbox.app.play.status._DRAWN_EVERY", 0.0)
    monkeypatch.setattr("sandbox.app.play.status.draw_work", draw)
    return drawn


def _press_escape(driver):
    return lambda button: driver.post(pygame.KEYDOWN, key=pygame.K_ESCAPE, mod=0, unicode="", scancode=0)


def _played(driver, ticks=40):
    """A run with something to undo at its beginning, and something after that."""
    session = driver.playback.session
    driver.playback.submit(Pin(3))
    driver.frames(ticks)
    driver.playback.submit(Pin(5))
    driver.frames(10)
    driver.playback.clock.paused = True
    driver.frames(2)
    return session


def test_escape_while_an_undo_plays_the_run_again_leaves_all_as_it_was(driver, monkeypatch):
    session = _played(driver)
    driver.key(pygame.K_z, CTRL)
    before = state_hash(session.world), session.tick, session.gestures, session.can_undo, session.can_redo
    drawn = _cancel_while_it_is_played_again(driver, monkeypatch, _press_escape(driver))
    driver.key(pygame.K_z, CTRL)
    assert len(drawn) == 1 and "Cancelled. The run did not change." in driver.notices
    assert (state_hash(session.world), session.tick, session.gestures, session.can_undo, session.can_redo) == before
    # What was cancelled can be done again.
    driver.key(pygame.K_z, CTRL)
    assert not session.gestures and state_hash(session.world) != before[0] and len(drawn) > 2


def test_the_button_cancels_a_recording_of_what_was_played_and_leaves_no_file(driver, monkeypatch, documents):
    session = _played(driver)
    click = lambda button: driver.post(pygame.MOUSEBUTTONDOWN, pos=button.center, button=1)  # noqa: E731
    drawn = _cancel_while_it_is_played_again(driver, monkeypatch, click)
    driver.key(pygame.K_r, CTRL)
    assert len(drawn) == 1 and session.recording is None and not list(documents.iterdir())
    assert "Cancelled: no recording was made." in driver.notices
    driver.key(pygame.K_r, CTRL)
    assert session.recording is not None


def test_a_window_that_is_to_be_closed_does_not_wait_for_a_run_to_be_played_again(driver, monkeypatch):
    session = _played(driver)
    tick = session.tick
    session.history.keyframes.drop_beyond(0)
    drawn = _cancel_while_it_is_played_again(driver, monkeypatch, lambda button: driver.post(pygame.QUIT))
    driver.playback.seek(tick - 2)
    assert len(drawn) == 1 and session.tick == tick and driver.playback.clock.paused
    driver.frames(2)
    assert not driver.app.running


def test_two_runs_side_by_side_are_played_again_together_or_not_at_all(driver, monkeypatch):
    driver.key(pygame.K_F9)
    _played(driver)
    shown = []
    monkeypatch.setattr("sandbox.app.play.status._PATIENCE", 0.0)
    monkeypatch.setattr("sandbox.app.play.status.draw_bar", lambda *_: shown.append(_press_escape(driver)(None)))
    driver.key(pygame.K_z, CTRL)
    driver.key(pygame.K_z, CTRL)
    screen = driver.app.play
    assert shown and [len(run.session.gestures) for run in (screen.playback, screen.other)] == [0, 0]
