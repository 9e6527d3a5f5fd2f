"""Areas and bends of bodies that touch, and of bodies that break."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.breaking import StrainLimits
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.marks import ALL_GROUPS, LINE
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.pipeline.tick import find_broken
from sandbox.physics.settings import AUTO
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.solvers.direct import layout
from sandbox.physics.step import step
from tests.support.contact_scenes import BODIES, FLOOR, GROUND, add_discs, add_jelly, world
from tests.support.physics_scenes import run, scaled

every_solver = pytest.mark.parametrize("solver", SOLVERS)


def add_filled_jelly(to, position, *, stiffness=0.5, damping=0.9, **options):
    """A box of jelly that keeps the area of its triangles; its slots."""
    slots = add_jelly(to, position, stiffness=stiffness, damping=damping, **options)
    count = slots.stop - slots.start
    side = round(count**0.5)
    corner = [slots.start + k for k in range(count) if k % side < side - 1 and k // side < side - 1]
    triangles = [(k, k + 1, k + side + 1) for k in corner] + [(k, k + side + 1, k + side) for k in corner]
    to.add_constraints(AREA, triangles, stiffness=stiffness, damping=damping)
    return slots


def add_ring(to, position, *, radius=0.5, segments=16, inflation=1.0, stiffness=0.8, damping=0.9):
    """A ring of particles that keeps the area inside and its angles; its slots."""
    angle = np.arange(segments) * (2.0 * np.pi / segments)
    points = np.asarray(position) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    first = to.particle_count
    to.add_particles(
        [f"ring.{first + k}" for k in range(segments)], points, radius=0.03, mass=0.2, friction=0.5, owner=first,
        group=BODIES, collides=ALL_GROUPS,
    )  # fmt: skip
    k = np.arange(segments)
    after, last = (k + 1) % segments, (k - 1) % segments
    to.add_springs(
        [f"ring:{first + i}" for i in k], first + k, first + after, stiffness=stiffness, damping=damping, edge=LINE
    )
    to.add_constraints(AREA, [first + k], inflation=inflation, stiffness=stiffness, damping=damping)
    to.add_constraints(BEND, np.stack([first + last, first + k, first + after], axis=1), stiffness=0.1, damping=0.5)
    return slice(first, first + segments)


def area(places):
    x, y = places[:, 0], places[:, 1]
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


@pytest.mark.parametrize("substeps", [1, AUTO])
def test_jellies_and_rings_with_areas_come_to_rest_on_the_ground(substeps):
    w = world(GROUND, substeps=substeps)
    add_filled_jelly(w, (0.0, 0.6))
    add_filled_jelly(w, (0.1, 1.7), angle=0.1)
    ring = add_ring(w, (2.0, 0.7), inflation=1.1)
    form = area(w.position[ring])
    run(w, scaled(500, 5))
    assert np.all(w.position[w.particle_active, 1] > 0.0)
    if scaled(1, 0):
        assert np.abs(w.velocity).max() < 0.05
        assert area(w.position[ring]) == pytest.approx(1.05 * form, rel=0.06)


@every_solver
def test_a_weight_on_a_balloon_is_carried_by_its_area(solver):
    heights = []
    for inflation in (1.0, None):
        w = world(FLOOR, solver=solver, iterations=60, substeps=4)
        ring = add_ring(w, (0.0, 0.54), stiffness=0.3, damping=0.3)
        w.change("constraint_active", False, w.constraint_kind == BEND)
        if inflation is None:
            w.change("constraint_active", False)
        add_discs(w, [(0.0, 1.2)], mass=3.0)
        run(w, scaled(240, 40))
        heights.append(np.ptp(w.position[ring, 1]))
    assert heights[0] > heights[1] + 0.2


def test_energy_never_rises_where_bodies_with_areas_touch():
    generator = np.random.default_rng(4)
    for substeps in (1, 4):
        w = world(GROUND, substeps=substeps)
        for k in range(3):
            add_filled_jelly(w, (0.3 * k, 0.8 + 1.4 * k), angle=generator.uniform(0.0, 6.0), velocity=(0.0, -5.0))
        add_ring(w, (5.0, 0.7), inflation=1.5)
        add_ring(w, (5.4, 2.1))
        energy = total_energy(w)
        for _ in range(scaled(90, 6)):
            step(w)
            assert total_energy(w) <= energy * (1.0 + 1e-6)


def test_a_wide_area_answers_to_contacts_as_a_narrow_one_does(monkeypatch):
    places = []
    for narrow in (3, 2):
        monkeypatch.setattr(layout, "NARROW", narrow)
        w = world(GROUND)
        ring = add_ring(w, (0.0, 0.6), segments=3)
        add_discs(w, [(0.1, 1.5)], mass=5.0)
        run(w, 40)
        assert len(w.contact_particle)
        places.append(w.position[ring].copy())
    assert np.abs(places[0] - places[1]).max() < 1e-8


def test_a_tangled_jelly_finds_its_form_again_on_the_ground():
    w = world(GROUND)
    jelly = add_filled_jelly(w, (0.0, 0.5), stiffness=0.7, damping=0.8)
    form = w.position[jelly].copy()
    w.position[jelly] = form * (1.0, 0.05) + (0.0, 0.1)
    w.position[jelly.start + 44] += (0.0, 0.3)
    w.trust()
    run(w, scaled(400, 10))
    if scaled(1, 0):
        height = np.ptp(w.position[jelly, 1])
        width = np.ptp(w.position[jelly, 0])
        assert max(height, width) == pytest.approx(0.9, rel=0.1)


@every_solver
def test_what_a_body_keeps_goes_with_the_springs_that_break(solver):
    w = world(solver=solver, gravity=(0.0, 0.0))
    jelly = add_filled_jelly(w, (0.0, 0.0))
    ring = add_ring(w, (3.0, 0.0))
    w.limits = StrainLimits(np.full(1, 0.3), np.full(1, np.inf), np.full(1, np.inf), np.zeros(1))
    w.position[jelly.start] -= (0.05, 0.05)
    w.position[ring.start] += (0.15, 0.0)
    block = block_of(w)
    w.break_springs(block.arrays.limits.broken[: find_broken(block.pointer)].copy())
    assert len(w.broken) >= 4
    run(w, 3)
    sides = {frozenset((int(w.particle_a[s]), int(w.particle_b[s]))) for s in np.flatnonzero(w.spring_active)}
    gone = 0
    for k in range(w.constraint_count):
        corners = w.corner_particle[w.constraint_first[k] :][: w.constraint_corners[k]].tolist()
        pairs = list(zip(corners, [*corners[1:], corners[0]], strict=True))[
            : 2 if w.constraint_kind[k] == BEND else None
        ]
        whole = all(frozenset(pair) in sides for pair in pairs)
        assert w.constraint_active[k] == whole
        gone += not whole
    assert gone >= 4


def test_a_side_that_two_springs_hold_keeps_its_area_until_both_are_gone():
    w = world()
    w.add_particles(["a", "b", "c"], [(0, 0), (1, 0), (0, 1)])
    w.add_springs(["ab", "bc", "ca", "ba"], [0, 1, 2, 1], [1, 2, 0, 0])
    w.add_constraints(AREA, [[0, 1, 2]])
    w.cut([0])
    assert w.constraint_active[0]
    w.break_springs(np.array([3]))
    assert not w.constraint_active[0]


@every_solver
def test_a_run_with_areas_and_contacts_goes_on_from_a_snapshot_with_the_same_bits(solver):
    w = world(GROUND, solver=solver, substeps=AUTO)
    add_filled_jelly(w, (0.0, 0.6), stiffness=0.1, damping=0.2)
    add_ring(w, (0.2, 1.8), stiffness=0.1, damping=0.2)
    w.limits = StrainLimits(np.full(1, 0.5), np.full(1, 0.6), np.full(1, 0.1), np.full(1, 0.2))
    run(w, 20)
    kept = take(w)
    run(w, scaled(40, 6))
    expected = state_hash(w)
    restore(w, kept)
    run(w, scaled(40, 6))
    assert state_hash(w) == expected
    assert len(w.contact_particle)
