from pathlib import Path

import pytest

from sandbox.session.replay.reader import read_replay, read_script
from sandbox.session.replay.recording import ReplayError
from sandbox.session.replay.verify import verify
from sandbox.session.session import Session
from tests.support.malformed_replays import bad_commands, cases, sealed
from tests.support.play import play
from tests.support.rope_level import rope_level


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("good") / "good.jsonl"
    session = Session(rope_level())
    session.record_to(path)
    play(session, 65)
    session.stop_recording()
    return path.read_bytes()


def _refusal(read, path: Path) -> list[str]:
    with pytest.raises(ReplayError) as refusal:
        read(path)
    faults = refusal.value.faults
    assert 1 <= len(faults) <= 50
    assert all(str(path) in fault and "\n" not in fault and "Traceback" not in fault for fault in faults)
    return faults


def test_every_malformed_replay_is_refused_in_clear_lines(good, tmp_path):
    path = tmp_path / "case.jsonl"
    count = 0
    for name, data in cases(good):
        path.write_bytes(data)
        faults = _refusal(read_replay, path)
        assert all(len(fault) < 600 for fault in faults), name
        count += 1
    assert count >= 80


def test_a_damaged_stored_state_is_refused_when_it_is_used(good, tmp_path):
    import json

    lines = [json.loads(line) for line in good.splitlines()]
    place = [number for number, line in enumerate(lines) if "state" in line][1]
    for text in ("", "%%%", "AAAA", lines[place]["state"]["velocity"][:-8], lines[place]["state"]["mass"]):
        lines[place]["state"]["position"] = text
        (tmp_path / "bad.jsonl").write_bytes(sealed(lines))
        replay = read_replay(tmp_path / "bad.jsonl")
        with pytest.raises(ReplayError, match=rf"line {place + 1}: state"):
            verify(replay, start=60)


def test_a_stored_state_that_its_own_hash_belies_is_refused(good, tmp_path):
    import json

    lines = [json.loads(line) for line in good.splitlines()]
    place = [number for number, line in enumerate(lines) if "state" in line][1]
    for change in (
        {"state": {**lines[place]["state"], "position": lines[place]["state"]["velocity"]}},
        {"settings": {**lines[place]["settings"], "solver": "magic"}},
        {"settings": {**lines[place]["settings"], "iterations": 11}},
    ):
        forged = [*lines[:place], {**lines[place], **change}, *lines[place + 1 :]]
        (tmp_path / "bad.jsonl").write_bytes(sealed(forged))
        with pytest.raises(ReplayError, match=rf"line {place + 1}: (state|settings)"):
            verify(read_replay(tmp_path / "bad.jsonl"), start=60)


def test_every_bad_command_is_refused_with_its_line(good, tmp_path):
    import json

    lines = [json.loads(line) for line in good.splitlines()]
    after_tick_zero = next(place for place, line in enumerate(lines) if "state" in line) + 1
    for name, record in bad_commands():
        forged = [*lines[:after_tick_zero], {"tick": 0, "gesture": 1, "command": record}, *lines[after_tick_zero:]]
        (tmp_path / "bad.jsonl").write_bytes(sealed(forged))
        with pytest.raises(ReplayError) as refusal:
            verify(read_replay(tmp_path / "bad.jsonl"))
        assert len(refusal.value.faults) == 1, name
        assert f"line {after_tick_zero + 1}: " in refusal.value.faults[0], name
        assert "\n" not in refusal.value.faults[0], name


def test_missing_files_folders_and_unreadable_names_are_refused(tmp_path):
    for path in (tmp_path / "missing.jsonl", tmp_path, tmp_path / ("x" * 300)):
        for read in (read_replay, read_script):
            _refusal(read, path)


def test_faults_in_a_script_are_told_all_at_once(tmp_path):
    path = tmp_path / "moves.jsonl"
    path.write_text('{"tick": 1, "command": {}}\nnonsense\n\n{"tick": -1, "command": {}}\n{"tick": 1}\n[]\n')
    assert [fault.split(": ")[1] for fault in _refusal(read_script, path)] == ["line 2", "line 4", "line 5", "line 6"]
