"""What is stuck is said, marked and freed with one button."""

import pygame
import pytest

from sandbox.app.play import stuck
from sandbox.physics.changing.freeing import overlapping
from tests.session.test_freeing import cage


@pytest.fixture
def caged(open_app, monkeypatch):
    """Two jellies in a cage that is too small for both, for longer than it takes to be called stuck."""
    monkeypatch.setattr(stuck, "STUCK_SECONDS", 0.1)
    driver = open_app(cage())
    driver.frames(4)
    return driver


def test_what_stays_in_something_is_said_and_a_button_frees_it(caged):
    assert not caged.app.screen.free.visible
    caged.frames(20)
    assert caged.app.screen.stuck.particles == [0]
    assert stuck.NOTICE in caged.notices
    caged.click_widget(caged.app.screen.free)
    caged.frames(10)
    assert not overlapping(caged.world)
    assert not caged.app.screen.free.visible and not caged.app.screen.stuck.particles
    caged.key(pygame.K_z, pygame.KMOD_CTRL)
    caged.frames(2)
    assert overlapping(caged.world)


def test_its_key_says_where_nothing_is_stuck(caged):
    caged.key(pygame.K_j)
    caged.frames(2)
    assert "Nothing is stuck." in caged.notices
    assert not caged.playback.session.can_undo
