import pytest

from sandbox.cli import main
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import Grab, MoveGrab
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.replay.rerecord import resume
from sandbox.session.session import Session
from tests.support.rope_level import rope_level


@pytest.fixture(params=["jsonl", "gz"])
def crashed(request, tmp_path):
    """A recording that ended in the middle of a line, while a hand held something; and the run itself."""
    session = Session(rope_level())
    path = tmp_path / f"run.replay.{request.param}"
    session.record_to(path)
    gesture = session.new_gesture()
    session.submit(Grab(0, 6, (3.0, 1.0)), gesture)
    for tick in range(130):
        session.submit(MoveGrab(0, (3.0, 1.0 + 0.01 * tick)), gesture)
        session.advance()
    session._recorder._file.flush()
    data = path.read_bytes()
    session.abandon_recording()
    path.write_bytes(data[:-20])
    return path, session


def test_a_recording_that_was_cut_off_goes_on_as_the_run_would_have(crashed):
    path, session = crashed
    cut = read_replay(path, partial=True)
    resume(cut, 200)
    whole = read_replay(path)
    assert whole.ticks == 200 and verify(whole) is None
    assert whole.hashes[: cut.ticks + 1] == cut.hashes
    if cut.ticks >= 129:
        for _ in range(200 - session.tick):
            session.advance()
        assert whole.end_hash == state_hash(session.world)
    assert [each.name for each in path.parent.iterdir()] == [path.name]


def test_it_is_made_whole_by_the_command_line_which_refuses_what_is_whole_or_longer(crashed, capsys):
    path, _ = crashed
    assert main(["resume", str(path), "--ticks", "5"]) == 2
    assert "has 1" in capsys.readouterr().err
    assert main(["resume", str(path)]) == 0
    assert main(["replay", str(path)]) == 0
    capsys.readouterr()
    assert main(["resume", str(path)]) == 2
    assert "there is nothing to resume" in capsys.readouterr().err


def test_what_runs_otherwise_now_is_refused_and_nothing_is_changed(crashed, monkeypatch):
    path, _ = crashed
    cut, data = read_replay(path, partial=True), path.read_bytes()
    monkeypatch.setattr("sandbox.session.replay.rerecord.state_hash", lambda world: "0" * 32)
    with pytest.raises(ReplayError, match="the run differs at tick 1,"):
        resume(cut, 200)
    assert path.read_bytes() == data and len(list(path.parent.iterdir())) == 1
