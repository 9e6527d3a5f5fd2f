"""Where two runs part, and which edits or values make a level fail."""

import html
import json
import re

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import level_data, parse_level
from sandbox.session.bisect import BisectError, Tried, checks_hold, deciding_edits, deciding_value
from sandbox.session.commands import CutSprings, Pin
from sandbox.session.compare.comparison import ComparedRun, difference
from sandbox.session.compare.divergence import Divergence
from sandbox.session.level_edits import edits_between, level_edits, with_value
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.rope_level import rope_level

TICKS = 40


def recorded(path, *cut, level=None):
    """A recording of a rope that is pinned at tick 5 and of which springs are cut at tick 20."""
    session = Session(level or rope_level())
    session.record_to(path, 15)
    for tick in range(TICKS):
        if tick == 5:
            session.submit(Pin(6))
        if tick == 20 and cut:
            session.submit(CutSprings(cut))
        session.advance()
    session.stop_recording()
    return path


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pair")
    return recorded(folder / "a.replay.gz", 3), recorded(folder / "b.replay.jsonl", 4)


def side(path):
    replay = read_replay(path)
    return ComparedRun(path.name, replay.level, replay)


def test_two_recordings_part_at_their_first_command_and_the_first_bit_after_it(pair):
    found = difference(side(pair[0]), side(pair[1]), 10**6)
    assert found.level == () and found.ticks == TICKS
    assert found.commands[0] == "command 2 differs"
    assert "rope:3" in found.commands[1] and "rope:4" in found.commands[2]
    assert found.divergence.tick == 21 and found.divergence.expected != found.divergence.actual
    assert [run.tick for run in (found.expected, found.actual)] == [21, 21]
    lines = found.lines()
    assert float.fromhex(lines[-1].split()[-1]) == found.divergence.actual
    assert difference(side(pair[0]), side(pair[0]), 10**6).is_equal


def test_a_level_runs_with_the_commands_of_a_recording_and_two_levels_alone(pair):
    same, other = rope_level(), rope_level(settings={"solver": "iterative", "iterations": 11})
    assert difference(side(pair[0]), ComparedRun("same", same, None), 10**6).is_equal
    found = difference(ComparedRun("same", same, None), ComparedRun("other", other, None), 10)
    assert found.level == ("level: settings.iterations: 10 (default) -> 11",)
    assert (found.divergence.tick, found.divergence.array) == (0, "settings")


def test_diff_prints_both_values_and_draws_a_page(pair, tmp_path, capsys):
    page = tmp_path / "both.html"
    assert main(["diff", *map(str, pair), "-o", str(page)]) == 1
    told = capsys.readouterr().out
    assert "first difference at tick 21, in " in told and "\nA  0" in told.replace("A  -", "A  ")
    assert '"name":"A  ' in page.read_text() and '"first":21' in page.read_text()
    assert main(["diff", str(pair[0]), str(pair[0]), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["equal"] is True
    assert main(["diff", *map(str, pair), "-o", "both.txt"]) == 2
    assert capsys.readouterr().err.endswith("end the name in .png or .html\n")


def test_render_and_a_report_write_pages(pair, tmp_path, capsys):
    page = tmp_path / "run.html"
    assert main(["render", str(pair[0]), "-o", str(page)]) == 0
    assert '"marks":[[5,"pin"],[20,"cut_springs"]]' in page.read_text()
    assert main(["render", str(pair[0]), "-o", str(page), "--fps", "30"]) == 2
    level = tmp_path / "other.json"
    level.write_text(json.dumps(level_data(rope_level(settings={"solver": "iterative", "gravity": [0.0, -5.0]}))))
    report = tmp_path / "report.html"
    assert main(["replay", str(pair[0]), "--against", str(level), "--report", str(report)]) == 1
    text = html.unescape(report.read_text())
    assert '"name":"expected"' in text and re.search(r'"first":\d', text) and "other.json: settings.gravity: " in text
    assert main(["replay", *map(str, pair), "--report", "report.txt"]) == 2
    capsys.readouterr()


CHECK = {"name": "holds", "metric": "y", "particle": "rope.end", "after": 0.5, "at_least": -1.6}


def variant(**changes):
    """The rope with other values at places of its fields."""
    level = rope_level(checks=[CHECK, {"name": "whole", "metric": "broken_springs", "after": 0.1, "at_most": 0}])
    for path, value in changes.items():
        level = with_value(level, path.replace("__", "."), value)
    return level


def test_edits_are_named_by_ids_and_what_only_shows_is_none():
    before, after = level_data(variant()), level_data(variant(bodies__soft__segments=5, settings__tick_rate=120))
    after["bodies"].append({**after["bodies"][0], "id": "third"})
    after["description"] = "other"
    told = sorted(map(str, edits_between(before, after)))
    assert [line.split(":")[0] for line in told] == ["bodies.soft.segments", "bodies.third", "settings.tick_rate"]


def test_the_edits_that_make_a_check_fail_are_found_among_others():
    bad = variant(
        settings__gravity=[0.0, -40.0], settings__iterations=12, materials__rubber__damping=0.2,
        bodies__soft__segments=6, bodies__rope__particle_mass=2.0, settings__drag=0.01,
    )  # fmt: skip
    *tried, edits = deciding_edits(variant(), bad, checks_hold([]))
    assert [str(edit) for edit in edits] == ["settings.gravity: [0.0, -9.81] (default) -> [0.0, -40.0]"]
    assert all(isinstance(each, Tried) for each in tried) and len(tried) < 12


def test_the_value_from_which_a_check_fails_is_found():
    *_, (last, first) = deciding_value(variant(), "settings.gravity.1", -1.0, -40.0, checks_hold(["holds"]))
    assert first < last and last - first < 1e-4
    values = [variant(settings__gravity=[0.0, gravity]) for gravity in (last, first)]
    assert [checks_hold(["holds"])(level) for level in values] == [True, False]
    *_, found = deciding_value(variant(), "settings.tick_rate", 60, 480, lambda level: level.settings.tick_rate < 100)
    assert found == (99, 100)


def test_what_cannot_be_bisected_is_said_in_a_line(tmp_path, capsys):
    good = tmp_path / "good.json"
    good.write_text(json.dumps(level_data(variant())))
    for arguments, words in (
        ([], "give a second level, BAD, or --set"),
        ([str(good)], "the two levels do not differ"),
        (["--set", "settings.substeps=8:1"], "settings.substeps = 1 holds already"),
        (["--set", "settings.gravty.1=-1:-40"], 'did you mean "gravity"?'),
        (["--set", "settings.gravity.1"], "write FIELD=GOOD:BAD"),
        (["--set", "settings.gravity.1=-1:-40", "--check", "nothing"], 'it has "holds", "whole"'),
    ):
        assert main(["bisect", str(good), *arguments]) == 2
        assert words in capsys.readouterr().err
    assert main(["bisect", str(good), "--set", "settings.gravity.1=-1:-40"]) == 0
    assert "settings.gravity.1: holds at -" in capsys.readouterr().out
    # A body goes by its id, as in a sweep.
    assert main(["bisect", str(good), "--set", "soft.segments=6:6"]) == 2
    assert "no such place" not in capsys.readouterr().err
    with pytest.raises(BisectError, match="fails already"):
        list(deciding_value(variant(), "settings.gravity.1", -40.0, -1.0, checks_hold([])))
    assert parse_level(json.dumps(level_data(variant())).encode(), "x").checks


@pytest.mark.parametrize(
    ("array", "name", "owner"),
    [
        ("position", "jelly.12", "body jelly, particle 12"),
        ("stiffness", "jelly:3", "body jelly, spring 3"),
        ("stiffness", ":4", "loose spring 4"),
        ("position", "ball", "particle ball"),
        ("position", "jar of jam at home.3", "body jar of jam at home, particle 3"),
        ("corner_weight", "corner at jelly.12", "corner of body jelly, particle 12"),
        ("element_rest", "area at jelly.3", "area of body jelly, particle 3"),
        ("element_rest", "bend at rope.1", "bend of body rope, particle 1"),
        ("contact_impulse", "contact of ball", "contact of particle ball"),
        ("contact_impulse", "contact of jelly.2", "contact of body jelly, particle 2"),
        ("position", "+.0", "added particle 0"),
        ("stiffness", "+:1", "added spring 1"),
        ("position", "+2.7", "added body 2, particle 7"),
        ("corner_weight", "corner at +2.7", "corner of added body 2, particle 7"),
        ("position", "+hand.1", "hand 1"),
        ("hand_force", "hand 1", "hand 1"),
        ("position", "", ""),
        ("corner_weight", "corner at jar of jam.3", "corner of body jar of jam, particle 3"),
        ("counter", 'counter "jar of jam"', 'counter "jar of jam"'),
        ("settings", "", ""),
    ],
)
def test_the_owner_of_a_difference_is_told_by_kind_and_number(array, name, owner):
    assert Divergence(1, array, 0, 1.0, 2.0, name).owner() == owner


def test_what_a_side_leaves_out_is_told_by_its_default():
    before = variant(materials__rubber__stiffness=0.95)
    after = level_data(before)
    after["materials"]["rubber"] = {"damping": 0.1}
    after["bodies"].append({**after["bodies"][1], "id": "third", "start": [0, 9], "end": [2, 9]})
    told = list(map(str, level_edits(before, parse_level(json.dumps(after).encode(), "after"))))
    assert told[0] == "materials.rubber.stiffness: 0.95 -> 0.5 (default)"
    assert told[1].startswith("bodies.third: left out -> {")
