"""Joined things on the sheet: a drag keeps them joined, and says where it cannot."""

import numpy as np
import pygame
import pytest

from sandbox.editor.items import Item
from tests.app.conftest import small_level

CTRL, ALT = pygame.KMOD_CTRL, pygame.KMOD_ALT


@pytest.fixture
def driver(edit):
    """A rope from the air to a jelly, and a rope between two jellies."""

    def jelly(name, x):
        return {"type": "jelly", "id": name, "shape": {"box": [1, 1]}, "spacing": 0.5, "position": [x, 0],
                "material": "rubber"}  # fmt: skip

    bodies = [
        jelly("jelly", 0.5), jelly("other", 5.5),
        {"type": "rope", "id": "rope", "start": [-2, 2], "end": [0, 0], "segments": 8, "material": "steel"},
        {"type": "rope", "id": "line", "start": [1, 0], "end": [5, 0], "segments": 8, "material": "steel"},
    ]  # fmt: skip
    welds = [["jelly.3", "rope.end"], ["jelly.5", "line.start"], ["other.3", "line.end"]]
    return edit(small_level(bodies=bodies, welds=welds))


def body(driver, name):
    return next(part for part in driver.editor.document.level.bodies if part.id == name)


def test_a_rope_dragged_by_its_middle_stays_at_its_join(driver):
    driver.drag((-1, 1), (-1.5, 0), (-2, -0.5), mods=ALT)

    rope = body(driver, "rope")
    assert rope.end == (0.0, 0.0) and np.allclose(rope.start, (-3.0, 0.5), atol=0.05)
    driver.key(pygame.K_z, CTRL)
    assert body(driver, "rope").start == (-2.0, 2.0)


def test_both_ropes_follow_a_jelly_that_is_dragged(driver):
    driver.editor.select(frozenset([Item("body", "jelly")]))
    driver.key(pygame.K_UP)

    moved = body(driver, "jelly").position[1]
    assert moved > 0.0
    assert body(driver, "rope").end == pytest.approx((0.0, moved)) and body(driver, "rope").start == (-2.0, 2.0)
    assert body(driver, "line").start == pytest.approx((1.0, moved)) and body(driver, "line").end == (5.0, 0.0)


def test_a_rope_that_two_joins_hold_says_why_it_does_not_move(driver):
    before = driver.editor.document.level
    driver.drag((3, 0), (3, 0.5), (3, 1), mods=ALT)

    assert driver.editor.document.level is before
    assert any(notice.startswith("Nothing moved: its joins hold it.") for notice in driver.notices)


def test_an_end_that_is_dragged_off_says_that_it_is_joined_no_longer(driver):
    driver.editor.select(frozenset([Item("body", "rope")]))
    driver.drag((0, 0), (-0.5, 1), (-1, 3), mods=ALT)

    assert len(driver.editor.document.level.welds) == 2
    assert 'No longer joined: "jelly" and "rope". Undo joins them again.' in driver.notices
