"""Nothing passes: balls a soft body, or what a hand drags a wall of pinned springs."""

import math

import numpy as np
import pytest

from sandbox.physics.jit import COMPILED
from tests.support.situations import advance, order, session_of, slots_of

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")


@pytest.mark.parametrize(
    ("stiffness", "damping", "mass", "radius"),
    [(0.1, 0.5, 5.0, 0.1), (0.02, 0.1, 5.0, 0.1), (0.5, 0.9, 5.0, 0.1), (0.5, 0.9, 50.0, 0.25)],
)
def test_a_ball_does_not_pass_a_soft_box(stiffness, damping, mass, radius):
    for speed in (20.0, 50.0, 80.0):
        session = session_of(
            settings={"gravity": [0, 0]}, materials={"m": {"stiffness": stiffness, "damping": damping}},
            contacts={"friction": 0.4, "restitution": 0.0},
            bodies=[{
                "type": "jelly", "id": "k", "shape": {"box": [1.25, 1.25]}, "spacing": 0.25, "position": [0, 0],
                "material": "m",
            }],
            particles=[{"id": "b", "position": [-2, 0.07], "velocity": [speed, 0], "mass": mass, "radius": radius}],
        )  # fmt: skip
        world, ball, body = session.world, session.world.particle_slot("b"), slots_of(session, "k")
        moving = np.append(body, ball)
        before = float(np.sum(world.mass[moving] * world.velocity[moving, 0]))
        advance(session, 120)
        jelly = float(np.average(world.velocity[body, 0], weights=world.mass[body]))
        assert world.velocity[ball, 0] <= jelly + 0.05
        assert np.sum(world.mass[moving] * world.velocity[moving, 0]) == pytest.approx(before, rel=1e-9)


@pytest.mark.parametrize("strength", [30, 100, 300])
def test_a_hand_draws_no_jelly_through_a_ring_of_pinned_springs(strength):
    links, radius = 24, 3.0
    ring = [[radius * math.cos(k * math.tau / links), radius * math.sin(k * math.tau / links)] for k in range(links)]
    for seed in range(2):
        session = session_of(
            materials={"m": {"stiffness": 0.7, "damping": 0.95}}, contacts={"friction": 0.4, "restitution": 0.2},
            bodies=[
                {"type": "jelly", "id": "k", "shape": {"box": [1, 1]}, "spacing": 0.25, "material": "m"},
                {"type": "mesh", "id": "wall", "particles": ring, "pinned": list(range(links)),
                 "springs": [[k, (k + 1) % links] for k in range(links)]},
            ],
        )  # fmt: skip
        world, body = session.world, slots_of(session, "k")
        generator, target, goal = np.random.default_rng(seed), np.zeros(2), np.zeros(2)
        order(session, type="grab", grab=0, particle="k.12", target=[0.0, 0.0], strength=strength)
        for tick in range(240):
            if tick % 20 == 0:
                goal = generator.uniform(-20.0, 20.0, 2)
            way = goal - target
            target = target + way * min(1.0, (20.0 / 60.0) / max(float(np.hypot(*way)), 1e-9))
            order(session, type="move_grab", grab=0, target=[float(target[0]), float(target[1])])
            advance(session, 1)
            assert np.hypot(*world.position[body].T).max() < radius + 1e-3
