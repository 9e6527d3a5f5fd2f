"""Sweeps: rows in the order of the grid, the same however they were made, and taken up again."""

import csv
import itertools
import json
import multiprocessing
import os
import signal

import numpy as np
import pytest

import sandbox.session.sweep.running as pool
from sandbox.cli import main
from sandbox.level.reading.files import level_data
from sandbox.session.level_edits import field_place
from sandbox.session.sweep.grid import Journal, SweepError, SweepGrid, read_table, table_text
from sandbox.session.sweep.running import run_case, swept, swept_by_dask
from sandbox.session.sweep.sweep_map import edges, is_logarithmic, sweep_panels
from tests.support.rope_level import rope_level

CHECKS = [{"name": "stays up", "metric": "y", "particle": "rope.end", "after": 0.1, "at_least": -0.2}]
MOON = {"solver": "iterative", "gravity": [0.0, -1.6]}
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

    def interrupted(request, case):
        if len(ran) == 5:
            raise KeyboardInterrupt
        ran.append(case)
        return run_case(request, case)

    monkeypatch.setattr(pool, "run_case", interrupted)
    assert sweep(level, tmp_path / "three.csv", "--processes", "1") == 130
    assert "5 of 12 runs are done; the same command goes on" in capsys.readouterr().err
    journal = tmp_path / "three.csv.unfinished"
    journal.write_text(journal.read_text()[:-9])
    again = []
    monkeypatch.setattr(pool, "run_case", lambda request, case: again.append(case) or run_case(request, case))
    assert sweep(level, tmp_path / "three.csv", "--processes", "1") == 0
    assert len(again) == 8 and len({*ran[:4], *again}) == 12
    texts = [(tmp_path / f"{name}.csv").read_bytes() for name in ("one", "two", "three")]
    assert texts[0] == texts[1] == texts[2]


@pytest.mark.whole_world
def test_dask_gives_the_same_table_though_a_worker_is_killed_half_way():
    grid = SweepGrid(rope_level(), {"cs": (0.1, 0.2, 0.4), "cd": (0.0, 0.3, 0.6, 1.0)}, 12)
    alone = dict(swept(grid, [], 1))
    found, killed = [(0, alone[0])], []
    for number, row in swept_by_dask(grid, [0], "local", 2):
        found.append((number, row))
        if len(found) == 5:
            killed.append(multiprocessing.active_children()[0].pid)
            os.kill(killed[0], signal.SIGKILL)
    assert killed and sorted(number for number, _ in found) == list(range(12))
    assert table_text(grid, dict(found)) == table_text(grid, alone)


def test_a_scheduler_that_does_not_answer_is_told_in_a_line(level, tmp_path, capsys):
    assert sweep(level, tmp_path / "x.csv", "--dask", "nowhere") == 2
    told = capsys.readouterr().err
    assert "nowhere" in told and len(told.splitlines()) == 1


def test_a_journal_of_another_level_or_grid_is_begun_anew_and_said(level, tmp_path, capsys):
    one = SweepGrid(rope_level(), {"cs": (0.1, 0.2)}, 3)
    Journal(tmp_path / "t.csv", one).add(1, [1.5, None])
    assert Journal(tmp_path / "t.csv", one).rows == {1: [1.5, None]}
    other = Journal(tmp_path / "t.csv", SweepGrid(rope_level(settings=MOON), {"cs": (0.1, 0.2)}, 3))
    assert other.replaced and other.rows == {}
    other.add(0, [2.0, 1])
    assert Journal(tmp_path / "t.csv", SweepGrid(rope_level(), {"cs": (0.1, 0.3)}, 3)).replaced
    assert Journal(tmp_path / "t.csv", one, fresh=True).rows == {}
    Journal(tmp_path / "a.csv", one)
    assert sweep(level, tmp_path / "a.csv", "--processes", "1") == 0
    assert "another level or grid" in capsys.readouterr().err


def test_a_whole_table_is_known_and_read_back_if_it_is_of_this_level(tmp_path):
    level = rope_level(checks=CHECKS)
    grid = SweepGrid(level, {"settings.solver": ("direct", "single_pass"), "cs": (0.1, 1.0), "cd": (0.2, 1.0)}, 6)
    table = tmp_path / "t.csv"
    done = dict(swept(grid, [], 1))
    table.write_text(table_text(grid, done))
    found, again = read_table(table, level)
    assert found == grid and again == done
    # What is swept, and what only shows, may be otherwise in the level.
    assert read_table(table, level.model_copy(update={"name": "other"}))[0].digest == grid.digest
    for other in (rope_level(), rope_level(checks=CHECKS, settings=MOON)):
        with pytest.raises(SweepError, match="another level"):
            read_table(table, other)
    lines = table.read_text().splitlines(keepends=True)
    for text in ("", "a,b\n1,2\n", "".join(lines[:-1]), "".join([*lines[:-1], lines[1]]), "".join(lines)[:-8]):
        table.write_text(text)
        with pytest.raises(SweepError):
            read_table(table, level)


def test_panels_of_a_map_have_cs_across_and_cd_up_whatever_the_order_of_columns():
    grid = SweepGrid(rope_level(), {"cd": (0.5, 0.1), "settings.substeps": (1, 4), "cs": (0.01, 0.1, 1.0)}, 1)
    rows = {number: [None, cs + cd, 0.0, substeps, 0] for number, (cd, substeps, cs) in enumerate(grid.cases)}
    del rows[0]
    panels = list(sweep_panels(grid, rows))
    assert [panel.title for panel in panels] == ["substeps 1", "substeps 4"]
    expected = np.array([[0.11, 0.2, 1.1], [0.51, 0.6, 1.5]])
    assert panels[1].values["max_strain"] == pytest.approx(expected)
    assert np.isnan(panels[0].values["max_strain"][1, 0])
    assert panels[1].zones.article.max() > panels[0].zones.article.max()


def test_cells_lie_around_their_values_on_either_scale():
    assert is_logarithmic(np.array([0.01, 0.1, 1.0])) and not is_logarithmic(np.array([0.0, 0.5, 1.0]))
    assert edges(np.array([0.0, 0.5, 1.0])) == pytest.approx([-0.25, 0.25, 0.75, 1.25])
    assert edges(np.array([0.01, 0.1, 1.0]))[1:3] == pytest.approx([0.1**1.5, 0.1**0.5])


def test_a_map_is_drawn_of_a_table_that_is_there(level, tmp_path, capsys, monkeypatch):
    assert sweep(level, tmp_path / "m.csv", "--processes", "1") == 0
    before = (tmp_path / "m.csv").read_bytes()
    monkeypatch.setattr(pool, "run_case", None)
    assert sweep(level, tmp_path / "m.png", "--measure", "max_strain,check: stays up") == 0
    assert "already" in capsys.readouterr().err and (tmp_path / "m.csv").read_bytes() == before
    assert (tmp_path / "m.png").read_bytes().startswith(b"\x89PNG")
    (tmp_path / "m.csv").write_text("mine")
    assert sweep(level, tmp_path / "m.png") == 2
    assert (tmp_path / "m.csv").read_text() == "mine"


def test_what_is_not_installed_is_named_with_how_to_get_it(level, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert sweep(level, tmp_path / "x.png") == 2
    assert 'a map needs matplotlib: pip install "spring-sandbox[export]"' in capsys.readouterr().err
    assert sweep(level, tmp_path / "x.csv", "--dask", "local") == 2
    assert 'pip install "spring-sandbox[sweep]"' in capsys.readouterr().err


def test_what_blows_up_and_what_breaks_is_said():
    material = {"law": "hooke", "k": 1e6, "c": 0.0}
    wild = rope_level(materials={"steel": material, "rubber": material})
    brittle = {"stiffness": 0.3, "damping": 0.5, "tension_limit": 0.001}
    torn = rope_level(materials={"steel": brittle, "rubber": brittle})
    for level, breaks, blows_up in ((wild, False, 1), (torn, True, 0)):
        grid = SweepGrid(level, {"settings.tick_rate": (60,)}, 60)
        ((_, row),) = swept(grid, [], 1)
        figures = dict(zip(grid.header[1:], row, strict=False))
        assert (figures["broken_springs"] > 0, figures["blew_up"]) == (breaks, blows_up)


def test_the_springs_of_one_material_are_swept_alone():
    level = rope_level()
    grids = [SweepGrid(level, {"cs": (0.01,)}, 20, material) for material in (None, *level.materials)]
    found = [dict(swept(grid, [], 1))[0][1] for grid in grids]
    assert len(set(found)) > 1 and len({grid.digest for grid in grids}) == len(grids)
    with pytest.raises(SweepError, match="no material 'gold'"):
        list(swept(SweepGrid(level, {"cs": (0.01,)}, 1, "gold"), [], 1))


def test_a_field_of_a_body_is_found_by_the_body_s_id():
    assert field_place(rope_level(), "rope.segments") == "bodies.rope.segments"
    assert field_place(rope_level(), "settings.solver") == "settings.solver"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--cs", "0:1"], "write A:B:N"),
        (["--cs", "0:1:3:log"], "logarithmic"),
        (["--cs", "0:2:3"], "between 0 and 1"),
        (["--cs", "0.1,0.1"], "given twice"),
        (["--set", "bodies.rope.segments=x"], "not a whole number"),
        (["--set", "bodies.ropes.segments=5:6:2"], 'did you mean "rope"?'),
        (["--set", "nothing"], "write FIELD="),
        (["--solver", "magic"], "magic"),
        (["--cs", "0,1", "--material", "gold"], "no material 'gold'"),
        ([], "nothing varies"),
        (["--cs", "0:1:1000", "--cd", "0:1:1000"], "at most 100,000"),
        (["--cs", "0,1", "--measure", "max_strain"], "--measure: is of a map"),
    ],
)
def test_a_sweep_that_makes_no_sense_is_refused_in_a_line(level, tmp_path, capsys, arguments, words):
    assert main(["sweep", level, *arguments, "-o", str(tmp_path / "x.csv")]) == 2
    told = capsys.readouterr().err
    assert words in told and len(told.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--cs", "0,1", "-o", "x.txt"], ".csv, for a table"),
        (["--cs", "0,1", "-o", "x.png"], "give --cs and --cd"),
        (["--cs", "0,1", "--cd", "0,1", "--measure", "joy", "-o", "x.png"], "no 'joy'; there are: settle_time"),
        (["--cs", "0,1", "--cd", "0,1", "--set", "rope.segments=5:24:20", "-o", "x.png"], "choose some"),
    ],
)
def test_a_map_that_cannot_be_is_refused_in_a_line(level, tmp_path, monkeypatch, capsys, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", level, *arguments]) == 2
    told = capsys.readouterr().err
    assert words in told and len(told.splitlines()) == 1 and not list(tmp_path.glob("x.*"))
