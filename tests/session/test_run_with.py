"""A recording keeps the solver and substeps that it was run with, and runs with them on whichever level."""

import json

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import level_data, run_with, write_level
from sandbox.session.level_edits import with_value
from sandbox.session.replay.reader import read_replay
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED
from tests.testing.test_edited_levels import resealed

pytest_plugins = ["pytester"]

RECORDING = "run.replay.gz"


@pytest.fixture
def project(pytester):
    """A folder with a level and a recording of it that was run otherwise than the level says."""
    (pytester.path / "levels").mkdir()
    level = pytester.path / "levels" / "rope.json"
    write_level(rope_level(), level)
    run = ["run", str(level), "--solver", "iterative", "--substeps", "2", "--seconds", "0.5"]
    assert main([*run, "--record", RECORDING]) == 0
    return level


def edit(path, place, value):
    path.write_text(json.dumps(level_data(with_value(rope_level(), place, value))), encoding="utf-8")


def test_it_is_equal_on_its_level_through_every_door(project, pytester, capsys):
    replay = read_replay(RECORDING)
    assert run_with(replay.level) == ("solver", "substeps") and replay.level.settings.substeps == 2
    for command in (["replay", RECORDING, "--against", str(project)], ["replay", ".", "--against", "levels"],
                    ["diff", RECORDING, str(project)], ["replay", RECORDING, "--against", "levels", "--rollback", "3"],
                    ["show", RECORDING]):  # fmt: skip
        assert main(command) == 0, capsys.readouterr()
    assert "run with solver iterative, substeps 2\n" in capsys.readouterr().out
    pytester.runpytest_inprocess(*LOADED, RECORDING).assert_outcomes(passed=1)
    pytester.runpytest_inprocess(*LOADED, RECORDING, "--replay-solver=single_pass").assert_outcomes(passed=1)


def test_an_edit_of_its_level_is_told_alone_and_accepted_with_them(project, pytester, capsys):
    edit(project, "settings.gravity.1", -14.0)
    result = pytester.runpytest_inprocess(*LOADED, "--replay-pictures=none", RECORDING)
    result.assert_outcomes(failed=1)
    told = result.stdout.str()
    assert "settings.gravity" in told and "settings.solver" not in told and "settings.substeps" not in told
    good = project.with_name("good.json")
    write_level(rope_level(), good)
    capsys.readouterr()
    assert main(["bisect", str(good), str(project), "--replay", RECORDING]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith("  settings.gravity: ")
    good.unlink()
    pytester.runpytest_inprocess(*LOADED, "--replay-update", RECORDING)
    accepted = read_replay(RECORDING)
    assert run_with(accepted.level) == ("solver", "substeps") and accepted.level.settings.solver == "iterative"
    pytester.runpytest_inprocess(*LOADED, RECORDING).assert_outcomes(passed=1)


def test_an_edit_of_what_it_was_run_with_changes_nothing(project, capsys):
    edit(project, "settings.solver", "single_pass")
    assert main(["replay", RECORDING, "--against", str(project)]) == 0


def test_what_it_was_run_with_is_a_setting(project, pytester, capsys):
    assert main(["run", str(project), "--substeps", "4", "--seconds", "0.1", "--record", "a.replay.jsonl"]) == 0
    resealed(pytester.path / "a.replay.jsonl", run_with=["tick_rate"])
    assert main(["replay", "a.replay.jsonl"]) == 2
    told = capsys.readouterr().err
    assert "a.replay.jsonl: line 1: " in told and "run_with" in told
