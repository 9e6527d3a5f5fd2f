"""A level with rules is edited: what compares its recording with it tells the edit and whose value is another."""

import json
import shutil
from pathlib import Path

import pytest

from sandbox.cli import main
from sandbox.level.reading.parse import parse_level
from sandbox.session.session import Session
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

LEVEL = Path(__file__).resolve().parents[2] / "levels" / "pinball_score.json"
TICKS = 70
HIT, SCORE = "bumper 2 hit", "score"


def _begun():
    """The level, in which the first ball falls from the start."""
    data = json.loads(LEVEL.read_text(encoding="utf-8"))
    del _of(data["particles"], "ball")["pinned"]
    data["rules"].remove(_of(data["rules"], "begin"))
    return data


def _of(parts, name):
    return next(each for each in parts if each["id"] == name)


def _give_more_points(data):
    _of(data["rules"], HIT)["then"][0]["by"] = 7


def _wait_longer(data):
    _of(data["rules"], HIT)["for_seconds"] = 5.0


def _ask_for_another_bumper(data):
    _of(data["rules"], HIT)["when"] = {"time": 0.2}


def _begin_with_points(data):
    _of(data["counters"], SCORE)["start"] = 5


def _add_a_rule(data):
    data["rules"].append({"id": "late", "when": {"time": 0.5}, "then": [{"say": "Late"}]})


def _remove_a_rule(data):
    data["rules"].remove(_of(data["rules"], HIT))


def _remove_all_rules(data):
    del data["rules"]


def _add_a_counter(data):
    data["counters"].append({"id": "lives", "start": 3})


def _add_a_budget(data):
    data["hands"] = {"at_most": {"cut": 3}}


def _add_a_rule_for_a_key(data):
    data["rules"].append({"id": "left", "when": {"none": [{"key": "g"}]}, "then": [{"sound": "bell"}]})


def _ask_whether_it_settles(data):
    about = {"metric": "settled", "body": "left flipper", "at_least": 0.5}
    data["rules"].append({"id": "rests", "when": {"none": [about]}, "then": [{"sound": "bell"}]})


EDITS = [
    (_give_more_points, f'counter "{SCORE}"'),
    (_wait_longer, f'rule "{HIT}"'),
    (_ask_for_another_bumper, f'rule "{HIT}"'),
    (_begin_with_points, f'counter "{SCORE}"'),
    (_add_a_rule, 'rule "late" is new'),
    (_remove_a_rule, f'rule "{HIT}" is gone'),
    (_remove_all_rules, f'rule "{HIT}" is gone, rule "bumper 3 hit" is gone, rule "bumper 4 hit" is gone and 14 more'),
    (_add_a_counter, 'counter "lives" is new'),
    (_add_a_budget, 'counter "Cuts left" is new'),
    (_add_a_rule_for_a_key, 'rule "left" is new'),
    (_ask_whether_it_settles, 'rule "rests" is new'),
]
edits = pytest.mark.parametrize(("edit", "told"), EDITS, ids=[edit.__name__.strip("_") for edit, _ in EDITS])


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A recording of a shipped level in which rules fire and count."""
    path = tmp_path_factory.mktemp("recorded") / "play.replay.gz"
    session = Session(parse_level(json.dumps(_begun()).encode(), LEVEL.name))
    session.record_to(path)
    for _ in range(TICKS):
        session.advance()
    session.stop_recording()
    assert session.world.counter[0] > 0.0
    return path


@pytest.fixture
def project(recorded, tmp_path):
    """A folder with that recording and a level to be edited."""
    (tmp_path / "levels").mkdir()
    shutil.copy(recorded, tmp_path)
    return tmp_path


def _edited(folder, edit):
    data = _begun()
    edit(data)
    path = folder / "levels" / LEVEL.name
    path.write_text(json.dumps(data), encoding="utf-8")
    return str(path)


@edits
@pytest.mark.parametrize("also", [[], ["--to-end"]], ids=["replay", "replay to the end"])
def test_replay_against_an_edited_level_tells_whose_value_is_another(project, edit, told, also, capsys):
    level = _edited(project, edit)
    assert main(["replay", str(project / "play.replay.gz"), "--against", level, *also]) == 1
    out, err = capsys.readouterr()
    assert told in out and not err
    assert "sealed again" not in out


@edits
def test_diff_with_an_edited_level_tells_edit_and_whose_value_is_another(project, edit, told, capsys):
    level = _edited(project, edit)
    assert main(["diff", str(project / "play.replay.gz"), level]) == 1
    out, err = capsys.readouterr()
    assert told in out and not err
    assert "level: " in out


@edits
def test_the_plugin_tells_an_edit_and_accepts_it(project, pytester, edit, told):
    shutil.copytree(project, pytester.path, dirs_exist_ok=True)
    _edited(pytester.path, edit)
    result = pytester.runpytest_inprocess("--replay-pictures=none", *LOADED, "play.replay.gz")
    result.assert_outcomes(failed=1)
    out = result.stdout.str()
    assert told in out and f"{LEVEL.name}: " in out
    assert "Traceback" not in out and "Error" not in out and "sealed again" not in out
    pytester.runpytest_inprocess("--replay-update", *LOADED, "play.replay.gz")
    pytester.runpytest_inprocess(*LOADED, "play.replay.gz").assert_outcomes(passed=1)


def test_a_rule_that_never_holds_changes_no_bit_and_accuses_no_recording(project, capsys):
    def add(data):
        data["rules"].append({"id": "late", "when": {"time": 60}, "then": [{"say": "Late"}]})
        for rule in data["rules"][:-1]:
            rule["when"] = {"time": 60}

    bare = _begun()
    for rule in bare["rules"]:
        rule["when"] = {"time": 60}
    path = project / "levels" / "bare.json"
    path.write_text(json.dumps(bare), encoding="utf-8")
    assert main(["run", str(path), "--seconds", "1", "--record", str(project / "bare.replay.gz")]) == 0
    capsys.readouterr()
    assert main(["replay", str(project / "bare.replay.gz"), "--against", _edited(project, add)]) == 0
    assert "equal" in capsys.readouterr().out
