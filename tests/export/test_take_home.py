"""What is taken home: limits that are proven, numbers that a run shows, programs that print what they say."""

import json
import re
import runpy
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from sandbox.cli import main
from sandbox.export.engines import LOOSE, NoSuchBody, body_names, choose_body
from sandbox.export.loops import LISTINGS, TICKS, expected, largest_pair, listing
from sandbox.export.numbers import floored, short
from sandbox.export.take_home import ENGINES, PASTED_MASSES, TARGETS, as_text, pasted, take_home, take_home_text
from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.stability import report
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.session.commands import SetCoefficients
from sandbox.session.session import Session
from tests.support.springs_elsewhere import lattice, level_of_springs, weight
from tests.support.wants import needs
from tests.support.wobbles import firm_level, height, measured_wobble, standing_box

JELLY = {"shape": {"box": [1, 1]}, "spacing": 0.25}


def jelly(**settings) -> World:
    return build_world(parse_level(firm_level({"sag": 0.1}, settings, **JELLY), "jelly"))


def with_pair(world, pair):
    """The world with that Cs and Cd in all its springs, areas and bends."""
    for family in ("", "constraint_"):
        for name, value in (("stiffness", pair.stiffness), ("damping", pair.damping), ("lowest_mode", 0.0)):
            world.change(f"{family}{name}", value)
    return world


@pytest.mark.parametrize("row", range(4))
@pytest.mark.parametrize("which", ["equal", "own"])
def test_the_pairs_are_proven_in_a_single_pass_and_within_a_per_cent_of_the_limit(row, which):
    taken = take_home(jelly())
    row = taken.rows[row]
    world = jelly(solver="single_pass", tick_rate=60 * row.substeps)
    pair = getattr(row, which)
    assert report(with_pair(world, pair)).within_limit is True
    assert (pair.stiffness + 2.0 * pair.damping) * taken.chosen.n_eff > 0.99 * 4.0
    # That of one body on its own is what the report says of a world of that body.
    assert report(world).n_eff == taken.chosen.n_eff


@pytest.mark.parametrize("row", range(4))
def test_the_wobble_of_a_row_is_within_2_percent_of_that_which_a_single_pass_shows(row):
    row = take_home(jelly()).rows[row]
    world = with_pair(jelly(solver="single_pass", tick_rate=60 * row.substeps), row.equal)
    hz, ratio = measured_wobble(world)
    assert row.equal.frequency == pytest.approx(hz, rel=0.02)
    assert row.equal.damping_ratio == pytest.approx(ratio, rel=0.05)


@pytest.mark.parametrize(("cells", "rows", "near"), [(4, (1, 2, 3), 0.06), (8, (2, 3), 0.06)])
def test_the_sag_of_a_row_below_a_tenth_is_that_at_which_a_single_pass_stands(cells, rows, near):
    taken = take_home(standing_box(1.0, cells, {"sag": 0.1}))
    for row in (taken.rows[number] for number in rows):
        settings = {"solver": "single_pass", "tick_rate": 60 * row.substeps}
        world = with_pair(standing_box(1.0, cells, {"sag": 0.1}, settings=settings), row.equal)
        before, heights = height(world), []
        for _ in range(480 * row.substeps):
            step(world)
            heights.append(height(world))
        assert row.equal.sag < 0.1
        assert 1.0 - np.mean(heights[-200:]) / before == pytest.approx(row.equal.sag, rel=near)


def test_sags_fall_with_the_square_of_the_substeps():
    rows = take_home(jelly()).rows
    # Deep sags are no longer in proportion to the weight.
    for row, near in zip(rows[1:], (0.2, 0.02, 0.02), strict=True):
        before = rows[row.substeps.bit_length() - 2]
        assert row.equal.sag == pytest.approx(before.equal.sag / 4.0, rel=near)


def test_a_body_of_the_level_that_is_within_the_limit_keeps_its_ratio_of_cs_to_cd():
    taken = take_home(lattice(0.01, 0.04))
    assert taken.holds
    own = taken.rows[0].own
    assert own.stiffness / own.damping == pytest.approx(0.25, rel=0.02)
    assert own.stiffness > 0.01


@pytest.mark.parametrize(("stiffness", "damping", "n_eff", "found"), [
    (1.0, 1.0, 1.0, (1.0, 1.0)), (1.0, 1.0, 2.0, (0.666, 0.666)), (1.0, 1.0, 4.0, (0.333, 0.333)),
    (0.5, 0.0, 8.0, (0.499, 0.0)), (0.0, 0.7, 8.0, (0.0, 0.249)), (0.2, 0.1, 4.0, (0.499, 0.249)),
])  # fmt: skip
def test_the_largest_pair_has_three_digits_and_stays_below_4_over_n_eff(stiffness, damping, n_eff, found):
    assert largest_pair(stiffness, damping, n_eff) == found
    assert (found[0] + 2.0 * found[1]) * n_eff < 4.0


@pytest.mark.slow
def test_every_shipped_level_with_springs_can_be_taken_home_to_everywhere():
    for path in shipped_levels():
        world = build_world(load_level(path.stem))
        if not body_names(world):
            continue
        taken = take_home(world)
        for to in TARGETS:
            text = as_text(taken, to)
            assert text.endswith("\n") and "nan" not in text and "inf" not in text.replace("infinite", ""), path.stem
        for row in taken.rows:
            for pair in (row.equal, row.own):
                assert 0.0 <= pair.stiffness <= 1.0 and 0.0 <= pair.damping <= 1.0
                assert (pair.stiffness + 2.0 * pair.damping) * taken.chosen.n_eff < 4.0


def test_the_first_body_with_springs_is_taken_and_loose_springs_have_a_name():
    assert choose_body(build_world(load_level("jelly_pile"))).name == "cube 1"
    assert body_names(build_world(load_level("side_by_side"))) == [LOOSE]
    assert choose_body(build_world(load_level("jelly_pile")), "plank 7").name == "plank 7"


def test_a_body_that_is_not_there_is_told_with_the_nearest_name_or_those_that_there_are():
    world = build_world(load_level("truck_bridge"))
    with pytest.raises(NoSuchBody, match=r'called "trukc"; did you mean "truck"\?'):
        take_home(world, "trukc")
    with pytest.raises(NoSuchBody, match='there are "deck", "truck"'):
        take_home(world, "zebra")
    with pytest.raises(NoSuchBody, match="no spring does anything"):
        take_home(World())


@pytest.mark.parametrize("solver", [*SOLVERS])
def test_the_text_says_in_one_line_whether_the_levels_own_numbers_hold_in_the_loop(solver):
    beyond = as_text(take_home(weight(0.9, 0.95, solver)))
    assert "the level's own numbers are inside" in beyond, "one spring alone is stable up to 1"
    pair = [{"id": "p", "pinned": True}, {"id": "q", "position": [1, 0]}, {"id": "r", "position": [2, 0]}]
    springs = [{"a": "p", "b": "q", "material": "m"}, {"a": "q", "b": "r", "material": "m"}]
    text = as_text(take_home(level_of_springs(0.9, 0.95, solver, particles=pair, springs=springs)))
    (line,) = [line for line in text.splitlines() if "may explode in a single pass" in line]
    assert ("direct solver alone" in line) == (solver == "direct")


def test_firmness_is_one_sentence_with_the_numbers_of_the_panel():
    assert take_home(jelly(gravity=[0, -9.81])).firmness.startswith(
        "It sags by 10 % of its height where it stands (soft)"
    )
    assert "rigid" in take_home(load_level("girder")).firmness
    assert "not stiff without pins" in take_home(load_level("rope")).firmness


def test_the_ten_ticks_are_those_of_the_worlds_own_single_pass():
    for name in ("jelly_pile", "rope", "hooke_comparison"):
        trial = take_home(load_level(name)).trial
        particles = [
            {"id": f"p{k}", "position": trial.start[k], "velocity": trial.velocity[k] if weight else (0, 0),
             "mass": 1.0 / weight if weight else 1.0, "pinned": not weight}
            for k, weight in enumerate(trial.inverse_mass)
        ]  # fmt: skip
        springs = [{"a": "p0", "b": "p1", "rest_length": trial.rest_length, "material": "m"}]
        world = level_of_springs(trial.stiffness, trial.damping, "single_pass", particles=particles, springs=springs)
        # The loop gives the first tick all of gravity.
        world.change("unmoved", False)
        assert len(trial.places) == TICKS
        for places in trial.places:
            step(world)
            np.testing.assert_allclose(world.position[:2], places, rtol=0.0, atol=1e-9)


def numbers(text):
    return np.array([[float(word) for word in line.split()] for line in text.strip().splitlines()])


@pytest.fixture(scope="module")
def trial():
    return take_home(load_level("jelly_pile")).trial


def test_the_python_loop_prints_the_ten_ticks(trial, tmp_path, capsys):
    (tmp_path / "loop.py").write_text(listing(trial, "python"))
    runpy.run_path(str(tmp_path / "loop.py"))
    np.testing.assert_allclose(numbers(capsys.readouterr().out), numbers("\n".join(expected(trial))), atol=1e-9)


@needs("node", shutil.which("node"))
def test_the_javascript_loop_prints_the_ten_ticks(trial, tmp_path):
    (tmp_path / "loop.js").write_text(listing(trial, "javascript"))
    run = subprocess.run(["node", tmp_path / "loop.js"], capture_output=True, text=True, check=True)
    np.testing.assert_allclose(numbers(run.stdout), numbers("\n".join(expected(trial))), atol=1e-9)


COMPILER = shutil.which("c++") or shutil.which("g++")


@needs("a C++ compiler", COMPILER)
def test_the_cpp_loop_is_compiled_without_a_warning_and_prints_the_ten_ticks(trial, tmp_path):
    (tmp_path / "loop.cpp").write_text(listing(trial, "cpp"))
    command = [COMPILER, "-std=c++17", "-Wall", "-Wextra", "-Werror", "-o", tmp_path / "loop", tmp_path / "loop.cpp"]
    subprocess.run(command, check=True, capture_output=True)
    run = subprocess.run([tmp_path / "loop"], capture_output=True, text=True, check=True)
    np.testing.assert_allclose(numbers(run.stdout), numbers("\n".join(expected(trial))), atol=1e-9)


@pytest.mark.parametrize("language", LISTINGS)
def test_a_loop_is_short_and_whole_and_has_every_number_of_the_trial(language, trial):
    text = listing(trial, language)
    assert len(text.splitlines()) <= 31 and max(map(len, text.splitlines())) <= 120
    for value in (trial.h, trial.stiffness, trial.damping, trial.rest_length, *trial.inverse_mass, trial.gravity[1]):
        assert repr(value) in text
    assert not re.search(r"\$\w", text)
    for opening, closing in ("()", "[]", "{}"):
        assert text.count(opening) == text.count(closing)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_engine_has_its_numbers_and_what_differs_there_in_lines_of_its_own(engine):
    lines = as_text(take_home(load_level("jelly_pile")), engine).splitlines()
    (numbers_line,) = [line for line in lines if "frequency" in line and "whatever the masses" in line]
    assert re.search(r"\d Hz", numbers_line)
    assert len([line for line in lines if line.startswith("  Differs: ")]) == 1
    assert any(" N/m, c " in line for line in lines) == (engine not in ("box2d", "unity"))


def test_numbers_for_a_person_have_three_digits_and_seldom_powers_of_ten():
    read = {0.0: "0", 0.666: "0.666", 1.0: "1", 1000.0: "1000", 1234.5: "1230", 0.00012345: "0.000123", 2e-9: "2e-09"}
    assert {value: short(value) for value in read} == read
    assert floored(1.0 / 3.0, lambda c: 3.0 * c < 1.0) == 0.333
    assert floored(0.25, lambda c: 4.0 * c < 1.0) == 0.249


def test_the_page_for_designers_shows_what_is_printed():
    page = (Path(__file__).resolve().parents[2] / "docs" / "how-to-design.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    printed = as_text(take_home(load_level("jelly_pile"))).splitlines()
    assert [line for line in block.splitlines() if line not in printed] == []


def test_a_world_in_a_run_takes_home_what_it_has_now():
    session = Session(load_level("jelly_pile"))
    assert take_home_text(session.world, "cube 1") == take_home_text(load_level("jelly_pile"), "cube 1")
    soft = session.world.material_names.index("jelly")
    session.submit(SetCoefficients(stiffness=0.05, damping=0.1, material=soft))
    for _ in range(30):
        session.advance()
    assert "Here: Cs 0.05, Cd 0.1 in a tick of 1/60 s, direct solver." in take_home_text(session.world, "cube 1")
    assert "Here: Cs 0.9, Cd 0.95 in a tick" in take_home_text(session.world, "plank 7")


@pytest.fixture(scope="module")
def cube():
    return take_home(load_level("jelly_pile"), "cube 1")


@pytest.mark.parametrize("engine", ENGINES)
def test_the_lines_hold_the_numbers_that_the_text_says(cube, engine):
    numbers = cube.engines[engine]
    found = [float(each) for each in re.findall(r"(?<![\w.])\d+\.\d+", pasted(cube, engine))]
    by_frequency = engine in ("box2d", "unity")
    mass = numbers.masses[0]
    wanted = [numbers.frequency, numbers.damping_ratio] if by_frequency else [mass.k, mass.c]
    assert found == pytest.approx(wanted, rel=5e-3)


def test_springs_between_different_masses_have_a_line_each_with_a_remark():
    level = load_level("truck_bridge")
    takes = [take_home(level, name) for name in body_names(build_world(level))]
    several = next(
        take for take in takes if len(take.engines["pymunk"].masses) > 1 and not take.engines["pymunk"].rigid
    )
    lines = pasted(several, "pymunk").splitlines()
    count = min(len(several.engines["pymunk"].masses), PASTED_MASSES)
    assert len(lines) == 2 * count and all(line.startswith("# the ") for line in lines[::2])


def test_what_is_too_stiff_for_the_springs_of_an_engine_has_nothing_to_be_pasted(cube):
    stiff = take_home(load_level("truss_bridge"))
    rigid = [engine for engine in ENGINES if stiff.engines[engine].rigid]
    assert rigid and not any(pasted(stiff, engine) for engine in rigid)


@needs("pymunk", find_spec("pymunk"))
def test_pymunk_takes_its_line(cube):
    import pymunk

    a, b, rest_length = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0), 0.4
    spring = eval(pasted(cube, "pymunk"), {"pymunk": pymunk, "a": a, "b": b, "rest_length": rest_length})
    mass = cube.engines["pymunk"].masses[0]
    assert (spring.stiffness, spring.damping) == pytest.approx((mass.k, mass.c), rel=5e-3)


def test_take_home_prints_every_number_of_the_first_body_and_how_to_have_the_programs(capsys):
    assert main(["take-home", "jelly_pile"]) == 0
    said = capsys.readouterr().out
    assert said == as_text(take_home(load_level("jelly_pile")))
    assert said.startswith('"cube 1" of "Jelly pile": ')
    for word in ("8 substeps", "Box2D 3", "Unity 2D", "Godot 4", "Rapier 2D", "pymunk 7", "Chipmunk 7", "--to csharp"):
        assert word in said


@pytest.mark.parametrize("to", TARGETS)
def test_take_home_prints_one_thing_where_it_is_asked_for_one(to, capsys):
    assert main(["take-home", "jelly_pile", "--body", "plank 7", "--to", to]) == 0
    said = capsys.readouterr().out
    assert said.startswith('"plank 7" of "Jelly pile": ')
    languages = [line for line in said.splitlines() if line.startswith("---- ")]
    wanted = {"article": 5, "csharp": 1, "gdscript": 1, "cpp": 1, "javascript": 1, "python": 1}
    assert len(languages) == wanted.get(to, 0)
    assert ("What it prints" in said) == (to in wanted)


@pytest.mark.parametrize(("arguments", "fault"), [
    (["jelly_pile", "--body", "plnk 7"], 'jelly_pile: there is no body with springs called "plnk 7"; did you mean'),
    (["jelly_pile", "--to", "rapir"], '--to rapir: there is nothing called "rapir"; did you mean "rapier"?'),
    (["jelly_pile", "--to", "zzz"], '--to zzz: there is nothing called "zzz"; there are all, article'),
    (["hourglass", "--body", "x"], "hourglass: no spring does anything here"),
])  # fmt: skip
def test_take_home_says_in_one_line_what_is_not_there(arguments, fault, capsys):
    assert main(["take-home", *arguments]) == 2
    said = capsys.readouterr()
    (line,) = said.err.splitlines()
    assert fault in line and said.out == ""


def test_export_prints_flat_data_or_writes_it_with_its_size(tmp_path, capsys):
    assert main(["export", "walker"]) == 0
    printed = capsys.readouterr().out
    assert json.loads(printed)["format"] == "spring-sandbox/flat"
    target = tmp_path / "walker.json"
    assert main(["export", "walker", "--to", "flat", "-o", str(target)]) == 0
    assert target.read_text(encoding="utf-8") == printed
    assert capsys.readouterr().out == f"{target}: {len(printed.encode()) / 1000:.1f} kB\n"


def test_export_writes_a_picture_a_program_and_the_schema(capsys):
    assert main(["export", "walker", "--to", "svg"]) == 0
    assert ElementTree.fromstring(capsys.readouterr().out).tag.endswith("svg")
    assert main(["export", "walker", "--to", "pymunk"]) == 0
    compile(capsys.readouterr().out, "walker.py", "exec")
    assert main(["export", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out)["title"] == "Spring Sandbox flat level"


@pytest.mark.parametrize(("arguments", "fault"), [
    ([], "name a level, or say --schema: one of the two"),
    (["walker", "--schema"], "name a level, or say --schema: one of the two"),
    (["walkr"], "walkr"),
    (["walker", "-o", "no/such/folder/x.json"], "no/such/folder"),
])  # fmt: skip
def test_export_says_in_one_line_what_cannot_be_done(arguments, fault, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["export", *arguments]) == 2
    said = capsys.readouterr()
    (line,) = said.err.splitlines()
    assert fault in line and said.out == ""
