"""A world that is shaken: what moves stays behind its frame, and what was shaken is recorded and taken back."""

import numpy as np
import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import state_hash
from sandbox.physics.solvers import SOLVERS
from sandbox.session.commands import CommandError, Shake, apply
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.parts import BODIES, RandomPlayer, furnished, placed, room


def floating(**changes):
    """A jelly and a ball in a room without gravity."""
    body = placed(BODIES["jelly"], 0, 3) | {"firmness": {"hz": 3, "ratio": 0.5}, "id": "cube"}
    ball = {"id": "ball", "position": [2, 2], "radius": 0.2, "gravity_scale": 0}
    settings = {"solver": "direct", "gravity": [0, 0]}
    return room("direct", body, **{"particles": [ball], "settings": settings, **changes})


def test_what_floats_stays_where_it_is_while_its_frame_moves():
    session = Session(floating())
    start = session.world.position.copy()
    # To the right by 30 m/s^2 for 3 ticks, and to rest again: 1.5 m/s in between, for 10 ticks.
    way = 0.0
    velocity = 0.0
    for push in (30.0, 30.0, 30.0, *([0.0] * 7), -30.0, -30.0, -30.0):
        if push:
            session.submit(Shake((push, 0.0)))
        session.advance()
        velocity += push / 60
        way += velocity / 60
    moved = session.world.position - start
    free = session.world.inverse_mass > 0
    free[session.world.grab_particle :] = False
    assert moved[free, 0] == pytest.approx(-way, abs=1e-9) and moved[free, 1] == pytest.approx(0.0, abs=1e-9)
    assert np.abs(session.world.velocity).max() < 1e-9


@pytest.mark.parametrize("solver", sorted(SOLVERS))
def test_what_lies_on_the_ground_slides_and_is_stopped_by_the_wall(solver):
    session = Session(room(solver, placed(BODIES["jelly"], 2.5, 0.4) | {"id": "cube"}))
    farthest = 0.0
    for tick in range(100):
        if tick == 60:
            session.submit(Shake((-900.0, 0.0)))
        session.advance()
        farthest = max(farthest, float(session.world.position[:, 0].max()))
    # The wall stands at 4 m, and a particle reaches 0.05 m.
    assert 3.85 < farthest < 4.0


def test_pins_and_hands_are_of_the_frame():
    session = Session(furnished())
    session.advance()
    pinned = session.world.inverse_mass == 0
    before = session.world.velocity[pinned].copy()
    apply(session.world, Shake((40.0, -20.0)))
    assert np.array_equal(session.world.velocity[pinned], before)


def test_where_nothing_moves_it_says_so_and_bad_numbers_are_refused():
    still = parse_level(
        b'{"format": "spring-sandbox/level", "version": 3, "name": "still",'
        b' "particles": [{"id": "nail", "position": [0, 0], "pinned": true}]}',
        "still",
    )
    with pytest.raises(CommandError, match="nothing that moves to be shaken"):
        apply(Session(still).world, Shake((1.0, 0.0)))
    for wrong in ((float("nan"), 0.0), (1e7, 0.0), (1.0,), "left"):
        with pytest.raises(CommandError, match=r"^acceleration"):
            apply(Session(floating()).world, Shake(wrong))


def test_a_gesture_of_many_shakes_is_undone_as_if_it_had_never_been():
    shaken, calm = Session(furnished()), Session(furnished())
    gesture = shaken.new_gesture()
    for tick in range(40):
        if 10 <= tick < 20:
            shaken.submit(Shake((60.0 if tick < 15 else -60.0, 25.0)), gesture)
        shaken.advance()
        calm.advance()
    after = state_hash(shaken.world)
    assert after != state_hash(calm.world)
    shaken.undo()
    shaken.apply_pending()
    assert state_hash(shaken.world) == state_hash(calm.world)
    shaken.redo()
    shaken.apply_pending()
    assert state_hash(shaken.world) == after


@pytest.mark.parametrize("seed", range(50, 53))
def test_random_sessions_with_shakes_verify(seed, tmp_path):
    session = Session(furnished(sorted(SOLVERS)[seed % 3]))
    player = RandomPlayer(session, seed)
    session.record_to(tmp_path / "run.replay")
    for tick in range(40):
        player.act()
        if tick % 3 == 0:
            player._shake()
        session.advance()
    session.stop_recording()
    replay = read_replay(tmp_path / "run.replay")
    assert sum('"shake"' in line for line in (tmp_path / "run.replay").read_text().splitlines()) > 10
    assert verify(replay) is None
