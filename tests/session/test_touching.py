"""Sessions in which things touch: particles that are added, recordings, undo, and faults of one bit."""

import json

import numpy as np
import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import state_hash
from sandbox.physics.state import BY_STORED, FAMILIES, Family
from sandbox.session.commands import AddParticle, CutSprings, SetDrive, apply
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session

FLOOR = {"id": "floor", "polyline": [[-9, 0], [9, 0]]}
MATERIALS = {"soft": {"stiffness": 0.4, "damping": 0.8, "tension_limit": 0.2, "compression_limit": 0.4}}
JELLY = {"type": "jelly", "id": "jelly", "shape": {"box": [1, 1]}, "spacing": 0.25, "position": [0, 2], "angle": 0.5}
RING = {"type": "ring", "id": "ring", "position": [-2, 2], "radius": 0.5, "segments": 10, "inflation": 1.2}
RING |= {"bending": {"stiffness": 0.2, "damping": 0.5}, "velocity": [4, 0]}
PISTON = {"a": "p", "b": "q", "hydraulic": {"shortest": 1, "longest": 2, "rate": 1, "key": "d"}}


def touching_level(**changes):
    """A jelly that falls on the floor and breaks, a ball and a balloon that meet it, and a hydraulic in wind."""
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Touching",
        "settings": {"wind": [1, 0], "drag": 0.2},
        "contacts": {"friction": 0.3, "restitution": 0.2},
        "terrain": [FLOOR],
        "materials": MATERIALS,
        "bodies": [{**JELLY, "material": "soft", "velocity": [0, -12], "gravity_scale": 1.5}, RING],
        "particles": [
            {"id": "ball", "position": [0.1, 3.5], "radius": 0.2, "mass": 30},
            {"id": "p", "position": [4, 1], "pinned": True},
            {"id": "q", "position": [4, 2]},
        ],
        "springs": [PISTON],
        **changes,
    }
    return parse_level(json.dumps(data).encode(), "touching")


def play(session, ticks=150):
    """Drive the piston, add particles, cut a spring, undo one and redo it."""
    for tick in range(ticks):
        if tick == 5:
            session.submit(SetDrive(0, 1.0))
        elif tick in (10, 40):
            session.submit(AddParticle((0.3, 4.0), mass=2.0, radius=0.1))
        elif tick == 70:
            session.submit(CutSprings((3,)))
        elif tick == 90:
            session.undo()
        elif tick == 95:
            session.redo()
        session.advance()


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A recording of a session in which things touch."""
    path = tmp_path_factory.mktemp("replays") / "touching.replay.jsonl"
    session = Session(touching_level())
    session.record_to(path, state_ticks=60)
    play(session)
    session.stop_recording()
    assert not session.messages or all("broke" in message for message in session.messages)
    assert len(session.world.contact_particle) > 5
    assert not session.world.spring_active[:40].all()
    assert 0 < np.count_nonzero(session.world.constraint_active) < session.world.constraint_count
    return path


@pytest.mark.parametrize("solver", ["single_pass", "iterative", "direct"])
def test_an_added_particle_touches_what_the_others_touch(solver):
    session = Session(touching_level(settings={"solver": solver}, bodies=[], particles=[], springs=[]))
    apply(session.world, AddParticle((0.0, 0.5), radius=0.1))
    apply(session.world, AddParticle((0.05, 1.0), radius=0.1))
    for _ in range(200):
        session.advance()
    assert np.all(session.world.position[session.world.particle_slot("+.0"), 1] > 0.099)
    assert np.linalg.norm(np.diff(session.world.position[[0, -1]], axis=0)) > 0.19
    assert session.world.friction[0] == 0.3 and session.world.restitution[0] == 0.2


def test_a_particle_added_to_a_level_without_contacts_touches_nothing():
    session = Session(touching_level(contacts=None, terrain=[]))
    apply(session.world, AddParticle((0.0, 0.5)))
    assert not session.world.has_contacts


def test_an_undone_particle_leaves_a_world_as_it_was():
    session = Session(touching_level(bodies=[], particles=[], springs=[]))
    session.advance()
    before = state_hash(session.world)
    assert not session.world.has_contacts
    session.submit(AddParticle((0.0, 0.5)))
    session.advance()
    assert session.world.has_contacts
    session.undo()
    session.advance()
    assert not session.world.has_contacts
    fresh = Session(touching_level(bodies=[], particles=[], springs=[]))
    fresh.advance()
    assert state_hash(fresh.world) == before


def test_a_recording_verifies_from_its_start_and_from_its_middle(recorded):
    replay = read_replay(recorded)
    assert verify(replay) is None
    assert verify(replay, start=120) is None


def test_a_recording_of_a_level_that_begins_empty_verifies_from_its_middle(tmp_path):
    session = Session(touching_level(bodies=[], particles=[], springs=[]))
    path = tmp_path / "empty.replay.jsonl"
    session.record_to(path, state_ticks=60)
    session.submit(AddParticle((0.0, 0.5), radius=0.1))
    for _ in range(90):
        session.advance()
    session.stop_recording()
    assert len(session.world.contact_particle) == 1
    assert verify(read_replay(path), start=60) is None


@pytest.mark.parametrize("array", [*(column.stored for column in FAMILIES[Family.CONTACT]), "part_value"])
def test_a_fault_of_one_bit_in_a_contact_or_a_driven_part_is_named(recorded, array):
    def disturb(world):
        if world.tick == 137:
            values = getattr(world, BY_STORED[array].name)
            place = (0, 1) if values.ndim == 2 else 0
            values[place] = np.nextafter(values[place], np.inf) if values.dtype.kind == "f" else values[place] ^ 1

    divergence = verify(read_replay(recorded), on_tick=disturb)
    assert (divergence.tick, divergence.array) == (137, array)
    assert divergence.index == ((0, 1) if array == "contact_impulse" else 0)
    assert divergence.expected != divergence.actual
