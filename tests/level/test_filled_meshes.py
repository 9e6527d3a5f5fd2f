"""Meshes with triangles: they move as the jelly that they were made of; bad triangles are refused in a line."""

import json

import numpy as np
import pytest

from sandbox.app.draw.looks import body_looks
from sandbox.editor.document import Document
from sandbox.editor.edits.moving import mirror
from sandbox.editor.items import items_of
from sandbox.level.format.level_error import LevelError
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.jelly import Jelly, JellyDef
from sandbox.level.reading.parse import parse_level
from sandbox.session.session import Session
from tests.support.parts import room

BOX = {"type": "jelly", "id": "jelly", "shape": {"box": [1, 0.8]}, "mesh": "fitted", "spacing": 0.25}
HOLE = [[-0.2, -0.15], [0.2, -0.15], [0.0, 0.2]]
FLAT = [[0, 0], [1, 0], [1, 1], [0, 1]]
SIDES = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]]


def mesh_of(jelly):
    """The mesh of the particles, springs and triangles of a jelly."""
    made = Jelly(JellyDef.model_validate_json(json.dumps(jelly)))
    return {
        "type": "mesh", "id": "mesh", "particles": made.form.tolist(), "springs": made.pairs.tolist(),
        "triangles": made.polygons().tolist(), "masses": made.mass.tolist(),
    }  # fmt: skip


@pytest.mark.parametrize("more", [{}, {"holes": [HOLE]}, {"angle": 0.5}])
def test_a_mesh_with_the_triangles_of_a_jelly_moves_and_collides_as_it_does(more):
    jelly = BOX | more | {"position": [0.25, 2.0]}
    worlds = []
    for body in (jelly, mesh_of(jelly)):
        session = Session(room("direct", body))
        for _ in range(120):
            session.advance()
        worlds.append(session.world)
    one, other = worlds
    assert np.array_equal(one.edge, other.edge) and one.constraint_count == other.constraint_count > 0
    assert np.array_equal(one.position, other.position) and one.position[:, 1].min() < 0.05
    assert other.area_names == ("mesh",) and other.forms[0].name == "mesh"


def test_a_mesh_floats_by_its_triangles_and_is_filled_like_a_jelly():
    mesh = mesh_of(BOX)
    lined = {key: value for key, value in mesh.items() if key != "triangles"} | {"id": "lines"}
    looks = body_looks(room("direct", mesh | {"look": {"skin": "wood"}}, mesh | {"id": "other"}, lined))
    assert [look.skin for look in looks] == ["wood", "jelly", ""] and looks[1].face
    hull = expansion(room("direct", mesh).bodies[0]).hull()
    assert np.array_equal(hull, Jelly(JellyDef.model_validate_json(json.dumps(BOX))).hull())


def test_a_mirrored_mesh_is_sound_and_has_its_triangles_the_other_way_round():
    level = room("direct", mesh_of(BOX))
    chosen = frozenset(item for item in items_of(level) if item.kind == "body")
    mirrored = mirror(Document(level, chosen), "x", (0.0, 0.0)).level
    (before,), (after,) = level.bodies, mirrored.bodies
    assert after.triangles == tuple(triangle[::-1] for triangle in before.triangles)


@pytest.mark.parametrize(
    ("triangles", "place", "words"),
    [
        ([[0, 1, 4]], "triangles.0", "4 is beyond the last particle, 3"),
        ([[0, 1, 1]], "triangles.0", "has a corner twice; name three particles"),
        ([[0, 2, 1]], "triangles.0", "does not run counter-clockwise; turn it round"),
        ([[0, 1, 2], [0, 1, 3]], "triangles.1", "has no spring from particle 1 to 3; add one"),
        ([[0, 1, 2], [0, 1, 2]], "triangles.1", "lies on the same side of 0 and 1 as an earlier one; take one out"),
    ],
)
def test_a_bad_triangle_is_refused_in_a_line(triangles, place, words):
    body = {"type": "mesh", "id": "mesh", "particles": FLAT, "springs": SIDES, "triangles": triangles}
    level = {"format": "spring-sandbox/level", "version": 3, "name": "bad", "bodies": [body]}
    with pytest.raises(LevelError) as error:
        parse_level(json.dumps(level).encode(), "bad")
    assert [line.removeprefix("bad: ") for line in error.value.faults] == [f"bodies.0.{place}: {words}"]
