"""Fitted meshes: borders on the outline, even triangles inside, the same bits always, and nothing that cannot be."""

import hashlib
import json
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.geometry import TooCoarse, disc_counts, fitted_mesh, is_simple
from sandbox.level.kinds.jelly import JellyDef
from sandbox.level.reading.parse import parse_level
from sandbox.physics.marks import NO_EDGE
from sandbox.physics.step import step

L_SHAPE = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0))
KITE = ((-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 2.0))
HOLE = ((-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3))
# By name: outline, holes, spacing and area.
SHAPES = {
    "L": (L_SHAPE, (), 0.2, 3.0),
    "kite": (KITE, (), 0.25, 3.0),
    "clockwise": (KITE[::-1], (), 0.25, 3.0),
    "box with a hole": (((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)), (HOLE,), 0.2, 4.0 - 0.36),
}


def angles(places, triangles):
    """Angles [degrees] (3, t) of all triangles, negative ones where they lie face down."""
    corners = places[triangles]
    found = []
    for k in range(3):
        u, w = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        found.append(np.arctan2(u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0], np.sum(u * w, axis=1)))
    return np.degrees(found)


def area(places, triangles):
    a, b, c = (places[triangles[:, k]] for k in range(3))
    return float(np.sum((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])) / 2.0


def ways(mesh):
    """Every side of a triangle, the way it runs around that."""
    return [tuple(side) for t in mesh.triangles.tolist() for side in (t[:2], t[1:], [t[2], t[0]])]


def border_of(mesh):
    """The sides that have a triangle on their left alone."""
    every = ways(mesh)
    return sorted(set(every) - {(b, a) for a, b in every})


def away(points, loops):
    """Distance [m] of each point from the nearest side of closed lines."""
    least = np.full(len(points), np.inf)
    for loop in loops:
        for a, b in zip(np.array(loop), np.roll(np.array(loop), -1, axis=0), strict=True):
            share = np.clip((points - a) @ (b - a) / np.dot(b - a, b - a), 0.0, 1.0)
            least = np.minimum(least, np.linalg.norm(points - a - share[:, None] * (b - a), axis=1))
    return least


def jelly(**fields):
    return JellyDef(**{"type": "jelly", "id": "j", "mesh": "fitted", "spacing": 0.25, **fields})


def parsed(*bodies, **rest):
    data = {"format": "spring-sandbox/level", "version": 3, "name": "Test", "bodies": bodies, **rest}
    return parse_level(json.dumps(data).encode(), "x")


def faults(**fields):
    with pytest.raises(LevelError) as refused:
        parsed({"type": "jelly", "id": "j", "mesh": "fitted", "spacing": 0.25, **fields})
    return refused.value.faults


@pytest.mark.parametrize("name", SHAPES)
def test_border_particles_stand_on_the_outline_evenly_and_on_its_corners(name):
    outline, holes, spacing, _ = SHAPES[name]
    mesh = fitted_mesh(outline, holes, spacing)
    sides = np.array(border_of(mesh))
    border = np.unique(sides)
    assert border.tolist() == list(range(len(border)))
    assert away(mesh.places[border], (outline, *holes)).max() < 1e-12
    assert away(mesh.places[len(border) :], (outline, *holes)).min() > 0.3 * spacing
    corners = [corner for loop in (outline, *holes) for corner in loop]
    assert {*corners} <= {*map(tuple, mesh.places.tolist())}
    length = np.linalg.norm(mesh.places[sides[:, 1]] - mesh.places[sides[:, 0]], axis=1)
    assert 0.75 * spacing < length.min() and length.max() < 1.5 * spacing


@pytest.mark.parametrize("name", SHAPES)
def test_areas_of_the_triangles_sum_to_that_of_the_shape(name):
    outline, holes, spacing, wanted = SHAPES[name]
    mesh = fitted_mesh(outline, holes, spacing)
    assert area(mesh.places, mesh.triangles) == pytest.approx(wanted, rel=1e-12)
    # Each side has triangles on both sides of it, but for those of the border, which have one on their left.
    every, border = ways(mesh), border_of(mesh)
    assert len(set(every)) == len(every)
    assert sorted(a for a, _ in border) == sorted(b for _, b in border) == list(range(len(border)))
    assert [*map(tuple, mesh.pairs.tolist())] == sorted({(min(way), max(way)) for way in every})


@pytest.mark.parametrize("name", SHAPES)
def test_triangles_of_plain_shapes_have_no_angle_below_25_degrees(name):
    outline, holes, spacing, _ = SHAPES[name]
    for finer in (1.0, 0.7, 0.4):
        mesh = fitted_mesh(outline, holes, finer * spacing)
        assert angles(mesh.places, mesh.triangles).min() > 25.0


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0.6, 1.4), min_size=3, max_size=24), st.sampled_from([0.1, 0.17]))
def test_no_outline_gets_a_triangle_below_20_degrees_or_half_its_sharpest_corner(radii, spacing):
    turns = [math.tau * k / len(radii) for k in range(len(radii))]
    outline = tuple((r * math.cos(t), r * math.sin(t)) for r, t in zip(radii, turns, strict=True))
    assume(is_simple(outline))
    try:
        mesh = fitted_mesh(outline, (), spacing)
    except TooCoarse:
        return
    a = np.array(outline)
    corners = angles(a, np.stack([np.arange(len(a)), np.roll(np.arange(len(a)), -1), np.arange(len(a)) - 1], axis=1))[0]
    sharpest = min([corner for corner in corners if corner > 0.0], default=180.0)
    assert angles(mesh.places, mesh.triangles).min() > max(min(20.0, sharpest / 2.0), 5.0) - 1e-3
    assert away(mesh.places[np.unique(border_of(mesh))], [outline]).max() < 1e-12


@pytest.mark.parametrize("rings", [1, 2, 4, 9])
def test_a_disc_is_rings_that_look_the_same_from_six_sides_and_in_a_mirror(rings):
    made = expansion(jelly(shape={"circle": 1.0}, spacing=1.0 / rings))
    assert made.form_count == disc_counts(rings) == (len(made.form), len(made.form_pairs))
    assert np.hypot(*made.form[: 6 * rings].T) == pytest.approx(np.ones(6 * rings), abs=1e-12)
    assert made.form[-1].tolist() == [0.0, 0.0]
    springs = {frozenset(map(tuple, np.round(pair, 6) + 0.0)) for pair in made.form[made.form_pairs]}
    cosine, sine = 0.5, math.sqrt(0.75)
    for change in (np.array([[cosine, sine], [-sine, cosine]]), np.diag([1.0, -1.0]), np.diag([-1.0, 1.0])):
        seen = made.form @ change
        assert {frozenset(map(tuple, np.round(pair, 6) + 0.0)) for pair in seen[made.form_pairs]} == springs
    assert angles(made.form, made.polygons()).min() > 44.0
    inside = 6 * rings * math.sin(math.tau / (6 * rings)) / 2.0
    assert area(made.form, made.polygons()) == pytest.approx(inside, rel=1e-9)


def test_a_mesh_has_the_same_bits_always():
    parts = []
    for outline, holes, spacing, _ in SHAPES.values():
        fitted_mesh.cache_clear()
        mesh = fitted_mesh(outline, holes, spacing)
        parts += [mesh.places.tobytes(), mesh.triangles.tobytes(), mesh.pairs.tobytes()]
    parts.append(expansion(jelly(shape={"circle": 1.0}, angle=0.3)).form.tobytes())
    assert hashlib.sha256(b"".join(parts)).hexdigest()[:16] == "309b8a3917ddad14"


def test_a_grid_stays_what_it_was_and_files_say_nothing_of_it():
    given_, plain = (
        JellyDef(type="jelly", id="j", shape={"circle": 1.0}, spacing=0.25, **m) for m in ({"mesh": "grid"}, {})
    )
    assert given_ == plain
    assert np.array_equal(expansion(given_).form, expansion(plain).form)
    text = level_text(parsed({"type": "jelly", "id": "j", "shape": {"circle": 1.0}, "spacing": 0.25, "mesh": "grid"}))
    assert "mesh" not in text


def test_a_fitted_jelly_with_holes_survives_a_round_trip_and_expands_to_the_same_world():
    body = {"type": "jelly", "id": "j", "shape": {"circle": 1.0}, "mesh": "fitted", "holes": [HOLE], "spacing": 0.2}
    level = parsed(body | {"pinned": [0, 3], "cut": [7], "angle": 0.5}, welds=[["p", "j.5"]], particles=[
        {"id": "p", "position": [2, 0]}
    ])  # fmt: skip
    again = parse_level(level_text(level).encode(), "again")
    assert again == level
    first, second = build_world(level), build_world(again)
    assert np.array_equal(first.position, second.position) and np.array_equal(first.particle_a, second.particle_a)
    assert first.particle_slot("p") == first.particle_slot("j.5")
    assert not first.inverse_mass[first.particle_slot("j.3")]


def test_the_edges_of_a_fitted_jelly_are_its_border_and_that_of_its_holes():
    made = expansion(jelly(shape={"circle": 1.0}, holes=(HOLE,), spacing=0.2))
    solid = made.pairs[made.edges != NO_EDGE]
    mesh = fitted_mesh(1.0, (HOLE,), 0.2)
    assert {*map(tuple, solid.tolist())} == {tuple(sorted(side)) for side in border_of(mesh)}


def test_what_is_thrown_through_the_hole_of_a_fitted_jelly_passes_and_beside_it_bounces():
    ring = {"type": "jelly", "id": "j", "shape": {"circle": 1.0}, "holes": [HOLE], "spacing": 0.2, "mesh": "fitted"}
    ball = {"id": "inside", "position": [0.0, 0.0], "radius": 0.05, "mass": 0.01}
    above = {"id": "above", "position": [0.6, 1.2], "radius": 0.05, "velocity": [0.0, -2.0], "mass": 0.01}
    world = build_world(
        parsed(ring, particles=[ball, above], contacts={}, settings={"gravity": [0.0, 0.0], "solver": "direct"})
    )
    for _ in range(60):
        step(world)
    # The one rests in the hole, where nothing pushes it; the other has not gone in, and rolls off.
    assert world.position[world.particle_slot("inside")].tolist() == pytest.approx([0.0, 0.0], abs=0.02)
    assert np.hypot(*world.position[world.particle_slot("above")]) > 1.0


def test_a_fitted_disc_falls_rests_and_rolls_without_losing_its_form():
    disc = {"type": "jelly", "id": "j", "shape": {"circle": 0.5}, "spacing": 0.125, "mesh": "fitted", "material": "m"}
    world = build_world(
        parsed(
            disc | {"position": [0.0, 0.6], "velocity": [1.0, 0.0]},
            materials={"m": {"stiffness": 0.9, "damping": 0.99}},
            terrain=[{"id": "g", "polyline": [[-9, 0], [9, 0]]}],
            settings={"solver": "direct"},
        )
    )
    for _ in range(90):
        step(world)
    height = np.ptp(world.position[: disc_counts(4)[0], 1])
    assert 0.9 < height < 1.05
    assert world.position[: disc_counts(4)[0], 0].mean() > 0.5


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        (
            {"shape": {"polygon": [[0, 0], [1, 1], [1, 0], [0, 1]]}},
            "bodies.0.shape.polygon: its sides touch or cross, or a corner comes twice; draw it without",
        ),
        (
            {"shape": {"circle": 1.0}, "holes": [[[0, 0], [0.5, 0.5], [0.5, 0], [0, 0.5]]]},
            "bodies.0.holes.0: its sides touch or cross, or a corner comes twice; draw it without",
        ),
        (
            {"shape": {"circle": 1.0}, "holes": [[[0, 0], [2, 0], [0, 0.5]]]},
            "bodies.0.holes.0: does not lie inside the outline; move it in, or take it out",
        ),
        (
            {"shape": {"circle": 1.0}, "holes": [[[3, 3], [4, 3], [3, 4]]]},
            "bodies.0.holes.0: does not lie inside the outline; move it in, or take it out",
        ),
        (
            {"shape": {"circle": 2.0}, "holes": [[[-1, -1], [1, -1], [0, 1]], [[-0.2, -0.2], [0.2, -0.2], [0, 0]]]},
            "bodies.0.holes.1: touches hole 0 or overlaps it; move them apart, or make them one",
        ),
        (
            {"shape": {"circle": 1.0}, "holes": [[[0, 0], [0.3, 0], [0, 0.3]]], "mesh": "grid"},
            'bodies.0.holes: need "mesh": "fitted"; a grid has none',
        ),
        (
            {"shape": {"box": [10.0, 0.2]}, "spacing": 1.0},
            "bodies.0.spacing: 1.0 is too coarse for triangles to fit the outline; 0.512 would do",
        ),
        (
            {"shape": {"box": [100.0, 100.0]}, "spacing": 0.01},
            "bodies.0.spacing: is too fine for so large a polygon; make it larger",
        ),
        (
            {"shape": {"circle": 1000.0}, "spacing": 0.01},
            "bodies.0.spacing: brings the level above 100,000 particles; make it smaller or coarser",
        ),
        ({"shape": {"circle": 1.0}, "mesh": "fine"}, 'bodies.0.mesh: "fine" is not "grid" or "fitted"'),
        ({"shape": {"circle": 1.0}, "pinned": [61]}, "bodies.0.pinned.0: 61 is beyond the last particle, 60"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_cannot_be_fitted_is_refused_in_one_line_that_says_what_would_do(fields, fault):
    assert faults(**fields) == [f"x: {fault}"]


def test_the_spacing_that_a_fault_names_does():
    level = parsed({"type": "jelly", "id": "j", "mesh": "fitted", "shape": {"box": [10.0, 0.2]}, "spacing": 0.512})
    made = expansion(level.bodies[0])
    assert angles(made.form, made.polygons()).min() > 20.0
