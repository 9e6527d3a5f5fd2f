"""A link to the run so far, by Ctrl+Shift+L and from the page of sharing: what is copied is the run, to the bit."""

import pygame
import pytest

from sandbox.app.base import desktop
from sandbox.app.share.page import NO_SITE, so_far
from sandbox.app.widgets.field import Field
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import AddParticle, CutSprings
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.link import replay_of
from tests.app.conftest import small_level


@pytest.fixture
def copied(monkeypatch):
    """What is put on the clipboard."""
    found = []
    monkeypatch.setattr(desktop, "_clipboard_tool", lambda: None)
    monkeypatch.setattr(desktop.pygame.scrap, "put_text", found.append)
    return found


def played(driver):
    """The session of a run of half a second with a thing added, and one that was undone."""
    session = driver.app.play.playback.session
    session.do(AddParticle((0.5, 2.0), mass=2.0, radius=0.1))
    driver.frames(20)
    session.submit(CutSprings((0,)))
    driver.frames(5)
    session.undo()
    driver.frames(5)
    return session


def test_the_link_that_is_copied_is_the_run_without_what_was_undone(open_app, copied):
    driver = open_app(small_level())
    driver.app.chosen.choose("link_site", "https://toys.example/play")
    session = played(driver)
    driver.key(pygame.K_l, pygame.KMOD_CTRL | pygame.KMOD_SHIFT)
    driver.frames(60)
    (link,) = copied
    assert link.startswith("https://toys.example/play#scene=") and not driver.app.ui.has_sheet
    replay = replay_of(link)
    assert 0 < replay.ticks <= session.tick and verify(replay) is None
    assert [line.record["type"] for line in replay.script] == ["add_particle"]


def test_without_a_site_it_is_for_sandbox_open_and_a_toy_of_a_new_place_has_one_too(open_app, copied):
    driver = open_app()
    driver.app.documents.play_new()
    driver.frames(2)
    driver.app.play.playback.submit(AddParticle((0.5, 2.0), mass=2.0, radius=0.1))
    driver.frames(20)
    driver.key(pygame.K_l, pygame.KMOD_CTRL | pygame.KMOD_SHIFT)
    driver.frames(60)
    (link,) = copied
    assert link.startswith("#scene=") and verify(replay_of(link)) is None
    assert driver.notices[-1].endswith(NO_SITE)


def test_an_address_that_is_none_is_said_in_the_settings_and_not_taken(open_app):
    driver = open_app(small_level())
    driver.app.act("settings")
    driver.frames(2)
    (field,) = [each for each in driver.app.ui.ring() if isinstance(each, Field)]
    driver.fill(field, "toys.example")
    assert driver.app.chosen["link_site"] == ""
    driver.fill(field, "https://toys.example")
    assert driver.app.chosen["link_site"] == "https://toys.example"


def test_the_run_so_far_ends_as_the_world_is_now(open_app):
    session = played(open_app(small_level()))
    replay = so_far(session)
    assert replay.end_hash == state_hash(session.world) and replay.ticks == session.tick
