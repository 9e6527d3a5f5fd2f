"""Kits: bodies as rows join a world to the bits that their definitions would, and nothing in them is out of range."""

import json

import numpy as np
import pytest

from sandbox.level.assembly.joining import Joiners
from sandbox.level.assembly.kit_files import written
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import AddBody, CommandError, Remove, SetDrive, SetFirmness, SetInflation, apply
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.parts import BODIES, SKIN, furnished, placed, placed_cart, room

WEAK = {"weak": {"stiffness": 0.3, "damping": 0.4, "tension_limit": 0.5, "yield_strain": 0.02, "yield_limit": 0.2}}
ROPE = {"type": "rope", "start": [0, 4], "end": [2, 4], "segments": 6}
BLOCK = {
    "type": "mesh", "particles": [[0, 7], [1, 7], [1, 8], [0, 8], [2, 7], [2, 8]],
    "springs": [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 4], [4, 5], [5, 2], [1, 5]],
    "triangles": [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]],
}  # fmt: skip
DEFINITIONS = {kind: {"body": placed(body, 0.3, 3.0, (1.0, -2.0))} for kind, body in BODIES.items()} | {
    "cart": placed_cart(0.0, 3.0),
    "muscle": {"body": ROPE | {"drive": {"amplitude": 0.2, "period": 50, "phase": 0.3, "force": 30.0}}},
    "weak": {"body": ROPE | {"material": "weak"}, "materials": WEAK},
    "skin": {"body": placed(BODIES["jelly"], 2, 1) | {"material": "skin"}, "materials": SKIN},
    "in pieces": {"body": BLOCK | {"cut": [5, 7, 8], "collides": ["terrain"]}},
    "moving": {"body": BLOCK | {"velocity": [1.0, -0.0], "pinned": [0], "masses": [1, 2, 3, 4, 5, 6]}},
}


def kit_of(world, definition):
    """The kit of a definition, as a line of a file would hold it."""
    return json.loads(json.dumps(written(Joiners(world, definition).kit(world), {}, {}), allow_nan=False))


@pytest.mark.parametrize("kind", DEFINITIONS)
def test_a_kit_comes_to_the_bits_names_and_forms_of_its_definition(kind, tmp_path):
    defined, given = Session(furnished()), Session(furnished())
    given.record_to(tmp_path / "kit.replay.gz", state_ticks=10)
    for session in (defined, given):
        for _ in range(7):
            session.advance()
    definition = DEFINITIONS[kind]
    defined.submit(AddBody(**definition))
    given.submit(AddBody(kit=kit_of(given.world, definition)))
    for session in (defined, given):
        for part in range(1, 1 + len(session.world.actuators.names) - 1):
            session.submit(SetDrive(part, 1.0))
        for body, form in enumerate(session.world.forms):
            if form.name.startswith("+"):
                session.submit(SetFirmness(body, sag=0.1))
        for place, name in enumerate(session.world.area_names):
            if name.startswith("+"):
                session.submit(SetInflation(place, 1.2))
        for _ in range(30):
            session.advance()
    assert not defined.messages and not given.messages
    one, other = defined.world, given.world
    assert state_hash(one) == state_hash(other)
    assert one.particle_names == other.particle_names and one.spring_names == other.spring_names
    assert one.particle_naming.second == other.particle_naming.second
    assert one.actuators.names == other.actuators.names and one.material_names == other.material_names
    assert np.array_equal(one.hulls, other.hulls)
    given.submit(Remove(body="+1"))
    given.advance()
    given.stop_recording()
    replay = read_replay(tmp_path / "kit.replay.gz")
    assert verify(replay) is None and verify(replay, start=30) is None


def wrong(kit, place, value):
    part, column, *rows = place.split(".")
    made = json.loads(json.dumps(kit))
    if rows:
        made[part][column][int(rows[0])] = value
    else:
        made[part][column] = value
    return made


WRONG = [
    ("particles.x.1", 1e300, "particles.x.1: 1e+300 is not -1e+18 to 1e+18"),
    ("particles.x.1", None, "particles.x.1: a number is needed"),
    ("particles.mass", -1.0, "particles.mass.0: -1 is not above 0 to 1e+18"),
    ("particles.mass", 10**400, "particles.mass.0: inf is not above 0 to 1e+18"),
    ("particles.group", 3, "particles.group.0: 3 does not fit"),
    ("particles.colour", 3, "particles.colour: kits have no such thing"),
    ("particles.body.0", 4, "particles.body.0: 4 does not fit"),
    ("springs.a.0", 10**9, "springs.a.0: 1e+09 does not fit"),
    ("springs.a.0", "nobody", "springs.a.0: there is no particle nobody"),
    ("springs.a.0", 0.5, "springs.a.0: a whole number is needed"),
    ("springs.stiffness", 2.0, "springs.stiffness.0: 2 is not 0 to 1"),
    ("springs.stiffness", [0.5], "springs.stiffness: a list of"),
    ("springs.material", 5, "springs.material.0: 5 does not fit"),
    ("constraints.corners", 10**9, "constraints.corners.0: 1e+09 does not fit"),
    ("corners.particle.0", 1e9, "corners.particle.0: 1e+09 does not fit"),
    ("materials.name", ["a", "a"], "materials.name: a list of different rows is needed"),
]


@pytest.mark.parametrize(("place", "value", "words"), WRONG, ids=[each[2] for each in WRONG])
def test_a_number_of_a_kit_that_is_out_of_range_is_named_and_nothing_changes(place, value, words):
    world = Session(room()).world
    kit = kit_of(world, {"body": BLOCK | {"masses": [1, 2, 3, 4, 5, 6]}})
    before, names = state_hash(world), world.particle_names.copy()
    with pytest.raises(CommandError) as raised:
        apply(world, AddBody(kit=wrong(kit, place, value)))
    assert str(raised.value).startswith(f"add_body: kit: {words}")
    assert state_hash(world) == before and world.particle_names == names and not world.joined


def test_a_kit_may_be_tied_to_what_is_there_by_its_name():
    session = Session(furnished())
    rope = {
        "bodies": 1,
        "particles": {"x": [0.0, 1.0], "y": [5.0, 5.0], "body": [0, 0], "group": 2, "collides": 0},
        "springs": {"a": [0, 1], "b": [1, "cube.0"]},
        "materials": {"name": ["default"]},
    }
    session.submit(AddBody(kit=rope))
    session.advance()
    world = session.world
    assert not session.messages
    assert world.particle_b[world.spring_slot("+1:1")] == world.particle_slot("cube.0")


def test_particles_of_no_body_in_a_kit_have_names_of_their_own():
    world = Session(furnished()).world
    rows = {"x": [0.0, 1.0, 2.0, 3.0], "y": 5.0, "body": [0, 0, -1, -1], "group": 2, "collides": 0}
    names = {"particles": [[0, 0, 2], [-1, 0, 2]]}
    apply(world, AddBody(kit={"bodies": 1, "particles": rows, "names": names}))
    apply(world, AddBody(kit={"particles": rows | {"body": [-1, -2, -1, -2]}}))
    assert world.particle_names[-8:] == ["+1.0", "+1.1", "+.0", "+.1", "+.2", "+.3", "+.4", "+.5"]
