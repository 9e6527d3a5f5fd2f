"""A body is made softer and firmer while it moves: by command, undone, recorded, ended by Cs and Cd."""

import numpy as np
import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.equation import of_body
from sandbox.physics.snapshot import state_hash
from sandbox.physics.softness.firmness import FirmnessRange, lowest_mode_of
from sandbox.replay import read_replay, verify
from sandbox.session.commands import CommandError, SetCoefficients, SetFirmness, SetSolver, apply
from sandbox.session.session import Session
from tests.support.wobbles import firm_level, firm_world


def session_of(firmness=None, **body) -> Session:
    form = body or {"shape": {"box": [1, 1]}, "spacing": 0.25}
    return Session(parse_level(firm_level(firmness, **form), "firm"))


def body_pair(world):
    """Cs and Cd of the world's first body as a whole."""
    mode = lowest_mode_of(world.forms[0].shape)
    return of_body(float(world.stiffness[0]), float(world.damping[0]), mode)


@pytest.mark.parametrize("asked", [{"hz": 3.0, "ratio": 0.4}, {"hz": 3.0}, {"sag": 0.0}])
def test_the_command_gives_what_the_level_s_field_gives(asked):
    commanded, written = session_of().world, session_of(asked).world
    apply(commanded, SetFirmness(0, **asked))
    assert state_hash(commanded) == state_hash(written)


def test_firmness_is_undone_redone_and_recorded(tmp_path):
    session = session_of({"sag": 0.02})
    session.record_to(tmp_path / "run.replay", state_ticks=60)
    before = state_hash(session.world)
    session.submit(SetFirmness(0, sag=0.25))
    for _ in range(70):
        session.advance()
    softer = state_hash(session.world)
    session.undo()
    session.apply_pending()
    assert np.array_equal(session.world.stiffness, session_of({"sag": 0.02}).world.stiffness)
    session.redo()
    session.apply_pending()
    assert state_hash(session.world) == softer != before
    session.submit(SetSolver(substeps=4))
    session.submit(SetCoefficients(stiffness=0.2))
    for _ in range(20):
        session.advance()
    session.stop_recording()
    assert '"type": "set_firmness", "body": "body", "sag": 0.25' in (tmp_path / "run.replay").read_text()
    assert verify(read_replay(tmp_path / "run.replay")) is None


def test_a_recording_goes_on_from_a_stored_state_with_the_firmness_it_had(tmp_path):
    session = session_of()
    session.record_to(tmp_path / "run.replay", state_ticks=60)
    session.submit(SetFirmness(0, hz=2.0, ratio=0.2))
    session.advance()
    session.submit(SetSolver(substeps=4))
    for _ in range(70):
        session.advance()
    session.stop_recording()
    assert verify(read_replay(tmp_path / "run.replay"), start=60) is None


def test_another_cs_or_cd_takes_a_body_off_its_firmness_until_it_is_set_again():
    world = session_of({"hz": 3.0}).world
    apply(world, SetCoefficients(damping=0.97))
    assert not world.lowest_mode.any() and not world.constraint_lowest_mode.any()
    assert set(world.damping[:-10]) == {0.97}
    apply(world, SetFirmness(0, hz=3.0))
    assert state_hash(world) == state_hash(session_of({"hz": 3.0}).world)


def test_firmness_of_one_body_leaves_others_alone_and_outlives_gravity():
    world = session_of({"hz": 4.0, "ratio": 0.3}).world
    others = firm_world({"hz": 4.0, "ratio": 0.3}, {"gravity": [0.0, -3.0]}, shape={"box": [1, 1]}, spacing=0.25)
    assert np.array_equal(world.stiffness, others.stiffness)
    reach = FirmnessRange.of(world.forms[0].shape, (0.0, -3.0), 60.0)
    assert reach.reading(*body_pair(world))[1:] == pytest.approx((4.0, 0.3), rel=1e-9)


def test_what_cannot_be_had_is_refused_and_changes_nothing():
    world = session_of().world
    before = state_hash(world)
    for command, message in (
        (
            SetFirmness(0, hz=10.0, ratio=0.1),
            "body: 10 Hz at ratio 0.1 is out of reach at 60 ticks a second; the nearest is",
        ),
        (SetFirmness(0, sag=0.5), "sag: must be less than or equal to 0.4"),
        (SetFirmness(0), "say sag, or hz"),
        (SetFirmness(0, sag=0.1, hz=2.0), "say sag, or hz"),
        (SetFirmness(0, sag=0.1, ratio=0.2), "say sag, or hz"),
        (SetFirmness(1, sag=0.1), "there is no body whose form may be stiff 1"),
    ):
        with pytest.raises(CommandError, match=message):
            apply(world, command)
    assert state_hash(world) == before
    rope = session_of(type="rope", start=[0, 0], end=[1, 0], segments=4)
    assert rope.world.forms == ()
