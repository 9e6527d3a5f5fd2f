"""Contact points and elastic forces, as they are shown: where they are, and that they carry what lies on them."""

from dataclasses import replace

import numpy as np
import pytest

from sandbox.physics.analysis.applied_forces import contact_points
from sandbox.physics.analysis.energy import spring_forces
from sandbox.physics.analysis.stability import BOUND, spring_loads, stability_shares
from sandbox.physics.settings import WorldSettings
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from sandbox.physics.world import World
from tests.support.contact_scenes import add_discs, add_jelly, world


def rested(made, ticks=240):
    for _ in range(ticks):
        step(made)
    return made


def weight_of(made):
    return 9.81 * made.mass[made.inverse_mass > 0.0].sum()


@pytest.mark.parametrize("kind", ["line", "solid"])
def test_discs_at_rest_are_pushed_upward_at_their_lowest_point_by_their_weight(kind):
    ground = Chain(np.array([[-5.0, -1.0], [5.0, -1.0], [5.0, 0.0], [-5.0, 0.0]]), "solid")
    chains = [ground] if kind == "solid" else [Chain(np.array([[-5.0, 0.0], [5.0, 0.0]]))]
    made = world(*chains)
    add_discs(made, [[-1.0, 0.1], [1.0, 0.1]])
    rested(made, 60)
    found = contact_points(made)
    assert found.particle.tolist() == [0, 1]
    assert found.normal == pytest.approx(np.array([[0.0, 1.0]] * 2))
    assert found.point[:, 1] == pytest.approx(np.zeros(2), abs=2e-3)
    assert found.force[:, 1].sum() == pytest.approx(weight_of(made), rel=0.02)


def test_a_disc_on_a_jelly_and_one_on_a_disc_are_pushed_away_from_what_they_lie_on():
    made = world(Chain(np.array([[-5.0, 0.0], [5.0, 0.0]])))
    add_jelly(made, (0.0, 0.5))
    add_discs(made, [[0.0, 1.06], [3.0, 0.1], [3.0, 0.3]])
    rested(made, 90)
    found = contact_points(made)
    count = len(made.mass)
    upper = found.particle >= count - 3
    assert (found.normal[upper, 1] > 0.9).all() and upper.sum() >= 3
    apart = np.sqrt(((found.point - made.position[found.particle]) ** 2).sum(axis=1))
    assert (apart <= made.radius[found.particle] + 1e-9).all()
    assert found.force[:, 1].sum() >= weight_of(made) * 0.9


def test_contacts_with_what_is_gone_are_left_out():
    made = world(Chain(np.array([[-5.0, 0.0], [5.0, 0.0]])))
    add_discs(made, [[0.0, 0.1]])
    rested(made, 20)
    made.contact_feature[0] = 3 * 10_000 + 2
    assert len(contact_points(made).particle) == 0


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_spring_pulls_with_the_weight_that_hangs_on_it(solver):
    made = World(WorldSettings(solver=solver))
    made.add_particles(["pin", "weight"], np.array([[0.0, 0.0], [0.0, -1.0]]), mass=2.0, pinned=[True, False])
    made.add_springs(["s"], [0], [1], stiffness=0.05, damping=0.1)
    rested(made, 600)
    forces = spring_forces(made)
    assert forces[0] == pytest.approx(2.0 * 9.81, rel=1e-3)


def test_stability_is_a_share_of_the_proven_limit_and_under_a_solver_that_bounds_the_energy_nothing_is_past_it():
    made = world()
    add_jelly(made, (0.0, 0.5), stiffness=0.9, damping=0.2)
    assert set(stability_shares(made).tolist()) <= {0.0, 1.0} and stability_shares(made).max() == 1.0
    made.settings = replace(made.settings, solver="single_pass")
    assert stability_shares(made) == pytest.approx(spring_loads(made)[: made.spring_count] / BOUND)
    assert stability_shares(made).max() > 1.0
