"""Commands whose change takes time: undone, redone, recorded, and gone on with when the body is cut or removed."""

import pytest

from sandbox.level.reading.files import load_level
from sandbox.level.reading.parse import parse_level
from sandbox.physics.jit import COMPILED
from sandbox.physics.keeping.equipment import height_of
from sandbox.physics.snapshot import state_hash
from sandbox.replay import read_replay, verify
from sandbox.session.commands import (
    AddBody,
    CommandError,
    CutSprings,
    Pin,
    Remove,
    SetAir,
    SetCoefficients,
    SetFirmness,
    SetGravity,
    SetInflation,
    SetSolver,
    apply,
)
from sandbox.session.commands.records import from_record, to_record
from sandbox.session.session import Session
from tests.support.wobbles import firm_level

BOX = {"shape": {"box": [1, 1]}, "spacing": 0.25, "position": [0, 0.7]}
TICKS = 20


def session_of() -> Session:
    """A soft box on the floor."""
    return Session(parse_level(firm_level({"sag": 0.2}, floor=True, **BOX), "firm"))


def go(session, ticks):
    """Go on for some ticks; the hash of each."""
    hashes = []
    for _ in range(ticks):
        session.advance()
        hashes.append(state_hash(session.world))
    return hashes


RAMPED = {
    "firmness": SetFirmness(0, sag=0.0, duration=TICKS),
    "coefficients": SetCoefficients(0.9, 0.95, duration=TICKS),
    "gravity": SetGravity((3.0, -2.0), TICKS),
    "air": SetAir((4.0, 0.0), 0.5, TICKS),
    "inflation": SetInflation(0, 1.4, TICKS),
    "solver": SetSolver(solver="iterative", duration=TICKS),
}


@pytest.mark.parametrize("command", RAMPED.values(), ids=RAMPED)
def test_a_ramp_is_undone_and_redone_in_its_middle_with_the_same_bits(command):
    session, never, once = session_of(), session_of(), session_of()
    for each in (session, never, once):
        go(each, 5)
    for each in (session, once):
        each.submit(command)
        go(each, 8)
    go(never, 8)
    session.undo()
    session.apply_pending()
    assert state_hash(session.world) == state_hash(never.world) != state_hash(once.world)
    session.redo()
    assert go(session, 20) == go(once, 20)
    # And sought, from a state that is kept or not.
    last = state_hash(session.world)
    session.seek(9)
    session.seek(33)
    assert state_hash(session.world) == last


@pytest.mark.parametrize("command", RAMPED.values(), ids=RAMPED)
def test_a_recording_holds_the_duration_and_goes_on_from_a_state_in_the_middle(command, tmp_path):
    session = session_of()
    session.record_to(tmp_path / "run.replay", state_ticks=15)
    go(session, 5)
    session.submit(command)
    go(session, 40)
    session.stop_recording()
    replay = read_replay(tmp_path / "run.replay")
    assert replay.script[0].record["duration"] == TICKS
    assert verify(replay) is None and verify(replay, start=15) is None


def test_what_is_done_to_a_body_in_the_middle_of_its_ramp_is_recorded_and_undone(tmp_path):
    session = session_of()
    session.record_to(tmp_path / "run.replay", state_ticks=10)
    session.submit(RAMPED["firmness"])
    go(session, 4)
    session.submit(Pin(0))
    session.submit(CutSprings((3, 4)))
    go(session, 4)
    session.submit(AddBody({"type": "jelly", **BOX, "position": [3, 1]}))
    go(session, 4)
    session.undo()
    session.redo()
    session.submit(SetFirmness(0, sag=0.1, duration=TICKS))
    go(session, 4)
    session.submit(Remove(body="body"))
    go(session, TICKS)
    session.stop_recording()
    assert not session.messages
    assert verify(read_replay(tmp_path / "run.replay")) is None


def test_a_command_without_a_duration_means_at_once_as_it_always_did():
    session = session_of()
    for record in (
        {"type": "set_firmness", "body": "body", "sag": 0.1},
        {"type": "set_coefficients", "stiffness": 0.5},
        {"type": "set_gravity", "gravity": [0.0, -1.0]},
    ):
        command = from_record(record, session.world)
        assert command.duration == 0 and to_record(command, session.world)["duration"] == 0
        apply(session.world, command)
        assert not session.world.ramp_ticks.any() and not session.world.setting_ticks.any()


@pytest.mark.parametrize("duration", [-1, 1.5, True, 1_000_001])
def test_a_duration_that_is_no_number_of_ticks_is_refused(duration):
    world = session_of().world
    before = state_hash(world)
    for command in (SetCoefficients(0.5, duration=duration), SetGravity((0.0, 0.0), duration)):
        with pytest.raises(CommandError, match="duration: must be"):
            apply(world, command)
    assert state_hash(world) == before


def heights(world):
    """How high [m] the middle of each body is."""
    return [float(world.position[world.particle_a[form.springs], 1].mean()) for form in world.forms]


@pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")
@pytest.mark.parametrize("softness", [0.25, None], ids=["jelly", "the level's own"])
def test_a_heap_of_jellies_that_is_made_rigid_stays_where_it_is(softness):
    session = Session(load_level("jelly_pile"))
    bodies, firm_up = range(len(session.world.forms)), 75
    go(session, 240)
    if softness is not None:
        for body in bodies:
            session.submit(SetFirmness(body, sag=softness, duration=firm_up), 1)
        go(session, 180)
    for body in bodies:
        session.submit(SetFirmness(body, sag=0.0, duration=firm_up), 2)
    highest = heights(session.world)
    for _ in range(180):
        session.advance()
        highest = [max(pair) for pair in zip(highest, heights(session.world), strict=True)]
    world, (left, bottom, right, top) = session.world, session.level.view
    for body, high, end in zip(world.forms, highest, heights(world), strict=True):
        assert high - end < 0.5 * height_of(body.shape, 0.0, -9.81), body.name
        places = world.position[world.particle_a[body.springs]]
        assert left < places[:, 0].min() and places[:, 0].max() < right, body.name
        assert bottom < places[:, 1].min() and places[:, 1].max() < top, body.name
