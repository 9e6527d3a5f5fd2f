"""Notices: whole in any window, beside the parts to play with, under pages, and never over most of a low world."""

import pygame
import pytest

from sandbox.app.draw.colours import TEXT
from sandbox.app.play.drive_keys import KEYS_HEIGHT
from sandbox.app.play.status import STATUS_HEIGHT
from sandbox.app.play.toolbar import PartsPalette
from sandbox.app.run.playback import Playback
from sandbox.level.reading.files import load_level
from tests.app.conftest import small_level

LONG = "A line of many words " * 12


def seen(driver, text, axis=0):
    """Columns of pixels of the window that a notice changes; axis 1: rows."""
    driver.app._describe("")
    driver.frames(2)
    before = pygame.surfarray.array3d(driver.app.display.surface)
    driver.app.say(text)
    driver.frames(1)
    after = pygame.surfarray.array3d(driver.app.display.surface)
    return (before != after).any(axis=(1 - axis, 2)).nonzero()[0]


def test_a_notice_is_as_narrow_as_the_window(driver):
    driver.app.act("pause")
    driver.app.display.window.size = (640, 480)
    driver.app.chosen.choose("scale", 1.5)
    driver.frames(2)
    columns = seen(driver, LONG)
    assert len(columns) and columns.max() < 640 - 10


def test_a_notice_lies_beside_the_parts(driver):
    driver.app.act("pause")
    driver.app.act("palette")
    driver.frames(2)
    palette = driver.app.play.palette
    assert isinstance(palette, PartsPalette)
    columns = seen(driver, LONG)
    assert columns.min() >= palette.back.rect.right


@pytest.mark.parametrize(("size", "above"), [((640, 480), KEYS_HEIGHT), ((1280, 720), 0.0)])
def test_a_notice_leaves_the_keys_of_a_level_in_sight(driver, size, above):
    driver.app.start(Playback(load_level("pinball")))
    driver.app.act("pause")
    driver.app.display.window.size = size
    driver.frames(2)
    assert driver.app.play._keys.shown()
    assert driver.app.play.notices_place[1] == driver.app.play._below + above


def test_in_a_low_world_one_notice_at_a_time_lies_over_the_status_line(driver):
    driver.app.act("pause")
    driver.app.act("compare")
    driver.app.display.window.size = (640, 480)
    driver.frames(2)
    driver.app._notices.clear()
    line = driver.app.ui.size[1] - driver.app.ui.px(STATUS_HEIGHT)
    assert driver.app.play.notices_place is None
    assert seen(driver, "A short line.", axis=1).min() > line - 12
    driver.app.say(LONG)
    first, second = driver.app._notices
    left = first.left, second.left
    driver.frames(6)
    assert first.left == left[0] and second.left < left[1], "what is not seen waits"
    driver.app.display.window.size = (1280, 720)
    driver.frames(2)
    assert driver.app.play.notices_place is not None
    driver.frames(2)
    assert first.left < left[0]


def test_what_was_said_before_a_page_opened_lies_under_it_and_what_is_said_of_the_page_over_it(driver):
    driver.app.act("pause")
    driver.app._describe("")
    driver.app.act("open")
    driver.frames(3)
    shown = pygame.surfarray.array3d(driver.app.display.surface)
    driver.key(pygame.K_ESCAPE)
    driver.app.say(LONG)
    driver.app.act("open")
    driver.frames(3)
    under = abs(pygame.surfarray.array3d(driver.app.display.surface).astype(int) - shown)
    driver.app._notices.clear()
    driver.app.say(LONG)
    driver.frames(1)
    over = abs(pygame.surfarray.array3d(driver.app.display.surface).astype(int) - shown)
    assert 0 < under.max() < 60 < 120 < over.max()


def test_the_last_part_of_the_status_line_that_has_any_room_is_shortened(driver):
    status, surface = driver.app.status, driver.app.display.surface
    status.draw(surface, [("a part of the line " * 20, TEXT)])
    row = pygame.surfarray.array3d(surface)[:, -20]
    assert (row[-200:] != row[-1]).any() and (row[-8:] == row[-1]).all()


def test_what_broke_in_the_run_is_not_said_over_the_gallery(open_app):
    brittle = {"stiffness": 0.3, "damping": 0.3, "tension_limit": 1e-4}
    materials = {"steel": brittle, "rubber": {"stiffness": 0.02, "damping": 0.1}}
    driver = open_app(small_level(settings={"solver": "single_pass"}, materials=materials))
    driver.frames(30)
    driver.app.say("Saved as a file.")
    assert any("broke" in text for text in driver.notices)
    driver.app.open_gallery()
    assert driver.notices == ["Saved as a file."]


def test_what_is_said_of_a_run_ends_with_it_and_what_is_said_of_files_stays(driver):
    driver.app.act("melt")
    driver.app.say("Saved as a file.")
    driver.frames(1)
    assert len(driver.notices) == 2
    driver.app.start(Playback(load_level("rope")))
    driver.frames(1)
    assert "Saved as a file." in driver.notices and not any("one spring" in text.lower() for text in driver.notices)
    driver.app.act("melt")
    driver.frames(1)
    assert any("one spring" in text.lower() for text in driver.notices)
    driver.app.act("reset")
    driver.frames(1)
    assert not any("one spring" in text.lower() for text in driver.notices)


def test_what_went_out_of_bounds_is_said_in_plain_words_and_its_numbers_behind_details(driver):
    details = driver.app.play.problems.quick_fixes.buttons["details"]
    assert not details.visible
    for name in ("rope.2", "rope.3"):
        driver.world.velocity[driver.world.particle_slot(name)] = 1e300
    driver.frames(3)
    said = [text for text in driver.notices if "out of bounds" in text]
    assert said == ["The rope went out of bounds and was stopped. A click with Pin lets it go."]
    assert not any("tick" in text or "rope." in text for text in driver.notices)
    driver.click_widget(details)
    lines = driver.playback.stopped.details(driver.world.tick)
    assert len(lines) == 2 and "rope.2" in lines[0] and lines[0].startswith("tick ")
    sprites = driver.app.ui.walk()
    block = next(each for each in sprites if getattr(each, "text", "") == "\n".join(lines))
    assert block.visible
    driver.key(pygame.K_ESCAPE)
    driver.app.act("reset")
    driver.frames(2)
    assert not details.visible and not any("out of bounds" in text for text in driver.notices)
