"""Friction acts where it touches: at the rim of a particle's disc, which turns with a body."""

import math

import numpy as np
import pytest

from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.marks import ALL_GROUPS, LINE, SOLID_LEFT
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from sandbox.physics.world import World
from tests.abuse.discs import angular_momentum, turning
from tests.support.contact_scenes import BODIES, FLOOR, add_discs, world

both_solvers = pytest.mark.parametrize("solver", ["direct", "iterative"])


def add_box(
    to: World, centre, size, rim, *, angle=0.0, velocity=(0.0, 0.0), spin=0.0, friction=0.5, firmness=1.0
) -> int:
    """A box of four particles of 1 kg, of springs of Cs = Cd = firmness; the first slot."""
    x, y = 0.5 * np.asarray(size)
    corners = np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    arms = corners[:, :1] * along + corners[:, 1:] * across
    first = to.particle_count
    to.add_particles(
        [f"box.{first + k}" for k in range(4)], np.asarray(centre) + arms,
        velocity=np.asarray(velocity) + spin * arms @ np.array([[0.0, 1.0], [-1.0, 0.0]]), radius=rim,
        friction=friction, rolling=0.0, owner=first, group=BODIES, collides=ALL_GROUPS,
    )  # fmt: skip
    a, b = first + np.array([0, 1, 2, 3, 0, 1]), first + np.array([1, 2, 3, 0, 2, 3])
    names = [f"box:{first}.{k}" for k in range(6)]
    to.add_springs(names[:4], a[:4], b[:4], stiffness=firmness, damping=firmness, edge=SOLID_LEFT)
    to.add_springs(names[4:], a[4:], b[4:], stiffness=firmness, damping=firmness)
    return first


def tips(size, rim: float, angle: float, solver: str, substeps: int) -> bool:
    """Whether a box on a slope [rad] on which it cannot slide tips over within 6 s."""
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    w = world(Chain([-50.0 * along, 50.0 * along]), solver=solver, substeps=substeps)
    a = add_box(w, (0.5 * size[1] + rim) * across, size, rim, angle=angle, friction=10.0)
    for _ in range(360):
        step(w)
        x, y = w.position[a + 1] - w.position[a]
        if abs(math.atan2(y, x) - angle) > 0.3:
            return True
    return False


# In one step the iterative solver lets the lower corner sink by 2 cm, which tips it 0.6 degrees sooner.
@pytest.mark.parametrize("solver, substeps", [("direct", 1), ("iterative", 4)])
@pytest.mark.parametrize("size, rim", [((0.4, 1.2), 0.1), ((0.9, 1.0), 0.3), ((0.6, 0.8), 0.02)])
def test_a_box_tips_over_the_rim_of_its_lower_corner(size, rim, solver, substeps):
    critical = math.atan2(0.5 * size[0], 0.5 * size[1] + rim)
    assert not tips(size, rim, critical - math.radians(0.4), solver, substeps)
    assert tips(size, rim, critical + math.radians(0.4), solver, substeps)


@pytest.mark.parametrize("solver, firmness", [("direct", 1.0), ("iterative", 1.0), ("single_pass", 0.2)])
@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize("rim, friction", [(0.1, 0.3), (0.25, 1.5)])
def test_boxes_that_rub_in_empty_space_keep_their_angular_momentum(rim, friction, substeps, solver, firmness):
    w = world(solver=solver, substeps=substeps, gravity=(0.0, 0.0))
    add_box(w, (0.0, 0.0), (1.0, 0.7), rim, friction=friction, firmness=firmness)
    add_box(
        w, (-0.7, 0.8 + 2.0 * rim), (0.8, 0.8), rim, angle=0.2, velocity=(1.5, -0.7), spin=0.4, friction=friction,
        firmness=firmness,
    )  # fmt: skip
    before, whole, energy = angular_momentum(w), turning(w), total_energy(w)
    for _ in range(120):
        step(w)
        assert total_energy(w) <= energy * (1.0 + (1e-9 if solver == "direct" else 1e-3))
        assert abs(angular_momentum(w) - before) <= 1e-9 * whole
    assert not np.allclose(w.velocity[:4], 0.0), "they have met"


@both_solvers
def test_a_disc_and_a_box_that_rub_keep_their_angular_momentum(solver):
    w = world(solver=solver, gravity=(0.0, 0.0))
    add_box(w, (0.0, 0.0), (1.0, 0.7), 0.15)
    add_discs(w, [(-0.2, 0.9)], radius=0.2, velocity=(1.5, -0.7), spin=-3.0, rolling=0.0)
    before, whole = angular_momentum(w), turning(w)
    for _ in range(120):
        step(w)
        assert abs(angular_momentum(w) - before) <= 1e-9 * whole
    assert not np.allclose(w.velocity[:4], 0.0), "they have met"


# In the iterative solver it gives way where it stands, and rolls by a little less.
@pytest.mark.parametrize(
    "solver, substeps, firmness, within",
    [("direct", 1, 1.0, 0.01), ("iterative", 1, 0.9, 0.04), ("iterative", 4, 0.9, 0.03)],
)
@pytest.mark.parametrize("radius, rim, corners", [(0.4, 0.15, 12), (0.7, 0.2, 16)])
def test_a_wheel_rolls_by_the_radius_of_its_rim(radius, rim, corners, solver, substeps, firmness, within):
    w = world(FLOOR, solver=solver, substeps=substeps)
    turns = math.tau * np.arange(corners) / corners
    rounds = radius * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    hub = np.array([0.0, radius + rim])
    speed = 1.5
    spin = -speed / (radius + rim)
    arms = np.concatenate([[(0.0, 0.0)], rounds])
    w.add_particles(
        [f"wheel.{k}" for k in range(corners + 1)], hub + arms,
        velocity=np.array([speed, 0.0]) + spin * arms @ np.array([[0.0, 1.0], [-1.0, 0.0]]), radius=rim, friction=1.0,
        owner=0, group=BODIES, collides=ALL_GROUPS,
    )  # fmt: skip
    corner, following = 1 + np.arange(corners), 1 + (1 + np.arange(corners)) % corners
    w.add_springs([f"rim:{k}" for k in corner], corner, following, stiffness=firmness, damping=firmness, edge=LINE)
    w.add_springs([f"spoke:{k}" for k in corner], 0 * corner, corner, stiffness=firmness, damping=firmness)
    turned, last = 0.0, 0.0
    for _ in range(120):
        step(w)
        x, y = w.position[1] - w.position[0]
        now = math.atan2(y, x)
        turned += (now - last + math.pi) % math.tau - math.pi
        last = now
    assert float(w.position[0, 0]) / -turned == pytest.approx(radius + rim, rel=within)
