"""Trails: where things go in the next seconds."""

import json

import numpy as np
import pytest

from sandbox.editor.forecast import SECONDS, Trail
from sandbox.editor.items import Item
from sandbox.level.reading.files import level_data, load_level, parse_level
from sandbox.session.commands import Pin
from sandbox.session.session import Session
from tests.app.conftest import small_level

STONE, ROPE = Item("particle", "stone"), Item("body", "rope")


def thrown():
    """A stone that is thrown in vacuum, beside the small level's ropes."""
    stone = {"id": "stone", "position": [0, 5], "velocity": [3, 4], "mass": 1}
    return small_level(particles=[stone], settings={"gravity": [0, -10], "tick_rate": 120})


def done(trail):
    while not trail.advance(1.0):
        pass
    return trail


def test_the_trail_of_a_thrown_stone_is_its_parabola():
    trail = done(Trail(thrown()))
    (line,) = trail.lines(frozenset([STONE]), 8)
    t = np.arange(len(line)) / trail.per_second
    assert t[-1] == pytest.approx(SECONDS)
    wanted = np.stack([3 * t, 5 + 4 * t - 5 * t * t], axis=1)
    # The velocity is integrated before the place: g h t / 2 further down.
    assert np.abs(line - wanted).max() <= 10 / 120 * SECONDS / 2 * 1.001


def test_a_group_has_one_trail_and_springs_alone_have_none():
    level = load_level("suspension_car")
    trail = done(Trail(level))
    springs = frozenset(item for item in trail.scene.items if item.kind == "spring")
    assert trail.lines(springs, 8) == []
    bodies = frozenset(item for item in trail.scene.items if item.kind == "body")
    assert len(trail.lines(bodies, 8)) == len(bodies) and len(trail.lines(bodies, 2)) == 2


def test_the_trail_of_a_run_goes_where_that_run_went_and_changes_nothing_of_it():
    session = Session(thrown())
    session.submit(Pin(session.world.particle_slot("stone")))
    session.apply_pending()
    for _ in range(240):
        session.advance()
    before = session.snapshot()
    trail = done(Trail(session.level, session.retold(0)))
    (line,) = trail.lines(frozenset([STONE]), 8)
    assert len(line) - 1 == 2 * trail.per_second
    assert np.allclose(line, line[0]) and session.snapshot() is not before
    assert session.tick == 240 and np.array_equal(
        session.world.position, before.position[: len(session.world.position)]
    )


def test_keys_that_a_check_holds_are_held_for_the_trail():
    level = load_level("catapult")
    held = {"name": "throws", "metric": "x", "particle": "arm.0", "at_least": -100, "after": 1,
            "hold": [{"key": "d", "during": [0.0, 1.0]}]}  # fmt: skip
    arm = frozenset([Item("body", "arm")])
    still = done(Trail(level)).lines(arm, 8)[0]
    level = parse_level(json.dumps({**level_data(level), "checks": [held]}).encode(), "a test")
    moved = done(Trail(level)).lines(arm, 8)[0]
    assert np.abs(still - moved).max() > 0.5


def test_too_many_particles_have_no_trail_but_a_line_that_says_so():
    body = {"type": "jelly", "id": "block", "position": [0, 0], "shape": {"box": [20, 20]}, "spacing": 0.25}
    trail = done(Trail(small_level(bodies=[body])))
    assert "too many for a trail" in trail.fault and trail.lines(frozenset([Item("body", "block")]), 8) == []
