"""What is stuck is said, marked and freed with one button."""

import pygame
import pytest

from sandbox.app.play import problems
from sandbox.physics.analysis.applied_forces import overlapping
from sandbox.session.commands import AddBody
from tests.session.test_freeing import cage


@pytest.fixture
def caged(open_app, monkeypatch):
    """Two jellies in a cage that is too small for both, for longer than it takes to be called stuck."""
    monkeypatch.setattr(problems, "STUCK_SECONDS", 0.1)
    driver = open_app(cage())
    driver.frames(4)
    return driver


def test_what_stays_in_something_is_said_and_a_button_frees_it(caged):
    assert not caged.app.screen.problems.quick_fixes.buttons["free"].visible
    caged.frames(20)
    assert caged.app.screen.problems.stuck.particles == [0]
    assert problems.STUCK in caged.notices
    caged.click_widget(caged.app.screen.problems.quick_fixes.buttons["free"])
    caged.frames(10)
    assert not overlapping(caged.world)
    assert (
        not caged.app.screen.problems.quick_fixes.buttons["free"].visible
        and not caged.app.screen.problems.stuck.particles
    )
    caged.key(pygame.K_z, pygame.KMOD_CTRL)
    caged.frames(2)
    assert overlapping(caged.world)


@pytest.mark.parametrize("paused", [False, True])
def test_the_addition_of_what_is_stuck_can_be_undone(caged, paused):
    before = caged.world.particle_count
    # A tool that drops looks for room first; a command does not.
    caged.playback.submit(AddBody({"type": "jelly", "shape": {"box": [0.8, 0.8]}, "spacing": 0.2, "position": [0, 0]}))
    caged.frames(30)
    assert any(particle >= before for pair in overlapping(caged.world) for particle in pair)
    if paused:
        caged.key(pygame.K_SPACE)
    caged.key(pygame.K_z, pygame.KMOD_CTRL)
    caged.frames(2)
    assert caged.world.particle_count == before
    assert all(particle < before for particle in caged.app.screen.problems.stuck.particles)


def test_its_key_says_where_nothing_is_stuck(caged):
    caged.key(pygame.K_j)
    caged.frames(2)
    assert "Nothing is stuck." in caged.notices
    assert not caged.playback.session.can_undo
