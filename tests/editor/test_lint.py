"""Lint: what it finds, what it leaves in peace, and that it pauses."""

import json
from pathlib import Path

import numpy as np
import pytest

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.placing import weld
from sandbox.editor.items import Item, items_of
from sandbox.editor.lint.finding import LISTED, connected_parts
from sandbox.editor.lint.lint import findings
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import Snap
from sandbox.level.assembly.build_world import build_world
from sandbox.level.checks import CheckDef
from sandbox.level.document.model import (
    ContactsDef,
    Level,
    NissenMaterial,
    ParticleDef,
    Settings,
    SpringDef,
    TerrainDef,
    WallsDef,
    ZoneDef,
)  # fmt: skip
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.body_def import FirmnessDef
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.kinds.jelly import BoxShape, JellyDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.reading.files import read_level
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.stability import report, spring_loads
from tests.support.pools import pool
from tests.support.zoo import zoo

LEVELS = sorted((Path(__file__).resolve().parents[2] / "levels").glob("*.json"))


def level_of(**parts):
    return Level(format="spring-sandbox/level", version=4, name="Lint", **parts)


def found(level):
    return [finding for finding in findings(level, make_scene(level)) if finding is not None]


def texts(level):
    return [finding.text for finding in found(level)]


def rope(name="rope", y=0.0, start=0.0, **fields):
    given = {"segments": 4, "pin": ("start",)} | fields
    return RopeDef(type="rope", id=name, start=(start, y), end=(start + 4.0, y), **given)


def cube(name, x, y, **fields):
    return JellyDef(type="jelly", id=name, shape=BoxShape(box=(1.0, 1.0)), spacing=0.25, position=(x, y), **fields)


def test_an_empty_level_and_a_sound_one_have_no_findings():
    assert texts(empty_level()) == []
    assert texts(level_of(bodies=(rope(),), particles=(ParticleDef(id="weight", position=(4.0, 0.0)),),
                          welds=(("rope.end", "weight"),))) == []  # fmt: skip


@pytest.mark.parametrize("path", LEVELS, ids=lambda path: path.stem)
def test_findings_of_shipped_levels_have_items_that_exist_and_places_in_them(path):
    level = read_level(path)
    left, bottom, right, top = make_scene(level).bounds()
    for finding in found(level):
        assert finding.items <= set(items_of(level))
        assert finding.text[-1] != "." and "\n" not in finding.text
        if finding.place is not None:
            assert left <= finding.place[0] <= right
            assert bottom <= finding.place[1] <= top


def test_of_a_level_with_everything_each_finding_is_one_line_and_about_something():
    lines = found(zoo())
    assert lines
    assert all(finding.items and finding.place for finding in lines)


def test_what_nothing_holds_is_found_and_what_hangs_on_a_pin_is_not():
    level = level_of(bodies=(rope(), rope("loose", 5.0, pin=()), cube("cube", 9.0, 9.0)))
    assert [(finding.severity, finding.items) for finding in found(level)] == [
        ("warning", {Item("body", "loose")}),
        ("warning", {Item("body", "cube")}),
    ]
    hung = level.model_copy(update={"welds": (("loose.start", "rope.2"),)})
    assert [finding.items for finding in found(hung)] == [{Item("body", "cube")}]
    assert texts(level.model_copy(update={"settings": Settings(gravity=(0.0, 0.0))})) == []


def test_a_part_of_several_items_is_one_finding_and_a_part_cut_off_a_body_is_named_by_its_particles():
    joined = level_of(bodies=(cube("cube", 0.0, 0.0),), particles=(ParticleDef(id="ball", position=(0.0, 3.0)),),
                      springs=(SpringDef(a="ball", b="cube.22"),))  # fmt: skip
    (finding,) = found(joined)
    assert finding.items == {Item("body", "cube"), Item("particle", "ball")}
    assert finding.text.startswith('"cube" and what it is joined to, 2 items,')
    (finding,) = found(level_of(bodies=(rope(cut=(2,)),)))
    assert finding.text.startswith('"rope.3" and 1 more will fall')
    assert finding.place == (3.0, 0.0)


def test_a_loose_spring_is_called_by_its_name_or_by_its_ends():
    ends = tuple(ParticleDef(id=name, position=(x, 0.0), pinned=True) for name, x in (("left", 0.0), ("right", 2.0)))
    unnamed, named = SpringDef(a="left", b="right"), SpringDef(a="left", b="right", name="leg")
    lines = texts(level_of(particles=ends, springs=(unnamed, named)))
    assert [line.partition(" does nothing")[0] for line in lines] == [
        'the spring from "left" to "right"', 'the spring "leg"',
    ]  # fmt: skip


def test_findings_of_one_kind_are_one_line_with_all_that_they_hit_and_one_remedy():
    balls = tuple(ParticleDef(id=f"ball {index}", position=(float(index), 0.0)) for index in range(50))
    (line,) = found(level_of(particles=balls))
    assert line.text.startswith("50 things will fall out of sight") and len(line.items) == 50
    mended = line.remedy.edit(Document(level_of(particles=balls))).level
    assert mended.has_contacts and len(mended.terrain) == 1 and texts(mended) == []


def test_a_few_findings_of_one_kind_stand_each_for_itself():
    balls = tuple(ParticleDef(id=f"ball {index}", position=(float(index), 0.0)) for index in range(LISTED))
    assert len(texts(level_of(particles=balls))) == LISTED


def test_pinned_particles_that_hold_nothing_are_deleted_by_one_remedy():
    pins = tuple(ParticleDef(id=f"pin {index}", position=(float(index), 0.0), pinned=True) for index in range(9))
    (line,) = found(level_of(particles=pins))
    assert line.remedy.label == "Delete them"
    assert line.remedy.edit(Document(level_of(particles=pins))).level.particles == ()


def test_springs_and_pins_that_do_nothing_are_found():
    pins = tuple(ParticleDef(id=name, position=(x, 0.0), pinned=True) for name, x in (("a", 0.0), ("b", 1.0)))
    level = level_of(particles=(*pins, ParticleDef(id="nail", position=(5.0, 0.0), pinned=True)),
                     springs=(SpringDef(a="a", b="b"),))  # fmt: skip
    assert [(finding.severity, finding.items, finding.place) for finding in found(level)] == [
        ("hint", {Item("spring", 0)}, (0.5, 0.0)),
        ("hint", {Item("particle", "nail")}, (5.0, 0.0)),
    ]


def test_a_motor_whose_hub_is_fixed_to_nothing_is_found():
    wheel = WheelDef(
        type="wheel", id="w", position=(0.0, 0.0), radius=1.0, thickness=0.3, segments=6, pin=("hub",),
        motor=MotorDef(speed=1.0, torque=5.0),
    )  # fmt: skip
    loose = replaced(wheel, pin=(), pinned=(3,))
    level = level_of(bodies=(loose, rope(y=5.0)))
    assert ['the motor of "w"' in text and "fixed to nothing" in text for text in texts(level)] == [True]
    held = (
        level_of(bodies=(wheel,)),
        replaced(level, springs=(SpringDef(a="rope.end", b="w.hub"),)),
        replaced(level, welds=(("rope.end", "w.hub"),)),
    )
    assert not any("motor" in text for each in held for text in texts(each))


def test_a_motor_that_turns_nothing_that_cannot_climb_or_that_no_solver_carries_is_found():
    def cart(torque, solver="direct", cut=()):
        wheel = WheelDef(
            type="wheel", id="w", position=(0.0, 1.0), radius=1.0, thickness=0.3, segments=6, particle_mass=1.0,
            motor=MotorDef(speed=1.0, torque=torque), cut=cut,
        )  # fmt: skip
        load = ParticleDef(id="load", position=(0.0, 0.5), mass=7.0)
        springs = (SpringDef(a="w.hub", b="load"),)
        ground = TerrainDef(id="ground", polyline=((-9.0, -0.1), (9.0, -0.1)))
        return level_of(
            bodies=(wheel,), particles=(load,), springs=springs, terrain=(ground,), settings=Settings(solver=solver)
        )

    # 20 kg over the corner of a wheel of six: 20 g sin(30 degrees) = 98.1 N m.
    assert not any("motor" in text or "torque" in text for text in texts(cart(99.0)))
    (weak,) = [text for text in texts(cart(97.0)) if "torque" in text]
    assert "97 N m in all, does not lift 20 kg" in weak and "takes 98.1 N m" in weak
    assert any("turns nothing" in text for text in texts(cart(99.0, cut=tuple(range(6)))))
    assert any("single pass solver cannot carry wheels" in text for text in texts(cart(99.0, "single_pass")))
    assert not any("cannot carry" in text for text in texts(cart(99.0, "iterative")))


@pytest.mark.parametrize(
    ("shortest", "longest", "way"),
    [(0.6, 1.5, "0.9 m shorter than it is drawn and pulls"), (2.0, 3.0, "0.5 m longer than it is drawn and pushes")],
)
def test_a_hydraulic_that_begins_at_another_length_than_it_is_drawn_is_found(shortest, longest, way):
    piston = HydraulicDef(shortest=shortest, longest=longest, rate=1.0, key="x")
    ends = tuple(ParticleDef(id=name, position=(x, 0.0), pinned=not x) for name, x in (("nail", 0.0), ("rod", 1.5)))
    spring = SpringDef(a="nail", b="rod", name="piston", hydraulic=piston)
    (finding,) = found(level_of(particles=ends, springs=(spring,)))
    assert finding.text.startswith(f'the spring "piston" begins {way} at once') and finding.items == {Item("spring", 0)}
    if shortest > 1.5:
        assert finding.remedy is None, "it cannot begin as it is drawn"
    else:
        mended = finding.remedy.edit(Document(level_of(particles=ends, springs=(spring,)))).level
        assert mended.springs[0].rest_length == 1.5 and found(mended) == []
    asked = replaced(spring, rest_length=shortest)
    assert found(level_of(particles=ends, springs=(asked,))) == [], "a length of its own is meant so"


def test_particles_that_lie_on_each_other_are_found_until_they_are_joined():
    level = level_of(bodies=(rope(), rope("other", 0.01, start=4.01)))
    (finding,) = found(level)
    assert finding.items == {Item("body", "rope"), Item("body", "other")}
    assert finding.text.startswith('"rope.4" lies on "other.0" and is not joined to it; weld')
    assert finding.place == (4.0, 0.0)
    assert found(weld(Document(level), "rope.end", "other.start").level) == []
    assert found(level.model_copy(update={"springs": (SpringDef(a="rope.end", b="other.start"),)})) == []


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.0249, 0.0249), (0.025, 0.05), (-0.001, 0.049), (7.3, -2.19)])
def test_particles_that_lie_on_each_other_are_found_wherever_the_grid_of_the_search_divides_them(shift):
    x, y = shift
    pair = tuple(ParticleDef(id=name, position=(x + dx, y), pinned=True) for name, dx in (("a", -0.01), ("b", 0.01)))
    assert any('"a" lies on "b"' in text for text in texts(level_of(particles=pair)))


def test_overlaps_are_those_that_comparing_every_pair_finds():
    random = np.random.default_rng(3)
    places = random.uniform(0.0, 0.6, (120, 2)).tolist()
    balls = tuple(ParticleDef(id=str(index), position=tuple(place)) for index, place in enumerate(places))
    level = level_of(particles=balls, settings=Settings(gravity=(0.0, 0.0)))
    apart = np.linalg.norm(np.array(places)[:, None] - np.array(places)[None], axis=2)
    expected = int(np.sum(np.triu(apart <= 0.025, 1)))
    assert expected > LISTED
    last = found(level)[-1]
    assert last.text.startswith(f"{expected} pairs lie on each other")
    assert not any("lie" in text for text in texts(last.remedy.edit(Document(level)).level))


def test_bodies_that_cross_are_found_where_they_cross_and_joined_or_touching_ones_are_left_in_peace():
    still = {"settings": Settings(gravity=(0.0, 0.0))}
    apart = cube("a", 0.0, 0.0), cube("b", 1.0, 0.3)
    assert texts(level_of(bodies=apart, **still)) == []
    (finding,) = found(level_of(bodies=(cube("a", 0.0, 0.0), cube("b", 0.9, 0.6)), **still))
    assert (finding.severity, finding.items) == ("hint", {Item("body", "a"), Item("body", "b")})
    assert 0.4 <= finding.place[0] <= 0.5
    assert 0.1 <= finding.place[1] <= 0.5
    crossing = cube("a", 0.0, 0.0), cube("b", 0.9, 0.6)
    for order in (crossing, crossing[::-1]):
        assert texts(level_of(bodies=order, springs=(SpringDef(a="a.0", b="b.24"),), **still)) == []


def test_crossing_is_found_in_either_order_and_among_many_bodies():
    bodies = tuple(cube(f"c{index}", 2.0 * index, 0.0, pinned=(0,)) for index in range(12))
    across = rope("across", 0.3, start=5.1)
    for order in ((*bodies, across), (across, *bodies)):
        crossed = {frozenset(item.key for item in finding.items) for finding in found(level_of(bodies=order))}
        assert crossed == {frozenset({"across", f"c{index}"}) for index in (3, 4)}


def test_springs_past_the_proven_limit_are_found_by_item_with_what_the_meter_says():
    hard = NissenMaterial(stiffness=1.0, damping=1.0)
    soft = NissenMaterial(stiffness=0.01, damping=0.01)
    deck = BridgeDef(type="bridge", id="deck", start=(0.0, 0.0), end=(4.0, 0.0), segments=4, pin=("start",))
    bodies = deck.model_copy(update={"material": "hard"}), rope(y=5.0, material="soft")
    level = level_of(bodies=bodies, materials={"hard": hard, "soft": soft}, settings=Settings(solver="single_pass"))
    (finding,) = found(level)
    assert (finding.severity, finding.items) == ("warning", {Item("body", "deck")})
    world = build_world(level)
    load = spring_loads(world)
    past = int(np.sum(load[: level.bodies[0].segments * 5 + 1] >= 4.0))
    assert finding.text.startswith(f'{past} springs of "deck" are past')
    assert f"{load.max():.3g} at {world.spring_names[int(np.argmax(load))]}" in finding.text
    assert not report(world).within_limit
    assert texts(level.model_copy(update={"settings": Settings(solver="direct")})) == []


@pytest.mark.parametrize(("coefficient", "is_past"), [(0.66, False), (0.67, True)])
def test_the_limit_is_where_the_meter_has_it(coefficient, is_past):
    materials = {"default": NissenMaterial(stiffness=coefficient, damping=coefficient)}
    level = level_of(bodies=(rope(),), materials=materials, settings=Settings(solver="single_pass"))
    assert bool(texts(level)) == is_past
    assert report(build_world(level)).within_limit != is_past


def test_a_weight_that_is_welded_on_counts_for_the_limit():
    materials = {"default": NissenMaterial(stiffness=0.8, damping=0.8)}
    ball = ParticleDef(id="ball", position=(4.0, 0.0), mass=1000.0)
    level = level_of(bodies=(rope(),), particles=(ball,), welds=(("rope.end", "ball"),), materials=materials,
                     settings=Settings(solver="single_pass"))  # fmt: skip
    (finding,) = found(level)
    load = spring_loads(build_world(level))
    assert f"add up to {load.max():.3g} at" in finding.text
    assert finding.text.startswith(f'{int(np.sum(load >= 4.0))} springs of "rope"')


@pytest.mark.parametrize("substeps", [1, 4])
def test_the_firmness_of_a_body_counts_for_the_limit(substeps):
    settings = Settings(solver="single_pass", substeps=substeps)
    level = level_of(bodies=(cube("firm", 0.0, 2.0, firmness=FirmnessDef(hz=4.0, ratio=0.9)),), settings=settings)
    text, *_ = texts(level)
    assert f"add up to {spring_loads(build_world(level)).max():.3g} at" in text


@pytest.mark.parametrize("path", LEVELS, ids=lambda path: path.stem)
def test_the_lint_and_the_meter_agree_on_shipped_levels_under_the_single_pass(path):
    level = read_level(path)
    level = level.model_copy(update={"settings": level.settings.model_copy(update={"solver": "single_pass"})})
    past = any("is proven to hold" in text for text in texts(level))
    assert past == (report(build_world(level)).within_limit is False)


def test_the_iterative_solver_gets_one_hint_about_the_published_limit():
    material = {"default": NissenMaterial(stiffness=0.6, damping=0.6)}
    level = level_of(bodies=(rope(),), materials=material, settings=Settings(solver="iterative"))
    (finding,) = found(level)
    assert finding.severity == "hint"
    assert "published limit 1/(n+1)" in finding.text
    gentle = {"default": NissenMaterial(stiffness=0.3, damping=0.3)}
    assert texts(level.model_copy(update={"materials": gentle})) == []


CHECKS = {
    "never below 0": CheckDef(name="c", metric="max_strain", at_most=-0.1),
    "no spring breaks": CheckDef(name="c", metric="broken_springs", at_least=1.0),
    "x stays 0": CheckDef(name="c", metric="x", particle="rope.start", at_least=1.0),
    "speed stays 0": CheckDef(name="c", metric="speed", particle="rope.start", at_least=0.5),
    "before the first tick": CheckDef(name="c", metric="y", particle="rope.end", after=0.0, at_most=1.0),
    "says nothing": CheckDef(name="c", metric="y", particle="rope.start", at_most=1.0),
}


@pytest.mark.parametrize("words", CHECKS)
def test_a_check_that_cannot_hold_or_says_nothing_is_found(words):
    (finding,) = found(level_of(bodies=(rope(),), checks=(CHECKS[words],)))
    assert words in finding.text
    assert finding.severity == ("hint" if words in ("before the first tick", "says nothing") else "warning")


def test_checks_that_contradict_each_other_are_found_and_ones_that_do_not_are_left_in_peace():
    def checks(least):
        return (
            CheckDef(name="low", metric="y", particle="rope.end", at_most=1.0),
            CheckDef(name="high", metric="y", particle="rope.end", at_least=least),
        )

    (finding,) = found(level_of(bodies=(rope(),), checks=checks(2.0)))
    assert 'Check "high" contradicts check "low"' in finding.text
    assert found(level_of(bodies=(rope(),), checks=checks(0.5))) == []


def test_connected_parts_are_what_springs_and_welds_join():
    level = level_of(bodies=(rope(), rope("b", 5.0), rope("c", 9.0)), welds=(("rope.end", "c.2"),))
    work = connected_parts(make_scene(level))
    pauses = 0
    try:
        while True:
            next(work)
            pauses += 1
    except StopIteration as end:
        part = end.value
    assert part.tolist() == [0] * 5 + [5] * 5 + [0] * 5
    assert pauses > 0


def test_a_large_level_is_searched_in_many_slices():
    bodies = tuple(cube(f"c{index}", 1.01 * (index % 20), 1.01 * (index // 20)) for index in range(200))
    level = level_of(bodies=bodies)
    assert sum(finding is None for finding in findings(level, make_scene(level))) > 200


def test_the_tools_draw_nothing_that_the_lint_complains_about():
    document = Document(empty_level())
    for index, tool in enumerate(("rope", "bridge", "girder", "web")):
        drawing = TOOLS[tool].drawing()
        drawing.down(Snap((0.0, 10.0 * index)))
        drawing.up(Snap((3.0, 10.0 * index)))
        document = drawing.done(document)
    assert texts(document.level) == []


GROUND = TerrainDef(id="ground", polygon=((-9.0, -3.0), (9.0, -3.0), (9.0, 0.0), (-9.0, 0.0)))


def test_what_starts_inside_the_ground_is_found_and_its_remedy_takes_it_out():
    ball = ParticleDef(id="ball", position=(2.0, -0.5), radius=0.3)
    level = level_of(terrain=(GROUND,), particles=(ball,), bodies=(cube("box", 0.0, -0.25),))
    buried = [finding for finding in found(level) if "inside" in finding.text]
    assert [finding.text for finding in buried] == [
        '"box" starts with 15 of 25 particles inside "ground", and will be pushed out; move it',
        '"ball" starts inside "ground", and will be pushed out; move it',
    ]
    document = Document(level)
    for finding in buried:
        document = finding.remedy.edit(document)
    assert not any("inside" in text for text in texts(document.level))
    position = make_scene(document.level).position
    assert (position[:, 1] >= 0.0).all() and position[:, 1].min() < 0.1


def test_what_rests_on_the_ground_is_held_in_it_or_does_not_touch_it_is_left_in_peace():
    resting = ParticleDef(id="rest", position=(2.0, 0.1), radius=0.2)
    nail = ParticleDef(id="nail", position=(3.0, -1.0), pinned=True)
    ghost = ParticleDef(id="ghost", position=(4.0, -1.0), collides=False)
    level = level_of(terrain=(GROUND,), particles=(resting, nail, ghost), springs=(SpringDef(a="nail", b="rest"),))
    assert not any("inside" in text for text in texts(level))
    assert [text for text in texts(level) if "fall" in text] == [text for text in texts(level) if "ghost" in text]


def test_beyond_the_walls_is_found_and_moved_in():
    level = level_of(walls=WallsDef(box=(-1.0, -1.0, 1.0, 1.0)), particles=(ParticleDef(id="p", position=(3.0, 0.5)),))
    (finding,) = found(level)
    assert "beyond the walls" in finding.text
    inside = finding.remedy.edit(Document(level)).level
    assert texts(inside) == [] and 0.9 < inside.particles[0].position[0] < 1.0


def test_what_falls_on_a_bridge_that_it_touches_does_not_fall_away():
    bridge = RopeDef(type="rope", id="deck", start=(-2.0, 0.0), end=(2.0, 0.0), segments=4, pin=("start", "end"))
    above, beside = ParticleDef(id="above", position=(0.5, 3.0)), ParticleDef(id="beside", position=(4.0, 3.0))
    below = ParticleDef(id="below", position=(0.5, -3.0))
    ghost = ParticleDef(id="ghost", position=(0.5, 3.5), collides=False)
    level = level_of(contacts=ContactsDef(), bodies=(bridge,), particles=(above, beside, below, ghost))
    assert [text.split()[0] for text in texts(level)] == ['"beside"', '"below"', '"ghost"']


def test_what_terrain_lies_below_does_not_fall_away_and_what_it_lies_beside_does():
    drops = (ParticleDef(id="above", position=(0.0, 5.0)), ParticleDef(id="beside", position=(20.0, 5.0)))
    floats = ParticleDef(id="floats", position=(30.0, 5.0), gravity_scale=0.0)
    (falls,) = texts(level_of(terrain=(GROUND,), particles=(*drops, floats)))
    assert falls.startswith('"beside" will fall')
    upward = level_of(terrain=(GROUND,), particles=drops, settings=Settings(gravity=(0.0, 9.81)))
    assert len(texts(upward)) == 2


def test_what_sinks_in_a_pool_is_found_and_what_floats_is_not():
    box = {"bodies": (cube("slab", 0.0, 1.0),), "zones": (ZoneDef(id="pool", box=(-5.0, -5.0, 5.0, 0.0), water={}),)}
    (finding,) = found(level_of(**box))
    assert finding.text == '"slab" would sink in "pool": its water bears 40% of the weight; make it lighter'
    assert finding.items == {Item("body", "slab")}
    light = replaced(box["bodies"][0], particle_mass=0.1)
    assert texts(level_of(**box | {"bodies": (light,)})) == []


def test_boxes_on_each_other_overlap_in_one_line_of_the_level():
    boxes = tuple(cube(f"box {k}", 0.0, 0.55 + k) for k in range(6))
    (finding,) = [each for each in found(level_of(bodies=boxes, terrain=(GROUND,), contacts=ContactsDef()))
                  if "overlap" in each.text]  # fmt: skip
    assert finding.text.startswith("5 pairs of bodies overlap at the start, by up to 0.1 m (")
    assert finding.severity == "hint" and finding.items == {Item("body", box.id) for box in boxes}


def test_discs_that_overlap_are_found_where_they_touch_and_nothing_joins_them():
    pair = [ParticleDef(id=name, position=(x, 0.0), radius=0.5) for name, x in (("a", 0.0), ("b", 0.4))]
    level = level_of(particles=tuple(pair), contacts=ContactsDef(), settings=Settings(gravity=(0.0, 0.0)))
    assert ["overlap at the start" in text for text in texts(level)] == [True]
    others = (
        replaced(level, contacts=None),
        replaced(level, springs=(SpringDef(a="a", b="b"),)),
        replaced(level, particles=(pair[0], replaced(pair[1], collides=False))),
        replaced(level, particles=(pair[0], replaced(pair[1], position=(0.95, 0.0)))),
    )
    assert [text for each in others for text in texts(each)] == []


def test_discs_that_turn_in_vain_or_shake_heaps_are_found():
    ball = ParticleDef(id="a", radius=0.5, spin=3.0, pinned=True)
    level = level_of(particles=(ball,), contacts=ContactsDef(), settings=Settings(gravity=(0.0, 0.0)))
    assert ["its spin of 3 rad/s is lost" in text for text in texts(level)] == [True]
    for changes in ({"spin": 0.0}, {"pinned": False}):
        assert texts(replaced(level, particles=(replaced(ball, **changes),))) == []
    rough = ParticleDef(id="a", radius=0.5, rolling=0.06)
    assert ["rolling resistance of 0.06" in text for text in texts(replaced(level, particles=(rough,)))] == [True]
    for changes in ({"rolling": 0.05}, {"rolls": False}):
        assert texts(replaced(level, particles=(replaced(rough, **changes),))) == []


def test_bodies_that_cross_are_pushed_apart_where_they_touch_each_other():
    level = level_of(bodies=(cube("a", 0, 0, pinned=(0,)), cube("b", 0.6, 0.6, pinned=(0,))))
    (finding,) = found(level)
    assert finding.severity == "hint" and "pass through" in finding.text
    (finding,) = found(replaced(level, contacts=ContactsDef()))
    assert finding.severity == "warning" and "pushed apart" in finding.text
    apart = tuple(replaced(body, collides=()) for body in level.bodies)
    (finding,) = found(replaced(level, contacts=ContactsDef(), bodies=apart))
    assert "pass through" in finding.text


def column(height, stiffness, damping, width=1.0, **fields):
    box = JellyDef(
        type="jelly", id="tower", shape=BoxShape(box=(width, height)), spacing=width / 4, position=(0.0, height / 2),
        **fields,
    )  # fmt: skip
    return level_of(bodies=(box,), materials={"default": NissenMaterial(stiffness=stiffness, damping=damping)})


def buckling(level):
    return [text for text in texts(level) if "buckles" in text]


def test_a_column_of_jelly_that_is_taller_than_it_can_stand_is_found():
    # 3.7 m by hand, from the sag of a column of this mesh: E A = 2 sag / (q H^2), q H^3 = 7.84 E A w^2 / 12.
    (text,) = buckling(column(6.0, 0.5, 0.9))
    assert text == (
        '"tower" is 6 m tall, and a column of this jelly buckles above 3.8 m; make it firmer, wider or lower'
    )
    assert not buckling(column(3.5, 0.5, 0.9))
    assert not buckling(column(6.0, 0.9, 0.99))
    # As high as the cube root of the stiffness, and of the width squared and the width's masses.
    assert not buckling(column(6.0, 0.5, 0.9, width=2.5))
    assert not buckling(column(6.0, 1.0, 1.0))
    assert not buckling(column(6.0, 0.5, 0.9, pinned=(0,)))


def test_a_column_of_jelly_boxes_that_lie_on_one_another_is_found_as_one():
    boxes = [cube(f"box {k}", 0.05 * (k % 2), 0.5 + 1.02 * k) for k in range(6)]
    materials = {"default": NissenMaterial(stiffness=0.5, damping=0.9)}
    touching = {"bodies": (*boxes, cube("aside", 4.0, 0.5)), "materials": materials, "contacts": ContactsDef()}
    (text,) = buckling(level_of(**touching))
    assert text == (
        'the column of 6 bodies on "box 0" is 6 m tall, and a column of this jelly buckles above 3.6 m; '
        "make them firmer or wider, or take some off"
    )
    assert not buckling(level_of(bodies=tuple(boxes[:3]), materials=materials, contacts=ContactsDef()))
    # They fall through one another.
    assert not buckling(level_of(bodies=tuple(boxes), materials=materials))
    apart = tuple(cube(f"box {k}", 0.0, 0.5 + 2.5 * k) for k in range(6))
    assert not buckling(level_of(bodies=apart, materials=materials, contacts=ContactsDef()))


def test_what_is_over_water_does_not_fall_for_ever_and_water_in_water_is_told():
    ball = {"id": "ball", "position": [0, 2], "mass": 0.1, "radius": 0.2}
    pools = [pool((-5, -5, 5, 0)), pool((3, -5, 9, -1)) | {"id": "other"}, pool((9, -5, 12, 0)) | {"id": "beside"}]
    head = {"format": "spring-sandbox/level", "version": 4, "name": "w", "particles": [ball]}
    for zones, lines in (
        ([], ["ball"]),
        (pools[:1], []),
        (pools, ['the water of "pool" and "other" overlaps, and lifts twice there; part them']),
    ):
        level = parse_level(json.dumps(head | {"zones": zones}).encode(), "w")
        found = [each.text for each in findings(level, make_scene(level)) if each is not None]
        assert len(found) == len(lines) and all(line in text for line, text in zip(lines, found, strict=True))


def test_a_goal_that_lets_hands_do_everything_is_found_and_a_remedy_lets_them_only_pull():
    asks = {"metric": "y", "particle": "ball", "at_least": 5}
    data = {
        "format": "spring-sandbox/level", "version": 3, "name": "Open", "settings": {"gravity": [0, 0]},
        "particles": [{"id": "ball", "position": [0, 0]}],
        "rules": [{"id": "goal", "when": asks, "then": [{"win": "Up!"}]}],
    }  # fmt: skip
    for hands in (None, {}, {"bodies": ["ball"]}):
        level = parse_level(json.dumps(data | ({} if hands is None else {"hands": hands})).encode(), "open")
        (finding,) = [each for each in found(level) if each.text.startswith("Whoever pauses")]
        mended = finding.remedy.edit(Document(level)).level
        assert mended.hands.may == ("grab",) and mended.hands.bodies == (level.hands and level.hands.bodies)
        assert not [text for text in texts(mended) if text.startswith("Whoever pauses")]
