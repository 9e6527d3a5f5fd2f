"""Parts of the catalogue that join a run: the same bits as on the sheet, whatever the level, or one line why not."""

import json

import numpy as np
import pytest

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.copying import place_part
from sandbox.editor.edits.joining import joining_commands
from sandbox.editor.storage.level_file import catalogue
from sandbox.level.format.quantities import replaced
from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import AddBody, AddParticle
from sandbox.session.session import Session
from tests.support.parts import SKIN, room

SHIPPED = {part.path.stem: part.level for part in catalogue() if not part.is_own}
WIDE = {"walls": {"box": [-15, 0, 15, 20]}}
BAR = {"type": "mesh", "id": "bar", "particles": [[0, 0], [1, 0]], "springs": [[0, 1]], "material": "skin"}


def part(**data):
    head = {"format": "spring-sandbox/level", "version": 3, "name": "Thing"}
    return parse_level(json.dumps(head | data).encode(), "part")


def join(session, level, at=(0.0, 2.0), velocity=(0.0, 0.0)):
    """Drop a part; its commands."""
    commands = joining_commands(level, session.world, at, velocity)
    gesture = session.new_gesture()
    for command in commands:
        session.submit(command, gesture)
    session.apply_pending()
    return commands


def shown(session):
    """Places [m] of all that is there."""
    return session.world.position[session.world.particle_active]


def test_what_joins_moves_with_the_bits_of_what_the_editor_puts_there_and_one_undo_takes_it_back():
    found = {}
    for name, level in SHIPPED.items():
        session = Session(room(**WIDE))
        before = state_hash(session.world)
        try:
            join(session, level, (0.0, 0.5))
        except EditError as error:
            found[name] = str(error)
            continue
        built = Session(place_part(Document(room(**WIDE)), level, (0.0, 0.5)).level)
        for _ in range(5):
            session.advance()
            built.advance()
        assert len(shown(session)) > 0 and np.array_equal(shown(session), shown(built)), name
        session.seek(0)
        session.undo()
        session.apply_pending()
        assert state_hash(session.world) == before and not session.messages
    assert not found


def test_terrain_cannot_join():
    hill = part(bodies=[BAR | {"material": "default"}], terrain=[{"id": "hill", "polyline": [[0, 0], [1, 0]]}])
    with pytest.raises(EditError, match='"Thing" has terrain, which cannot join a run; build it into a level'):
        joining_commands(hill, Session(room()).world, (0.0, 1.0))


def test_loose_balls_join_beside_bodies_and_those_that_springs_hold_are_bodies_of_one_particle():
    level = part(
        contacts={},
        materials=SKIN,
        bodies=[BAR],
        particles=[
            {"id": "knot", "position": [0.5, 1], "mass": 3, "radius": 0.1, "friction": 0.9, "gravity_scale": 0.5},
            {"id": "marble", "position": [3, 0], "mass": 2, "radius": 0.3, "restitution": 0.7},
        ],
        springs=[{"a": "bar.0", "b": "knot", "material": "skin"}, {"a": "knot", "b": "bar.1"}],
    )
    session, built = Session(room(**WIDE)), Session(place_part(Document(room(**WIDE)), level, (0.0, 2.0)).level)
    body, marble = join(session, level)
    assert isinstance(body, AddBody) and [each["id"] for each in body.others] == ["knot"]
    assert isinstance(marble, AddParticle) and marble.position == (3.0, 2.0) and marble.restitution == 0.7
    for _ in range(90):
        session.advance()
        built.advance()
    assert np.abs(shown(session) - shown(built)).max() < 1e-9
    floating = replaced(level, particles=(level.particles[0], replaced(level.particles[1], gravity_scale=0.5)))
    with pytest.raises(EditError, match='"marble" is a loose particle with gravity scale'):
        joining_commands(floating, session.world, (0.0, 2.0))


def test_a_throw_is_added_to_what_the_part_moves_by_and_pins_stay():
    level = part(
        bodies=[BAR | {"material": "default", "velocity": [1, 0], "pinned": [0]}],
        particles=[{"id": "a"}, {"id": "b", "pinned": True}],
    )
    session = Session(room())
    join(session, level, (0.0, 2.0), (2.0, 3.0))
    assert session.world.velocity[:4].tolist() == [[0.0, 0.0], [3.0, 3.0], [2.0, 3.0], [0.0, 0.0]]


def test_materials_of_the_same_name_are_shared_where_they_are_the_same_and_follow_the_tick_rate():
    level = part(materials=SKIN, bodies=[BAR])
    session = Session(room(materials={"skin": {"stiffness": 0.1, "damping": 0.2}}))
    (first,), (second,) = join(session, level), join(session, level)
    assert first.body["material"] == "skin 2" and set(first.materials) == {"skin 2"}
    assert second.body["material"] == "skin 2" and second.materials is None
    fast = Session(room(settings={"tick_rate": 240}))
    (body,) = join(fast, level)
    assert body.materials["skin"]["stiffness"] < SKIN["skin"]["stiffness"]
    assert not session.messages and not fast.messages


def test_a_world_that_is_full_refuses_in_one_line(monkeypatch):
    session = Session(room())
    monkeypatch.setattr("sandbox.level.assembly.kits.PARTICLE_LIMIT", 1)
    with pytest.raises(EditError, match="a world holds at most 1 particles; this would make 2"):
        joining_commands(part(materials=SKIN, bodies=[BAR]), session.world, (0.0, 1.0))
