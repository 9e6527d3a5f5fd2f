"""Orbits about springs of rest length 0: an isotropic oscillator, whose ellipses keep their axes."""

import math

import numpy as np
import pytest

from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from tests.support.physics_scenes import network


def orbiting(stiffness, damping, speed, *, pinned=(0,), **settings):
    """A particle at 1.2 m from another, sideways at this speed, on a spring of rest length 0."""
    world = network(
        [(0.0, 0.0), (1.2, 0.0)], [(0, 1)], masses=[4.0, 1.0], pinned=pinned, stiffness=stiffness, damping=damping,
        **settings,
    )  # fmt: skip
    world.change("rest_length", 0.0)
    world.change("velocity", np.array([[0.0, -speed / 4.0 if not pinned else 0.0], [0.0, speed]]))
    return world


def axes(world, ticks):
    """Longest and shortest distance of the two."""
    found = []
    for _ in range(ticks):
        step(world)
        found.append(float(np.hypot(*(world.position[1] - world.position[0]))))
    return max(found), min(found)


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize("pinned", [(0,), ()])
@pytest.mark.parametrize(("stiffness", "speed"), [(0.004, 2.0), (0.02, 9.0), (0.06, 4.0)])
def test_an_orbit_about_a_spring_of_length_0_keeps_its_axes_for_a_minute(solver, substeps, pinned, stiffness, speed):
    world = orbiting(stiffness, 0.0, speed, pinned=pinned, solver=solver, substeps=substeps)
    # k = Cs m_r / h^2, whatever the masses; it goes at its speed against the other.
    against = speed if pinned else 1.25 * speed
    across = against / (60.0 * math.sqrt(stiffness))
    first = axes(world, 300)
    last = axes(world, 3300)
    assert first == pytest.approx((max(1.2, across), min(1.2, across)), rel=0.02)
    assert last == pytest.approx(first, rel=0.01)


@pytest.mark.parametrize(("stiffness", "damping"), [(0.02, 0.001), (0.05, 0.01), (0.02, 0.02)])
def test_damping_makes_such_an_orbit_the_same_circle_in_every_solver(stiffness, damping):
    found = [axes_after(orbiting(stiffness, damping, 5.0, solver=solver), 600) for solver in SOLVERS]
    for one in found:
        assert one == pytest.approx(found[0], rel=0.02)


def axes_after(world, ticks):
    """The axes of ten seconds, after so many ticks."""
    axes(world, ticks)
    return axes(world, 600)
