"""Bodies join, leave and are pushed while a level runs: the physics, undo, recordings, names, and what is refused."""

import json

import numpy as np
import pytest

from sandbox.cli import main
from sandbox.physics.marks import ALL_GROUPS
from sandbox.physics.snapshot import state_hash
from sandbox.physics.solvers import SOLVERS
from sandbox.session.commands import (
    AddBody,
    AddParticle,
    AddSpring,
    CommandError,
    Grab,
    Push,
    Remove,
    SetDrive,
    SetFirmness,
    SetInflation,
    apply,
)
from sandbox.session.compare.comparison import verify
from sandbox.session.probe import Probe, dump
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.parts import BODIES, SKIN, RandomPlayer, furnished, placed, placed_cart, room


def run(session, ticks):
    for _ in range(ticks):
        session.advance()
    return session


def momentum(world):
    return (world.mass[:, None] * world.velocity)[world.inverse_mass > 0.0].sum(axis=0)


def places_of(world, body):
    slots = [slot for slot, name in enumerate(world.particle_names) if name.startswith(f"{body}.")]
    return world.position[slots]


@pytest.mark.parametrize("solver", sorted(SOLVERS))
@pytest.mark.parametrize("kind", BODIES)
def test_a_body_that_joins_moves_as_one_that_the_level_has(kind, solver):
    own = placed(BODIES[kind], 0.1, 0.8, (1.0, -2.0))
    there = Session(room(solver, own | {"id": "own"}))
    joined = Session(room(solver))
    joined.submit(AddBody(own))
    touched = 0
    for _ in range(25):
        run(there, 1)
        run(joined, 1)
        touched += len(there.world.contact_particle)
    assert touched
    assert np.array_equal(places_of(there.world, "own"), places_of(joined.world, "+1"))


def test_a_cart_joins_with_axles_and_motors_and_passes_through_itself_alone():
    session = Session(furnished())
    session.submit(AddBody(**placed_cart(0.0, 0.5)))
    run(session, 30)
    world = session.world
    assert world.actuators.names == ("mill", "+2", "+3")
    frame, wheel = world.particle_slot("+1.2"), world.particle_slot("+2.7")
    assert not world.collides[frame] & world.group[wheel]
    assert world.collides[world.particle_slot("cube.0")] & world.group[wheel]
    before = places_of(world, "+1")[:, 0].mean()
    for part in (1, 2):
        session.submit(SetDrive(part, -1.0))
    run(session, 60)
    assert places_of(world, "+1")[:, 0].mean() > before + 0.5
    assert world.particle_slot("+1.0") == world.particle_slot("+2.hub")


@pytest.mark.parametrize("solver", sorted(SOLVERS))
def test_a_push_gives_what_is_near_its_impulse_and_nothing_else_any(solver):
    session = run(Session(furnished(solver)), 5)
    world = session.world
    before, far = momentum(world), world.velocity[world.particle_slot("ball")].copy()
    apply(world, Push((-2.0, 0.5), 1.5, (3.0, 4.0)))
    assert momentum(world) - before == pytest.approx((3.0, 4.0), rel=1e-12)
    assert np.array_equal(world.velocity[world.particle_slot("ball")], far)
    x, y = world.position[world.particle_slot("ball")].tolist()
    # From below it goes straight up.
    apply(world, Push((x, y - 0.1), 0.5, outward=6.0))
    assert world.velocity[world.particle_slot("ball")] - far == pytest.approx((0.0, 6.0))


@pytest.mark.parametrize("solver", sorted(SOLVERS))
def test_what_touches_nothing_can_go_and_leaves_the_others_bits(solver):
    bodies = placed(BODIES["rope"], 0.5, 4) | {"id": "rope"}, placed(BODIES["jelly"], -2, 0.5) | {"id": "cube"}
    level = room(solver, *bodies)
    stays, goes = run(Session(level), 20), run(Session(level), 20)
    goes.submit(Remove(body="rope"))
    run(stays, 30)
    run(goes, 30)
    assert len(stays.world.contact_particle)
    assert np.array_equal(places_of(stays.world, "cube"), places_of(goes.world, "cube"))
    assert not goes.world.particle_active[goes.world.particle_slot("rope.start")]


def test_removing_by_particle_takes_what_hangs_on_it_and_lets_hands_go():
    session = Session(furnished())
    world = session.world
    rope = world.particle_slot("rope.2")
    apply(world, Grab(0, rope, (1.0, 3.0)))
    apply(world, Remove(particle=rope))
    assert not world.is_held(0)
    assert not world.particle_active[[world.particle_slot(f"rope.{k}") for k in range(5)]].any()
    with pytest.raises(CommandError, match="there is no particle"):
        apply(world, Remove(particle=rope))
    with pytest.raises(CommandError, match="rope is removed already"):
        apply(world, Remove(body="rope"))
    with pytest.raises(CommandError, match="there is no body 'cubes'; did you mean \"cube\""):
        apply(world, Remove(body="cubes"))
    apply(world, Remove(body="cube"))
    assert not world.constraint_active.any()
    run(session, 5)


def test_welded_bodies_leave_one_by_one():
    session = Session(room())
    session.submit(AddBody(**placed_cart(0.0, 1.0)))
    run(session, 2)
    session.submit(Remove(body="+2"))
    run(session, 2)
    world = session.world
    assert world.particle_active[world.particle_slot("+2.hub")], "the frame's own corner"
    assert not world.particle_active[world.particle_slot("+2.1")]
    session.submit(Remove(particle=world.particle_slot("+3.1")))
    run(session, 2)
    assert not world.particle_active[: world.grab_particle].any() or not places_of(world, "+1").size
    assert not [name for name, there in zip(world.particle_names, world.particle_active, strict=True) if there]


def test_undo_and_redo_across_what_joined_give_the_same_bits_and_names(tmp_path):
    session = Session(furnished())
    session.record_to(tmp_path / "run.replay.gz")
    run(session, 5)
    session.submit(AddParticle((0.0, 5.0), velocity=(1.0, 0.0), restitution=0.5))
    session.submit(AddBody(**placed_cart(0.0, 2.0)))
    run(session, 6)
    session.submit(AddBody(placed(BODIES["ring"], 1.0, 4.0)))
    session.submit(AddSpring(session.world.particle_slot("+.0"), session.world.particle_slot("cube.0")))
    run(session, 4)
    session.submit(SetInflation(session.world.area_names.index("+4"), 1.5))
    session.submit(Remove(body="cube"))
    run(session, 10)
    before, names = state_hash(session.world), list(session.world.particle_names)
    for act in (session.undo, session.redo):
        for _ in range(4):
            act()
        session.apply_pending()
    assert state_hash(session.world) == before and session.world.particle_names == names
    for _ in range(5):
        session.undo()
    session.apply_pending()
    assert session.world.particle_names[-1] == "+.0" and session.world.area_names == ("cube",)
    for _ in range(5):
        session.redo()
    run(session, 5)
    session.stop_recording()
    assert not session.messages
    assert verify(read_replay(tmp_path / "run.replay.gz")) is None
    session.seek(10)
    assert [joined.names for joined in session.world.joined] == [("+1", "+2", "+3")]
    session.seek(3)
    assert not session.world.joined
    session.seek(session.last_tick)
    assert session.world.particle_slot("+4.0") > session.world.particle_slot("+3.1")


def test_a_recording_is_verified_from_a_state_that_bodies_have_joined(tmp_path):
    session = Session(room())
    session.record_to(tmp_path / "run.replay.gz", state_ticks=60)
    session.submit(AddParticle((0.0, 5.0)))
    session.submit(AddBody(placed(BODIES["jelly"], 2, 1) | {"material": "skin"}, materials=SKIN))
    session.submit(AddBody(**placed_cart(0.0, 3.0)))
    run(session, 70)
    session.submit(SetDrive(1, 1.0))
    session.submit(SetFirmness(0, sag=0.2))
    session.submit(Grab(0, session.world.particle_slot("+3.hub"), (1.0, 1.0)))
    session.submit(AddBody(placed(BODIES["rope"], 0, 4)))
    run(session, 20)
    session.stop_recording()
    replay = read_replay(tmp_path / "run.replay.gz")
    assert verify(replay) is None and verify(replay, start=60) is None
    again = Session(replay.level, script=replay.script, start=replay.state(60))
    assert again.world.particle_names == session.world.particle_names[: len(again.world.particle_names)]
    assert again.world.material_names == ("default", "skin") and again.world.actuators.names == ("+3", "+4")


def faults_of(world, **definition):
    before, names = state_hash(world), world.particle_names.copy()
    with pytest.raises(CommandError) as raised:
        apply(world, AddBody(**definition))
    assert state_hash(world) == before and world.particle_names == names and not world.joined
    return raised.value.faults


def test_a_bad_definition_is_refused_with_a_line_for_each_fault_and_changes_nothing():
    world = Session(furnished()).world
    jelly = BODIES["jelly"]
    assert faults_of(world, body={"type": "jello"}) == [
        'add_body: body.type: "jello" is not a kind of body; use rope, bridge, girder, web, wheel, ring, jelly or mesh'
    ]
    assert faults_of(world, body=jelly | {"spacing": 0, "material": 7, "shape": {"box": [1, -1]}}) == [
        "add_body: body.material: 7 is not text in quotes",
        "add_body: body.shape.box.1: -1 is not above 0",
        "add_body: body.spacing: 0 is below the limit 1e-06",
    ]
    assert faults_of(world, body=jelly | {"material": "oak"}) == ['add_body: body.material: there is no material "oak"']
    assert faults_of(world, body=jelly | {"collides": ["water"]}) == [
        'add_body: body.collides.0: the level has no group "water"'
    ]
    assert faults_of(world, body=jelly, materials={"default": {"stiffness": 0.1}}) == [
        "add_body: materials.default: is another material here; leave it out, or give it another name"
    ]
    cart = placed_cart(0, 0)
    assert faults_of(world, **cart | {"welds": (("frame.0", "cube.1"),)}) == [
        'add_body: welds.0.1: there is no body or particle "cube"'
    ]
    assert faults_of(world, **cart | {"others": ({**cart["others"][0], "radius": 0.1},), "welds": ()}) == [
        "add_body: others.0.thickness: 0.15 is not below the radius, 0.1"
    ]
    assert len(faults_of(world, body={"type": "rope", "start": [0, 0], "end": [1, 0], "segments": 200_000})) == 1


def test_names_reach_probes_dumps_and_the_command_line(tmp_path, capsys):
    session = Session(furnished())
    probe = Probe(session.world, ["+1.0", "+2", "+.0", "ball"])
    session.submit(AddBody(**placed_cart(0.0, 2.0)))
    session.submit(AddParticle((0.0, 5.0)))
    session.apply_pending()
    session.world.tick += 1
    probe.take(session.world)
    head, before, after = (line.split(",") for line in probe.table().splitlines())
    assert head[2:9] == ["+1.0.x", "+1.0.y", "+1.0.vx", "+1.0.vy", "+2.torque", "+2.share", "+.0.x"]
    assert before[2:8] == [""] * 6 and after[2:4] == ["-0.8", "2.0"]
    found = dump(session.world)
    assert found["particles"]["+1.0"]["position"] == [-0.8, 2.0] and "+3" in found["motors"]
    lines = [{"tick": 2, "command": {"type": "add_body", "body": BODIES["rope"]}},
             {"tick": 3, "command": {"type": "add_body", "body": {"type": "rope", "segments": 0}}}]  # fmt: skip
    script = tmp_path / "script.jsonl"
    script.write_text("\n".join(map(json.dumps, lines)))
    assert main(["run", "rope", "--ticks", "5", "--commands", str(script)]) == 2
    told = [line for line in capsys.readouterr().err.splitlines() if "tick" in line]
    assert [line.rpartition("body.")[2] for line in told] == [
        "start: is missing; it has no default",
        "end: is missing; it has no default",
        "segments: 0 is below the limit 1",
    ]
    assert all(f"{script}: tick 3: line 2: add_body: " in line for line in told)


def test_what_joins_a_level_without_contacts_touches_nothing_as_all_else_in_it():
    level = room(contacts=None, walls=None)
    session = Session(level)
    session.submit(AddBody(BODIES["jelly"]))
    session.submit(AddParticle((0.0, 0.1)))
    run(session, 2)
    assert not session.world.has_contacts
    assert Session(room()).world.surface.collides == ALL_GROUPS


@pytest.mark.parametrize("seed", range(3))
def test_random_sessions_with_parts_verify(seed, tmp_path):
    session = Session(furnished(sorted(SOLVERS)[seed % 3]))
    player = RandomPlayer(session, seed)
    session.record_to(tmp_path / "run.replay")
    for _ in range(40):
        player.act()
        session.advance()
    session.stop_recording()
    assert verify(read_replay(tmp_path / "run.replay")) is None
