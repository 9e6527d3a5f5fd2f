"""Runs of levels with water: what joins and leaves them, undo, recordings."""

import json

import numpy as np
import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import AddBody, CutSprings, Remove, Undo
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.pools import free, jelly, lift_over_weight, pool

WHEEL = {"type": "wheel", "radius": 0.5, "thickness": 0.1, "segments": 12, "particle_mass": 0.1, "position": [3.0, 0.0]}
RING = {"type": "ring", "radius": 0.5, "segments": 12, "particle_mass": 0.2, "position": [-3.0, 0.0]}


def level(**parts):
    head = {"format": "spring-sandbox/level", "version": 3, "name": "water", "zones": [pool()]}
    return parse_level(json.dumps(head | jelly((1.0, 0.5), 0.5, 0.0) | parts).encode(), "water")


def run(session, ticks):
    for _ in range(ticks):
        session.advance()
    return session


@pytest.mark.parametrize("body", [WHEEL, RING], ids=["wheel", "ring"])
@pytest.mark.parametrize("touches", [True, False])
def test_a_body_that_joins_floats_as_one_that_the_level_has(body, touches):
    parts = {"contacts": {}} if touches else {}
    box = jelly((1.0, 0.5), 0.5, 0.0)["bodies"]
    there = run(Session(level(bodies=[*box, body | {"id": "own"}], **parts)), 120)
    joined = Session(level(**parts))
    joined.submit(AddBody(body))
    run(joined, 120)
    count = there.world.grab_particle - joined.world.grab_particle
    own = there.world.position[joined.world.grab_particle : there.world.grab_particle]
    assert np.array_equal(own, joined.world.position[-count:])
    assert lift_over_weight(run(joined, 1200).world) == pytest.approx(1.0, abs=1e-4)


def test_a_body_that_is_removed_displaces_nothing():
    session = run(Session(level(bodies=[*jelly((1.0, 0.5), 0.5, 0.0)["bodies"], WHEEL | {"id": "own"}])), 10)
    session.submit(Remove("own"))
    run(session, 600)
    water = block_of(session.world).arrays.water
    assert len(water.shell_start) == 1 and len(water.disc) == 0
    assert lift_over_weight(session.world) == pytest.approx(1.0, abs=1e-6)


def test_undo_of_a_cut_in_water_is_as_if_nobody_had_cut():
    session, plain = Session(level()), Session(level())
    run(session, 20)
    session.submit(CutSprings([session.world.spring_names[k] for k in range(4)]), session.new_gesture())
    run(session, 20)
    session.submit(Undo())
    run(session, 20)
    run(plain, 60)
    assert state_hash(session.world) == state_hash(plain.world)
    assert free(session.world).any()


def test_a_recording_of_a_level_with_water_verifies(tmp_path):
    path = tmp_path / "water.replay"
    session = Session(level(contacts={}))
    session.record_to(path)
    session.submit(AddBody(WHEEL | {"position": [3.0, 2.0]}))
    run(session, 90)
    session.stop_recording()
    replay = read_replay(path)
    assert replay.level.zones[0].water is not None
    assert verify(replay) is None
