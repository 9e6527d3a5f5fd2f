"""No dead drags: a press anywhere inside a visible body holds it, and moves it while time stands."""

import random

import numpy as np
import pytest

from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.physics.analysis.query import shown_particles
from sandbox.session.commands import Grab, MoveBody
from sandbox.session.session import Session
from sandbox.tools.drag import TIME_STANDS, DragTool
from sandbox.tools.tool import PointerEvent

# Those in which hands may do everything.
NAMES = [path.stem for path in shipped_levels() if load_level(path.stem).hands is None]


def session_and_tool(name, ticks=20):
    session = Session(load_level(name))
    for _ in range(ticks):
        session.advance()
    return session, DragTool(session.new_gesture)


def inside_bodies(session, rng, count):
    """Places in cells of bodies: within triangles of springs, with a corner that is free."""
    world = session.world
    joined = {}
    for s in np.flatnonzero(world.spring_active & (world.material >= 0)).tolist():
        a, b = int(world.particle_a[s]), int(world.particle_b[s])
        joined.setdefault(a, set()).add(b)
        joined.setdefault(b, set()).add(a)
    cells = [(a, b, c) for a in joined for b in joined[a] if b > a for c in joined[a] & joined[b] if c > b]
    rng.shuffle(cells)
    for corners in cells[:count]:
        if world.inverse_mass[list(corners)].any():
            share = rng.random(), rng.random()
            share = share if sum(share) <= 1.0 else (1.0 - share[0], 1.0 - share[1])
            a, b, c = world.position[list(corners)]
            yield tuple((a + share[0] * (b - a) + share[1] * (c - a)).tolist()), corners


def test_presses_at_random_places_inside_bodies_hold_them():
    rng, held, tried = random.Random(1), 0, 0
    for name in NAMES:
        session, _ = session_and_tool(name)
        for place, corners in inside_bodies(session, rng, 10):
            tool = DragTool(session.new_gesture)
            response = tool.handle(PointerEvent("down", place, 0.02), session.snapshot())
            tried += 1
            assert [type(each.command) for each in response.submissions] == [Grab], (name, place)
            owner = session.world.owner
            held += owner[response.submissions[0].command.particle] in owner[list(corners)]
    # Bodies that lie over each other may both be meant.
    assert tried >= 200 and held >= 0.95 * tried


def test_what_is_taken_far_from_a_particle_does_not_jump():
    session, tool = session_and_tool("truss_bridge", 0)
    place, _ = next(inside_bodies(session, random.Random(2), 10))
    grab = tool.handle(PointerEvent("down", place, 1e-4), session.snapshot()).submissions[0].command
    assert grab.target == pytest.approx(tuple(session.world.position[grab.particle]))
    moved = tool.handle(PointerEvent("move", (place[0] + 1.0, place[1]), 1e-4), session.snapshot())
    assert moved.submissions[0].command.target == pytest.approx((grab.target[0] + 1.0, grab.target[1]))


def test_a_press_beside_all_bodies_takes_nothing():
    session, tool = session_and_tool("jelly_pile")
    assert not tool.handle(PointerEvent("down", (0.0, 500.0), 0.1), session.snapshot()).submissions


@pytest.mark.parametrize("name", NAMES)
def test_a_paused_drag_moves_the_thing_there_is_undone_at_once_and_verifies(name, tmp_path):
    session, tool = session_and_tool(name)
    found = next(inside_bodies(session, random.Random(3), 20), None)
    if found is None:
        free = np.flatnonzero(shown_particles(session.world) & (session.world.inverse_mass > 0.0))
        found = tuple(session.world.position[free[0]].tolist()), (int(free[0]),)
    place, _ = found
    before = session.world.position.copy()
    for kind, by in (("down", 0.0), ("move", 0.3), ("move", 0.5), ("up", 0.7)):
        event = PointerEvent(kind, (place[0] + by, place[1] - by), 0.05, paused=True)
        for command, gesture in tool.handle(event, session.snapshot()).submissions:
            assert type(command) is MoveBody
            session.submit(command, gesture)
            session.apply_pending()
    way = session.world.position - before
    moved = np.flatnonzero(np.abs(way).sum(axis=1) > 0.1)
    assert len(moved) and way[moved] == pytest.approx(np.tile([0.7, -0.7], (len(moved), 1)))
    after = session.world.position.copy()
    session.undo()
    session.apply_pending()
    assert session.world.position == pytest.approx(before, nan_ok=True)
    session.redo()
    session.apply_pending()
    assert session.world.position == pytest.approx(after, nan_ok=True)


def test_a_paused_drag_only_pulls_where_the_level_lets_no_hand_move_things_at_once():
    session, tool = session_and_tool("ferry")
    before = session.world.position.copy()
    place, types, said = tuple(session.world.position[session.world.particle_slot("crate 1.4")].tolist()), [], set()
    for kind, by in (("down", 0.0), ("move", 8.0), ("move", 16.0)):
        response = tool.handle(PointerEvent(kind, (place[0] + by, place[1]), 0.05, paused=True), session.snapshot())
        said.add(response.message)
        for command, gesture in response.submissions:
            types.append(command.type)
            session.submit(command, gesture)
            session.apply_pending()
    assert types == ["grab", "move_grab", "move_grab"] and said == {TIME_STANDS, None} and not session.refusals
    shown = shown_particles(session.world)
    assert session.world.position[shown] == pytest.approx(before[shown])
    session.advance()
    assert session.world.position[shown] != pytest.approx(before[shown], abs=1e-06)
