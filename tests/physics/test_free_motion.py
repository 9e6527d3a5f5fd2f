"""Free motion is free: nothing inside a body turns it, pendulums keep their swing, what flies is where it should be."""

import math

import numpy as np
import pytest

from sandbox.physics.jit import COMPILED
from sandbox.physics.solvers import SOLVERS
from tests.support.situations import advance, angular_momentum, session_of, slots_of

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")

WEIGHTLESS = [0.0, 0.0]
FORMS = {
    "dumbbell": ([[-0.5, 0.0], [0.5, 0.0]], [[0, 1]]),
    "square": ([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]]),
}


def turning(form, rate, *, stiffness=1.0, damping=1.0, pinned=(), **settings):
    """A mesh that turns at rate [rad/s] about the origin."""
    places, springs = FORMS[form]
    return session_of(
        settings={"gravity": WEIGHTLESS, **settings}, materials={"m": {"stiffness": stiffness, "damping": damping}},
        bodies=[{
            "type": "mesh", "id": "k", "particles": places, "springs": springs, "material": "m",
            "velocities": [[-rate * y, rate * x] for x, y in places], "pinned": list(pinned),
        }],
    )  # fmt: skip


def kinetic(session):
    world = session.world
    return 0.5 * float(np.sum(world.mass[:, None] * world.velocity**2))


@pytest.mark.parametrize("settings", [{}, {"substeps": 4}, {"substeps": "auto"}], ids=str)
@pytest.mark.parametrize("form", FORMS)
def test_a_rigid_body_turns_for_ever(form, settings):
    for rate in (3.0, 20.0, 60.0):
        session = turning(form, rate, **settings)
        body = slots_of(session, "k")
        spin, energy = angular_momentum(session, body), kinetic(session)
        advance(session, 600)
        assert angular_momentum(session, body) == pytest.approx(spin, rel=1e-11), rate
        # At a radian a step what it stretches by holds a part of that.
        assert kinetic(session) == pytest.approx(energy, rel=1e-6 if rate < 60.0 else 5e-3), rate


@pytest.mark.parametrize("solver", SOLVERS)
def test_nothing_inside_a_free_body_turns_it_whatever_its_springs(solver):
    for stiffness, damping in ((0.1, 0.3), (0.3, 0.3)):
        session = turning("square", 10.0, stiffness=stiffness, damping=damping, solver=solver)
        body = slots_of(session, "k")
        spin = angular_momentum(session, body)
        advance(session, 600)
        assert angular_momentum(session, body) == pytest.approx(spin, rel=1e-11)


BODIES = {
    "jelly": {"type": "jelly", "shape": {"box": [1, 1]}, "spacing": 0.25},
    "wheel": {"type": "wheel", "radius": 0.5, "thickness": 0.15, "segments": 12},
    "ring": {"type": "ring", "radius": 0.5, "segments": 12},
    "girder": {"type": "girder", "segments": 4, "height": 0.4, "start": [0, 0], "end": [2, 0]},
    "rope": {"type": "rope", "segments": 8, "start": [0, 0], "end": [2, 0]},
}


def set_turning(session, particles, rate, about):
    """Give them the velocities of a turn at rate [rad/s] about a place."""
    x, y = (session.world.position[particles] - about).T
    session.world.velocity[particles] = rate * np.stack([-y, x], axis=1)


@pytest.mark.parametrize("substeps", [1, 8, "auto"])
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("body", BODIES)
def test_bodies_of_all_kinds_keep_their_angular_momentum(body, solver, substeps):
    materials = [(0.02, 0.03)] if solver == "single_pass" else [(0.2, 0.3), (1.0, 1.0)]
    for stiffness, damping in materials:
        for rate in (3.0, 60.0):
            session = session_of(
                settings={"gravity": WEIGHTLESS, "solver": solver, "substeps": substeps},
                materials={"m": {"stiffness": stiffness, "damping": damping}},
                bodies=[{**BODIES[body], "id": "k", "material": "m"}],
            )
            particles = slots_of(session, "k")
            set_turning(session, particles, rate, np.average(session.world.position[particles], axis=0))
            spin = angular_momentum(session, particles)
            advance(session, 240)
            assert angular_momentum(session, particles) == pytest.approx(spin, rel=1e-11), (stiffness, rate)


@pytest.mark.parametrize("substeps", [1, 4])
def test_a_rigid_wheel_turns_on_its_pin_for_ever_through_the_angle_of_its_spin(substeps):
    for rate in (3.0, 20.0):
        wheel = {**BODIES["wheel"], "id": "k", "material": "m", "pin": ["hub"], "position": [0, 0]}
        session = session_of(settings={"gravity": WEIGHTLESS, "substeps": substeps}, bodies=[wheel])
        world, particles, hub = session.world, slots_of(session, "k"), session.world.particle_slot("k.hub")
        rim = particles[particles != hub]
        set_turning(session, rim, rate, world.position[hub])
        before = angular_momentum(session, rim, world.position[hub].copy())
        advance(session, 600)
        assert angular_momentum(session, rim, world.position[hub]) == pytest.approx(before, rel=1e-11)


def period_of(length, angle):
    """Period [s] of a pendulum: 2 pi sqrt(L / g) over the mean of 1 and cos(angle / 2) as Gauss makes it."""
    a, b = 1.0, math.cos(0.5 * angle)
    for _ in range(30):
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return 2.0 * math.pi * math.sqrt(length / 9.81) / a


@pytest.mark.parametrize("length", [0.1, 0.3, 1.0, 2.0])
@pytest.mark.parametrize("degrees", [10.0, 45.0, 90.0, 135.0, 170.0])
def test_a_pendulum_swings_as_far_after_a_minute_and_keeps_its_period(length, degrees):
    angle = math.radians(degrees)
    end = [length * math.sin(angle), -length * math.cos(angle)]
    session = session_of(
        bodies=[{
            "type": "rope", "id": "r", "start": [0, 0], "end": end, "segments": 1, "pin": ["start"], "material": "m",
        }],
    )  # fmt: skip
    slot, highest, before, crossed = session.world.particle_slot("r.end"), 0.0, angle, []
    for tick in range(3600):
        advance(session, 1)
        x, y = session.world.position[slot]
        now = math.atan2(x, -y)
        if before > 0.0 >= now and before - now < 2.0:
            crossed.append(tick + before / (before - now))
        before = now
        if tick > 3240:
            highest = max(highest, abs(now))
    assert math.degrees(highest) == pytest.approx(degrees, rel=0.015)
    period = (crossed[-1] - crossed[0]) / (len(crossed) - 1) / 60.0
    # So near to the top a hundredth of the swing is a twelfth of the period.
    share = 0.03 if (length, degrees) == (0.1, 170.0) else 0.005
    assert period == pytest.approx(period_of(length, angle), rel=share)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("contacts", [None, {}], ids=["alone", "with contacts"])
def test_what_flies_is_where_the_parabola_is(solver, contacts):
    for substeps in (1, 4):
        session = session_of(
            settings={"solver": solver, "substeps": substeps}, contacts=contacts,
            materials={"m": {"stiffness": 0.2, "damping": 0.3}},
            particles=[{"id": "d", "position": [0, 0], "velocity": [3, 4]}],
            bodies=[{
                "type": "rope", "id": "r", "start": [5, 0], "end": [6, 0], "segments": 3, "velocity": [3, 4],
                "material": "m",
            }],
        )  # fmt: skip
        advance(session, 60)
        fallen = 4.0 - 9.81 / 2.0
        assert session.world.position[session.world.particle_slot("d")] == pytest.approx([3.0, fallen], rel=1e-12)
        assert session.world.position[slots_of(session, "r"), 1] == pytest.approx(fallen, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("solver", "substeps"), [*((solver, 1) for solver in SOLVERS), *(("direct", parts) for parts in (2, 4, 8))]
)
def test_springs_sag_as_the_books_say_whatever_damping_air_and_substeps(solver, substeps):
    h = 1.0 / 60.0
    for drag in (0.0, 10.0, 60.0):
        for material, sag in (
            ({"law": "hooke", "k": 100.0, "c": 5.0}, 9.81 / 100.0),
            ({"stiffness": 0.3, "damping": 0.5}, 9.81 * h * h * 0.5 / 0.3),
        ):
            session = session_of(
                settings={"solver": solver, "drag": drag, "substeps": substeps}, materials={"m": material},
                particles=[
                    {"id": "nail", "position": [0, 0], "pinned": True}, {"id": "b", "position": [0, -1 - sag - 0.01]},
                ],
                springs=[{"a": "nail", "b": "b", "rest_length": 1.0, "material": "m"}],
            )  # fmt: skip
            advance(session, 9000)
            assert -1.0 - session.world.position[session.world.particle_slot("b"), 1] == pytest.approx(sag, rel=1e-9)


def test_a_particle_that_is_cut_out_of_a_jelly_rolls_as_a_loose_disc():
    slope = {"id": "slope", "polyline": [[-40.0, 20.0], [40.0, -20.0]]}
    spins = []
    for is_cut in (True, False):
        disc = {"id": "d", "position": [0, 0.5], "radius": 0.1, "friction": 0.8}
        jelly = {
            "type": "jelly", "id": "k", "shape": {"box": [1, 1]}, "spacing": 0.5, "position": [0, 1.5],
            "material": "m", "particle_radius": 0.1, "friction": 0.8,
        }  # fmt: skip
        session = session_of(
            contacts={}, terrain=[slope], bodies=[jelly] if is_cut else [], particles=[] if is_cut else [disc]
        )
        world = session.world
        if is_cut:
            world.cut(np.flatnonzero(world.spring_active).tolist())
        advance(session, 120)
        spins.append(float(np.abs(world.spin).max()))
    assert min(spins) > 10.0
