"""Treads of belts: chevrons run along them as fast as what they carry, to the same side."""

import json
from dataclasses import replace

import numpy as np
import pygame
import pytest

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.renderer import Renderer
from sandbox.app.draw.things.belt_marks import APART, MOST_PASSING, body_belts, ground_belts, mark_belts
from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import take
from sandbox.physics.step import step

ZOOM = 60.0
GROUND = {"id": "ground", "polygon": [[-4, -1], [4, -1], [4, 0], [-4, 0]], "belt": 1.5}
JELLY = {"type": "jelly", "id": "b", "shape": {"box": [0.8, 0.4]}, "position": [0, 3], "spacing": 0.2, "belt": 0.5}
# As bright as chevrons alone are, on ground and stage.
BRIGHT = (200, 150, 40)


def level_of(**parts):
    data = {"format": "spring-sandbox/level", "version": 2, "name": "belts", **parts}
    return parse_level(json.dumps(data).encode(), "belts")


def state_of(**parts):
    return take(build_world(level_of(**parts)))


WHOLE = np.array([[0.0, 1.0]])


def places(tread, seconds):
    """Where chevrons are along the way of a tread [m]."""
    edge, share = tread.chevrons(ZOOM, 1.0, seconds, np.repeat(WHOLE, len(tread.ends), axis=0))
    return tread.arc[edge] + share * (tread.arc[edge + 1] - tread.arc[edge])


def on_top(tread, vertex, seconds):
    """How far to the right [m] chevrons are that are on top of the ground."""
    edge, share = tread.chevrons(ZOOM, 1.0, seconds, np.repeat(WHOLE, len(tread.ends), axis=0))
    a, b = vertex[tread.ends[edge]].transpose(1, 0, 2)
    at = a + share[:, None] * (b - a)
    return np.sort(at[np.abs(at[:, 1]) < 1e-9, 0])


def test_chevrons_on_top_of_the_ground_run_to_the_right_at_the_speed_of_the_belt():
    terrain = state_of(terrain=[GROUND]).terrain
    (tread,) = ground_belts(terrain)
    before, after = (on_top(tread, terrain.vertex, at) for at in (0.3, 0.31))
    moved = after[1:-1, None] - before[None]
    assert len(before) > 10 and np.abs(moved - 0.015).min(axis=1).max() < 1e-9


def test_a_line_has_chevrons_on_both_sides_that_run_apart():
    terrain = state_of(terrain=[{"id": "line", "polyline": [[-2, 0], [2, 0]], "belt": -1.0}]).terrain
    assert [(tread.side, tread.speed, tread.closed) for tread in ground_belts(terrain)] == [
        (1, -1.0, False), (-1, 1.0, False)
    ]  # fmt: skip


def test_the_tread_of_a_jelly_is_one_way_round_all_of_its_outline():
    state = state_of(terrain=[{**GROUND, "belt": 0.0}], bodies=[JELLY])
    (tread,) = body_belts(state)
    assert tread.closed and tread.side == 0 and tread.arc[-1] == pytest.approx(2.4)
    assert (tread.ends[1:, 0] == tread.ends[:-1, 1]).all()
    assert sorted(tread.springs.tolist()) == np.flatnonzero(state.belt).tolist()
    assert ground_belts(state.terrain) == []


@pytest.mark.parametrize("speed", [0.01, 1.0, 30.0, 1000.0])
def test_chevrons_are_never_so_near_that_they_seem_to_run_back(speed):
    (tread,) = ground_belts(state_of(terrain=[{**GROUND, "belt": speed}]).terrain)
    found = places(tread, 12.34)
    apart = np.diff(found).min() if len(found) > 1 else tread.arc[-1]
    assert apart >= min(0.7 * max(APART / ZOOM, speed / MOST_PASSING), tread.arc[-1])
    assert len(found) >= 1 and found.min() >= 0.0 and found.max() < tread.arc[-1]


def test_of_a_belt_as_long_as_a_level_may_be_no_more_is_drawn_than_is_seen():
    level = level_of(terrain=[{**GROUND, "polygon": [[-1e6, -1], [1e6, -1], [1e6, 0], [-1e6, 0]]}])
    state, layer = take(build_world(level)), MarkList()
    camera = Camera((5e5, 0.0), 2000.0, (0, 0, 640, 360))
    at, none = camera.project(state.terrain.vertex), np.zeros(0, dtype=np.bool_)
    mark_belts(layer, ground_belts(state.terrain), at, none, camera, 1.0, 0.5, THEMES["dark"])
    drawn = layer.arrays()
    assert drawn is not None and 8 < len(drawn.ends) < 200
    assert np.abs(drawn.ends).max() < 1000.0


def test_what_is_nowhere_or_has_no_length_has_no_tread():
    state = state_of(terrain=[GROUND])
    (tread,) = ground_belts(state.terrain)
    layer, camera, none = MarkList(), Camera((0.0, 0.0), ZOOM, (0, 0, 640, 360)), np.zeros(0, dtype=np.bool_)
    flat = replace(tread, arc=np.zeros_like(tread.arc))
    mark_belts(layer, [tread, flat], np.full((4, 2), np.nan), none, camera, 1.0, 0.5, THEMES["dark"])
    assert layer.arrays() is None


def bright(surface):
    pixels = pygame.surfarray.array3d(surface).astype(int)
    return (pixels[..., 0] > BRIGHT[0]) & (pixels[..., 1] > BRIGHT[1]) & (pixels[..., 2] < pixels[..., 0] - BRIGHT[2])


@pytest.mark.parametrize("theme", THEMES)
def test_a_world_in_which_nothing_else_moves_is_drawn_again_with_each_tick(theme):
    level = level_of(terrain=[GROUND])
    world, renderer = build_world(level), Renderer(1.0, level)
    renderer.theme = THEMES[theme]
    camera, found = Camera((0.0, 0.0), ZOOM, (0, 0, 640, 360)), []
    for _ in range(3):
        surface = pygame.Surface((640, 360), 0, 32)
        # Once it is drawn with little care, once with all of it.
        for _ in range(2):
            renderer.draw(surface, camera, take(world), take(world), 1.0)
        found.append(bright(surface))
        step(world)
    assert all(each.sum() > 200 for each in found)
    assert (found[0] != found[1]).any() and (found[1] != found[2]).any()


def test_a_spring_that_is_cut_has_no_tread():
    level = level_of(terrain=[{**GROUND, "belt": 0.0}], bodies=[JELLY])
    world, renderer = build_world(level), Renderer(1.0, level)
    camera, counts = Camera((0.0, 3.0), 200.0, (0, 0, 640, 360)), []
    for cut in ([], np.flatnonzero(world.belt)[:8].tolist()):
        world.cut(cut)
        surface = pygame.Surface((640, 360), 0, 32)
        for _ in range(2):
            renderer.draw(surface, camera, take(world), take(world), 1.0)
        counts.append(int(bright(surface).sum()))
    assert 0 < counts[1] < 0.7 * counts[0]
