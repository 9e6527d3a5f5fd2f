"""What the plugin of pytest does where it is asked to shrink recordings, and to go back in runs."""

import json

import numpy as np
import pytest

import sandbox.session.session as session_module
from sandbox.level.reading.files import level_data
from sandbox.physics.step import step
from sandbox.session.commands import Pin, Push, Unpin
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

OPTIONS = [*LOADED, "--replay-output=out"]


@pytest.fixture
def project(pytester):
    """A folder with a level, weaker than the one that its recording is of."""
    level = rope_level()
    session = Session(level)
    session.record_to(pytester.path / "run.replay.gz")
    for tick in range(200):
        if tick % 20 == 10:
            session.submit(Pin(6) if tick % 40 == 10 else Unpin(6))
        if tick == 150:
            session.submit(Push((1.0, 3.0), 4.0, (900.0, 0.0)))
        session.advance()
    session.stop_recording()
    data = level_data(level)
    data["materials"]["rubber"]["tension_limit"] = 2.0
    (pytester.path / "levels").mkdir()
    (pytester.path / "levels" / "rope.json").write_text(json.dumps(data))
    return pytester


def test_a_recording_that_diverges_on_a_level_is_shrunk_where_that_is_asked_for(project):
    result = project.runpytest_inprocess(*OPTIONS, "--replay-against=levels", "--replay-shrink", "run.replay.gz")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        ["smallest: *run.smallest.replay.gz: 1 gesture, 1 command, *: tick *: soft.1 is * m from where it is on *"]
    )
    smallest = read_replay(project.path / "out" / "run.smallest.replay.gz")
    assert [line.record["type"] for line in smallest.script] == ["push"]
    plain = project.runpytest_inprocess(*OPTIONS, "--replay-against=levels", "run.replay.gz")
    assert "smallest" not in plain.stdout.str()


def test_recordings_and_levels_go_back_where_that_is_asked_for(project, monkeypatch):
    project.runpytest_inprocess(*OPTIONS, "--replay-rollback=8", "--replay-against=own").assert_outcomes(passed=2)

    def wrong(world):
        step(world)
        world.__dict__["hidden"] = world.__dict__.get("hidden", 0) + int(world.velocity[8, 1] < -4.0)
        if world.__dict__["hidden"] == 40:
            world.velocity[8, 1] = np.nextafter(world.velocity[8, 1], np.inf)

    monkeypatch.setattr(session_module, "step", wrong)
    result = project.runpytest_inprocess(*OPTIONS, "--replay-rollback=8", "levels/rope.json")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*rolled back 8 ticks under random hands, diverged: tick *: velocity*"])
