"""Corners of terrain hold edges of bodies, not only their particles: nothing falls through a post or a spike."""

import numpy as np
import pytest

from sandbox.physics.jit import COMPILED
from tests.support.situations import advance, session_of, slots_of

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")

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
