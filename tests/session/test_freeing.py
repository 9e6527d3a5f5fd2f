"""What does not come apart by itself is found, and freed by a command that is recorded and undone."""

import json

import numpy as np
import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.applied_forces import overlapping
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import CommandError, Free, Pin, Undo, apply
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.overlaps import overlaps
from tests.support.physics_scenes import scaled

BARS = {"left": (-0.8, -0.8, -0.6, 0.8), "right": (0.6, -0.8, 0.8, 0.8), "low": (-0.8, -0.8, 0.8, -0.6),
        "high": (-0.8, 0.6, 0.8, 0.8)}  # fmt: skip


def cage(**changes):
    """A level: two jellies in a cage that is too small for both."""
    jelly = {"type": "jelly", "shape": {"box": [0.8, 0.8]}, "spacing": 0.2}
    level = {
        "format": "spring-sandbox/level", "version": 3, "name": "cage", "contacts": {}, "settings": {"gravity": [0, 0]},
        "terrain": [
            {"id": name, "polygon": [[a, b], [c, b], [c, d], [a, d]]} for name, (a, b, c, d) in BARS.items()
        ],
        "bodies": [{**jelly, "id": "one", "position": [-0.1, 0]}, {**jelly, "id": "two", "position": [0.1, 0.05]}],
    } | changes  # fmt: skip
    return parse_level(json.dumps(level).encode(), "cage")


def run(session, ticks):
    for _ in range(ticks):
        session.advance()
    return session


def test_what_cannot_part_is_found_and_freed_into_its_own_form():
    session = run(Session(cage()), scaled(120, 3))
    world = session.world
    assert overlapping(world) == [(0, 25)]
    session.submit(Free(0))
    run(session, 1)
    assert not overlapping(world) and not overlaps(world).depth
    one, two = world.position[:25], world.position[25:50]
    assert np.abs(one).max(axis=1).min() > 0.6 or np.abs(one.mean(axis=0)).max() > 1.0
    sides = [np.linalg.norm(one[a] - one[b]) for a, b in ((0, 4), (0, 20), (4, 24), (20, 24))]
    assert np.allclose(sides, 0.8, atol=1e-9)
    assert np.abs(two).max() < 0.65
    run(session, scaled(60, 2))
    assert not overlapping(world)


def test_freeing_is_undone_and_recorded(tmp_path):
    session = Session(cage())
    session.record_to(tmp_path / "free.replay.gz")
    run(session, 5)
    session.submit(Free(30))
    session.apply_pending()
    freed = session.world.position.copy()
    run(session, 3)
    session.submit(Undo())
    run(session, 2)
    twin = run(Session(cage()), session.tick)
    assert state_hash(twin.world) == state_hash(session.world)
    assert not np.array_equal(freed, session.world.position)
    session.stop_recording()
    assert verify(read_replay(tmp_path / "free.replay.gz")) is None


def test_what_is_free_stays_where_it_is():
    session = run(Session(cage(terrain=[], bodies=[cage().bodies[0].model_dump(exclude_unset=True)])), 1)
    before = session.world.position.copy()
    session.submit(Free(0))
    session.apply_pending()
    assert np.allclose(session.world.position, before, atol=1e-12)


def test_what_is_pinned_or_has_no_room_is_not_freed():
    world = Session(cage()).world
    apply(world, Pin(3))
    with pytest.raises(CommandError, match=r"the body of one\.0 is pinned"):
        apply(world, Free(0))
    closed = Session(cage(walls={"box": [-0.85, -0.85, 0.85, 0.85]})).world
    with pytest.raises(CommandError, match=r"there is no free place for the body of two\.1 near by"):
        apply(closed, Free(26))
    alone = Session(cage(contacts=None, terrain=[])).world
    with pytest.raises(CommandError, match="nothing touches anything here"):
        apply(alone, Free(0))
