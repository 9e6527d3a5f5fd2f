"""Recordings and golden files keep what was said of a thing, follow its names, and offer commands that work."""

import json
import re
import shlex

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import level_data, load_level
from sandbox.session.commands import CutSprings, Grab, Pin
from sandbox.session.compare.comparison import verify
from sandbox.session.golden import read_golden, write_golden
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

CHECK = {"name": "the end", "metric": "speed", "particle": "rope.end", "after": 0.4, "at_most": 50.0}
TICKS = 40


@pytest.fixture
def project(pytester):
    """A folder with a level, a recording and a golden file in `tests`, and a function that runs pytest there."""
    path = pytester.path
    (path / "tests" / "levels").mkdir(parents=True)
    level, recording = path / "tests" / "levels" / "swing.json", path / "tests" / "my pull.replay.gz"

    def edit(change=lambda data: None):
        data = level_data(rope_level(checks=[CHECK]))
        change(data)
        level.write_text(json.dumps(data))

    def record(*commands):
        session = Session(load_level(level))
        session.record_to(recording, 30)
        for each in commands:
            session.do(each)
        while session.tick < TICKS:
            session.advance()
        session.stop_recording()
        return [line.record for line in read_replay(recording).script]

    def run(*arguments):
        found = pytester.runpytest_inprocess("-q", *LOADED, "--replay-output=out", "tests", *arguments)
        return found.ret, found.stdout.str() + "\n" + found.stderr.str()

    edit()
    run.path, run.edit, run.record, run.recording = path, edit, record, recording
    return run


def _rope(data):
    return next(body for body in data["bodies"] if body["id"] == "rope")


def _shorter(data):
    _rope(data)["segments"] -= 3


def _offered(told, start):
    """The command that a failure offers in a line with that start."""
    return shlex.split(re.search(rf"^{start}[^\n]*?: (.+)$", told, re.MULTILINE)[1])


def test_a_recording_keeps_the_end_of_a_body_as_it_was_said(project):
    said = project.record(Grab(0, "rope.end", (4.0, 1.0)), Pin("rope.end"))
    assert [each["particle"] for each in said] == ["rope.end", "rope.end"]
    assert verify(read_replay(project.recording)) is None
    again = Session(load_level(project.path / "tests" / "levels" / "swing.json"))
    slot = again.world.particle_slot("rope.end")
    assert project.record(Pin(slot))[0]["particle"] == again.world.particle_names[slot] != "rope.end"


def test_what_was_done_to_an_end_is_done_to_that_of_a_body_with_fewer_segments(project):
    project.record(Grab(0, "rope.end", (4.0, 1.0)))
    project.edit(_shorter)
    code, told = project()
    assert code == 1 and "the new run ends" not in told
    assert project(*_offered(told, "to accept")[1:])[0] == 0
    assert project()[0] == 0
    assert [line.record["particle"] for line in read_replay(project.recording).script] == ["rope.end"]


def test_a_run_that_a_command_ends_offers_what_is_done_about_it(project, capsys):
    project.record(Grab(0, "rope.11", (4.0, 1.0)))
    project.edit(_shorter)
    code, told = project()
    assert code == 1 and "the new run ends at tick 0" in told and "--replay-update" not in told
    command = _offered(told, "to accept, edit its commands")
    assert command[0] == "sandbox" and main(command[1:]) == 0
    moves = project.path / command[-1]
    moves.write_text(moves.read_text().replace("rope.11", "rope.end"))
    level = str(project.path / "tests" / "levels" / "swing.json")
    run = ["run", level, "--ticks", str(TICKS), "--commands", str(moves), "--record", str(project.recording)]
    assert main(run) == 0 and project()[0] == 0


def test_a_body_that_cannot_be_guessed_is_renamed_by_the_offered_command(project):
    project.record(CutSprings(("rope:2",)), Pin("rope.end"))

    def change(data):
        _shorter(data)
        _rope(data).update(id="chain")
        data["checks"] = []

    project.edit(change)
    code, told = project()
    command = _offered(told, "if rope is called otherwise now")
    assert code == 1 and command[-1] == "tests/my pull.replay.gz"
    assert project(*(each.replace("NEW", "chain") for each in command[1:]))[0] == 0
    assert [line.record for line in read_replay(project.recording).script][1]["particle"] == "chain.end"
    assert project()[0] == 0


@pytest.mark.parametrize("by", ["a script", "a recording"])
def test_a_golden_file_follows_names_by_the_commands_that_it_offers(project, by):
    project.record(Pin("rope.end"))
    moves, golden = project.path / "tests" / "moves.jsonl", project.path / "tests" / "swing.golden.json"
    moves.write_text('{"tick": 0, "command": {"type": "pin", "particle": "soft.2"}}\n')
    golden.write_text(json.dumps({
        "format": "spring-sandbox/golden", "level": "levels/swing.json", "at": [0.5],
        "commands": moves.name if by == "a script" else project.recording.name,
        "places": {"rope.end": [], "rope": [], "soft": []}, "values": {"the end": None},
    }))  # fmt: skip
    write_golden(golden, read_golden(golden).measured())
    assert project("-m", "golden")[0] == 0
    before = read_golden(golden).file

    def change(data):
        _rope(data)["id"] = "chain"
        data["checks"] = [{**CHECK, "particle": "chain.end", "name": "it rests"}]

    project.edit(change)
    told, options = project("-m", "golden")[1], []
    for missing, new in (("the end", "it rests"), ("rope", "chain")):
        command = _offered(told, f"if {missing} is called otherwise now")
        assert command[-1] == "tests/swing.golden.json"
        options += ["--replay-rename", command[-2].replace("NEW", new)]
        code, told = project("-m", "golden", *options)
    assert code == 1 and "swing.golden.json: rope.end is called chain.end now" in told
    command = _offered(told, "to accept")
    assert project(*command[1:], "-m", "golden")[0] == 0
    after = read_golden(golden).file
    assert list(after.places) == ["chain.end", "chain", "soft"] and after.values.keys() == {"it rests"}
    assert list(after.places.values()) == list(before.places.values())
    assert project("--replay-update")[0] == 0 and project()[0] == 0
