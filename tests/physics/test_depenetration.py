"""Bodies that have come to overlap: which crossings are found, and that they come apart and keep their form."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy, total_energy
from sandbox.physics.marks import LINE
from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.pipeline.collide import CROSSED
from sandbox.physics.step import step
from tests.support.carts import ring_wheel
from tests.support.contact_scenes import FLOOR, add_discs, add_jelly, world
from tests.support.contacts import collisions_of, last_contacts
from tests.support.overlaps import overlaps
from tests.support.physics_scenes import scaled


def deepest(w):
    """The deepest overlap of two bodies [radii]."""
    return max(overlaps(w).depth.values(), default=0.0)


def strain(w, body):
    """How far a jelly's places are from its form, moved and turned to fit [m]."""
    form, place = (at[body] - at[body].mean(axis=0) for at in (w.origin, w.position))
    u, _, v = np.linalg.svd(form.T @ place)
    turn = u @ np.diag([1.0, np.sign(np.linalg.det(u @ v))]) @ v
    return float(np.abs(form @ turn - place).max())


@pytest.mark.parametrize("way", [(0.45, 0.1), (0.05, 0.02), (1e-6, 1e-6), (0.6, 0.6)])
@pytest.mark.parametrize(("stiffness", "damping"), [(0.9, 0.99), (0.1, 0.5)])
def test_two_boxes_in_each_other_come_free_in_two_seconds_and_gain_at_most_what_parts_them(way, stiffness, damping):
    w = world(gravity=(0.0, 0.0))
    size = scaled(1, 0) * 0.5 + 0.4
    one, other = (
        add_jelly(w, place, size=(size, size), stiffness=stiffness, damping=damping) for place in ((0.0, 0.0), way)
    )
    reduced = float(w.mass[one].sum()) / 2.0
    for _ in range(120):
        step(w)
        assert total_energy(w) <= 0.5 * reduced * 1.0**2 * (1.0 + 1e-9)
    assert deepest(w) == 0.0
    assert max(strain(w, one), strain(w, other)) < 0.01 * size


def test_boxes_in_each_other_on_a_floor_come_free():
    w = world(FLOOR)
    one, other = add_jelly(w, (0.0, 0.45)), add_jelly(w, (0.4, 0.55))
    start = total_energy(w)
    for _ in range(scaled(180, 3)):
        step(w)
        assert total_energy(w) <= start + 0.25 * float(w.mass[one].sum()) * 1.01
    if scaled(1, 0):
        assert deepest(w) == 0.0
        assert abs(float(w.position[one].mean() - w.position[other].mean())) > 0.1
        assert kinetic_energy(w) < 1.0


def test_a_small_body_inside_of_a_large_one_comes_out():
    w = world(gravity=(0.0, 0.0))
    add_jelly(w, (0.0, 0.0), size=(0.9, 0.9))
    add_jelly(w, (0.12, 0.03), size=(0.2, 0.2))
    for _ in range(scaled(90, 40)):
        step(w)
    assert deepest(w) == 0.0


def test_what_is_only_pressed_together_keeps_its_contacts():
    w = world(FLOOR)
    for k in range(3):
        add_jelly(w, (0.0, 0.5 + 0.95 * k), size=(0.9, 0.9))
    for _ in range(scaled(240, 3)):
        step(w)
    if scaled(1, 0):
        assert w.position[:, 1].max() > 2.6
        assert kinetic_energy(w) < 1e-3


def test_a_rope_that_is_drawn_out_of_a_box_goes_through_that_nowhere_else():
    # Its end is in the box; the rest goes round that and lies in a loop on top, caught in itself.
    w = world(FLOOR)
    add_jelly(w, (0.0, 0.5))
    left, top = [(-0.25, 0.5), (-0.45, 0.5), (-0.65, 0.5), (-0.65, 0.7), (-0.65, 0.9)], [-0.5, -0.3, -0.1, 0.1]
    places = [*left, *((x, 1.05) for x in top), (0.15, 1.2), (0.0, 1.25), (0.0, 1.08), (0.0, 1.0)]
    rope = w.particle_count + np.arange(len(places))
    add_discs(w, [(2.0 + 0.2 * k, 3.0) for k in range(len(places))], radius=0.025, owner=rope[0])
    w.add_springs(
        [f"rope:{k}" for k in rope[1:]], rope[:-1], rope[1:], rest_length=0.2, stiffness=0.3, damping=0.6, edge=LINE
    )
    w.position[rope] = places
    for _ in range(scaled(30, 6)):
        step(w)
        assert overlaps(w).lines <= 1
        # To a fifth of its own radius; beside the box it hangs down.
        loop = w.position[rope[5:]]
        above = np.abs(loop[:, 0]) < 0.45
        assert above.sum() >= 6
        assert loop[above, 1].min() > w.position[: rope[0], 1].max() - 0.005
    assert overlaps(w).lines <= scaled(0, 1)


@pytest.mark.parametrize("saved", [0.0, 10.0])
def test_what_lies_deep_in_each_other_comes_apart_as_far_as_it_has_saved_for_that(saved):
    w = world(FLOOR)
    rope = add_discs(w, [(0.1 * (k - 6), 0.025) for k in range(13)], radius=0.025, owner=500) + np.arange(13)
    w.add_springs(
        [f"rope:{k}" for k in rope[1:]], rope[:-1], rope[1:], stiffness=0.9, damping=0.99, edge=LINE
    )  # fmt: skip
    # Their surfaces are 1.8 radii in each other.
    box = add_jelly(w, (0.03, 0.48))
    step(w)
    for body in (rope, box):
        w.energy_bank[body] = 0.0
        w.parting_reserve[body] = 0.0
        w.parting_reserve[np.arange(w.particle_count)[body][0]] = saved * float(w.mass[body].sum())
    for _ in range(scaled(20, 2)):
        step(w)
    if scaled(1, 0):
        assert (last_contacts(w).gap.min() > -0.025) == (saved > 0.0)


def test_a_body_that_has_come_deep_through_itself_rubs_on_nothing():
    w = world(FLOOR)
    through, whole = add_jelly(w, (0.0, 0.475)), add_jelly(w, (2.0, 0.475))
    # Its upper right corner, through the left side.
    w.position[np.argmax(w.position[through].sum(axis=1))] = (-0.6, 0.53)
    assert deepest(w) > 1.0
    step(w)
    contacts = last_contacts(w)
    rubs = contacts.friction > 0.0
    assert set(w.owner[contacts.particle[~rubs]]) == {w.owner[through][0]}
    assert set(w.owner[contacts.particle[rubs]]) == {w.owner[whole][0]}


def add_lines(to, points, pairs):
    """A body of lines; its slots."""
    first = add_discs(to, points, radius=1e-6, owner=to.particle_count + 1)
    a, b = first + np.array(pairs).T
    to.add_springs([f"line:{to.spring_count + k}" for k in range(len(a))], a, b, stiffness=0.5, damping=0.5, edge=LINE)
    return slice(first, first + len(points))


def crossings(w, place):
    """Pairs of edges that cross at these places, by number; of a body's own also where it was made."""
    outline = outline_of(w)
    edges = list(zip(outline.edge_a.tolist(), outline.edge_b.tolist(), strict=True))

    def side(a, b, p):
        return (b[0] - a[0]) * (p[1] - a[1]) > (b[1] - a[1]) * (p[0] - a[0])

    def cross(at, a, b, c, d):
        p, q, r, s = at[[a, b, c, d]].tolist()
        return side(p, q, r) != side(p, q, s) and side(r, s, p) != side(r, s, q)

    found = 0
    for e in range(len(edges)):
        for f in range(e):
            if set(edges[e]) & set(edges[f]) or not cross(place, *edges[e], *edges[f]):
                continue
            own = w.owner[edges[e][0]] == w.owner[edges[f][0]]
            found += not (own and cross(w.origin, *edges[e], *edges[f]))
    return found


@pytest.mark.parametrize("bend", [0.0, 0.05, 0.15, 0.5])
def test_every_crossing_of_lines_is_found_however_bodies_are_bent_and_wherever_they_lie(bend):
    generator = np.random.default_rng(7)
    w = world(gravity=(0.0, 0.0))
    wheel = ring_wheel(segments=9)
    bodies = [add_lines(w, *wheel), add_lines(w, *ring_wheel((0.9, 0.3), segments=7))]
    bodies.append(add_lines(w, [(0.2 * k - 1.0, -0.4) for k in range(14)], [(k, k + 1) for k in range(13)]))
    totals = []
    for _ in range(6):
        place = w.origin.copy()
        for body in bodies:
            angle, own = generator.uniform(0.0, 6.28), place[body] - place[body].mean(axis=0)
            turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            place[body] = own @ turn + generator.uniform(-0.9, 0.9, 2)
        place += bend * generator.uniform(-1.0, 1.0, place.shape)
        w.position[:], w.velocity[:] = place, 0.0
        step(w)
        totals.append(int(collisions_of(w).counts[CROSSED]))
        assert totals[-1] == crossings(w, place)
    assert max(totals) > 10


def test_a_wheel_that_has_kept_its_form_and_meets_nothing_is_not_searched():
    w = world(gravity=(0.0, 0.0))
    wheel = add_lines(w, *ring_wheel())
    w.position[wheel] = w.position[wheel][:, ::-1] * (-1.0, 1.0) + (3.0, 1.0)
    step(w)
    assert collisions_of(w).shape_bounds.intact.all()
    w.position[wheel.start + 1] += (0.0, -1.5)
    step(w)
    assert not collisions_of(w).shape_bounds.intact.any()
