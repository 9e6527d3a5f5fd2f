"""Breaks that are reported and repeat; parts driven by commands, with undo, redo, seek, scripts and recordings."""

import json

import numpy as np
import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import CommandError, CutSprings, Grab, MoveGrab, SetAir, SetDrive, SetInflation, apply
from sandbox.session.commands.records import ScriptLine
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay, read_script
from sandbox.session.session import Session
from sandbox.session.summary import run

WHEEL = {"type": "wheel", "id": "w", "position": [0, 6], "radius": 1, "thickness": 0.3, "segments": 6, "pin": ["hub"]}


def busy_level(solver="direct", **changes):
    """A weak bridge under a weight, a wheel with a motor, a hydraulic and a muscle, in wind."""
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Busy",
        "settings": {"solver": solver, "wind": [2, 0], "drag": 0.1},
        "materials": {"steel": {"stiffness": 0.8, "damping": 0.9, "tension_limit": 0.006, "yield_strain": 0.005}},
        "bodies": [
            {"type": "bridge", "id": "deck", "start": [-4, 0], "end": [4, 0], "segments": 12, "material": "steel"}
            | {"pin": ["start", "end"]},
            {**WHEEL, "motor": {"speed": 5, "torque": 200, "key": "d"}},
            {"type": "rope", "id": "worm", "start": [-3, 6], "end": [-5, 6], "segments": 4}
            | {"drive": {"amplitude": 0.2, "period": 20}, "gravity_scale": 0},
        ],
        "particles": [
            {"id": "load", "position": [0, -2], "mass": 60},
            {"id": "p", "position": [3, 6], "pinned": True},
            {"id": "q", "position": [3, 5]},
        ],
        "springs": [
            {"a": "load", "b": "deck.19"},
            {"a": "p", "b": "q", "hydraulic": {"shortest": 1, "longest": 2, "rate": 1, "key": "d"}},
        ],
        **changes,
    }
    return parse_level(json.dumps(data).encode(), "busy")


def advance(session, ticks):
    """Make so many ticks."""
    for _ in range(ticks):
        session.advance()


def test_what_breaks_is_named_once_at_its_tick_and_many_are_counted():
    session = Session(busy_level())
    broken = []
    for _ in range(240):
        session.advance()
        if len(session.world.broken):
            broken.append((session.tick, session.world.broken.tolist()))
    assert broken
    names = session.world.spring_names
    for (tick, slots), line in zip(broken, session.messages, strict=True):
        if len(slots) > 3:
            assert line == f"tick {tick}: {len(slots)} springs broke"
        else:
            assert line.startswith(f"tick {tick}: {names[slots[0]]}") and line.endswith(" broke")
            assert all(names[slot] in line for slot in slots)


def test_going_back_tells_no_break_a_second_time_and_meets_it_at_the_same_tick():
    session = Session(busy_level())
    advance(session, 240)
    told, end = list(session.events), state_hash(session.world)
    session.seek(10)
    assert session.world.spring_active[0]
    session.seek(240)
    assert session.events == told
    assert state_hash(session.world) == end


@pytest.mark.parametrize("solver", ["single_pass", "iterative", "direct"])
def test_a_recording_of_breaks_drives_and_air_verifies_from_every_state(solver, tmp_path):
    session = Session(busy_level(solver))
    session.record_to(tmp_path / "run.replay", state_ticks=60)
    for tick in range(200):
        if tick == 20:
            session.submit(SetDrive(0, 1.0), 500)
            session.submit(SetDrive(1, 0.75), 500)
        if tick == 70:
            session.submit(SetDrive(0, 0.0), 500)
        if tick == 90:
            session.submit(Grab(0, 40, (0.0, 7.0)))
        if tick == 95:
            session.submit(MoveGrab(0, (0.5, 8.0)))
        if tick == 100:
            session.submit(SetAir(wind=(-3.0, 1.0), drag=0.5))
        if tick == 110:
            session.submit(CutSprings((0,)) if session.world.spring_active[0] else SetDrive(0, -1.0))
        session.advance()
    session.stop_recording()
    assert np.count_nonzero(~session.world.spring_active[: session.world.grab_spring]) > 1
    replay = read_replay(tmp_path / "run.replay")
    assert [line.record for line in replay.script][:2] == [
        {"type": "set_drive", "part": "w", "value": 1.0},
        {"type": "set_drive", "part": ":1", "value": 0.75},
    ]
    for start in (0, 60, 120, 180):
        assert verify(replay, start=start) is None


def test_a_divergence_names_the_driven_part(tmp_path):
    session = Session(busy_level())
    session.record_to(tmp_path / "run.replay", state_ticks=60)
    advance(session, 30)
    session.stop_recording()

    def disturb(world):
        if world.tick == 17:
            world.actuator_value[1] = 0.5

    divergence = verify(read_replay(tmp_path / "run.replay"), on_tick=disturb)
    assert (divergence.tick, divergence.array, divergence.index, divergence.name) == (17, "part_value", 1, ":1")


def test_undo_takes_a_drive_back_and_redo_leaves_nothing_driven_that_was_let_go():
    session = Session(busy_level())
    advance(session, 5)
    before = Session(busy_level())
    advance(before, 25)
    session.submit(SetDrive(0, 1.0), 9)
    advance(session, 20)
    assert session.world.actuator_value[0] == 1.0
    session.undo()
    session.apply_pending()
    assert state_hash(session.world) == state_hash(before.world)
    # The key is let go when its gesture is gone already.
    session.submit(SetDrive(0, 0.0), 9)
    session.apply_pending()
    session.redo()
    session.apply_pending()
    assert session.world.velocity[session.world.particle_slot("w.1")].any()
    assert session.world.actuator_value[0] == 0.0
    assert not session.messages or all("broke" in line for line in session.messages)


def test_undo_lets_a_spring_that_a_pull_broke_be_whole_again():
    level = busy_level(particles=[{"id": "load", "position": [0, -2], "mass": 0.1}, {"id": "p"}, {"id": "q"}])
    session = Session(level)
    advance(session, 30)
    assert session.world.spring_active[: session.world.grab_spring].all()
    session.submit(Grab(0, session.world.particle_slot("deck.6"), (0.0, 0.0)), 4)
    session.submit(MoveGrab(0, (0.0, 30.0)), 4)
    advance(session, 60)
    assert not session.world.spring_active[: session.world.grab_spring].all()
    session.undo()
    session.apply_pending()
    assert session.world.spring_active[: session.world.grab_spring].all()


def test_drives_of_nothing_and_beyond_1_are_refused_in_one_line():
    world = Session(busy_level()).world
    for command, text in [
        (SetDrive(2, 1.0), "there is no driven part 2"),
        (SetDrive(0, 1.5), "value: must be less than or equal to 1"),
        (SetAir(drag=-1.0), "drag: must be greater than or equal to 0"),
    ]:
        with pytest.raises(CommandError, match=text):
            apply(world, command)
    session = Session(busy_level(), [ScriptLine(0, 1, {"type": "set_drive", "part": "deck", "value": 1}, 1)])
    with pytest.raises(CommandError, match='there is no driven part "deck"'):
        session.advance()


def test_a_state_with_another_number_of_parts_is_refused(tmp_path):
    session = Session(busy_level())
    session.record_to(tmp_path / "run.replay", state_ticks=60)
    advance(session, 60)
    session.stop_recording()
    replay = read_replay(tmp_path / "run.replay")
    for name in ("part_value", "part_impulse"):
        replay.states[60].arrays[name] = replay.states[60].arrays["mass"]
    with pytest.raises(ValueError, match="where there are 2 driven parts"):
        replay.state(60)


def test_a_run_counts_what_broke():
    session = Session(busy_level())
    summary = run(session, 240)
    assert summary.broken_springs == np.count_nonzero(
        ~session.world.spring_active[: session.world.grab_spring]
    )  # fmt: skip
    assert summary.broken_springs > 0


def test_a_script_drives_a_part_by_its_name(tmp_path):
    file = tmp_path / "drive.jsonl"
    file.write_text('{"tick": 3, "command": {"type": "set_drive", "part": ":1", "value": 1}}\n')
    session = Session(busy_level(), read_script(file))
    advance(session, 33)
    assert session.world.rest_length[session.world.spring_slot(":1")] == pytest.approx(1.5)


def test_a_balloon_and_a_jelly_are_pumped_up_by_commands_that_replay_and_undo(tmp_path):
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Pumped",
        "settings": {"gravity": [0.0, 0.0]},
        "bodies": [
            {"type": "jelly", "id": "cube", "shape": {"box": [1, 1]}, "spacing": 0.5, "position": [3, 0]},
            {"type": "ring", "id": "balloon", "radius": 1.0, "segments": 12},
            {"type": "ring", "id": "hoop", "radius": 1.0, "segments": 12, "inflation": None, "position": [-5, 0]},
        ],
    }
    level = parse_level(json.dumps(data).encode(), "pumped")

    def size(session, body):
        place = session.world.position[[session.world.particle_slot(f"{body}.{k}") for k in range(9)]]
        return np.sqrt(np.sum((place - place.mean(axis=0)) ** 2))

    session = Session(level)
    assert session.world.area_names == ("cube", "balloon")
    session.record_to(tmp_path / "run.replay", state_ticks=60)
    before = {body: size(session, body) for body in ("cube", "balloon", "hoop")}
    session.submit(SetInflation(0, 1.5), 1)
    session.submit(SetInflation(1, 2.0), 2)
    advance(session, 120)
    assert size(session, "cube") > 1.05 * before["cube"]
    assert size(session, "balloon") > 1.05 * before["balloon"]
    assert size(session, "hoop") == before["hoop"]
    session.undo()
    session.apply_pending()
    assert size(session, "cube") > 1.05 * before["cube"]
    assert size(session, "balloon") == pytest.approx(before["balloon"])
    session.stop_recording()
    assert '"type": "set_inflation", "body": "balloon", "value": 2.0' in (tmp_path / "run.replay").read_text()
    assert verify(read_replay(tmp_path / "run.replay")) is None


def test_what_keeps_no_area_is_not_inflated():
    world = Session(busy_level()).world
    with pytest.raises(CommandError, match="there is no body that keeps an area 0"):
        apply(world, SetInflation(0, 1.0))
    session = Session(busy_level(), [ScriptLine(0, 1, {"type": "set_inflation", "body": "deck", "value": 1}, 1)])
    with pytest.raises(CommandError, match='there is no body that keeps an area "deck"'):
        session.advance()
    with pytest.raises(CommandError, match="value: must be less than or equal to 100"):
        apply(world, SetInflation(0, 101.0))
