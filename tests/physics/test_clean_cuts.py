"""A cut along a stroke: the edge of the pieces is the stroke, and mass, momentum, its moment and area stay."""

import copy
import json
import math

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.query import shares_crossed, springs_crossing
from sandbox.physics.commands.command_table import RefusedCommand
from sandbox.physics.constraints import AREA
from sandbox.physics.geometry.segment import signed_area
from sandbox.physics.marks import MOST_PARTICLES, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.softness.firmness import firm_bodies
from sandbox.physics.state import Family
from sandbox.replay import read_replay, verify
from sandbox.session.commands import Grab, Pin, SetFirmness
from tests.support.cutting import advance, begun, level_with, part
from tests.support.overlaps import crossed_by_itself, overlaps

SPACING = 0.4
# How deep bodies lie in each other at most [radii of particles, or spacings].
DEEPEST = 0.05
ROUND = [[math.cos(angle), math.sin(angle)] for angle in np.linspace(0.0, 2.0 * math.pi, 17)[:-1]]
BODIES = {
    "box": {"shape": {"box": [3.2, 3.2]}},
    "disc": {"shape": {"circle": 1.6}},
    "ring": {"shape": {"circle": 1.8}, "mesh": "fitted", "holes": [(0.8 * np.array(ROUND)).tolist()]},
    "slab": {"shape": {"box": [4.0, 0.4]}},
    "drawn": {"shape": {"polygon": [[-2, -1], [2, -1.3], [1.5, 1.2], [0, 0.3], [-1.5, 1.6]]}, "mesh": "fitted"},
    "fitted disc": {"shape": {"circle": 1.6}, "mesh": "fitted"},
    "tilted": {"shape": {"box": [3.2, 3.2]}, "angle": 0.4},
    "deformed": {"shape": {"box": [3.2, 3.2]}},
}


def world_of(kind, radius=0.0):
    """A world of one body that turns, goes and trembles; radius [m] of its particles."""
    chance = np.random.default_rng(7)
    body = {"type": "jelly", "id": "it", "position": [0.0, 0.0], "spacing": SPACING, "material": "soft", **BODIES[kind]}
    level = {
        "format": "spring-sandbox/level", "version": 3, "name": kind, "contacts": {},
        "settings": {"solver": "direct", "gravity": [0.0, 0.0]}, "bodies": [body],
        "materials": {"soft": {"stiffness": 0.2, "damping": 0.4}},
    }  # fmt: skip
    world = build_world(parse_level(json.dumps(level).encode(), kind))
    own = world.particle_active
    world.change("radius", radius, own)
    if kind == "deformed":
        bent = world.position[own] @ np.array([[1.1, 0.2], [-0.1, 0.8]])
        world.change("position", bent + 0.06 * np.sin(2.0 * bent[:, ::-1]), own)
    x, y = world.position[own].T
    trembling = 0.3 * chance.normal(size=(len(x), 2))
    world.change("velocity", np.stack([1.0 - 2.0 * y, 0.5 + 2.0 * x], axis=1) + trembling, own)
    return world


def triangles_of(world):
    """Places (t, 3, 2) of the triangles that keep their areas, and their owners (t,)."""
    whole = np.flatnonzero(world.constraint_active & (world.constraint_kind == AREA))
    corners = world.corner_particle[world.constraint_first[whole][:, None] + np.arange(3)]
    return world.position[corners], world.owner[corners[:, 0]]


def area_of(triangles):
    return sum(signed_area(each, np.roll(each, -1, axis=0)) for each in triangles)


def motion_of(world):
    """Mass, momentum and its moment."""
    own = world.particle_active
    mass, place, velocity = world.mass[own], world.position[own], world.velocity[own]
    moment = place[:, 0] * velocity[:, 1] - place[:, 1] * velocity[:, 0]
    return np.array([mass.sum(), *(mass @ velocity), mass @ moment])


def cut_along(world, start, end):
    springs = springs_crossing(world, start, end)
    shares = shares_crossed(world, springs, start, end)
    world.cut(springs[shares >= 0.0], shares[shares >= 0.0])


def ways(count):
    """Strokes right through the middle of things."""
    chance = np.random.default_rng(3)
    for _ in range(count):
        angle, off = chance.uniform(0.0, 2.0 * math.pi), chance.uniform(-1.2, 1.2)
        way = np.array([math.cos(angle), math.sin(angle)])
        start = off * np.array([-way[1], way[0]]) - 6.0 * way
        yield tuple(start.tolist()), tuple((start + 12.0 * way).tolist()), np.array([-way[1], way[0]])


@pytest.mark.parametrize("kind", BODIES)
def test_the_edge_of_pieces_is_the_stroke_and_mass_momentum_and_area_stay(kind):
    whole = world_of(kind)
    before, area = motion_of(whole), area_of(triangles_of(whole)[0])
    for start, end, across in ways(100):
        world = copy.deepcopy(whole)
        cut_along(world, start, end)
        assert motion_of(world) == pytest.approx(before, abs=1e-9)
        triangles, _ = triangles_of(world)
        assert area_of(triangles) == pytest.approx(area, abs=1e-9)
        # No triangle lies on both sides of the stroke by more than a tenth of the spacing.
        side = np.sort((triangles - np.array(start)) @ across, axis=1)
        assert np.minimum(-side[:, 0], side[:, 2]).max(initial=0.0) <= SPACING / 10.0
        # Places at rest and lengths at rest belong together, and every triangle has its three springs.
        pairs = {frozenset(pair) for pair in zip(world.particle_a.tolist(), world.particle_b.tolist(), strict=True)}
        chosen = np.flatnonzero(world.constraint_active)
        for corners in world.corner_particle[world.constraint_first[chosen][:, None] + np.arange(3)].tolist():
            assert {frozenset((corners[k - 1], corners[k])) for k in range(3)} <= pairs


@pytest.mark.parametrize("kind", [kind for kind in BODIES if kind != "deformed"])
def test_a_body_at_rest_stays_at_rest_where_it_is_cut(kind):
    world = world_of(kind)
    world.change("velocity", 0.0, world.particle_active)
    cut_along(world, (-3.0, -1.0), (3.0, 1.3))
    own = np.flatnonzero(world.spring_active)
    apart = world.position[world.particle_b[own]] - world.position[world.particle_a[own]]
    np.testing.assert_allclose(np.hypot(*apart.T), world.rest_length[own], atol=1e-12)
    chosen = np.flatnonzero(world.constraint_active)
    areas = [area_of([each]) for each in triangles_of(world)[0]]
    np.testing.assert_allclose(areas, world.constraint_rest[chosen, 0], atol=1e-12)


CASES = {
    "along a row of the lattice": ((-3.0, 0.4), (3.0, 0.4), 2),
    "through corners": ((-3.0, -3.0), (3.0, 3.0), 2),
    "near an edge": ((-3.0, 1.57), (3.0, 1.57), 2),
    "ends inside": ((0.1, -3.0), (0.1, 0.3), 1),
    "ends at a particle": ((0.0, -3.0), (0.0, 0.4), 1),
    "inside": ((-0.5, -0.5), (0.7, 0.3), 1),
    "a corner": ((0.9, 2.1), (2.1, 0.9), 2),
}


@pytest.mark.parametrize("case", CASES)
def test_strokes_that_are_hard_to_follow_leave_whole_pieces(case):
    start, end, count = CASES[case]
    world = world_of("box")
    before, area = motion_of(world), area_of(triangles_of(world)[0])
    cut_along(world, start, end)
    triangles, owners = triangles_of(world)
    assert len(np.unique(owners)) == count
    assert area_of(triangles) == pytest.approx(area, abs=1e-9)
    assert min(area_of([each]) for each in triangles) > 1e-6
    assert motion_of(world) == pytest.approx(before, abs=1e-9)


def test_cuts_across_cuts_leave_pieces_that_keep_it_all():
    world = world_of("box")
    before, area = motion_of(world), area_of(triangles_of(world)[0])
    counts = []
    for start, end, _ in ways(6):
        cut_along(world, start, end)
        triangles, owners = triangles_of(world)
        counts.append(len(np.unique(owners)))
        assert area_of(triangles) == pytest.approx(area, abs=1e-9)
        assert motion_of(world) == pytest.approx(before, abs=1e-9)
        assert len(firm_bodies(world)) == counts[-1]
    assert counts == sorted(counts) and counts[-1] > 6
    edge = np.isin(world.edge, (SOLID_LEFT, SOLID_RIGHT)) & world.spring_active
    ends = np.concatenate([world.particle_a[edge], world.particle_b[edge]])
    # Outlines are closed.
    assert np.all(np.bincount(ends)[np.unique(ends)] % 2 == 0)


def test_firmness_reaches_all_of_a_piece():
    world = world_of("box")
    cut_along(world, (-3.0, -1.0), (3.0, 1.3))
    for number in range(len(firm_bodies(world))):
        world.command("set_firmness", body=number, sag=0.0, hz=None, ratio=None)
    own = world.spring_active & (world.material >= 0)
    assert world.is_split[own].any() and np.all(world.stiffness[own] == 1.0)
    assert np.all(world.constraint_stiffness[world.constraint_active] == 1.0)


def test_a_cut_without_room_says_so_and_changes_nothing():
    world = world_of("box")
    world.append(Family.PARTICLE, MOST_PARTICLES - world.particle_count, mass=1.0)
    before = {name: getattr(world, name).copy() for name in ("position", "mass", "spring_active", "constraint_active")}
    with pytest.raises(RefusedCommand, match="no room for the pieces"):
        cut_along(world, (-3.0, -1.0), (3.0, 1.3))
    for name, values in before.items():
        np.testing.assert_array_equal(getattr(world, name), values)


def test_pinned_and_held_particles_stay_where_they_are():
    session = begun(level_with("jelly_pile", "direct"), 60)
    slots = [slot for slot in range(8, 24)]
    for slot in slots[:4]:
        session.submit(Pin(slot))
    session.submit(Grab(0, slots[6], tuple(session.world.position[slots[6]].tolist()), 50.0, 0.0))
    session.apply_pending()
    places = session.world.position[slots].copy()
    pinned = session.world.inverse_mass == 0.0
    part(session, "cube 1", "across")
    session.apply_pending()
    np.testing.assert_array_equal(session.world.position[slots][[0, 1, 2, 3, 6]], places[[0, 1, 2, 3, 6]])
    np.testing.assert_array_equal(session.world.inverse_mass[: len(pinned)] == 0.0, pinned)
    assert session.world.is_held(0)


def test_undo_joins_the_pieces_and_redo_and_a_recording_part_them_to_the_same_bits(tmp_path):
    session = begun(level_with("jelly_pile", "direct"), 0)
    session.record_to(tmp_path / "cut.replay")
    advance(session, 30)
    for body, stroke in (("cube 1", "across"), ("wheel 4", "corner"), ("cube 1", "along")):
        part(session, body, stroke)
        advance(session, 10)
    rows = session.world.particle_count
    session.undo()
    advance(session, 10)
    assert session.world.particle_count < rows
    session.redo()
    advance(session, 10)
    assert session.world.particle_count == rows
    session.stop_recording()
    recording = read_replay(tmp_path / "cut.replay")
    assert verify(recording) is None and recording.ticks > 60


def test_the_edges_of_pieces_that_touch_lie_back_by_their_radii():
    world = world_of("box", radius=0.03)
    start, end = (-3.0, -1.0), (3.0, 1.3)
    cut_along(world, start, end)
    across = np.array([start[1] - end[1], end[0] - start[0]]) / math.dist(start, end)
    triangles, owners = triangles_of(world)
    side = (triangles - np.array(start)) @ across
    back = float(world.radius[0])
    for owner in np.unique(owners):
        assert np.abs(side[owners == owner]).min() == pytest.approx(back, abs=SPACING / 20.0)
    assert not [pair for pair in overlaps(world).depth if pair[0] != pair[1]]


@pytest.mark.parametrize("seed", range(4))
def test_pieces_in_a_heap_lie_in_nothing_from_the_cut_on_as_jelly_too(seed):
    chance = np.random.default_rng(seed)
    session = begun(level_with("jelly_pile", "direct"), 60)
    bodies = [body.id for body in session.level.bodies if body.type == "jelly"]
    for body in chance.choice(bodies, 3, replace=False).tolist():
        part(session, body, ("across", "along", "corner")[int(chance.integers(3))])
    for ticks, sag in ((1, None), (5, None), (54, None), (90, 0.25)):
        for form in firm_bodies(session.world) if sag is not None else ():
            session.submit(SetFirmness(form.name, sag=sag))
        advance(session, ticks)
        deepest = [deep for pair, deep in overlaps(session.world).depth.items() if pair[0] != pair[1]]
        assert max(deepest, default=0.0) <= DEEPEST
        assert max(crossed_by_itself(session.world).values(), default=0.0) <= DEEPEST * SPACING
