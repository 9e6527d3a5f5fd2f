"""What does not touch changes nothing: a body comes out bit for bit as it would alone in the world."""

import json
from pathlib import Path

import numpy as np
import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session
from tests.support.physics_scenes import scaled

TICKS = scaled(300, 8)
FAR = 200.0
MATERIALS = {
    "rigid": {"stiffness": 1.0, "damping": 1.0}, "jelly": {"stiffness": 0.4, "damping": 0.6},
    "cloth": {"stiffness": 0.3, "damping": 0.35},
}  # fmt: skip
MUSCLE = {"amplitude": 0.2, "period": 40, "force": 5.0}


def ground(name, x, **more):
    return {"id": name, "polygon": [[x - 25, -5], [x + 25, -5], [x + 25, 0], [x - 25, 0]], **more}


def box(name, position, size=1.6, material="jelly", **more):
    return {
        "type": "jelly", "id": name, "shape": {"box": [size, size]}, "position": position, "spacing": size / 4,
        "material": material, "particle_radius": 0.06, **more,
    }  # fmt: skip


def heap():
    return {"bodies": [box(f"cube {k}", [0.4 * (k % 2), 1.2 + 1.9 * k], angle=0.3 * k) for k in range(4)]}


def tower():
    return {"bodies": [box(f"box {k}", [0.02 * (k % 3), 0.56 + 1.12 * k], 1.0, "rigid") for k in range(6)]}


def cart():
    level = json.loads(Path("levels/suspension_car.json").read_text())
    return {key: level[key] for key in ("bodies", "springs", "materials", "terrain", "contacts", "settings")}


def cloth():
    body = box("cloth", [0.0, 3.6], 5.0, "cloth", particle_mass=0.05)
    return {"bodies": [body], "particles": [{"id": "peg", "position": [0.3, 0.5], "radius": 0.4, "pinned": True}]}


def bouncing():
    return {"terrain": [ground("ground", 0.0, restitution=0.8)], "bodies": [box("dice", [0.0, 3.0], angle=0.4)]}


def far_things():
    """A pin, a disc, a jelly that falls, one that is held, and a pair that a muscle of limited force joins."""
    return {
        "terrain": [ground("far ground", FAR, restitution=0.8)],
        "bodies": [box("far jelly", [FAR, 3.0], angle=0.4), box("far held", [FAR + 5.0, 1.2])],
        "particles": [
            {"id": "far pin", "position": [FAR - 3.0, 3.0], "radius": 0.1, "pinned": True},
            {"id": "far disc", "position": [FAR - 6.0, 3.0], "radius": 0.3},
            {"id": "far a", "position": [FAR - 9.0, 1.0], "radius": 0.1},
            {"id": "far b", "position": [FAR - 9.0, 2.0], "radius": 0.1},
        ],
        "springs": [{"a": "far a", "b": "far b", "drive": MUSCLE}],
    }


def level_of(near, far, far_first, solver):
    keys = ("terrain", "bodies", "particles", "springs")
    lists = {key: [*near.get(key, []), *far.get(key, [])] for key in keys}
    if far_first:
        lists = {key: [*far.get(key, []), *near.get(key, [])] for key in keys}
    return parse_level(
        json.dumps({
            "format": "spring-sandbox/level", "version": 3, "name": "apart",
            "settings": {**near.get("settings", {}), "solver": solver},
            "materials": {**MATERIALS, **near.get("materials", {})}, "contacts": near.get("contacts", {}), **lists,
        }).encode(),
        "apart",
    )  # fmt: skip


def submit(session, **record):
    session.submit(from_record(record, session.world))


def motion(level, ticks, drive=1.0):
    """Places and velocities of all that is near, tick by tick, as bytes; wheels are driven, the far jelly is held."""
    session = Session(level)
    world = session.world
    near = [k for k, name in enumerate(world.particle_names) if name and not name.startswith(("far", "+hand"))]
    for part in world.actuators.names:
        submit(session, type="set_drive", part=part, value=drive)
    if "far held.0" in world.particle_names:
        submit(session, type="grab", grab=0, particle="far held.0", target=[FAR + 6.0, 3.0])
    frames = []
    for _ in range(ticks):
        session.advance()
        frames.append((world.position[near] + 0.0).tobytes() + (world.velocity[near] + 0.0).tobytes())
    return frames


@pytest.mark.parametrize("far_first", [False, True])
@pytest.mark.parametrize(
    ("solver", "near"),
    [
        *((solver, near) for solver in ("direct", "iterative") for near in (heap, tower, cart, cloth, bouncing)),
        # In a single pass what is rigid flies apart, the cart farther than 200 m.
        *(("single_pass", near) for near in (heap, cloth, bouncing)),
    ],
)
def test_a_body_moves_as_if_nothing_were_far_away(near, solver, far_first):
    here = {"terrain": [ground("ground", 0.0)], **near()}
    alone = motion(level_of(here, {}, False, solver), TICKS)
    beside = motion(level_of(here, far_things(), far_first, solver), TICKS)
    assert [tick for tick in range(TICKS) if alone[tick] != beside[tick]] == []


@pytest.mark.parametrize("drive", [0.7, 0.5])
def test_far_terrain_changes_nothing_of_a_cart_on_bumps(drive):
    here = {"terrain": [ground("ground", 0.0)], **cart()}
    alone = motion(level_of(here, {}, False, "direct"), TICKS, drive)
    beside = motion(level_of(here, {"terrain": far_things()["terrain"]}, False, "direct"), TICKS, drive)
    assert [tick for tick in range(TICKS) if alone[tick] != beside[tick]] == []


def pair(k):
    ends = [{"id": f"{k} a", "position": [3.0 * k, 0.0]}, {"id": f"{k} b", "position": [3.0 * k + 1.0, 0.2]}]
    return ends, {"a": f"{k} a", "b": f"{k} b", "drive": MUSCLE}


def pairs(which):
    made = [pair(k) for k in which]
    near = {"particles": [end for ends, _ in made for end in ends], "springs": [spring for _, spring in made]}
    return level_of(near, {}, False, "direct")


def test_pairs_that_a_muscle_of_limited_force_joins_move_as_one_pair_alone():
    session = Session(pairs(range(30)))
    singles = [Session(pairs([k])) for k in range(30)]
    for _ in range(scaled(120, 5)):
        session.advance()
        for k, single in enumerate(singles):
            single.advance()
            assert session.world.position[2 * k : 2 * k + 2].tobytes() == single.world.position[:2].tobytes()
            assert session.world.velocity[2 * k : 2 * k + 2].tobytes() == single.world.velocity[:2].tobytes()


def couplings(session):
    """How many couplings each row of joints has, itself included."""
    session.advance()
    return np.diff(block_of(session.world).arrays.workspace.delassus.joints.couplings.first).tolist()


def test_joints_are_coupled_within_a_body_and_not_beyond():
    assert couplings(Session(pairs(range(30)))) == [1] * 30
    chain = [{"id": f"p{k}", "position": [float(k), 0.0]} for k in range(5)]
    muscles = [{"a": f"p{k}", "b": f"p{k + 1}", "drive": MUSCLE} for k in range(4)]
    hung = level_of({"particles": chain, "springs": muscles}, {}, False, "direct")
    assert couplings(Session(hung)) == [2, 3, 3, 2]
    assert couplings(Session(level_of(cart(), {}, False, "direct"))) == [2, 2]


def test_joints_know_how_fast_what_they_act_on_leaves_an_impact():
    near = {
        "terrain": [ground("ground", 0.0, restitution=1.0)],
        "particles": [
            {"id": "a", "position": [0.0, 1.0], "radius": 0.1, "restitution": 1.0},
            {"id": "b", "position": [0.0, 2.0], "radius": 0.1, "restitution": 1.0},
        ],
        "springs": [{"a": "a", "b": "b", "drive": MUSCLE}],
    }  # fmt: skip
    session = Session(level_of(near, {}, False, "direct"))
    rose = 0
    for _ in range(scaled(120, 60)):
        before = session.world.velocity[0, 1]
        session.advance()
        arrays = block_of(session.world).arrays
        rows, velocity = arrays.joints.rows, session.world.velocity
        known = arrays.workspace.delassus.joints.velocity[0]
        assert known == pytest.approx((rows.gradient * velocity[rows.particle]).sum(), abs=1e-9)
        rose += before < 0.0 < session.world.velocity[0, 1]
    assert rose > 0
