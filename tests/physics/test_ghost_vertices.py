"""Ghost vertices: flush ground is one ground; steps stay steps, and convex corners of terrain hold edges of bodies."""

import math

import numpy as np
import pytest

from sandbox.physics.jit import COMPILED
from tests.support.situations import advance, session_of, slots_of

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")

PIECES = 30
R = 0.05  # [m] of particles of pinned bodies


def pieces(kind, step=0.0):
    """Terrain and bodies of flush ground at y = 0 in pieces of 1 m; step [m]: by which every second one is higher."""
    terrain, bodies = [], []
    for i in range(PIECES):
        a, b, y = i - 2.0, i - 1.0, step * (i % 2)
        block = {"id": f"t{i}", "polygon": [[a, y - 1], [b, y - 1], [b, y], [a, y]]}
        line = {"start": [a, -R], "end": [b, -R], "segments": 2, "material": "m", "particle_radius": R, "id": f"b{i}"}
        if kind == "blocks" or (kind in ("rope", "bridge") and i % 2 == 0):
            terrain.append(block)
        elif kind == "lines":
            terrain.append({"id": f"t{i}", "polyline": [[a, y], [b, y]]})
        elif kind == "overlapping":
            terrain.append({"id": f"t{i}", "polygon": [[a - 0.1, -1], [b + 0.1, -1], [b + 0.1, 0], [a - 0.1, 0]]})
        elif kind == "rope":
            bodies.append({"type": "rope", "pinned": [0, 1, 2], **line})
        elif kind == "bridge":
            bodies.append({"type": "bridge", "height": 0.5, "pinned": list(range(6)), **line})
        else:
            end = [a, 0] if kind == "walls below" else [b, 0]
            terrain.append({"id": f"t{i}", "polyline": [[a, -0.5], end]})
    if kind in ("walls below", "truss below"):
        terrain.append({"id": "floor", "polyline": [[-2, 0], [PIECES - 2, 0]]})
    return {"terrain": terrain, "bodies": bodies}


def roll(ground, speed, radius, *, restitution=0.0, **settings):
    """The highest hop [m] of a disc that rolls over it, and the share of its speed that it keeps."""
    session = session_of(
        settings=settings, contacts={"friction": 0.5, "restitution": restitution},
        particles=[{
            "id": "d", "position": [-1.5, radius], "radius": radius, "velocity": [speed, 0], "spin": -speed / radius,
            "rolling": 0,
        }],
        **ground,
    )  # fmt: skip
    world, disc, hop = session.world, session.world.particle_slot("d"), 0.0
    for _ in range(int(min(4.0, 26.0 / speed) * 60)):
        advance(session, 1)
        hop = max(hop, float(world.position[disc, 1]) - radius)
    return hop, float(world.velocity[disc, 0]) / speed


@pytest.mark.parametrize(
    "kind", ["blocks", "lines", "overlapping", "rope", "bridge", "walls below", "truss below"]
)  # fmt: skip
def test_a_disc_rolls_over_flush_ground_as_over_one_piece(kind):
    # Ropes and bridges have a rolling resistance of their own.
    kept = 0.97 if kind in ("rope", "bridge") else 1.0 - 1e-4
    for speed in (1.0, 5.0, 20.0, 100.0):
        for radius in (0.05, 0.3):
            hop, share = roll(pieces(kind), speed, radius)
            assert hop < 1e-4 and share > kept, (speed, radius, hop, share)


@pytest.mark.parametrize("settings", [{"substeps": 4}, {"solver": "iterative"}], ids=str)
def test_so_it_does_in_substeps_in_the_iterative_solver_and_with_restitution(settings):
    for kind in ("blocks", "lines"):
        hop, share = roll(pieces(kind), 10.0, 0.3, restitution=0.5, **settings)
        assert hop < 1e-4 and share > 1.0 - 1e-4


def test_a_box_slides_over_flush_ground_without_friction_as_over_one_piece():
    session = session_of(
        contacts={"friction": 0.0, "restitution": 0.0}, terrain=pieces("blocks")["terrain"],
        bodies=[{
            "type": "jelly", "id": "k", "shape": {"box": [0.5, 0.5]}, "spacing": 0.25, "position": [-1.0, 0.3],
            "velocity": [5, 0], "material": "m", "particle_radius": 0.05,
        }],
    )  # fmt: skip
    advance(session, 180)
    assert session.world.velocity[slots_of(session, "k"), 0] == pytest.approx(5.0, rel=1e-4)


@pytest.mark.parametrize(("speed", "within"), [(5.0, 0.25), (10.0, 0.1), (20.0, 0.1)])
def test_a_step_throws_a_disc_up_as_one_that_turns_about_its_edge(speed, within):
    # Angular momentum about the edge: v' = v (1 - 2 s / 3 r) along the tangent, cos t = 1 - s / r.
    r = 0.3
    for s in (0.002, 0.01, 0.03):
        session = session_of(
            contacts={"friction": 0.5, "restitution": 0.0},
            terrain=[
                {"id": "low", "polygon": [[-3, -1], [0, -1], [0, 0], [-3, 0]]},
                {"id": "high", "polygon": [[0, -1], [60, -1], [60, s], [0, s]]},
            ],
            particles=[{
                "id": "d", "position": [-1.5, r], "radius": r, "velocity": [speed, 0], "spin": -speed / r, "rolling": 0,
            }],
        )  # fmt: skip
        world, disc, hop = session.world, session.world.particle_slot("d"), 0.0
        for _ in range(120):
            advance(session, 1)
            hop = max(hop, float(world.position[disc, 1]) - r)
        along = speed * (1.0 - 2.0 * s / (3.0 * r))
        sine = math.sqrt(1.0 - (1.0 - s / r) ** 2)
        assert hop == pytest.approx((along * sine) ** 2 / (2.0 * 9.81), rel=within), s


TERRAIN = {
    "post": {"polygon": [[-0.02, -50], [0.02, -50], [0.02, 0], [-0.02, 0]]},
    "spike": {"polygon": [[-0.2, -50], [0.2, -50], [0, 0]]},
    "line end": {"polyline": [[0, -50], [0, 0]]},
    "bend": {"polyline": [[-2, -2], [0, 0], [2, -2]]},
}
Y = 1.3
BODIES = {
    "jelly": {"type": "jelly", "shape": {"box": [1, 1]}, "spacing": 0.25},
    "rope": {"type": "rope", "segments": 4},
    "girder": {"type": "girder", "segments": 4, "height": 0.4},
    "ring": {"type": "ring", "radius": 0.5, "segments": 12},
    "wheel": {"type": "wheel", "radius": 0.5, "thickness": 0.15, "segments": 12},
}


def thrown(body, corner, speed, x, *, solver="direct", substeps=1, restitution=0.0):
    """A body thrown down at a corner in (0, 0), between two of its particles or at one."""
    lies = body in ("rope", "girder")
    place = {"start": [x - 0.5, Y], "end": [x + 0.5, Y]} if lies else {"position": [x, Y + 0.5]}
    return session_of(
        settings={"solver": solver, "substeps": substeps}, materials={"m": {"stiffness": 0.5, "damping": 0.9}},
        contacts={"friction": 0.8, "restitution": restitution}, terrain=[{"id": "t", **TERRAIN[corner]}],
        bodies=[{**BODIES[body], **place, "id": "k", "material": "m", "velocity": [0, -speed],
                 "particle_radius": 0.05}],
    )  # fmt: skip


def passes(session, speed):
    """Whether it is ever wholly below the corner while on both sides of it; and whether it ever has gained energy."""
    world, body = session.world, slots_of(session, "k")
    mass = world.mass[body]

    def energy():
        v = world.velocity[body]
        return float(np.sum(mass * (0.5 * np.sum(v * v, axis=1) + 9.81 * world.position[body, 1])))

    passed, before = False, energy()
    for _ in range(int(60 * (0.5 + 2.0 / max(speed, 4.0)))):
        advance(session, 1)
        x, y = world.position[body].T
        passed |= y.max() < -0.2 and x.min() < -0.05 and x.max() > 0.05
    return passed, energy() > before * 1.001 + 1e-6


@pytest.mark.parametrize("corner", TERRAIN)
@pytest.mark.parametrize("body", BODIES)
def test_a_body_that_is_thrown_at_a_corner_does_not_pass_it(body, corner):
    for speed in (0.0, 10.0, 60.0):
        for x in (0.13, 0.03):
            assert passes(thrown(body, corner, speed, x), speed) == (False, False), (speed, x)


@pytest.mark.parametrize("settings", [{"substeps": 4}, {"restitution": 0.8}, {"solver": "iterative"}], ids=str)
def test_nor_in_substeps_with_restitution_or_in_the_iterative_solver_to_30_metres_a_second(settings):
    for body in ("jelly", "rope", "wheel"):
        for corner in ("post", "line end"):
            for speed in (0.0, 30.0):
                assert not passes(thrown(body, corner, speed, 0.13, **settings), speed)[0], (body, corner, speed)


def test_friction_at_a_corner_holds_a_plank_that_leans_less_than_its_angle():
    heights = []
    for friction in (0.0, 1.0):
        session = session_of(
            contacts={"friction": friction, "restitution": 0.0},
            terrain=[{"id": "post", "polygon": [[-0.02, -5], [0.02, -5], [0.02, 0], [-0.02, 0]]}],
            bodies=[{
                "type": "girder", "id": "k", "start": [-1.0, 0.04], "end": [1.0, 0.44], "segments": 4, "height": 0.2,
                "particle_radius": 0.03, "material": "m",
            }],
        )  # fmt: skip
        body = slots_of(session, "k")
        first = session.world.position[body].mean(axis=0)
        advance(session, 40)
        heights.append(abs(float(session.world.position[body, 0].mean() - first[0])))
    assert heights[0] > 2.0 * heights[1]
