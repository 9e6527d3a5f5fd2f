"""A seeded sample of tests/abuse: stirred heaps, random scenes after the hands have let go, and lines in bodies."""

import numpy as np
import pytest

from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.jelly import JellyDef
from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.jit import COMPILED
from sandbox.physics.marks import ALL_GROUPS, LINE
from sandbox.physics.settings import AUTO
from sandbox.physics.step import step
from tests.support.contact_scenes import BODIES, add_discs, add_jelly, world
from tests.support.contacts import last_contacts
from tests.support.overlaps import overlaps
from tests.support.random_scenes import energies, kept_scene, random_scene
from tests.support.stirring import heap, stir

pytestmark = pytest.mark.skipif(not COMPILED, reason="takes minutes where kernels are interpreted")


# In 2057 a truss of 19 t that lies in the ground must not be pushed out of it by what a ball of 0.15 kg lost on it.
@pytest.mark.parametrize("name", ["abuse-2057", "abuse-2109", "abuse-2167", "abuse-2198"])
def test_no_energy_appears_after_the_hands_have_let_go(name):
    found = energies(*kept_scene(name), 120)
    assert found.over <= 1.001
    assert found.growth <= 0.05


# With banks that kept what hands had put in, or all that contacts of a stiff rope might cost, these grew by .3 to 32 %.
# Where the parts of a tick had other k, the last two had 2.9 and 1.6 times the energy of the release. In 138 two discs
# travel together in small steps and bounce; in 567 a jelly that was folded over sprang back with what a crash had cost.
@pytest.mark.parametrize(
    ("seed", "substeps"),
    [(k, None) for k in (138, 348, 360, 424, 449, 460, 567)] + [(29, AUTO), (32, AUTO)],
)
def test_in_random_scenes_no_energy_appears(seed, substeps):
    found = energies(*random_scene(seed, substeps=substeps), 90)
    assert found.over <= 1.001
    assert found.growth <= 0.05


def test_bouncy_springs_have_at_most_four_times_the_energy_of_the_release():
    assert energies(*kept_scene("abuse-2076"), 120).over <= 4.01


@pytest.mark.parametrize("seed", [0, 3, 4, 6, 7, 8])
def test_in_random_scenes_of_the_softest_springs_no_energy_appears(seed):
    found = energies(*random_scene(seed, softest=True), 90)
    assert np.isfinite(found.total).all()
    assert found.over <= 1.001
    assert found.growth <= 0.05


# A cloth that is caught in itself must let go: springs of the second held 15 times what they had held before. In the
# third nothing paid for the way out of a rope that a box lay on; in the fourth a plank was wound in itself; in the
# fifth a box whose corner had been drawn through it could not come back; in the last friction of the floor held what
# had come through itself.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "damping", "speed", "seed"),
    [
        (0.1, 0.5, 20.0, 0), (0.9, 0.99, 20.0, 0), (0.5, 0.9, 20.0, 880009),
        pytest.param(0.02, 0.1, 80.0, 128, marks=pytest.mark.whole_world),
        pytest.param(0.02, 0.1, 20.0, 1228, marks=pytest.mark.whole_world),
        pytest.param(0.1, 0.5, 5.0, 51008, marks=pytest.mark.whole_world),
    ],
)  # fmt: skip
def test_a_stirred_heap_lies_in_no_knots_five_seconds_later(stiffness, damping, speed, seed):
    found = stir(heap(stiffness, damping, seed), speed, seed)
    assert found.deepest <= 1.5
    assert found.lines == 0
    # Of 36 such runs one is above twice.
    assert found.springs <= 4.0
    assert found.gain <= 1.001
    assert not found.stays


def add_line(to, points, pinned=(), **options):
    """A rope of 0.1 kg particles through these points; the first slot."""
    first = add_discs(
        to, points, radius=0.02, mass=0.1, owner=to.particle_count, pinned=[k in pinned for k in range(len(points))]
    )  # fmt: skip
    a = first + np.arange(len(points) - 1)
    to.add_springs([f"line:{k}" for k in a], a, a + 1, stiffness=0.9, damping=0.99, edge=LINE, **options)
    return first


@pytest.mark.parametrize(("height", "touches"), [(0.0, False), (-0.12, True)])
@pytest.mark.parametrize("has_solid", [True, False])
def test_what_is_caught_in_a_mesh_of_lines_does_not_push_it_open(has_solid, height, touches):
    w = world(gravity=(0.0, 0.0))
    if has_solid:
        add_jelly(w, (3.0, 0.0))
    net = add_discs(w, [(-0.1, -0.06), (0.1, -0.06), (0.0, 0.12)], radius=0.05, owner=1)
    a = np.arange(3)
    w.add_springs([f"net:{k}" for k in a], net + a, net + (a + 1) % 3, stiffness=0.9, damping=0.99, edge=LINE)
    add_line(w, [(0.2 * (k - 2), height) for k in range(5)])
    step(w)
    contacts = last_contacts(w)
    assert bool(np.any((contacts.end_b >= 0) & (contacts.gap < 0.0))) == touches


@pytest.mark.parametrize("pinned", [(), (0,), (0, 20)])
def test_a_rope_that_goes_right_through_a_body_comes_out_at_the_nearer_side(pinned):
    w = world(gravity=(0.0, 0.0))
    jelly = add_jelly(w, (0.0, 0.0), size=(0.8, 0.8))
    rope = add_line(w, [(0.1 * (k - 10), 0.23) for k in range(21)], pinned)
    assert overlaps(w).lines > 0
    start = total_energy(w)
    for _ in range(150):
        step(w)
    assert overlaps(w).lines == 0
    assert float(w.position[rope + 10, 1]) > float(w.position[jelly, 1].max())
    assert total_energy(w) <= start + 0.5 * 2.1 + 1e-9


def test_a_corner_that_pokes_through_a_rope_goes_back_and_a_rope_s_end_comes_out_the_way_it_went_in():
    w = world(gravity=(0.0, 0.0))
    jelly = add_jelly(w, (0.0, 0.0), size=(0.8, 0.8), angle=np.pi / 4.0)
    corner = float(w.position[jelly, 1].max())
    above = add_line(w, [(0.2 * (k - 5) + 0.1, corner - 0.06) for k in range(11)])
    end = add_line(w, [(0.35 + 0.1 * k, 0.02) for k in range(8)])
    assert overlaps(w).lines >= 3
    for _ in range(150):
        step(w)
    assert overlaps(w).lines == 0
    assert float(w.position[above + 5, 1]) > float(w.position[jelly, 1].max()) - 0.1
    assert float(w.position[end, 0]) > float(w.position[jelly, 0].mean())


def test_a_body_that_has_come_through_itself_comes_out_again():
    w = world(gravity=(0.0, 0.0))
    corners = (
        (-0.6, 0.0), (0.6, 0.0), (0.6, 1.2), (0.3, 1.2), (0.3, 0.3), (-0.3, 0.3), (-0.3, 1.2), (-0.6, 1.2),
    )  # fmt: skip
    made = expansion(
        JellyDef.model_validate({"type": "jelly", "id": "u", "shape": {"polygon": corners}, "spacing": 0.15})
    )
    # Both legs leaned inwards, through each other.
    form = np.array(made.form)
    lean = np.clip((form[:, 1] - 0.3) / 0.9, 0.0, None)
    places = form - np.stack([np.sign(form[:, 0]) * 0.75 * lean, 0.0 * lean], axis=1)
    w.add_particles(
        [f"u.{k}" for k in range(len(form))],
        form,
        radius=0.03,
        owner=1,
        group=BODIES,
        collides=ALL_GROUPS,
        friction=0.5,
    )
    pairs = made.pairs
    w.add_springs([f"u:{k}" for k in range(len(pairs))], *pairs.T, stiffness=0.5, damping=0.9, edge=made.edges)
    w.position[:] = places
    assert max(overlaps(w).depth.values()) > 1.0
    start = total_energy(w)
    for _ in range(180):
        step(w)
        assert total_energy(w) <= start * (1.0 + 1e-9)
    assert not overlaps(w).depth
    assert total_energy(w) < 0.05 * start
