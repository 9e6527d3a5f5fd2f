"""Goldens belong to the file of their level: new titles, files and names of bodies are carried over, and reviewed."""

import json
import subprocess
import sys

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import file_of, level_data, load_level, write_level
from sandbox.session.commands import CutSprings, Grab, Pin, Release
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED
from tests.testing.test_edited_levels import resealed

pytest_plugins = ["pytester"]

TICKS = 60


def recorded(level, path):
    """A recording of a level in which the end of the rope is pulled, and links of both ropes are cut."""
    session = Session(level)
    session.record_to(path, 30)
    for tick in range(TICKS):
        if tick == 10:
            session.submit(Grab(0, session.world.particle_slot("rope.end"), (4.0, 1.0)), 900)
        if tick == 30:
            session.submit(Release(0), 900)
            session.submit(Pin(session.world.particle_slot("soft.2")))
            session.submit(CutSprings((session.world.spring_slot("rope:8"),)))
        session.advance()
    session.stop_recording()


@pytest.fixture
def project(pytester):
    """A folder with a level and two recordings of it, and a function that runs pytest there."""
    path = pytester.path
    (path / "levels").mkdir()
    level = path / "levels" / "swing.json"
    write_level(rope_level(), level)
    for name in ("a.replay.gz", "b.replay.jsonl"):
        recorded(load_level(level), path / name)
    (path / "pytest.ini").write_text("[pytest]\nsandbox_against = levels\n")

    def run(*arguments):
        usual = ["-q", *LOADED, "--replay-output=out"]
        found = pytester.runpytest_inprocess(*usual, *arguments, "a.replay.gz", "b.replay.jsonl")
        return found.ret, found.stdout.str() + "\n" + found.stderr.str()

    def edit(change, file="swing.json"):
        data = level_data(rope_level())
        change(data)
        (path / "levels" / file).write_text(json.dumps(data))

    run.path, run.edit = path, edit
    return run


def renamed(data, old, new):
    next(body for body in data["bodies"] if body["id"] == old)["id"] = new


def test_a_recording_names_the_file_of_its_level_and_runs_on_it_whatever_its_title(project):
    assert read_replay(project.path / "a.replay.gz").level is not None
    assert file_of(read_replay(project.path / "a.replay.gz").level) == "swing.json"
    project.edit(lambda data: data.update(name="Other title"))
    # Another file has the old title: it is not this recording's.
    project.edit(lambda data: data["settings"].update(gravity=[0.0, -2.0]), "copy.json")
    assert project()[0] == 0
    code, told = project("--replay-update")
    assert code == 0
    assert "swing.json: title: Test rope -> Other title\n  equal in every bit\n  2 recordings: a.replay.gz, b" in told
    assert read_replay(project.path / "a.replay.gz").level.name == "Other title"
    before = (project.path / "a.replay.gz").read_bytes()
    assert "recorded again" not in project("--replay-update")[1]
    assert (project.path / "a.replay.gz").read_bytes() == before


def test_a_level_of_neither_its_file_nor_its_title_is_named_once(project):
    (project.path / "levels" / "swing.json").rename(project.path / "levels" / "moved.json")
    assert project()[0] == 0
    (project.path / "levels" / "moved.json").unlink()
    project.edit(lambda data: data.update(name="Moved"), "moved.json")
    code, told = project()
    assert code == 1 and "there is neither swing.json nor a level with the title 'Test rope'\n" in told
    assert "name its file: pytest --replay-update --replay-against " in told
    assert project("--replay-update", "--replay-against", "levels/moved.json")[0] == 0
    assert project()[0] == 0


def test_two_levels_of_one_title_are_told_apart_or_said(project):
    for name in ("a.replay.gz", "b.replay.jsonl"):
        recorded(rope_level(), project.path / name)
    assert project()[0] == 0
    project.edit(lambda data: None, "twin.json")
    code, told = project()
    assert code == 1 and "2 levels are called 'Test rope': " in told and "twin.json" in told


def test_a_renamed_body_is_told_and_carried_over(project):
    project.edit(lambda data: renamed(data, "rope", "chain"))
    code, told = project()
    assert code == 1 and "\nswing.json: rope is called chain now\n" in told
    assert "with these names every bit is equal\n" in told and "to accept: pytest --replay-update a.replay.gz" in told
    code, told = project("--replay-update")
    assert code == 0 and "swing.json: rope is called chain now\n  equal in every bit\n  2 recordings: " in told
    updated = read_replay(project.path / "a.replay.gz")
    assert [line.record.get("particle") for line in updated.script] == ["chain.11", None, "soft.2", None]
    assert updated.script[3].record["springs"] == ["chain:8"] and verify(updated) is None
    assert project()[0] == 0


def test_names_that_cannot_be_guessed_are_given(project):
    def twice(data):
        renamed(data, "rope", "chain")
        data["bodies"].append({**data["bodies"][0], "id": "twin", "start": [0, 9], "end": [5.5, 9]})

    project.edit(twice)
    code, told = project("--replay-update")
    assert code == 1
    assert "its commands name rope, which swing.json lacks; new there: chain, twin\n" in told
    assert "if rope is called otherwise now: pytest --replay-update --replay-rename rope=NEW a.replay.gz\n" in told
    assert project("--replay-update", "--replay-rename", "rope")[0] == 4
    code, told = project("--replay-update", "--replay-rename", "rope=chain")
    assert code == 0 and "swing.json: rope is called chain now\n" in told
    assert project()[0] == 0


def test_each_cause_is_told_once_with_its_largest_effect(project):
    project.edit(lambda data: data["settings"].update(gravity=[0.0, -12.0]))
    _, told = project("--replay-update")
    cause = "swing.json: settings.gravity: [0.0, -9.81] (default) -> [0.0, -12.0]\n  at most "
    assert told.count(cause) == 1 and told.count(" apart, ") == 1
    assert "\n  2 recordings: a.replay.gz, b.replay.jsonl\n" in told


def test_a_recording_is_shown_as_text_and_its_commands_make_the_same_recording(project, capsys):
    path, moves, again = project.path / "a.replay.gz", project.path / "moves.jsonl", project.path / "again.replay.gz"
    assert main(["show", str(path)]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith('recording of swing.json, "Test rope"\n')
    assert shown.endswith(f"ends after tick {TICKS}, 1 s\nhash {read_replay(path).end_hash}\n")
    assert shown.count('"command"') == 4 and "chain" not in shown
    assert main(["export", str(path), "--to", "commands", "-o", str(moves)]) == 0
    level = str(project.path / "levels" / "swing.json")
    run = ["run", level, "--ticks", str(TICKS), "--commands", str(moves), "--record", str(again)]
    assert main(run) == 0 and main(["diff", str(path), str(again)]) == 0
    assert f"equal in every bit of {TICKS} ticks" in capsys.readouterr().out


def test_git_shows_a_recording_with_the_two_lines_of_the_document(project):
    def git(*arguments):
        identity = ["-c", "user.name=x", "-c", "user.email=x@example.org"]
        return subprocess.run(
            ["git", *identity, *arguments], cwd=project.path, capture_output=True, text=True, check=True
        ).stdout

    git("init", "-q")
    (project.path / ".gitattributes").write_text("*.replay.gz diff=sandbox\n")
    git("config", "diff.sandbox.textconv", f"{sys.executable} -m sandbox show")
    git("add", "-A")
    git("commit", "-qm", "before")
    project.edit(lambda data: data["settings"].update(gravity=[0.0, -12.0]))
    assert project("--replay-update")[0] == 0
    changed = [line for line in git("diff", "a.replay.gz").splitlines()[4:] if line[0] in "+-"]
    assert len(changed) == 4 and any("-12.0" in line for line in changed)


def test_diff_compares_stored_states_across_physics_versions(project, capsys):
    old, new, level = (str(project.path / name) for name in ("b.replay.jsonl", "a.replay.gz", "levels/swing.json"))
    resealed(project.path / "b.replay.jsonl", physics_version=3)
    assert main(["diff", old, new]) == 0
    assert "no particle is elsewhere at the stored states until tick 60" in capsys.readouterr().out
    project.edit(lambda data: data["settings"].update(gravity=[0.0, -12.0]))
    assert main(["diff", old, level]) == 1
    told = capsys.readouterr().out
    assert "physics version: 3 -> " in told and "level: settings.gravity: " in told
    assert " apart at the stored states, soft.4" in told
    assert main(["diff", old, level, "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["apart"]["stored"] is True
    assert main(["diff", old, new, "-o", "x.html"]) == 2
    assert "cannot be played or drawn here" in capsys.readouterr().err
