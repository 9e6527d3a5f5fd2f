"""Files of tests as git leaves them: line ends of Windows, a byte order mark, and conflicts of a merge."""

import json
import subprocess

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import level_data, write_level
from sandbox.session.compare.comparison import verify
from sandbox.session.golden import read_golden, write_golden
from sandbox.session.replay.reader import read_replay, read_script
from sandbox.session.session import Session
from tests.support.play import play
from tests.support.rope_level import rope_level
from tests.testing.test_golden import GOLDEN

BOM = b"\xef\xbb\xbf"
CHECK = {"name": "the end", "metric": "speed", "particle": "rope.end", "after": 0.4, "at_most": 50.0}


@pytest.fixture
def files(tmp_path):
    """A folder with one of each kind of text: a level, a recording, its commands and a golden file."""
    write_level(rope_level(checks=[CHECK]), tmp_path / "rope.json")
    session = Session(rope_level())
    session.record_to(tmp_path / "a.replay.jsonl", 30)
    play(session, 40)
    session.stop_recording()
    lines = [{"tick": line.tick, "command": line.record} for line in read_replay(tmp_path / "a.replay.jsonl").script]
    (tmp_path / "moves.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    golden = tmp_path / "rope.golden.json"
    golden.write_text(json.dumps({**GOLDEN, "commands": "moves.jsonl", "at": [0.2, 2]}))
    write_golden(golden, read_golden(golden).measured())
    return tmp_path


@pytest.mark.parametrize("added", ["line ends", "byte order mark", "both"])
def test_line_ends_and_a_byte_order_mark_change_nothing(files, added):
    before = read_script(files / "moves.jsonl")
    for path in files.iterdir():
        data = path.read_bytes()
        data = data if added == "byte order mark" else data.replace(b"\n", b"\r\n")
        path.write_bytes(data if added == "line ends" else BOM + data)
    assert verify(read_replay(files / "a.replay.jsonl")) is None
    assert [line.record for line in read_script(files / "moves.jsonl")] == [line.record for line in before]
    assert main(["check", str(files / "rope.json")]) == 0 and main(["check", str(files / "rope.golden.json")]) == 0


def test_a_changed_byte_is_named_by_its_line_whatever_the_line_ends_are(files, capsys):
    path = files / "a.replay.jsonl"
    lines = path.read_bytes().replace(b"\n", b"\r\n").splitlines(keepends=True)
    lines[7] = lines[7].replace(b"1", b"2", 1)
    path.write_bytes(b"".join(lines))
    assert main(["replay", str(path)]) == 2
    assert f"{path}: line 8: changed or damaged" in capsys.readouterr().err


def _git(folder, *arguments, check=True):
    identity = ["-c", "user.name=x", "-c", "user.email=x@example.org", "-c", "core.autocrlf=true"]
    return subprocess.run(["git", *identity, *arguments], cwd=folder, capture_output=True, text=True, check=check)


def _merged(files, attributes):
    """Two branches, in which gravity differs and all is recorded anew, merged as far as git does it."""
    (files / ".gitattributes").write_text(attributes)
    _git(files, "init", "-q", "-b", "one")
    _git(files, "add", "-A")
    _git(files, "commit", "-qm", "before")
    for branch, gravity in (("two", -5.0), ("one", -15.0)):
        _git(files, "checkout", "-q", *(["-b"] if branch == "two" else []), branch)
        level = rope_level(settings={"solver": "iterative", "gravity": [0.0, gravity]}, checks=[CHECK])
        write_level(level, files / "rope.json")
        session = Session(level)
        session.record_to(files / "a.replay.jsonl", 30)
        play(session, 40)
        session.stop_recording()
        moves = (files / "moves.jsonl").read_text().splitlines()
        (files / "moves.jsonl").write_text("\n".join([moves[0].replace("{", "{ " if branch == "one" else "{  ", 1)]))
        write_golden(files / "rope.golden.json", read_golden(files / "rope.golden.json").measured())
        _git(files, "commit", "-qam", branch)
    assert _git(files, "merge", "-q", "two", check=False).returncode == 1


def test_a_merge_conflict_is_named_with_the_way_out(files, capsys):
    _merged(files, "")
    for name, command in (
        ("rope.json", "check"), ("rope.golden.json", "check"), ("a.replay.jsonl", "replay"),
    ):  # fmt: skip
        path = files / name
        assert b"<<<<<<< " in path.read_bytes(), name
        assert main([command, str(path)]) == 2
        told = capsys.readouterr().err
        assert len(told.splitlines()) == 1 and "a merge conflict of git; " in told, told
    with pytest.raises(ValueError, match=r"moves.jsonl: line 1: a merge conflict of git; .* git checkout --ours "):
        read_script(files / "moves.jsonl")
    _git(files, "checkout", "--ours", "a.replay.jsonl")
    assert verify(read_replay(files / "a.replay.jsonl")) is None


def test_with_the_lines_of_the_document_git_takes_a_recording_whole(files):
    _merged(files, "*.replay.jsonl -text -merge diff=sandbox\n")
    assert b"\r" not in (files / "a.replay.jsonl").read_bytes()
    assert verify(read_replay(files / "a.replay.jsonl")) is None
    assert level_data(read_replay(files / "a.replay.jsonl").level)["settings"]["gravity"] == [0.0, -15.0]
