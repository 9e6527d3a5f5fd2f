"""Contacts by name: who pushes whom, how hard, and when that begins and ends."""

import json

import numpy as np
import pytest

import sandbox
from sandbox import ContactListener, Session, build_world, contacts, step
from sandbox.commands import AddParticle, CutSprings
from sandbox.level.reading.files import load_level, parse_level
from sandbox.level.things.contacts import touching_pairs
from sandbox.physics.snapshot import restore, take


def level_of(**parts):
    data = {"format": "spring-sandbox/level", "version": 3, "name": "Things", "contacts": {"restitution": 0.0}} | parts
    return parse_level(json.dumps(data).encode(), "things")


GROUND = {"id": "ground", "polygon": [[-5, -1], [5, -1], [5, 0], [-5, 0]]}
BALL = {"id": "ball", "position": [0, 1.0], "radius": 0.2, "mass": 2.0}
JELLY = {
    "id": "jelly", "type": "jelly", "shape": {"box": [1, 1]}, "spacing": 0.25, "position": [3, 0.55],
    "firmness": {"sag": 0.05},
}  # fmt: skip


def run(world, ticks, each=lambda world: None):
    for _ in range(ticks):
        step(world)
        each(world)
    return world


def test_what_lies_on_the_ground_pushes_it_downward_by_its_weight_in_each_tick():
    world = run(build_world(level_of(terrain=[GROUND], particles=[BALL], bodies=[JELLY])), 300)
    found = contacts(world)
    assert {each.pair for each in found} == {("ball", "ground"), ("jelly", "ground")}
    for name in ("ball", "jelly"):
        mine = [each for each in found if each.a == name]
        assert all(each.normal == pytest.approx((0.0, -1.0)) and abs(each.point[1]) < 0.02 for each in mine)
        slots = [slot for slot, particle in enumerate(world.particle_names) if particle.partition(".")[0] == name]
        weight = 9.81 * world.mass[slots].sum()
        assert sum(each.impulse for each in mine) * 60 == pytest.approx(weight, rel=0.03)


def test_the_normal_points_from_the_first_name_to_the_second_whichever_of_them_the_step_found():
    balls = [BALL | {"id": "low", "position": [0, 0.2]}, BALL | {"id": "high", "position": [0, 0.65]}]
    for ordered in (balls, balls[::-1]):
        world = run(build_world(level_of(terrain=[GROUND], particles=ordered)), 120)
        (found,) = [each for each in contacts(world) if "ground" not in each.pair]
        upward = 1.0 if found.pair == ("low", "high") else -1.0
        assert found.normal == pytest.approx((0.0, upward), abs=1e-6)
        assert found.pair == tuple(each["id"] for each in ordered)


def test_a_rule_that_asks_for_touches_fires_in_the_tick_in_which_contacts_tell_of_them():
    rule = {"id": "landed", "when": {"touches": ["ground", "jelly"]}, "then": [{"say": "Landed"}]}
    session = Session(level_of(terrain=[GROUND], bodies=[JELLY | {"position": [0, 2]}], rules=[rule]))
    while not touching_pairs(session.world):
        assert session.world.rule_first[0] < 0
        session.advance()
    assert session.world.rule_first[0] == session.tick


def test_a_contact_begins_once_and_ends_when_the_things_are_apart():
    session = Session(level_of(terrain=[GROUND], particles=[BALL]))
    listener, told = ContactListener(), []
    for _ in range(120):
        session.advance()
        events = listener.update(session.world)
        told += [("begin", each.pair) for each in events.begin] + [("end", pair) for pair in events.end]
    assert told == [("begin", ("ball", "ground"))]
    session.world.change("velocity", [0.0, 6.0], 0)
    while not (events := listener.update(session.world)).end:
        assert not events.begin and session.tick < 200
        session.advance()
    assert events.end == (("ball", "ground"),)


def test_a_blow_is_told_with_its_impulse():
    session = Session(level_of(terrain=[GROUND], particles=[BALL | {"restitution": 1.0}]))
    listener, begun = ContactListener(), []
    while not begun:
        speed = -session.world.velocity[0, 1]
        session.advance()
        begun = listener.update(session.world).begin
    assert begun[0].impulse == pytest.approx(2 * 2.0 * speed, rel=0.1)


def test_a_world_that_goes_back_in_time_begins_its_contacts_anew():
    world = build_world(level_of(terrain=[GROUND], particles=[BALL]))
    before, listener = take(world), ContactListener()
    run(world, 60, listener.update)
    restore(world, before)
    assert listener.update(world).end == (("ball", "ground"),)
    begun = []
    run(world, 60, lambda world: begun.extend(listener.update(world).begin))
    assert [each.pair for each in begun] == [("ball", "ground")]
    with pytest.raises(ValueError, match="patience"):
        ContactListener(-1)


def test_walls_pieces_and_what_joined_have_names_too():
    session = Session(level_of(walls={"box": [-4, 0, 4, 5]}, bodies=[JELLY | {"position": [0, 0.6]}]))
    session.submit(AddParticle((-2.0, 0.3), radius=0.2))
    for _ in range(120):
        session.advance()
    assert touching_pairs(session.world) == {("jelly", "walls"), ("+.0", "walls")}
    middle = [
        slot for slot in np.flatnonzero(session.world.spring_active).tolist()
        if session.world.position[[session.world.particle_a[slot], session.world.particle_b[slot]], 0].prod() <= 1e-6
    ]  # fmt: skip
    session.submit(CutSprings(tuple(middle)))
    seen = set()
    for _ in range(240):
        session.advance()
        seen |= touching_pairs(session.world)
    assert seen <= {("jelly", "walls"), ("+.0", "walls"), ("jelly", "jelly"), ("jelly", "+.0")}
    assert ("jelly", "walls") in seen


@pytest.mark.parametrize("name", ["jelly_pile", "marble_mill", "catapult"])
def test_who_asks_for_contacts_changes_no_bit_of_the_run(name):
    asked, plain = Session(load_level(name)), Session(load_level(name))
    listener = ContactListener()
    for _ in range(120):
        asked.advance()
        plain.advance()
        listener.update(asked.world)
        told = {each.pair for each in contacts(asked.world)}
        assert told == touching_pairs(asked.world)
    assert sandbox.state_hash(asked.world) == sandbox.state_hash(plain.world)
    assert told
