"""Weights in the panel: mass of the whole and density, to read and to set, and how deep things lie in water."""

import math

import pytest

from sandbox.editor.document import Document, EditError
from sandbox.editor.items import Item
from sandbox.editor.panel.properties import properties
from sandbox.level.document.model import ContactsDef, Level, ParticleDef, ZoneDef
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.jelly import BoxShape, JellyDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.kinds.wheel import WheelDef

RAFT = JellyDef(type="jelly", id="raft", shape=BoxShape(box=(2.5, 0.5)), spacing=0.25, position=(0.0, 1.0))
ROPE = RopeDef(type="rope", id="rope", start=(20.0, 5.0), end=(24.0, 5.0), segments=4, pin=("start",), end_mass=3.0)
WHEEL = WheelDef(type="wheel", id="wheel", position=(9.0, 9.0), radius=1.0, thickness=0.3, segments=8, hub_mass=4.0)
BALL = ParticleDef(id="ball", position=(5.0, 5.0), radius=0.5, mass=2.0)
POOL = ZoneDef(id="pool", box=(-8.0, -8.0, 8.0, 0.0), water={})
LEVEL = Level(format="spring-sandbox/level", version=4, name="Weights", bodies=(RAFT, ROPE, WHEEL), particles=(BALL,),
              zones=(POOL,), contacts=ContactsDef())  # fmt: skip


def chosen(*ids):
    kinds = {"ball": "particle"}
    return Document(LEVEL, frozenset(Item(kinds.get(name, "body"), name) for name in ids))


def found(document):
    return {each.field: each for section in properties(document) for each in section.properties}


def body(document, name):
    return next(body for body in document.level.bodies if body.id == name)


@pytest.mark.parametrize("name", ["raft", "rope", "wheel"])
def test_the_mass_of_the_whole_is_that_of_all_particles_and_setting_it_keeps_their_shares(name):
    document = chosen(name)
    shown = found(document)["weight.mass"]
    before = expansion(body(document, name)).mass
    assert shown.value == before.sum()
    after = expansion(body(shown.set(document, 7.0), name)).mass
    assert after.sum() == pytest.approx(7.0, rel=1e-11)
    assert after / after.sum() == pytest.approx(before / before.sum())
    assert found(shown.set(document, 7.0))["weight.mass"].value == 7.0


def test_density_is_mass_by_what_water_cannot_enter_and_sets_the_mass():
    assert found(chosen("raft"))["weight.density"].value == pytest.approx(33.0 / 1.25, rel=1e-5)
    assert found(chosen("ball"))["weight.density"].value == pytest.approx(2.0 / (math.pi * 0.25), rel=1e-5)
    document = found(chosen("raft"))["weight.density"].set(chosen("raft"), 4.0)
    assert found(document)["weight.mass"].value == pytest.approx(5.0)
    both = found(chosen("raft", "ball"))["weight.density"].set(chosen("raft", "ball"), 4.0)
    assert found(both)["weight.density"].value == pytest.approx(4.0)
    assert both.level.particles[0].mass == pytest.approx(math.pi)


def test_the_panel_says_whether_a_body_floats_and_how_deep_and_nothing_of_what_is_in_no_water():
    assert found(chosen("raft"))["weight.floats"].value == "sinks: 38% is borne"
    light = found(chosen("raft"))["weight.density"].set(chosen("raft"), 6.0)
    assert found(light)["weight.floats"].value == "floats, 0.30 m under"
    assert "weight.floats" not in found(chosen("rope"))


def test_a_mass_that_no_particle_can_have_is_refused_in_a_line():
    for value in (0.0, -1.0, 1e300):
        with pytest.raises(EditError, match=r"^Whole mass: .* the old value stays$"):
            found(chosen("raft"))["weight.mass"].set(chosen("raft"), value)
