import json
import tracemalloc
from pathlib import Path

import pytest

from sandbox.cli import main
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay, read_script
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session
from tests.support.malformed_replays import bad_commands, cases, compressed, sealed
from tests.support.play import play
from tests.support.rope_level import rope_level


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("good") / "good.jsonl"
    session = Session(rope_level())
    session.record_to(path, state_ticks=60)
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
    lines = [json.loads(line) for line in good.splitlines()]
    first, place, _ = (number for number, line in enumerate(lines) if "state" in line)
    mass = lines[first]["state"]["mass"]
    for text in ("", "%%%", "AAAA", lines[place]["state"]["velocity"][:-8], mass):
        lines[place]["state"]["position"] = text
        (tmp_path / "bad.jsonl").write_bytes(sealed(lines))
        replay = read_replay(tmp_path / "bad.jsonl")
        with pytest.raises(ReplayError, match=rf"line {place + 1}: state"):
            verify(replay, start=60)


def test_a_stored_state_that_its_own_hash_belies_is_refused(good, tmp_path):
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


@pytest.mark.parametrize("cut", [1, 4, 8, 9])
def test_the_last_bytes_of_a_compressed_recording_are_missed(good, tmp_path, cut):
    path = tmp_path / "cut.gz"
    path.write_bytes(compressed(good)[:-cut])
    assert any("cut off" in fault for fault in _refusal(read_replay, path))
    assert verify(read_replay(path, partial=True)) is None


def test_a_level_is_said_to_be_no_replay(tmp_path):
    path = tmp_path / "rope.json"
    path.write_text('{\n  "format": "spring-sandbox/level"\n}\n')
    with pytest.raises(ReplayError, match="line 1: not a replay: not a line of JSON"):
        read_replay(path)


@pytest.mark.parametrize("tail", [b"x", bytes(8), compressed(b"more\n")])
def test_bytes_behind_a_compressed_recording_are_refused(good, tmp_path, tail):
    path = tmp_path / "long.gz"
    path.write_bytes(compressed(good) + tail)
    assert "bytes follow" in _refusal(read_replay, path)[0]


def test_a_recording_cut_before_its_first_tick_verifies_nothing(good, tmp_path):
    path = tmp_path / "cut.jsonl"
    path.write_bytes(b"".join(good.splitlines(keepends=True)[:3]))
    with pytest.raises(ReplayError, match="cut off before tick 1: nothing to verify"):
        read_replay(path, partial=True)


def test_a_forged_line_is_refused_before_it_is_held(good, tmp_path):
    lines = [json.loads(line) for line in good.splitlines()]
    flood = {"tick": 0, "gesture": 1, "command": {"type": "x" * 12_000_000}}
    wide = {"tick": 0, "state": {"position": "A" * 12_000_000}, "settings": {}}
    for forged in (flood, wide, {"note": [[]] * 3_000_000}):
        path = tmp_path / "forged.gz"
        path.write_bytes(compressed(sealed([*lines[:3], forged])))
        tracemalloc.start()
        fault = _refusal(read_replay, path)[0]
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert "line 4: longer than" in fault
        assert peak < 10_000_000


def test_a_header_of_endless_lists_is_refused_before_it_is_parsed(tmp_path):
    path = tmp_path / "forged.gz"
    path.write_bytes(compressed(b'{"format": "spring-sandbox/replay", "level": [' + b"[]," * 2_000_000 + b"[]]}\n"))
    assert "more than 1,000,000 lists" in _refusal(read_replay, path)[0]


def test_a_key_that_stands_twice_in_a_command_is_refused(tmp_path):
    path = tmp_path / "moves.jsonl"
    path.write_text('{"tick": 1, "tick": 2, "command": {}}\n{"tick": 1, "command": {"type": "pin", "type": "undo"}}\n')
    faults = _refusal(read_script, path)
    assert ['"tick": this key' in faults[0], '"type": this key' in faults[1]] == [True, True]


def test_a_script_of_endless_lines_is_refused(tmp_path):
    path = tmp_path / "moves.jsonl"
    path.write_bytes(b'{"tick": 1, "command": ' + b" " * 2_000_000 + b"{}}\n")
    assert "line 1: longer than" in _refusal(read_script, path)[0]
    path.write_bytes(b" " * 40_000_000)
    assert "larger than 32 MiB" in _refusal(read_script, path)[0]


def test_faults_in_a_script_are_told_all_at_once(tmp_path):
    path = tmp_path / "moves.jsonl"
    path.write_text('{"tick": 1, "command": {}}\nnonsense\n\n{"tick": -1, "command": {}}\n{"tick": 1}\n[]\n')
    assert [fault.split(": ")[1] for fault in _refusal(read_script, path)] == ["line 2", "line 4", "line 5", "line 6"]


def test_a_pointer_of_git_lfs_and_damaged_gzip_are_named(tmp_path, capsys):
    session = Session(rope_level())
    session.record_to(tmp_path / "good.replay.gz")
    for _ in range(5):
        session.advance()
    session.stop_recording()
    data = (tmp_path / "good.replay.gz").read_bytes()
    pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 29092\n"
    for content, words in (
        (pointer, "is a Git LFS pointer, not the recording: git lfs pull fetches it"),
        (b"\x00" + data[1:], "damaged gzip data: it does not begin as gzip does"),
        (data[:12] + bytes([data[12] ^ 0x55]) + data[13:], "damaged gzip data: "),
        (data[:200], "line 1: cut off before its end, or no recording"),
    ):
        path = tmp_path / "x.replay.gz"
        path.write_bytes(content)
        assert main(["replay", str(path)]) == 2
        assert capsys.readouterr().err.startswith(f"{path}: {words}")
    (tmp_path / "x.json").write_bytes(pointer)
    assert main(["check", str(tmp_path / "x.json")]) == 2
    assert "is a Git LFS pointer (git lfs pull fetches the file), not a" in capsys.readouterr().err
