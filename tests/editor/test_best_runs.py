"""The best result of each level is kept by all of the level that says something about its run."""

import json

import pytest

from sandbox.editor.storage.best_runs import Result, best_recording, best_result, keep_result, record_best
from sandbox.level.format.quantities import replaced
from sandbox.level.reading.parse import parse_level
from sandbox.session.commands.records import ScriptLine


@pytest.fixture
def level():
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Fall",
        "particles": [{"id": "ball", "position": [0, 1]}],
        "rules": [{"id": "end", "when": {"time": 1}, "then": [{"win": "Down"}]}],
    }
    return parse_level(json.dumps(data).encode(), "x")


def test_more_stars_count_before_less_time_and_only_a_better_result_is_kept(level, tmp_path):
    kept = [keep_result(level, Result(stars, ticks, 60), tmp_path) for stars, ticks in ((2, 90), (2, 91), (1, 30))]
    assert kept == [True, False, False] and best_result(level, tmp_path) == Result(2, 90, 60)
    assert keep_result(level, Result(3, 400, 60), tmp_path) and keep_result(level, Result(3, 399, 60), tmp_path)
    assert best_result(level, tmp_path).seconds == 399 / 60


def test_other_words_of_a_level_keep_its_result_and_another_body_does_not(level, tmp_path):
    keep_result(level, Result(1, 60, 60), tmp_path)
    reworded = replaced(level, name="Drop", description="Wait.", goal="Wait", author="me")
    assert best_result(reworded, tmp_path) is not None
    moved = replaced(level, particles=(replaced(level.particles[0], position=(0.0, 2.0)),))
    assert best_result(moved, tmp_path) is None


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{}", '{"stars": 4, "ticks": 3}', '{"stars": 1, "ticks": 0}', '{"stars": true, "ticks": 3}', "\xff"],
)
def test_a_damaged_result_is_none_and_the_next_one_takes_its_place(level, tmp_path, text):
    keep_result(level, Result(1, 60, 60), tmp_path)
    (file,) = (tmp_path / "best").glob("*.json")
    file.write_text(text, encoding="latin-1")
    assert best_result(level, tmp_path) is None
    assert keep_result(level, Result(1, 70, 60), tmp_path) and best_result(level, tmp_path) == Result(1, 70, 60)


def test_a_run_that_cannot_be_recorded_leaves_the_recording_before_and_nothing_beside_it(level, tmp_path):
    keep_result(level, Result(1, 60, 60), tmp_path)
    assert best_recording(level, tmp_path) is None
    list(record_best(level, [], 60, tmp_path))
    before = best_recording(level, tmp_path).read_bytes()
    wrong = ScriptLine(3, 1, {"type": "pin", "particle": "nobody"}, 1)
    list(record_best(level, [wrong], 50, tmp_path))
    given_up = record_best(level, [], 50, tmp_path)
    next(given_up)
    given_up.close()
    assert best_recording(level, tmp_path).read_bytes() == before
    assert len(list((tmp_path / "best").iterdir())) == 2
