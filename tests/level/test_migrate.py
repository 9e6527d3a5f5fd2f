"""Migrations: older versions are brought to this one step by step, in memory; newer ones are refused."""

import pytest

from sandbox.level.format.files import LevelError, parse_level
from sandbox.level.format.limits import VERSION
from sandbox.level.format.migrate import MIGRATIONS, migrated
from sandbox.level.format.salvage import salvage
from tests.support.malformed_levels import GOOD, encoded


def title_to_name(raw):
    return {("name" if key == "title" else key): value for key, value in raw.items()}


def heavier(raw):
    return {**raw, "mass": raw["mass"] * 2}


STEPS = {1: title_to_name, 2: heavier}
OLD = {**{("title" if key == "name" else key): value for key, value in GOOD.items()}, "version": VERSION - 1}


def test_every_step_from_its_version_on_is_taken_in_order():
    assert migrated({"version": 1, "title": "x", "mass": 3}, STEPS, 3) == {"version": 3, "name": "x", "mass": 6}
    assert migrated({"version": 2, "name": "x", "mass": 3}, STEPS, 3) == {"version": 3, "name": "x", "mass": 6}


def test_what_is_given_is_not_changed():
    raw = {"version": 1, "title": "x", "mass": 3}
    migrated(raw, STEPS, 3)
    assert raw == {"version": 1, "title": "x", "mass": 3}


@pytest.mark.parametrize("version", [0, 3, 4, True, 1.0, "1", None, -1])
def test_a_version_of_this_day_or_of_none_stays_as_it_is(version):
    raw = {"version": version, "title": "x"}
    assert migrated(raw, STEPS, 3) is raw


def test_a_file_that_its_own_version_forbids_is_refused_in_a_line():
    with pytest.raises(ValueError, match="is no valid level of version 2, so it cannot be brought to 3"):
        migrated({"version": 2, "mass": None}, STEPS, 3)


def test_an_older_file_is_read_as_a_level_of_this_version(monkeypatch):
    with pytest.raises(LevelError):
        parse_level(encoded(OLD), "x.json")
    monkeypatch.setitem(MIGRATIONS, VERSION - 1, title_to_name)
    assert parse_level(encoded(OLD), "x.json") == parse_level(encoded(GOOD), "x.json")
    assert salvage(encoded(OLD), "x.json") == (parse_level(encoded(GOOD), "x.json"), [])


def test_a_damaged_older_file_is_refused_by_its_version(monkeypatch):
    monkeypatch.setitem(MIGRATIONS, VERSION - 1, heavier)
    line = f"x.json: version: is no valid level of version {VERSION - 1}, so it cannot be brought to {VERSION}"
    with pytest.raises(LevelError) as refused:
        parse_level(encoded(OLD), "x.json")
    assert refused.value.faults == [line]
    assert salvage(encoded(OLD), "x.json") == (None, [line])


def test_there_is_a_step_from_each_version_to_the_next():
    assert sorted(MIGRATIONS) == list(range(1, VERSION))
