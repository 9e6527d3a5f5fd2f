"""Forecast: where things will hang."""

import math

import numpy as np
import pytest

from sandbox.editor.forecast import Forecast
from sandbox.editor.items import Item
from sandbox.editor.scene import make_scene
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import (
    HookeMaterial,
    Level,
    NissenMaterial,
    ParticleDef,
    Settings,
    SpringDef,
    TerrainDef,
)
from sandbox.level.format.actuator_defs import MotorDef, MuscleDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.jelly import BoxShape, JellyDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.physics.step import step

STEEL = NissenMaterial(stiffness=1.0, damping=1.0)


def level_of(**parts):
    return Level(format="spring-sandbox/level", version=4, name="Forecast", materials={"steel": STEEL}, **parts)


def finished(level):
    forecast = Forecast(level)
    assert forecast.position is None
    while not forecast.advance(1.0):
        pass
    return forecast


def rope(**fields):
    given = {"segments": 20, "pin": ("start",), "material": "steel"} | fields
    return RopeDef(type="rope", id="rope", start=(0.0, 0.0), end=(3.0, 0.0), **given)


@pytest.mark.parametrize("solver", ["direct", "iterative"])
def test_a_rope_held_at_one_end_will_hang_straight_down(solver):
    forecast = finished(level_of(bodies=(rope(),), settings=Settings(solver=solver)))
    assert forecast.at_rest
    assert np.max(np.abs(forecast.position[:, 0])) < 0.05
    assert forecast.position[-1, 1] == pytest.approx(-3.0, rel=0.05)


def test_a_slack_rope_between_two_pins_will_hang_in_a_catenary():
    forecast = finished(level_of(bodies=(rope(pin=("start", "end"), rest_length=0.165),)))
    # 3.3 m of chain over 3 m: 2 a sinh(1.5 / a) = 3.3, sag a (cosh(1.5 / a) - 1).
    low, high = 0.5, 20.0
    for _ in range(60):
        a = (low + high) / 2.0
        low, high = (a, high) if 2.0 * a * math.sinh(1.5 / a) > 3.3 else (low, a)
    sag = a * (math.cosh(1.5 / a) - 1.0)
    assert forecast.position[10] == pytest.approx((1.5, -sag), abs=0.02)


def test_a_part_behind_a_weld_is_a_part_of_its_own():
    other = rope().model_copy(update={"id": "other", "pin": ()})
    ball = ParticleDef(id="ball", position=(9.0, 0.0), pinned=True)
    level = level_of(bodies=(rope(), other), particles=(ball,), welds=(("rope.end", "other.end"),))
    forecast = finished(level)
    assert forecast.at_rest
    assert forecast.position[-1] == pytest.approx((9.0, 0.0))


def test_playing_from_the_forecast_moves_nothing():
    level = level_of(bodies=(rope(pin=("start", "end"), rest_length=0.165),))
    forecast = finished(level)
    world = build_world(level)
    count = len(forecast.position)
    world.position[:count] = forecast.position
    for _ in range(300):
        step(world)
    assert np.max(np.abs(world.position[:count] - forecast.position)) < 0.02


def test_what_balances_on_its_head_will_fall_over():
    particles = (ParticleDef(id="foot", pinned=True), ParticleDef(id="head", position=(0.0, 1.0)))
    springs = (SpringDef(a="foot", b="head", material="steel"),)
    forecast = finished(level_of(particles=particles, springs=springs))
    assert forecast.position[1] == pytest.approx((0.0, -1.0), abs=0.02)


def test_what_nothing_holds_is_named_and_stays_as_drawn_and_the_rest_is_forecast():
    cube = JellyDef(type="jelly", id="cube", shape=BoxShape(box=(1.0, 1.0)), spacing=0.5, position=(9.0, 9.0))
    level = level_of(bodies=(cube, rope()))
    forecast = finished(level)
    assert forecast.falling == {Item("body", "cube")}
    assert "cube" in forecast.text
    scene = make_scene(level)
    assert np.array_equal(forecast.position[:9], scene.position[:9])
    assert forecast.position[-1, 1] < -2.5


def test_welded_particles_are_forecast_in_one_place():
    ball = ParticleDef(id="ball", position=(3.0, 0.0), mass=50.0)
    level = level_of(bodies=(rope(),), particles=(ball,), welds=(("rope.end", "ball"),))
    forecast = finished(level)
    assert len(forecast.position) == 22
    assert forecast.position[20].tolist() == forecast.position[21].tolist()
    assert forecast.position[21, 1] < -2.9


def test_what_blows_up_is_said_not_to_come_to_rest():
    particles = (ParticleDef(id="a", pinned=True), ParticleDef(id="b", position=(1.0, 0.0)))
    level = Level(
        format="spring-sandbox/level",
        version=4,
        name="Blows up",
        settings=Settings(solver="single_pass"),
        materials={"mistuned": HookeMaterial(law="hooke", k=1e5)},
        particles=particles,
        springs=(SpringDef(a="a", b="b", rest_length=0.5, material="mistuned"),),
    )
    forecast = finished(level)
    assert forecast.at_rest is False
    assert forecast.position is None
    assert "blows up" in forecast.text


def test_the_same_level_gets_the_same_forecast_however_it_is_sliced():
    level = level_of(bodies=(rope(),))
    sliced = Forecast(level)
    slices = 0
    while not sliced.advance(0.0):
        slices += 1
    assert slices > 50
    assert np.array_equal(sliced.position, finished(level).position)


def test_an_empty_level_is_at_rest():
    forecast = finished(level_of())
    assert forecast.at_rest
    assert forecast.position.shape == (0, 2)


def test_a_level_of_too_many_moving_particles_is_refused_before_anything_is_built():
    cube = JellyDef(type="jelly", id="cube", shape=BoxShape(box=(7.0, 7.0)), spacing=0.1, pinned=(0,))
    forecast = Forecast(level_of(bodies=(cube,)))
    while not forecast.advance(1.0):
        pass
    assert forecast.position is None
    assert forecast.text == "5,040 particles move, too many for a forecast (4,000); play it to see"
    falling = finished(level_of(bodies=(cube.model_copy(update={"pinned": ()}), rope())))
    assert falling.at_rest


def test_what_drives_itself_has_no_rest_and_what_waits_for_a_key_has():
    wheel = WheelDef(type="wheel", id="w", radius=0.5, thickness=0.2, segments=8, pin=("hub",))
    runs = replaced(wheel, motor=MotorDef(speed=1.0, torque=5.0))
    beats = rope(drive=MuscleDef(amplitude=0.1, period=30))
    for body in (runs, beats):
        forecast = finished(level_of(bodies=(body,)))
        assert forecast.text == f'"{body.id}" is driven, and never comes to rest; play it to see'
    assert finished(level_of(bodies=(replaced(runs, motor=replaced(runs.motor, key="d")),))).at_rest
    assert finished(level_of(bodies=(replaced(beats, drive=MuscleDef(amplitude=0.0, period=30)),))).at_rest


def test_what_falls_onto_the_ground_is_shown_where_it_lies():
    ball = ParticleDef(id="ball", position=(0.1, 1.0), radius=0.25)
    ground = TerrainDef(id="ground", polygon=((-3.0, -1.0), (3.0, -1.0), (3.0, 0.0), (-3.0, 0.0)))
    forecast = finished(level_of(particles=(ball,), terrain=(ground,)))
    assert forecast.at_rest and not forecast.falling
    assert forecast.position[0, 1] == pytest.approx(0.25, abs=0.02)
