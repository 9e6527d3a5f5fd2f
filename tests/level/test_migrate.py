"""Migrations: older versions are brought to this one step by step, in memory; newer ones are refused."""

import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format.limits import VERSION
from sandbox.level.reading.files import LevelError, load_level, parse_level, shipped_levels
from sandbox.level.reading.parse import MIGRATIONS, migrated
from sandbox.level.reading.salvage import salvage
from sandbox.physics.equation import half_step
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from sandbox.physics.substeps import constraint_coefficients, substep_coefficients, tick_constraint_coefficients
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
        parse_level(encoded({**OLD, "version": VERSION}), "x.json")
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


def version_1(solver="direct", substeps=4, **parts):
    """The text of a level of version 1: a soft net with bends, a rope of the default material, a jelly by firmness."""
    return {
        "format": "spring-sandbox/level",
        "version": 1,
        "name": "Old",
        "settings": {"solver": solver, "substeps": substeps},
        "materials": {
            "soft": {"stiffness": 0.3, "damping": 0.35},
            "half": {"damping": 0.6},
            "rigid": {"stiffness": 1.0, "damping": 1.0},
            "classic": {"law": "hooke", "k": 300.0},
        },
        "bodies": [
            {"type": "mesh", "id": "net", "particles": [[0, 0], [1, 0], [2, 0.5]], "springs": [[0, 1], [1, 2]],
             "material": "soft", "bending": {"stiffness": 0.2}},
            {"type": "rope", "id": "rope", "start": [0, 5], "end": [3, 5], "segments": 3, "pin": ["start"]},
            {"type": "rope", "id": "bar", "start": [0, 7], "end": [3, 7], "segments": 3, "material": "rigid"},
            {"type": "rope", "id": "classic", "start": [0, 8], "end": [3, 8], "segments": 2, "material": "classic"},
            {"type": "jelly", "id": "jelly", "shape": {"box": [2.0, 1.0]}, "position": [9, 6], "spacing": 0.5,
             "firmness": {"sag": 0.05}},
        ],
        "springs": [{"a": "rope.0", "b": "bar.0", "material": "half"}],
        **parts,
    }  # fmt: skip


def halved(stiffness, damping, parts):
    while parts > 1:
        stiffness, damping = half_step(stiffness, damping)
        parts //= 2
    return stiffness, damping


@pytest.mark.parametrize("substeps", [2, 4, 8, 16])
def test_a_substep_of_a_direct_level_of_version_1_has_the_coefficients_that_it_had(substeps):
    level = version_1(substeps=substeps)
    world = build_world(parse_level(encoded(level), "x.json"))
    old = build_world(parse_level(encoded({**level, "version": 2}), "x.json"))
    now = substep_coefficients(world)
    for s in range(world.grab_spring):
        if old.law[s] == 0 and old.lowest_mode[s] == 0.0:
            expected = halved(old.stiffness[s], old.damping[s], substeps)
        else:
            expected = substep_coefficients(old)[0][s], None
        assert now[0][s] == pytest.approx(expected[0], rel=1e-9, abs=1e-12)
        if expected[1] is not None:
            assert now[1][s] == pytest.approx(expected[1], rel=1e-9, abs=1e-12)
    bend = tick_constraint_coefficients(old)[0].tolist().index(0.2)
    stiffness, damping = constraint_coefficients(world)
    assert (stiffness[bend], damping[bend]) == pytest.approx(halved(0.2, 0.9, substeps), rel=1e-9)


@pytest.mark.parametrize(("solver", "substeps"), [("direct", 1), ("direct", "auto"), ("iterative", 4)])
def test_other_levels_of_version_1_are_what_they_were(solver, substeps):
    level = version_1(solver, substeps)
    assert parse_level(encoded(level), "x.json") == parse_level(encoded({**level, "version": 2}), "x.json")


def test_shipped_levels_are_of_a_version_that_can_be_saved_in_this_one():
    for path in shipped_levels():
        level = load_level(path)
        assert level.version == VERSION and parse_level(level_text(level).encode(), path.name) == level


def test_a_saved_level_of_version_1_is_the_level_that_was_opened():
    opened = parse_level(encoded(version_1()), "x.json")
    saved = parse_level(level_text(opened).encode(), "x.json")
    assert saved == opened and saved.version == VERSION
    worlds = build_world(opened), build_world(saved)
    for _ in range(30):
        for world in worlds:
            step(world)
    assert state_hash(worlds[0]) == state_hash(worlds[1])


@pytest.mark.parametrize(
    "broken", [{"materials": 3}, {"bodies": [7]}, {"settings": []}, {"materials": {"a": {"damping": "x"}}}]
)
def test_a_damaged_level_of_version_1_is_refused_by_its_fault_or_its_version(broken):
    with pytest.raises(LevelError) as refused:
        parse_level(encoded(version_1(**broken)), "x.json")
    assert all(line.startswith("x.json: ") for line in refused.value.faults)
