"""Names, hints and ids that testers stumbled over."""

import json

import pytest

from sandbox.cli import main
from sandbox.commands import CommandError
from sandbox.level.reading.files import level_data, write_level
from sandbox.testing import Driver
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED
from tests.testing.test_edited_levels import recorded

pytest_plugins = ["pytester"]


def level_with(checks):
    return level_data(rope_level()) | {"checks": [{"metric": "max_strain", "at_most": 9, **each} for each in checks]}


@pytest.fixture
def levels(pytester):
    (pytester.path / "levels").mkdir()
    return pytester.path / "levels"


def test_each_check_has_an_id_of_its_own_that_can_be_chosen(levels, pytester):
    names = ["is valid", "goal", "a::b", "goal"]
    data = level_with([{"name": name} for name in dict.fromkeys(names)])
    (levels / "a.json").write_text(json.dumps(data), encoding="utf-8")
    found = pytester.inline_run("--collect-only", *LOADED).getcalls("pytest_itemcollected")
    ids = [each.item.nodeid for each in found]
    assert len(ids) == len(set(ids)) == 4
    chosen = next(each for each in ids if each.endswith("a:b"))
    pytester.runpytest_inprocess(*LOADED, chosen).assert_outcomes(passed=1)


def test_a_level_that_is_none_tells_its_faults_once(levels, pytester):
    data = level_with([{"name": "one"}, {"name": "two"}]) | {"settings": {"solver": "magic"}}
    (levels / "a.json").write_text(json.dumps(data), encoding="utf-8")
    result = pytester.runpytest_inprocess(*LOADED, "-rN")
    result.assert_outcomes(failed=3)
    assert result.stdout.str().count("there is no such solver") == 1
    assert result.stdout.str().count("a.json is no level, see its test 'is valid'") == 2


def test_the_smallest_recording_is_told_by_its_test_alone(levels, pytester):
    recorded(pytester.path / "a.smallest.replay.gz")
    write_level(rope_level(), levels / "rope.json")
    assert "a.smallest.replay.gz" in pytester.runpytest_inprocess(*LOADED, "-v").stdout.str()
    (pytester.path / "test_a_smallest.py").write_text("def test(): pass\n", encoding="utf-8")
    assert "a.smallest.replay.gz" not in pytester.runpytest_inprocess(*LOADED, "-v").stdout.str()


def test_a_fixture_finds_a_level_by_its_name_in_levels(levels, pytester):
    write_level(rope_level(), levels / "mine.json")
    pytester.makepyfile("def test_it(sandbox_session):\n    assert 'Test rope' in repr(sandbox_session('mine'))\n")
    pytester.runpytest_inprocess(*LOADED, "-k", "test_it").assert_outcomes(passed=1)


def test_a_name_that_is_nearly_that_of_an_end_is_told_that():
    with pytest.raises(CommandError, match=r'mean "rope\.end"'):
        Driver(rope_level()).drag("rope.ned", (0.0, 0.0))


def test_commands_are_told_as_json_and_without_numbers_that_nobody_gave(pytester, capsys):
    for name, particle in (("a", "rope.2"), ("b", "rope.3")):
        (pytester.path / f"{name}.jsonl").write_text(
            json.dumps({"tick": 3, "command": {"type": "pin", "particle": particle}}), encoding="utf-8"
        )
        run = ["run", "rope", "--seconds", "0.2", "--commands", f"{name}.jsonl", "--record", f"{name}.replay.gz"]
        assert main(run) == 0
    capsys.readouterr()
    assert main(["diff", "a.replay.gz", "b.replay.gz"]) == 1
    assert 'A  tick 3: {"type": "pin", "particle": "rope.2"}\n' in capsys.readouterr().out
    assert main(["export", "a.replay.gz", "--to", "commands", "-o", "again.jsonl"]) == 0
    again = (pytester.path / "again.jsonl").read_text(encoding="utf-8")
    assert json.loads(again) == {"tick": 3, "command": {"type": "pin", "particle": "rope.2"}}
