"""Treads of belts: chevrons run along them as fast as what they carry, to the same side."""

import json

import numpy as np
import pygame
import pytest

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.renderer import Renderer
from sandbox.app.draw.themes import THEMES
from sandbox.app.draw.things.treads import APART, MOST_PASSING, body_treads, ground_treads
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


def ways(tread, vertex, seconds):
    """Where chevrons are, and where they are 10 ms later."""
    places = [tread.places(ZOOM, 1.0, at) for at in (seconds, seconds + 0.01)]
    return [
        np.stack([np.interp(each, tread.arc, np.append(vertex[tread.ends[:, 0], axis], vertex[tread.ends[-1, 1], axis]))
                  for axis in (0, 1)], axis=1)
        for each in places
    ]  # fmt: skip


def test_chevrons_on_top_of_the_ground_run_to_the_right_at_the_speed_of_the_belt():
    terrain = state_of(terrain=[GROUND]).terrain
    (tread,) = ground_treads(terrain)
    before, after = (places[np.abs(places[:, 1]) < 1e-9] for places in ways(tread, terrain.vertex, 0.3))
    moved = np.sort(after[:, 0])[1:-1, None] - np.sort(before[:, 0])[None]
    assert np.abs(moved - 0.015).min(axis=1).max() < 1e-9


def test_a_line_has_chevrons_on_both_sides_that_run_apart():
    terrain = state_of(terrain=[{"id": "line", "polyline": [[-2, 0], [2, 0]], "belt": -1.0}]).terrain
    assert [(tread.side, tread.speed, tread.closed) for tread in ground_treads(terrain)] == [
        (1, -1.0, False), (-1, 1.0, False)
    ]  # fmt: skip


def test_the_tread_of_a_jelly_is_one_way_round_all_of_its_outline():
    state = state_of(terrain=[{**GROUND, "belt": 0.0}], bodies=[JELLY])
    (tread,) = body_treads(state)
    assert tread.closed and tread.side == 0 and tread.arc[-1] == pytest.approx(2.4)
    assert (tread.ends[1:, 0] == tread.ends[:-1, 1]).all()
    assert sorted(tread.springs.tolist()) == np.flatnonzero(state.belt).tolist()
    assert ground_treads(state.terrain) == []


@pytest.mark.parametrize("speed", [0.01, 1.0, 30.0, 1000.0])
def test_chevrons_are_never_so_near_that_they_seem_to_run_back(speed):
    (tread,) = ground_treads(state_of(terrain=[{**GROUND, "belt": speed}]).terrain)
    places = tread.places(ZOOM, 1.0, 12.34)
    apart = np.diff(places).min() if len(places) > 1 else tread.arc[-1]
    assert apart >= min(0.7 * max(APART / ZOOM, speed / MOST_PASSING), tread.arc[-1])
    assert len(places) >= 1 and places.min() >= 0.0 and places.max() < tread.arc[-1]


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
