"""Outlines of a running world: in order, about what is solid, and true after a cut."""

import numpy as np
import pytest

from sandbox import Session, outlines
from sandbox.commands import CutSprings
from sandbox.export.flat import flat
from sandbox.level.reading.files import load_level
from sandbox.physics.geometry.segment import signed_area
from tests.level.test_contacts_by_name import BALL, GROUND, JELLY, level_of


def area_of(points):
    return signed_area(points, np.roll(points, -1, axis=0))


def test_a_jelly_has_a_closed_rim_about_its_area_and_terrain_the_corners_of_its_file():
    session = Session(level_of(terrain=[GROUND], particles=[BALL], bodies=[JELLY | {"look": {"colour": "#102030"}}]))
    jelly, ground = outlines(session.world)
    assert (jelly.name, jelly.closed, jelly.solid, jelly.colour) == ("jelly", True, True, 0x102030)
    assert area_of(jelly.points) == pytest.approx(1.0)
    assert (ground.name, ground.closed, ground.solid, len(ground.particles)) == ("ground", True, True, 0)
    assert area_of(ground.points) == pytest.approx(10.0)
    session.advance()
    moved = outlines(session.world)[0]
    assert (
        np.array_equal(moved.points, session.world.position[jelly.particles]) and (moved.points != jelly.points).any()
    )


def test_walls_enclose_nothing_and_a_line_of_terrain_is_open():
    line = {"id": "slope", "polyline": [[0, 1], [1, 0], [2, 0]]}
    slope, walls = outlines(Session(level_of(terrain=[line], walls={"box": [-4, 0, 4, 5]})).world)
    assert (slope.closed, slope.solid, slope.points.tolist()) == (False, False, [[0, 1], [1, 0], [2, 0]])
    assert (walls.name, walls.closed, walls.solid, len(walls.points)) == ("walls", True, False, 4)


@pytest.mark.parametrize("name", ["jelly_pile", "rope", "curtain", "suspension_bridge", "balloons"])
def test_at_the_start_bodies_have_the_outlines_that_a_flat_export_writes(name):
    level = load_level(name)
    world = Session(level).world
    found = [(each.name, each.closed, sorted(each.particles.tolist())) for each in outlines(world)]
    ids = {piece.id for piece in level.terrain} | {"walls"}
    exported = flat(level)
    assert [each for each in found if each[0] not in ids] == [
        (body.id, outline.closed, sorted(outline.particles)) for body in exported.bodies for outline in body.outlines
    ]


def test_a_jelly_that_is_cut_in_two_has_two_rims_and_a_rope_two_lines():
    jelly = JELLY | {"shape": {"box": [2, 1]}, "position": [0, 2]}
    rope = {"id": "rope", "type": "rope", "start": [-3, 4], "end": [3, 4], "segments": 10}
    session = Session(level_of(bodies=[jelly, rope]))
    world = session.world
    ends = world.position[np.stack([world.particle_a, world.particle_b])][:, :, 0]
    crossing = np.flatnonzero(world.spring_active & (ends.min(axis=0) < 0.1) & (ends.max(axis=0) > 0.1)).tolist()
    session.submit(CutSprings(tuple(crossing)))
    session.advance()
    found = outlines(world)
    assert [(each.name, each.closed, each.solid) for each in found] == [
        *[("jelly", True, True)] * 2, *[("rope", False, False)] * 2
    ]  # fmt: skip
    assert sum(area_of(each.points) for each in found[:2]) == pytest.approx(2.0 * 7 / 8, rel=0.05)
    assert sum(len(each.points) for each in found[2:]) == 11


def test_the_outline_of_a_hole_runs_the_other_way_and_is_not_solid():
    square = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
    shape = {"mesh": "fitted", "shape": {"polygon": square}, "holes": [[[0.4 * x, 0.4 * y] for x, y in square]]}
    rims = outlines(Session(level_of(bodies=[JELLY | shape | {"position": [0, 2]}])).world)
    assert sorted((each.solid, round(area_of(each.points), 1)) for each in rims) == [(False, -0.6), (True, 4.0)]
