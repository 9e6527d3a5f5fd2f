"""A scene, from its file, stands as the run stood that it was taken of, and goes on to the very bits; undo as well."""

import base64
import subprocess
import sys
import zlib

import numpy as np
import pytest

from sandbox.level.reading.files import load_level
from sandbox.physics.snapshot import state_hash
from sandbox.physics.state import BY_STORED, Family
from sandbox.session.commands import (
    AddBody,
    AddParticle,
    CutSprings,
    Grab,
    MoveGrab,
    Pin,
    Release,
    SetFirmness,
    SetGravity,
)
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.scene import SceneTaker, read_about, read_scene, scene_lines
from sandbox.session.session import Session
from tests.support.hostile_scenes import bodies_far_out, resealed

JELLY = {
    "type": "jelly", "position": [0.0, 5.0], "shape": {"box": [0.6, 0.6]}, "spacing": 0.2, "particle_radius": 0.03,
    "firmness": {"sag": 0.1},
}  # fmt: skip
TICKS = 150


def played(level_name):
    """A run in which things were added, cut, pinned, set and held, and one was undone."""
    session = Session(load_level(level_name))
    hand = session.new_gesture()
    free = np.flatnonzero(session.world.inverse_mass > 0.0)[2:6].tolist()
    deeds = {
        5: AddBody(JELLY), 20: AddParticle((0.5, 6.0), radius=0.2), 40: Pin(free[1]), 60: CutSprings((4, 5, 6)),
        80: SetGravity((0.5, -9.0)), 90: Pin(free[2]),
    }  # fmt: skip
    while session.tick < TICKS:
        if session.tick in deeds:
            session.submit(deeds[session.tick])
        if session.tick == 95:
            session.undo()
        if session.tick == 30:
            session.submit(Grab(0, free[0], tuple(session.world.position[free[0]].tolist())), hand)
        elif 30 < session.tick < 70:
            session.submit(MoveGrab(0, tuple((session.world.position[free[0]] + 0.1).tolist())), hand)
        elif session.tick == 70:
            session.submit(Release(0), hand)
        session.advance()
    assert not session.messages
    return session


def through_file(session, path):
    path.write_bytes(b"".join(scene_lines(SceneTaker(session).take(), None)))
    return read_scene(path)[0].session()


def advanced(session, ticks):
    for _ in range(ticks):
        session.advance()
    return state_hash(session.world)


@pytest.mark.parametrize("level", ["jelly_pile", "rope_bridge_jelly"])
def test_a_scene_goes_on_to_the_very_bits_of_the_run_that_it_was_taken_of(level, tmp_path):
    session = played(level)
    again = through_file(session, tmp_path / "kept")
    assert again.tick == TICKS and state_hash(again.world) == state_hash(session.world)
    assert advanced(again, 60) == advanced(session, 60)


@pytest.mark.parametrize("undone", [1, 3, 6])
def test_what_was_done_before_a_scene_was_taken_is_undone_as_in_the_run_itself(undone, tmp_path):
    session = played("rope_bridge_jelly")
    again = through_file(session, tmp_path / "kept")
    for _ in range(undone):
        for run in (session, again):
            run.undo()
            run.apply_pending()
    assert state_hash(again.world) == state_hash(session.world)
    assert len(again.gestures) == len(session.gestures)
    assert advanced(again, 20) == advanced(session, 20)


def test_undoing_the_last_deed_of_a_scene_steps_less_than_half_of_the_run_again(tmp_path):
    session = played("rope_bridge_jelly")
    advanced(session, 600)
    session.submit(Pin(9))
    advanced(session, 30)
    again = through_file(session, tmp_path / "kept")
    ticks = []
    again.progress = lambda done, total: ticks.append(total)
    again.undo()
    again.apply_pending()
    assert ticks and max(ticks) < 120


def test_a_scene_can_be_recorded_from_the_beginning_of_its_run(tmp_path):
    again = through_file(played("rope_bridge_jelly"), tmp_path / "kept")
    again.record_to(tmp_path / "run.replay.jsonl")
    advanced(again, 20)
    again.stop_recording()
    replay = read_replay(tmp_path / "run.replay.jsonl")
    assert replay.ticks == TICKS + 20 and verify(replay) is None


def test_a_scene_that_was_taken_while_a_hand_held_something_lets_it_go(tmp_path):
    session = Session(load_level("rope_bridge_jelly"))
    free = int(np.flatnonzero(session.world.inverse_mass > 0.0)[2])
    session.submit(Grab(0, free, tuple(session.world.position[free].tolist())))
    advanced(session, 5)
    again = through_file(session, tmp_path / "kept")
    assert again.world.any_held()
    advanced(again, 1)
    assert not again.world.any_held()
    again.undo()
    advanced(again, 1)
    assert not again.world.any_held() and again.gestures == ()


def test_a_scene_in_which_all_was_done_while_the_run_had_not_begun_does_nothing_twice(tmp_path):
    session = Session(load_level("rope_bridge_jelly"))
    for deed in (AddParticle((0.0, 3.0)), SetFirmness(0.5, 0.5), AddParticle((1.0, 3.0))):
        session.submit(deed)
    session.apply_pending()
    again = through_file(session, tmp_path / "kept")
    assert again.world.particle_count == session.world.particle_count
    assert advanced(again, 10) == advanced(session, 10)


def test_a_scene_follows_the_scene_that_it_went_on_from_and_no_other():
    session = played("rope_bridge_jelly")
    taker = SceneTaker(session)
    first = taker.take()
    session.submit(Pin(8))
    advanced(session, 5)
    later = taker.take()
    assert later.follows(first) and first.follows(first) and not first.follows(later)
    assert later.actions == "2 things added, 1 cut, 4 deeds"


def test_the_first_line_of_a_scene_says_what_it_is_of(tmp_path):
    session = played("rope_bridge_jelly")
    through_file(session, tmp_path / "kept")
    about = read_about(tmp_path / "kept")
    assert (about.name, about.actions) == (session.level.name, "2 things added, 1 cut, 3 deeds")


@pytest.mark.parametrize("line", [0, 1, 5, -2, -1])
def test_a_changed_byte_of_a_scene_is_told_by_its_line(line, tmp_path):
    path = tmp_path / "kept"
    through_file(played("rope_bridge_jelly"), path)
    lines = path.read_bytes().splitlines(keepends=True)
    changed = bytearray(lines[line])
    changed[len(changed) // 2] ^= 1
    lines[line] = bytes(changed)
    path.write_bytes(b"".join(lines))
    with pytest.raises(ReplayError) as error:
        read_scene(path)
    assert f"line {line % len(lines) + 1}" in error.value.faults[0] and len(error.value.faults) == 1


@pytest.mark.parametrize("kept", [0, 1, -1])
def test_a_scene_that_is_cut_off_is_refused_in_one_line(kept, tmp_path):
    path = tmp_path / "kept"
    through_file(played("rope_bridge_jelly"), path)
    path.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[:kept]))
    with pytest.raises(ReplayError) as error:
        read_scene(path)
    assert len(error.value.faults) == 1


def _zeros(name, count):
    rows = BY_STORED[name].usual_rows(count)
    return base64.b64encode(zlib.compress(rows.tobytes(), 9)).decode()


def _endless_rows(values):
    if "state" in values:
        values["state"]["mass"] = _zeros("mass", 10_000_000)
    yield values


def _many_rows(values):
    columns = [column for column in BY_STORED.values() if column.family is Family.CONTACT]
    if "state" in values:
        values["state"] |= {column.stored: _zeros(column.stored, 1_000_000) for column in columns}
    yield values
    if "state" in values:
        yield from [values | {"state": {}}] * 12


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (bodies_far_out, "joined: bodies lie over each other, or beyond the arrays"),
        (_endless_rows, "state.mass: cut off, or of more than 100,010 rows"),
        (_many_rows, "state: holds more than there is memory for"),
    ],
)
def test_a_small_file_that_asks_for_all_memory_is_refused_before_it_has_it(change, said, tmp_path):
    path = tmp_path / "hostile.scene.jsonl"
    through_file(played("rope_bridge_jelly"), path)
    resealed(path, change)
    # In a process of its own, whose memory is limited by the system.
    program = (
        "import resource, sys, pathlib; from sandbox.session.scene import read_scene; "
        "resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31)); "
        "read_scene(pathlib.Path(sys.argv[1]))"
    )
    ended = subprocess.run([sys.executable, "-c", program, path], capture_output=True, text=True, check=False)
    assert ended.returncode == 1 and said in ended.stderr.splitlines()[-1], ended.stderr[-500:]


@pytest.mark.parametrize("name", ["particle_a", "corner_particle", "material", "law", "edge", "element_kind"])
def test_a_state_whose_slots_are_not_there_is_refused_by_the_name_of_the_array(name, tmp_path):
    path = tmp_path / "hostile.scene.jsonl"
    through_file(played("jelly_cube"), path)

    def change(values):
        if name in values.get("state", {}):
            kind = BY_STORED[name].dtype
            rows = np.frombuffer(zlib.decompress(base64.b64decode(values["state"][name])), kind).copy()
            rows[0] = min(10**6, np.iinfo(kind).max)
            values["state"][name] = base64.b64encode(zlib.compress(rows.tobytes())).decode()
        yield values

    resealed(path, change)
    with pytest.raises(ReplayError, match=rf"state\.{name}[ :]"):
        read_scene(path)
