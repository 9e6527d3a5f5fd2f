"""Solutions: what wins a level is kept beside it, run again, and told by the shell and by pytest."""

import json
from pathlib import Path

import pytest

from sandbox.cli import main
from sandbox.level.document.canonical import level_text
from sandbox.level.format.quantities import replaced
from sandbox.level.format.slices import at_once
from sandbox.level.reading.files import read_level
from sandbox.physics.jit import COMPILED
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from sandbox.session.solution import Proof, keep_solution, recorded_win, solution_of, solved_text, try_goal
from tests.support import rules_level
from tests.testing.conftest import LOADED

ROOT = Path(__file__).resolve().parents[2]
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


def test_a_run_that_does_not_win_is_kept_neither_beside_nor_in_the_place_of_a_solution(level):
    before = solution_of(level).read_bytes()
    verdict = at_once(keep_solution(level, (), 20))
    assert not verdict.passed and "does not win" in verdict.text
    assert solution_of(level).read_bytes() == before
    assert sorted(path.name for path in level.parent.iterdir()) == [level.name, solution_of(level).name]


def test_a_run_that_wins_is_kept_as_its_solution_which_the_end_of_the_file_alone_says(level):
    replay = read_replay(solution_of(level))
    solution_of(level).unlink()
    assert at_once(keep_solution(level, replay.script, replay.ticks)).passed
    kept, data = read_replay(solution_of(level)), read_level(level)
    found = recorded_win(data, kept)
    assert found == Proof(data, kept).whole().outcome
    assert solved_text(found, 60) == "Solved in 1.3 s with 2 stars, by its author."
    # What no run tells apart leaves it, all else has to be run.
    assert recorded_win(replaced(data, name="Another", view=(0, 0, 9, 9)), kept) == found
    assert recorded_win(replaced(data, particles=()), kept) is None


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda data: data["zones"][0].update(box=[3, 0, 4, 1]), "it parts at 1.28 s: the rule goal fired there"),
        (lambda data: data["particles"][0].update(position=[3, 4]), "it parts at 0.00 s: ball is 3 m from where"),
        (lambda data: data["rules"].pop(5), "it parts at 0.50 s: there is no key that"),
        (lambda data: data["settings"].update(gravity=[0, 0]), "it parts at 0.15 s: rope."),
    ],
)
def test_where_a_solution_parts_is_said(level, edit, said):
    data = json.loads(level.read_text(encoding="utf-8"))
    edit(data)
    level.write_text(json.dumps(data), encoding="utf-8")
    verdict = Proof(read_level(level), read_replay(solution_of(level))).whole()
    assert not verdict.passed and said in verdict.text and "\n" not in verdict.text


def test_levels_and_folders_are_proved_in_the_shell(level, told):
    plain = level.with_name("plain.json")
    plain.write_text(level_text(rules_level.answering(rules=[])), encoding="utf-8")
    code, text = told("check", "--prove", str(level.parent))
    assert code == 0 and text.endswith(
        "won at 1.28 s with 2 stars, by answering.solution.replay.gz\n1 of 1 won by their solutions\n"
    )
    assert "plain" not in text
    harder(level)
    code, text = told("check", "--prove", str(level))
    assert code == 1 and "it parts at 1.28 s" in text and "0 of 1" in text
    (data,) = map(json.loads, told("check", "--prove", "--json", str(level))[1].splitlines())
    assert data["result"] == "failed" and "it parts at" in data["text"]
    solution_of(level).write_bytes(b"no recording")
    assert told("check", "--prove", str(level))[0] == 1
    assert told("check", "--prove", str(level.parent / "none.json"))[0] == 2
    assert told("check", "--look", str(level))[0] == 2


def test_a_way_that_is_found_in_the_shell_is_kept_in_the_place_of_what_wins_no_more(level, told):
    solution_of(level).unlink()
    code, text = told("check", "--prove", "--look", str(level))
    assert code == 0 and "has no solution" in text and "found      won at 1.28 s" in text
    assert told("check", "--prove", str(level))[0] == 0


@pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")
def test_all_shipped_solutions_win(told):
    code, text = told("check", "--prove", str(ROOT / "levels"))
    assert code == 0 and text.endswith("13 of 13 won by their solutions\n")
