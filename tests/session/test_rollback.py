"""A run that goes back by a snapshot comes to the same bits again; a state that no snapshot holds shows."""

import json

import numpy as np
import pytest

import sandbox.session.session as session_module
from sandbox.cli import main
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.physics.step import step
from sandbox.session.commands import Grab, Push
from sandbox.session.compare.rollback import roll_back, roll_back_level
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.play import play, without_limits
from tests.support.rope_level import rope_level
from tests.support.wholes import some_and_whole

# Levels of many kinds of things whose ticks are quick; the others are tried with all kernels' tests.
LEVELS = some_and_whole(("rope", "walker", "basket_throw", "truss_bridge"), [path.stem for path in shipped_levels()])


@pytest.fixture
def hidden(monkeypatch):
    """Every run remembers, where no snapshot does, how often something was fast; what was, is slower by a bit."""

    def wrong(world):
        step(world)
        fast = world.velocity[:, 1] < -2.0
        world.__dict__["hidden"] = world.__dict__.get("hidden", 0) + int(fast.any())
        if world.__dict__["hidden"] > 30 and world.__dict__["hidden"] % 7 == 0:
            world.velocity[3, 1] = np.nextafter(world.velocity[3, 1], np.inf)

    monkeypatch.setattr(session_module, "step", wrong)


@pytest.fixture
def recorded(tmp_path):
    session = Session(rope_level())
    session.record_to(tmp_path / "run.replay.gz")
    play(session, 300)
    session.stop_recording()
    return tmp_path / "run.replay.gz"


@pytest.mark.parametrize("name", LEVELS)
def test_a_shipped_level_comes_to_the_same_bits_from_eight_ticks_before_each(name):
    # Whatever hands may do.
    result = roll_back_level(without_limits(load_level(name)), 8)
    assert result.found is None and result.ticks >= 300 and result.commands > 20


def test_a_recording_with_cuts_undo_and_solvers_does_too(recorded):
    for back in (1, 8, 60):
        assert roll_back(read_replay(recorded), back).found is None


def test_a_state_that_no_snapshot_holds_is_found_with_its_tick_and_array(recorded, hidden):
    found = roll_back(read_replay(recorded), 8).found
    assert found is not None and (found.array, found.index, found.name) == ("velocity", (3, 1), "rope.3")
    assert found.note == f"stepped again from tick {found.tick - 8}"
    assert roll_back_level(load_level("rope"), 8).found is not None


def test_stepping_again_changes_nothing_of_a_run_and_of_its_recording(tmp_path):
    def run(name, back):
        session = Session(load_level("rope"))
        session.record_to(tmp_path / name)
        session.submit(Grab(0, session.world.particle_slot("rope.end"), (3.0, 3.0)))
        for tick in range(90):
            state = session.snapshot()
            if tick == 50:
                session.submit(Push((0.0, 5.0), 8.0, (40.0, 0.0)))
            session.advance()
            if back:
                session.step_again(state)
        session.undo()
        session.advance()
        session.stop_recording()
        return (tmp_path / name).read_bytes(), session.messages

    assert run("a.replay.gz", False) == run("b.replay.gz", True)


def test_the_command_line_goes_back_in_recordings_and_levels(recorded, tmp_path, capsys, request):
    (tmp_path / "rope.json").write_text(json.dumps(json.loads(
        next(path for path in shipped_levels() if path.stem == "rope").read_text("utf-8"))))  # fmt: skip
    level = str(tmp_path / "rope.json")
    assert main(["replay", str(recorded), "--rollback", "8"]) == 0
    assert main(["check", level, "--rollback", "8"]) == 0
    told = capsys.readouterr().out
    assert "equal, 300 ticks, and again from 8 ticks before each" in told
    assert "rollback   equal again from 8 ticks before each of 600" in told
    request.getfixturevalue("hidden")
    assert main(["check", level, "--rollback", "8"]) == 1
    assert "rollback   DIVERGES at tick" in capsys.readouterr().out


def test_a_fault_of_rollback_alone_fails_the_replay_of_a_recording(tmp_path, capsys, request):
    request.getfixturevalue("hidden")
    session = Session(rope_level())
    session.record_to(tmp_path / "run.replay.gz")
    for _ in range(300):
        session.advance()
    session.stop_recording()
    assert main(["replay", str(tmp_path / "run.replay.gz")]) == 0
    assert main(["replay", str(tmp_path / "run.replay.gz"), "--rollback", "8", "--json"]) == 1
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert told["result"] == "diverged" and told["text"].startswith("rolled back 8 ticks, diverged at tick")
