"""The models: defaults, ranges and what stays open, as the format says."""

import pytest
from pydantic import ValidationError

from sandbox.level.checks import CheckDef, judge
from sandbox.level.document.model import NissenMaterial, Settings
from sandbox.level.format.limits import DEFAULT_SOLVER
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.reading.files import LevelError, parse_level
from sandbox.physics.solvers import SOLVERS
from tests.support.malformed_levels import GOOD, changed, encoded

MINIMAL = b'{"format": "spring-sandbox/level", "version": 3, "name": "n"}'


def parsed(level):
    return parse_level(encoded(level), "x.json")


def body(**keys):
    return parsed({"format": "spring-sandbox/level", "version": 3, "name": "n", "bodies": [keys]}).bodies[0]


def test_format_version_and_name_are_a_whole_level():
    level = parse_level(MINIMAL, "x.json")
    assert level.settings.gravity == (0.0, -9.81)
    assert (level.settings.tick_rate, level.settings.substeps) == (60, 1)
    assert (level.settings.iterations, level.settings.warm_start) == (10, 0.5)
    assert level.settings.solver == DEFAULT_SOLVER
    assert (level.view, level.bodies, level.particles, level.springs, level.extras) == (None, (), (), (), {})


def test_the_default_solver_exists():
    assert DEFAULT_SOLVER in SOLVERS


@pytest.mark.parametrize("solver", SOLVERS)
def test_every_solver_there_is_can_be_named(solver):
    assert parsed(changed("settings.solver", solver)).settings.solver == solver


def test_a_body_has_the_defaults_of_the_format():
    rope = body(type="rope", id="r", start=[0, 0], end=[1, 0], segments=2)
    assert (rope.particle_mass, rope.end_mass, rope.rest_length, rope.pin) == (1.0, None, None, ())
    assert (rope.velocity, rope.material, rope.extras) == ((0.0, 0.0), "default", {})
    assert body(type="bridge", id="b", start=[0, 0], end=[1, 0], segments=2).height == 1.0
    jelly = body(type="jelly", id="j", shape={"circle": 1}, spacing=0.5)
    assert (jelly.position, jelly.angle, jelly.particle_mass) == ((0.0, 0.0), 0.0, 1.0)
    mesh = body(type="mesh", id="m", particles=[[0, 0]])
    assert (mesh.masses, mesh.velocities, mesh.pinned, mesh.springs) == (None, None, (), ())


def test_a_material_has_the_defaults_of_the_format():
    assert NissenMaterial() == NissenMaterial(stiffness=0.5, damping=0.9)
    assert parsed(changed("materials.steel", {})).materials["steel"] == NissenMaterial()


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("settings.tick_rate", 1),
        ("settings.tick_rate", 10_000),
        ("settings.substeps", 64),
        ("settings.substeps", "auto"),
        ("settings.iterations", 1_000),
        ("settings.warm_start", 0),
        ("settings.warm_start", 1),
        ("settings.gravity", [-1e6, 1e6]),
        ("materials.steel.stiffness", 0),
        ("materials.steel.damping", 1),
        ("bodies.0.start", [-1e6, 1e6]),
        ("bodies.0.segments", 1),
        ("bodies.0.segments", 90_000),
        ("bodies.0.end_mass", 1e9),
        ("bodies.0.end_mass", 1e-9),
        ("bodies.0.velocity", [1e9, -1e9]),
        ("bodies.0.rest_length", 0),
        ("bodies.0.pin", ["end", "start"]),
        ("bodies.0.id", "x" * 256),
        ("bodies.0.id", "Brücke 1 (steel)"),
        ("bodies.4.shape.polygon", [[0, 0], [0, 2], [2, 0]]),
        ("bodies.5.pinned", [0, 0, 1]),
        ("bodies.0.pinned", [0, 0, 30]),
        ("bodies.0.cut", [0, 0, 29]),
        ("bodies.0.pose", None),
        ("bodies.0.group", "x" * 256),
        ("bodies.7.spokes", 3),
        ("bodies.7.rings", 1),
        ("bodies.7.radius", 1e6),
        ("bodies.8.thickness", 0.9999999),
        ("welds", [["rope.0", "deck.7"], ["deck.7", "rope.0"], ["rope.0", "cube.4"]]),
        ("particles.0.radius", 0),
        ("springs.0.b", "deck.end"),
        ("springs.0.b", "rope.start"),
        ("springs.0.rest_length", None),
        ("description", "two\nlines"),
        ("view", None),
        ("extras", {"a": [1, 2.5, None, True, {"b": "c"}]}),
        ("bodies.0.extras", {"a": 1}),
        ("particles.0.extras", {"a": 1}),
        ("springs.0.extras", {"a": 1}),
        ("materials.classic", {"law": "hooke"}),
    ],
)
def test_the_ends_of_every_range_are_inside_it(place, value):
    parsed(changed(place, value))


def test_unknown_keys_are_refused_with_what_may_have_been_meant():
    with pytest.raises(LevelError) as refused:
        parsed(changed("bodies.0.end_mas", 3.0))
    assert str(refused.value) == 'x.json: bodies.0.end_mas: unknown key; did you mean "end_mass"?'


def test_descriptions_are_frozen():
    with pytest.raises(ValidationError):
        Settings().tick_rate = 30


def test_a_rope_can_be_made_in_python_too():
    rope = RopeDef(type="rope", id="r", start=(0, 5), end=(3, 5), segments=30)
    assert rope.start == (0.0, 5.0)


def check(**keys):
    return CheckDef(name="c", **{"metric": "max_strain", **keys})


@pytest.mark.parametrize(
    ("bounds", "value", "passed"),
    [
        ({"at_most": 0.1}, 0.1, True),
        ({"at_most": 0.1}, 0.1001, False),
        ({"at_least": -1.0}, -1.0, True),
        ({"at_least": -1.0}, -2.0, False),
        ({"at_least": 0.0, "at_most": 1.0}, 0.5, True),
        ({"at_most": 0.1}, float("nan"), False),
        ({"at_least": 0.1}, float("inf"), True),
    ],
)
def test_a_check_holds_within_its_bounds(bounds, value, passed):
    result = judge(check(**bounds), value)
    assert (result.passed, result.text.startswith("c: holds" if passed else "c: FAILS")) == (passed, True)


def test_the_good_level_keeps_what_other_tools_left_in_it():
    assert parsed(GOOD).extras == {"editor": {"grid": 0.5}}
