"""Which crossings of lines are found: all of them, however few edges are compared."""

import numpy as np
import pytest

from sandbox.physics.marks import LINE
from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.pipeline.collide import CROSSED
from sandbox.physics.step import step
from tests.support.carts import ring_wheel
from tests.support.contact_scenes import add_discs, world
from tests.support.contacts import collisions_of


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
