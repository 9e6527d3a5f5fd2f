"""`sandbox replay FOLDER --against FOLDER`: each recording runs on the nearest level of its name."""

import json

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import level_data, load_level, write_level
from sandbox.session.session import Session
from tests.support.rope_level import rope_level


@pytest.fixture
def worlds(tmp_path):
    """Two worlds with a level 01.json each, of other titles, a recording in each world, and one edits a level."""

    def edit(world, **changed):
        data = {**level_data(rope_level()), "name": f"First of {world}"} | changed
        (tmp_path / "levels" / world / "01.json").write_text(json.dumps(data))

    for world in ("w1", "w2"):
        for folder in ("levels", "replays"):
            (tmp_path / folder / world).mkdir(parents=True)
        edit(world)
        session = Session(load_level(tmp_path / "levels" / world / "01.json"))
        session.record_to(tmp_path / "levels" / world / "run.replay.gz")
        for _ in range(5):
            session.advance()
        session.stop_recording()

    def run(recordings="levels", against="levels"):
        return main(["replay", str(tmp_path / recordings), "--against", str(tmp_path / against), "--json"])

    run.path, run.edit = tmp_path, edit
    return run


def _told(capsys):
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_an_edit_of_one_world_fails_the_recording_beside_it_alone(worlds, capsys):
    assert worlds() == 0
    assert [each["result"] for each in _told(capsys)] == ["equal", "equal"]
    worlds.edit("w2", settings={"solver": "iterative", "gravity": [0.0, -3.0]})
    assert worlds() == 1
    first, second = _told(capsys)
    assert first["result"] == "equal" and second["result"] == "diverged"
    assert "01.json: settings.gravity: " in second["text"]


def test_two_levels_as_near_as_each_other_are_both_named_and_none_is_chosen(worlds, capsys):
    (worlds.path / "levels" / "w1" / "run.replay.gz").rename(worlds.path / "replays" / "run.replay.gz")
    assert worlds("replays") == 2
    (fault,) = _told(capsys)[0]["faults"]
    assert "2 levels are called 01.json: " in fault and "w1/01.json" in fault and "w2/01.json" in fault


def test_a_folder_without_the_level_refuses_and_does_not_run_the_copy(worlds, capsys):
    (worlds.path / "other").mkdir()
    write_level(rope_level(name="Other"), worlds.path / "other" / "other.json")
    assert worlds("levels", "other") == 2
    assert "there is neither 01.json nor a level with the title 'First of w1'" in _told(capsys)[0]["faults"][0]
    assert worlds("levels", "nowhere") == 2


def test_a_level_that_was_renamed_is_found_by_its_title(worlds):
    (worlds.path / "levels" / "w2" / "01.json").rename(worlds.path / "levels" / "w2" / "02.json")
    (worlds.path / "levels" / "w1" / "01.json").rename(worlds.path / "levels" / "w1" / "03.json")
    assert worlds() == 0
