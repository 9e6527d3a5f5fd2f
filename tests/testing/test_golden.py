"""Golden files: a run within tolerances, from pytest, the command line, and after the level was tuned."""

import json
from pathlib import Path

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import level_data
from sandbox.session.golden import differences, read_golden, write_golden
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

CHECK = {"name": "the end", "metric": "speed", "particle": "rope.end", "after": 0.4, "at_most": 50.0}
GOLDEN = {
    "format": "spring-sandbox/golden", "level": "rope.json", "at": [0.2, 0.4], "within": 0.01,
    "places": {"rope.end": [], "rope": []}, "values": {"the end": None},
}  # fmt: skip


@pytest.fixture
def golden(pytester) -> Path:
    """A golden file that holds what its level does; its folder is the present one."""
    _level(pytester.path)
    path = pytester.path / "rope.golden.json"
    path.write_text(json.dumps(GOLDEN))
    write_golden(path, read_golden(path).measured())
    return path


def _level(folder: Path, **changed) -> None:
    (folder / "rope.json").write_text(json.dumps(level_data(rope_level(checks=[CHECK], **changed))))


def _told(path: Path) -> list[str]:
    found = read_golden(path)
    return differences(found.file, found.measured())


def test_what_was_recorded_holds_also_in_a_process_of_its_own(golden, pytester):
    assert _told(golden) == []
    pytester.runpytest_subprocess("-p", "no:cacheprovider").assert_outcomes(passed=1)


def test_a_small_change_is_accepted_and_a_large_one_is_told_thing_by_thing(golden, pytester):
    _level(golden.parent, settings={"solver": "iterative", "gravity": [0.0, -9.811]})
    assert _told(golden) == []
    _level(golden.parent, settings={"solver": "iterative", "gravity": [0.0, -15.0]})
    lines = _told(golden)
    assert any(line.startswith("rope.end: at 0.4 s expected (") for line in lines)
    assert any(line.startswith("the end: expected ") and "allowed 2 %" in line for line in lines)
    failed = pytester.runpytest_inprocess(*LOADED)
    told = failed.stdout.str()
    assert failed.ret == 1 and "Traceback" not in told
    assert lines[0] in told and "to accept: pytest --replay-update" in told


def test_an_update_records_what_came_in_lines_that_a_review_reads(golden, pytester):
    _level(golden.parent, settings={"gravity": [0.0, -3.0]})
    updated = pytester.runpytest_inprocess(*LOADED, "--replay-update")
    assert updated.ret == 0 and "recorded again" in updated.stdout.str()
    assert _told(golden) == []
    lines = golden.read_text().splitlines()
    assert sum(line.strip().startswith('"rope.end": [[') for line in lines) == 1
    places = json.loads(golden.read_text())["places"].values()
    numbers = [each for points in places for point in points for each in point]
    assert all(each == round(each, 4) for each in numbers)


def test_an_update_of_what_holds_leaves_the_file_as_it_is(golden, pytester):
    before = golden.read_bytes()
    assert pytester.runpytest_inprocess(*LOADED, "--replay-update").ret == 0
    assert golden.read_bytes() == before


def test_what_is_not_recorded_yet_fails(golden):
    golden.write_text(json.dumps(GOLDEN))
    assert _told(golden) == [
        "rope.end: no place is recorded yet", "rope: no place is recorded yet", "the end: no value is recorded yet",
    ]  # fmt: skip


def test_commands_are_given_at_their_ticks(golden):
    (golden.parent / "pin.jsonl").write_text('{"tick": 6, "command": {"type": "pin", "particle": "rope.end"}}\n')
    golden.write_text(json.dumps({**json.loads(golden.read_text()), "commands": "pin.jsonl"}))
    assert any(line.startswith("rope.end: at 0.4 s") for line in _told(golden))


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"places": {"rope.ed": []}}, "there is no particle or body 'rope.ed'; did you mean \"rope.end\"?"),
        ({"values": {"the ends": None}}, "values: the level has no check 'the ends'; did you mean \"the end\"?"),
        ({"places": {"rope": [[0, 0]]}}, "places.rope: 1 points, 2 times"),
        ({"within": 0}, "within: must be greater than 0"),
        ({"level": "robe.json"}, "robe.json: there is no such file"),
        ({"commands": "none.jsonl"}, "none.jsonl: cannot be read: No such file or directory"),
    ],
)
def test_what_a_golden_file_cannot_mean_is_one_line(golden, changed, said, capsys):
    golden.write_text(json.dumps({**json.loads(golden.read_text()), **changed}))
    assert main(["check", golden.name]) == 2
    told = capsys.readouterr().err
    assert said in told and len(told.splitlines()) == 1, told


def test_the_command_line_checks_golden_files_beside_levels(golden, capsys):
    assert main(["check", "rope.json", golden.name, "--json"]) == 0
    assert [json.loads(line)["result"] for line in capsys.readouterr().out.splitlines()] == ["passed", "passed"]


def test_a_golden_file_that_holds_nothing_is_refused(golden, pytester):
    golden.write_text(json.dumps({key: GOLDEN[key] for key in ("format", "level", "at")}))
    failed = pytester.runpytest_inprocess(*LOADED)
    assert failed.ret == 1 and "holds nothing to compare" in failed.stdout.str()
