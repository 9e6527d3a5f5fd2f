"""Solutions: what wins a level is kept beside it, run again, and told by the shell and by pytest."""

import json

import pytest

from sandbox.cli import main
from sandbox.level.document.canonical import level_text
from sandbox.session.checking import solution_of, try_goal
from sandbox.session.session import Session
from tests.support import rules_level
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]


@pytest.fixture
def level(tmp_path):
    """A level's file with its solution beside it."""
    path = tmp_path / "answering.json"
    path.write_text(level_text(rules_level.answering()), encoding="utf-8")
    session = Session(rules_level.answering())
    session.record_to(solution_of(path))
    rules_level.run(session)
    session.stop_recording()
    return path


@pytest.fixture
def told(capsys):
    """Runs a command of the shell: its exit code, and what it printed."""

    def run(*arguments):
        code = main(list(arguments))
        return code, capsys.readouterr().out

    return run


def harder(path):
    """The level with a basket elsewhere."""
    data = json.loads(path.read_text(encoding="utf-8"))
    data["zones"][0]["box"] = [3, 0, 4, 1]
    path.write_text(json.dumps(data), encoding="utf-8")


def test_a_solution_wins_its_level_in_the_shell(level, told):
    code, text = told("check", str(level))
    assert code == 0 and "goal       won at 1.28 s with 2 stars, by answering.solution.replay.gz" in text
    goal = json.loads(told("check", "--json", str(level))[1])["goal"]
    assert (goal["passed"], goal["outcome"]["stars"], goal["outcome"]["tick"]) == (True, 2, 77)


def test_a_level_that_its_solution_no_longer_wins_fails(level, told):
    harder(level)
    code, text = told("check", str(level))
    assert code == 1 and "goal       FAILS: not won in the 4.00 s of answering.solution.replay.gz" in text


def test_a_level_without_a_solution_passes_and_says_so(level, told):
    solution_of(level).unlink()
    code, text = told("check", str(level))
    assert code == 0 and "goal       not tried: there is no answering.solution.replay.gz" in text


@pytest.mark.parametrize("content", [b"", b"no recording", b"\x1f\x8b"])
def test_a_solution_that_is_damaged_fails_in_one_line(level, content):
    solution_of(level).write_bytes(content)
    result = try_goal(rules_level.answering(), level)
    assert not result.passed and result.text.startswith("FAILS: answering.solution.replay.gz: ")
    assert "\n" not in result.text


def test_a_recording_is_told_with_its_outcome_which_follows_from_its_bits(level, told):
    recording = str(solution_of(level))
    assert told("replay", recording)[1].endswith("equal, 240 ticks, won at 1.28 s with 2 stars\n")
    found = json.loads(told("replay", "--json", recording)[1])["outcome"]
    assert found == {"is_won": True, "text": "In!", "stars": 2, "tick": 77, "rule": 0, "seconds": 77 / 60}


def test_pytest_runs_the_solution_of_a_level_as_a_test_of_its_own(level, pytester):
    (pytester.path / "answering.json").write_bytes(level.read_bytes())
    (pytester.path / "answering.solution.replay.gz").write_bytes(solution_of(level).read_bytes())
    pytester.makeini("[pytest]\nsandbox_levels = *.json\n")
    pytester.runpytest_inprocess("-v", *LOADED).assert_outcomes(passed=3)
    harder(pytester.path / "answering.json")
    found = pytester.runpytest_inprocess("-v", *LOADED)
    found.stdout.fnmatch_lines(["*goal FAILS: not won in the 4.00 s of answering.solution.replay.gz*"])


def test_a_level_with_a_goal_that_leaves_all_tools_open_is_told(level, told):
    assert "hands      may do everything, so whoever pauses" in told("check", str(level))[1]
    data = json.loads(level.read_text(encoding="utf-8"))
    data["hands"] = {"may": ["grab"]}
    level.write_text(json.dumps(data), encoding="utf-8")
    assert "whoever pauses" not in told("check", str(level))[1]


def test_an_update_does_not_put_a_run_that_wins_no_more_in_the_place_of_a_solution(level, pytester):
    solution = pytester.path / "answering.solution.replay.gz"
    (pytester.path / "answering.json").write_bytes(level.read_bytes())
    solution.write_bytes(solution_of(level).read_bytes())
    before = solution.read_bytes()
    pytester.makeini("[pytest]\nsandbox_levels = *.json\n")
    harder(pytester.path / "answering.json")
    plain = pytester.runpytest_inprocess(*LOADED, "--replay-output=out", solution.name)
    assert "to accept" not in plain.stdout.str() and "record a run that wins in its place" in plain.stdout.str()
    pytester.runpytest_inprocess(*LOADED, "--replay-update", solution.name).assert_outcomes(failed=1)
    assert solution.read_bytes() == before
    data = json.loads(level.read_text(encoding="utf-8"))
    data["settings"] = {**data.get("settings", {}), "gravity": [0.0, -9.82]}
    (pytester.path / "answering.json").write_text(json.dumps(data), encoding="utf-8")
    pytester.runpytest_inprocess(*LOADED, "--replay-update", solution.name).assert_outcomes(passed=1)
    assert solution.read_bytes() != before
