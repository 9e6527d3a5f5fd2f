"""Sweeps: rows in the order of the grid, the same however they were made, and taken up again."""

import csv
import itertools
import json

import pytest

import sandbox.session.sweep as sweep_module
from sandbox.cli import main
from sandbox.level.format.files import level_data
from sandbox.session.sweep import Journal, SweepError, SweepGrid, run_case, swept
from tests.support.rope_level import rope_level

CHECKS = [{"name": "stays up", "metric": "y", "particle": "rope.end", "after": 0.1, "at_least": -0.2}]
ARGUMENTS = ["--cs", "0.1:1:3:log", "--cd", "0,1", "--set", "settings.gravity.1=-9.81,-40", "--seconds", "0.2"]


@pytest.fixture
def level(tmp_path):
    path = tmp_path / "rope.json"
    path.write_text(json.dumps(level_data(rope_level(checks=CHECKS))))
    return str(path)


def sweep(level, table, *more):
    return main(["sweep", level, *ARGUMENTS, "-o", str(table), *more])


def rows(table):
    return list(csv.DictReader(table.read_text().splitlines()))


def test_every_point_of_the_grid_is_a_row_in_order_with_its_figures(level, tmp_path):
    assert sweep(level, tmp_path / "a.csv", "--processes", "1") == 0
    table = rows(tmp_path / "a.csv")
    points = [(row["settings.gravity.1"], row["cs"], row["cd"]) for row in table]
    axes = ("-9.81", "-40"), ("0.1", "0.316227766", "1.0"), ("0.0", "1.0")
    assert points == list(itertools.product(*axes))
    assert [row["check: stays up"] for row in table] == ["1"] * 6 + ["0"] * 6
    assert all(float(row["max_strain"]) > 0.0 and row["settle_time"] == "" for row in table)
    stiff, soft = (next(row for row in table if row["cs"] == cs) for cs in ("1.0", "0.1"))
    assert float(stiff["max_strain"]) < float(soft["max_strain"])
    assert not (tmp_path / "a.csv.unfinished").exists()


def test_processes_and_a_resumed_sweep_give_the_same_table(level, tmp_path, monkeypatch, capsys):
    assert sweep(level, tmp_path / "one.csv", "--processes", "1") == 0
    assert sweep(level, tmp_path / "two.csv", "--processes", "2") == 0
    ran = []

    def interrupted(*arguments):
        if len(ran) == 5:
            raise KeyboardInterrupt
        ran.append(arguments[2])
        return run_case(*arguments)

    monkeypatch.setattr(sweep_module, "run_case", interrupted)
    assert sweep(level, tmp_path / "three.csv", "--processes", "1") == 130
    assert "5 of 12 runs are done; the same command goes on" in capsys.readouterr().err
    journal = tmp_path / "three.csv.unfinished"
    journal.write_text(journal.read_text()[:-9])
    again = []
    monkeypatch.setattr(sweep_module, "run_case", lambda *each: again.append(each[2]) or run_case(*each))
    assert sweep(level, tmp_path / "three.csv", "--processes", "1") == 0
    assert len(again) == 8 and len({*ran[:4], *again}) == 12
    texts = [(tmp_path / f"{name}.csv").read_bytes() for name in ("one", "two", "three")]
    assert texts[0] == texts[1] == texts[2]


def test_a_journal_of_another_sweep_is_left_alone(tmp_path):
    one = SweepGrid(rope_level(), {"cs": (0.1, 0.2)}, 3)
    Journal(tmp_path / "t.csv", one).add(1, [1.5, None])
    assert Journal(tmp_path / "t.csv", one).rows == {1: [1.5, None]}
    with pytest.raises(SweepError, match="another sweep"):
        Journal(tmp_path / "t.csv", SweepGrid(rope_level(), {"cs": (0.1, 0.3)}, 3))
    assert Journal(tmp_path / "t.csv", one, fresh=True).rows == {}


def test_what_blows_up_and_what_breaks_is_said():
    material = {"law": "hooke", "k": 1e6, "c": 0.0}
    wild = rope_level(materials={"steel": material, "rubber": material})
    brittle = {"stiffness": 0.3, "damping": 0.5, "tension_limit": 0.001}
    torn = rope_level(materials={"steel": brittle, "rubber": brittle})
    for level, breaks, blows_up in ((wild, False, 1), (torn, True, 0)):
        grid = SweepGrid(level, {"settings.tick_rate": (60,)}, 60)
        ((_, row),) = swept(grid, [], 1)
        figures = dict(zip(grid.header[1:], row, strict=True))
        assert (figures["broken_springs"] > 0, figures["blew_up"]) == (breaks, blows_up)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--cs", "0:1"], "write A:B:N"),
        (["--cs", "0:1:3:log"], "logarithmic"),
        (["--cs", "0:2:3"], "between 0 and 1"),
        (["--set", "bodies.rope.segments=x"], "not a whole number"),
        (["--set", "bodies.ropes.segments=5:6:2"], 'did you mean "rope"?'),
        (["--set", "nothing"], "write FIELD="),
        (["--solver", "magic"], "magic"),
        ([], "nothing varies"),
        (["--cs", "0:1:1000", "--cd", "0:1:1000"], "at most 100,000"),
    ],
)
def test_a_sweep_that_makes_no_sense_is_refused_in_a_line(level, tmp_path, capsys, arguments, words):
    assert main(["sweep", level, *arguments, "-o", str(tmp_path / "x.csv")]) == 2
    told = capsys.readouterr().err
    assert words in told and len(told.splitlines()) == 1
    assert main(["sweep", level, "--cs", "0,1", "-o", str(tmp_path / "x.txt")]) == 2
