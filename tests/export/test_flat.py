"""Flat levels: the same text of the same level, what it says is the world, and programs that read it run it."""

import json
import math
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from sandbox.export.flat import FlatLevel, flat, flat_schema, flat_text, pymunk_program
from sandbox.export.svg import svg
from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.energy import reduced_masses
from sandbox.physics.equation import HIGHEST_COEFFICIENT
from sandbox.physics.step import step
from sandbox.session.session import Session
from tests.support.wants import needs

ROOT = Path(__file__).resolve().parents[2]
GOLDENS = Path(__file__).parent / "golden"
READERS = ROOT / "docs" / "examples" / "flat"
# A soft body on a rope; muscles and rods on terrain; motors and marbles.
KEPT = ("trampoline", "walker", "marble_mill")
node = needs("node", shutil.which("node"))


@pytest.fixture(scope="module")
def levels():
    return {path.stem: flat(load_level(path.stem)) for path in shipped_levels()}


@pytest.mark.parametrize("name", KEPT)
def test_the_text_of_a_level_is_the_golden_file(name, levels):
    golden = GOLDENS / f"{name}.json"
    assert golden.stat().st_size < 60_000
    assert flat_text(levels[name]) == golden.read_text(encoding="utf-8"), (
        f"python -m sandbox export {name} -o tests/export/golden/{name}.json, and a new version if readers break"
    )


def test_a_text_is_read_back_as_the_level_that_it_was_written_from(levels):
    for made in levels.values():
        text = flat_text(made)
        assert FlatLevel.model_validate_json(text) == made
        assert "-0.0," not in text and "NaN" not in text and "Infinity" not in text


def test_the_schema_names_every_key_that_a_file_may_have_with_the_units_of_what_has_one(levels):
    schema = flat_schema()
    assert schema["properties"]["format"]["const"] == "spring-sandbox/flat"
    assert schema["properties"]["version"]["const"] == 1
    for made in levels.values():
        data = json.loads(flat_text(made))
        assert set(schema["required"]) <= set(data) <= set(schema["properties"])
        for part, model in (("particles", "FlatParticle"), ("springs", "FlatSpring"), ("motors", "FlatMotor")):
            known = schema["$defs"][model]
            for item in data.get(part, []):
                assert set(known["required"]) <= set(item) <= set(known["properties"])
    springs = schema["$defs"]["FlatSpring"]["properties"]
    assert [springs[key]["unit"] for key in ("rest_length", "Cs", "k", "c")] == ["m", "1", "N/m", "N s/m"]
    for name, model in schema["$defs"].items():
        if name.startswith("Flat"):
            assert all(each.get("description") or "$ref" in each for each in model["properties"].values()), name


@pytest.mark.parametrize("name", ["trampoline", "walker", "suspension_car", "clock_spring", "hooke_comparison"])
def test_what_a_file_says_is_what_the_world_has(name, levels):
    world, made = build_world(load_level(name)), levels[name]
    count, springs = world.grab_particle, world.grab_spring
    assert [part.name for part in made.particles] == world.particle_names[:count]
    np.testing.assert_array_equal([part.position for part in made.particles], world.position[:count])
    np.testing.assert_array_equal([part.pinned for part in made.particles], world.inverse_mass[:count] == 0.0)
    np.testing.assert_array_equal([(each.a, each.b) for each in made.springs],
                                  np.stack([world.particle_a, world.particle_b], axis=1)[:springs])  # fmt: skip
    assert len(made.areas) + len(made.bends) == world.constraint_count
    assert len(made.muscles) == len(world.actuators.muscles.spring)
    assert len(made.motors) == len(world.actuators.motors.hub)
    moved = set(world.actuators.muscles.spring.tolist())
    lengths = [each.rest_length for k, each in enumerate(made.springs) if k not in moved]
    np.testing.assert_array_equal(lengths, np.delete(world.rest_length[:springs], sorted(moved)))


def test_k_is_that_of_the_direct_solver_and_what_is_too_stiff_is_a_rod(levels):
    for name in ("trampoline", "catapult"):
        world, made = build_world(load_level(name)), levels[name]
        share = reduced_masses(world) * (made.rate * world.settings.substeps) ** 2
        for slot, spring in enumerate(made.springs):
            assert spring.rod == (spring.Cd > HIGHEST_COEFFICIENT)
            if not spring.rod and world.settings.substeps == 1:
                assert spring.k == pytest.approx(share[slot] * spring.Cs / (1.0 - spring.Cd), rel=1e-9)


def test_outlines_go_round_what_is_solid_counter_clockwise_and_along_ropes_in_order(levels):
    made = levels["trampoline"]
    rope, cube = made.bodies
    (line,) = rope.outlines
    assert not line.closed and [made.particles[p].name for p in line.particles] == [
        f"{rope.id}.{k}" for k in range(len(line.particles))
    ]
    (rim,) = cube.outlines
    places = np.array([made.particles[p].position for p in rim.particles])
    x, y = places.T
    assert rim.closed and 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0.0
    assert len(set(rim.particles)) == len(rim.particles)
    assert [len(body.outlines) for body in levels["balloons"].bodies][:1] == [1]


def test_extras_looks_terrain_walls_and_hydraulics_come_along():
    level = {
        "format": "spring-sandbox/level", "version": 4, "name": "all", "settings": {"solver": "direct"},
        "contacts": {"friction": 0.3, "restitution": 0.1}, "walls": {"box": [-5, -5, 5, 5]}, "extras": {"by": "me"},
        "terrain": [
            {"id": "hill", "polygon": [[0, 0], [1, 0], [0, 1]], "friction": 0.7, "belt": 2, "extras": {"soil": 1}},
            {"id": "path", "polyline": [[2, 0], [3, 0]]},
        ],
        "bodies": [{"type": "rope", "id": "r", "start": [0, 4], "end": [1, 4], "segments": 2, "extras": {"a": [1]},
                    "collides": ["terrain"], "belt": -1}],
        "particles": [{"id": "p", "position": [0, 2], "look": {"colour": "lemon"}, "extras": {"b": 2}}],
        "springs": [{"a": "p", "b": "r.end", "extras": {"c": 3},
                     "hydraulic": {"shortest": 1, "longest": 2, "rate": 0.5, "key": "h"}}],
    }  # fmt: skip
    made = flat(parse_level(json.dumps(level).encode(), "all"))
    hill, path, walls = made.terrain
    assert (hill.kind, hill.friction, hill.restitution, hill.extras) == ("solid", 0.7, 0.1, {"soil": 1})
    assert (hill.belt, path.belt, {(spring.edge, spring.belt) for spring in made.springs}) == (
        2.0, 0.0, {(True, -1.0), (False, 0.0)}
    )  # fmt: skip
    assert (path.kind, path.friction, walls.kind, walls.id) == ("line", 0.3, "hollow", "walls")
    assert (made.extras, made.bodies[0].extras) == ({"by": "me"}, {"a": [1]})
    (loose,) = [part for part in made.particles if part.body is None]
    assert loose.look is not None and loose.look.colour == "lemon" and loose.extras == {"b": 2}
    (hydraulic,) = made.hydraulics
    assert made.springs[hydraulic.spring].extras == {"c": 3} and (hydraulic.shortest, hydraulic.value) == (1.0, 0.0)
    touched = [made.surfaces[part.surface].touches for part in made.particles]
    assert touched == [(0,)] * 3 + [(0, 1)]


def places_said(command, cwd):
    run = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, cwd=cwd)
    assert run.returncode == 0, run.stderr
    return {
        name: tuple(map(float, numbers))
        for name, *numbers in ((*line.rsplit(" ", 2),) for line in run.stdout.splitlines())
    }


def places_here(name, seconds):
    session = Session(load_level(name))
    for _ in range(round(seconds * session.world.settings.tick_rate)):
        session.advance()
    world = session.world
    return {each: tuple(world.position[k]) for k, each in enumerate(world.particle_names[: world.grab_particle])}


def reading(reader, tmp_path, levels, name, seconds):
    """What a reader says of a level after some time."""
    if reader == "pymunk":
        pytest.importorskip("pymunk", reason="needs pymunk")
        command = [sys.executable, READERS / "read_flat_pymunk.py"]
    else:
        command = ["node", READERS / "read_flat.js"]
    (tmp_path / "level.json").write_text(flat_text(levels[name]), encoding="utf-8")
    return places_said([*command, tmp_path / "level.json", seconds], tmp_path)


@pytest.mark.parametrize("reader", ["pymunk", pytest.param("javascript", marks=node)])
def test_a_reader_swings_the_cradle_as_it_swings_here(reader, tmp_path, levels):
    there, here = reading(reader, tmp_path, levels, "newtons_cradle", 1.0), places_here("newtons_cradle", 1.0)
    apart = [math.dist(there[name], here[name]) for name in here]
    moved = max(math.dist(part.position, here[part.name]) for part in levels["newtons_cradle"].particles)
    assert moved > 3.0 and max(apart) < 0.02 * moved + 0.1


@pytest.mark.parametrize("reader", ["pymunk", pytest.param("javascript", marks=node)])
def test_a_reader_lets_the_walker_walk_on_its_ground_by_its_muscles(reader, tmp_path, levels):
    there, here = reading(reader, tmp_path, levels, "walker", 5.0), places_here("walker", 5.0)
    start = {part.name: part.position for part in levels["walker"].particles}
    walked = here["body.4"][0] - start["body.4"][0]
    assert walked > 1.0 and there["body.4"][0] - start["body.4"][0] == pytest.approx(walked, rel=0.35)
    assert min(y for _, y in there.values()) > -0.1


def test_a_reader_without_particles_that_it_is_asked_for_prints_those_that_it_is(tmp_path, levels):
    pytest.importorskip("pymunk", reason="needs pymunk")
    (tmp_path / "level.json").write_text(flat_text(levels["trampoline"]), encoding="utf-8")
    command = [sys.executable, READERS / "read_flat_pymunk.py", tmp_path / "level.json", 0.5, "heavy ball"]
    said = places_said(command, tmp_path)
    assert list(said) == ["heavy ball"]
    assert said["heavy ball"][1] == pytest.approx(places_here("trampoline", 0.5)["heavy ball"][1], abs=0.05)


def test_the_program_for_pymunk_is_of_one_file_and_does_what_the_reader_does(tmp_path, levels):
    pytest.importorskip("pymunk", reason="needs pymunk")
    program = tmp_path / "walker.py"
    program.write_text(pymunk_program(levels["walker"]), encoding="utf-8")
    alone = places_said([sys.executable, program, 1.0], tmp_path)
    assert alone == reading("pymunk", tmp_path, levels, "walker", 1.0)


@pytest.mark.parametrize("reader", sorted(READERS.iterdir()), ids=lambda path: path.name)
def test_a_reader_is_short_and_says_what_it_is_how_its_file_is_made_and_what_differs(reader):
    text = reader.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 150 and max(map(len, text.expandtabs(4).splitlines())) <= 125
    assert re.search(r"sandbox export \w+ --to flat -o", text) and "What differs: " in text


def test_a_picture_is_xml_with_every_body_spring_and_piece_in_metres_with_y_up(levels):
    for name, made in levels.items():
        root = ElementTree.fromstring(svg(made))
        assert root.tag == "{http://www.w3.org/2000/svg}svg", name
        left, top, width, height = map(float, root.attrib["viewBox"].split())
        assert width > 0.0 and height > 0.0
        if made.view is not None:
            assert (left, -top - height) == pytest.approx(made.view[:2], abs=1e-3)
        (group,) = root.findall("{*}g")
        assert group.attrib["transform"] == "scale(1 -1)"
        filled = {path.attrib["id"] for path in group.findall("{*}path") if "id" in path.attrib}
        assert filled == {body.id for body in made.bodies if any(each.closed for each in body.outlines)}
        loose = sum(part.body is None or part.pinned for part in made.particles)
        assert len(group.findall("{*}circle")) == loose
        lines = [path for path in group.findall("{*}path") if not path.findall("{*}title")]
        assert sum(path.attrib["d"].count("M") for path in lines) == len(made.springs)


def test_a_picture_is_drawn_by_a_renderer_with_the_ground_below_and_the_sky_above(levels, tmp_path):
    pygame = pytest.importorskip("pygame")
    (tmp_path / "picture.svg").write_text(svg(levels["trampoline"]), encoding="utf-8")
    picture = pygame.image.load(tmp_path / "picture.svg")
    width, height = picture.get_size()
    assert max(width, height) == 1000
    above, below = picture.get_at((width // 2, 5)), picture.get_at((width // 2, height - 5))
    assert above[:3] == (255, 255, 255) and below[:3] != above[:3]


def test_a_level_of_nothing_is_exported_as_well():
    level = parse_level(b'{"format": "spring-sandbox/level", "version": 4, "name": "<&\\">"}', "nothing")
    made = flat(level)
    assert FlatLevel.model_validate_json(flat_text(made)) == made
    assert ElementTree.fromstring(svg(made)).find("{*}title").text == '<&">'
    world = build_world(level)
    step(world)
    compile(pymunk_program(made), "nothing", "exec")
