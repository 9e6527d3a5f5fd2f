"""Rigid motion of random points, and best turns against the polar decomposition."""

import numpy as np
import pytest

from sandbox.physics.geometry.rigid import (
    RigidMotion,
    WeightedSums,
    best_turn,
    centre_of,
    fit_of,
    momentum_about,
    rotated,
    turn_rate,
    velocity_at,
    with_pair,
    with_point,
    with_spin,
    with_turn,
)

RANDOM = np.random.default_rng(11)
MASS = RANDOM.uniform(0.1, 3.0, 12)
PLACE, VELOCITY = RANDOM.normal(size=(2, 12, 2))


def motion_of(mass, place, velocity):
    points = list(zip(mass, *place.T, *velocity.T, strict=True))
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for point in points:
        sums = with_point(sums, *point)
    motion = centre_of(sums)
    for point in points:
        motion = with_turn(motion, *point)
    return motion


def momenta(mass, place, velocity):
    """Momentum, and angular momentum about the origin."""
    return *(mass @ velocity), np.sum(mass * (place[:, 0] * velocity[:, 1] - place[:, 1] * velocity[:, 0]))


def test_a_rigid_motion_has_all_momenta_of_the_points_and_the_least_kinetic_energy():
    motion = motion_of(MASS, PLACE, VELOCITY)
    rigid = np.array([velocity_at(motion, x, y) for x, y in PLACE])
    assert momenta(MASS, PLACE, rigid) == pytest.approx(momenta(MASS, PLACE, VELOCITY), rel=1e-12)
    # What is left beside it is at right angles to it, weighed by mass: no other motion of these momenta has less.
    assert np.sum(MASS[:, None] * rigid * (VELOCITY - rigid)) == pytest.approx(0.0, abs=1e-12)
    centre = MASS @ PLACE / MASS.sum()
    assert (motion.x, motion.y) == pytest.approx(tuple(centre), rel=1e-13)
    assert motion.inertia == pytest.approx(MASS @ np.sum((PLACE - centre) ** 2, axis=1), rel=1e-13)


def test_what_turns_as_a_rigid_body_is_found_to():
    turning = np.array([0.5, -2.0]) + 3.0 * np.stack([-PLACE[:, 1], PLACE[:, 0]], axis=1)
    motion = motion_of(MASS, PLACE, turning)
    assert turn_rate(motion) == pytest.approx(3.0, rel=1e-12)
    assert np.allclose([velocity_at(motion, x, y) for x, y in PLACE], turning, atol=1e-12)


def test_a_point_has_no_spin():
    motion = motion_of(MASS[:1], PLACE[:1], VELOCITY[:1])
    assert turn_rate(motion) == 0.0
    assert velocity_at(motion, 7.0, 8.0) == pytest.approx(tuple(VELOCITY[0]), rel=1e-15)


def test_spin_of_its_own_is_added_to_that_about_the_centre():
    motion = with_spin(RigidMotion(1.0, 2.0, 3.0, 4.0, 5.0, 6.0), 0.5, 0.25)
    assert motion == (1.0, 2.0, 3.0, 4.0, 5.5, 6.25)
    # 2 kg, 1 m to the right of the centre, 3 m/s faster upward.
    assert momentum_about(motion, 2.0, 2.0, 2.0, 3.0, 7.0) == 6.0


def polar_turn(weight, form, place):
    """The rotation that is nearest to sum w place form^T."""
    u, _, v = np.linalg.svd((weight[:, None] * place).T @ form)
    return u @ np.diag([1.0, np.linalg.det(u @ v)]) @ v


@pytest.mark.parametrize("angle", [0.0, 0.4, 2.0, -3.1])
def test_the_best_turn_is_that_of_the_polar_decomposition(angle):
    form = PLACE - MASS @ PLACE / MASS.sum()
    place = form @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]) + 0.2 * VELOCITY
    place = place - MASS @ place / MASS.sum()
    along = across = 0.0
    for k, weight in enumerate(MASS):
        along, across = with_pair(along, across, weight, *form[k], *place[k])
    cosine, sine = best_turn(along, across)
    assert np.allclose(polar_turn(MASS, form, place), [[cosine, -sine], [sine, cosine]], atol=1e-12)
    assert np.allclose([rotated(cosine, sine, x, y) for x, y in form], form @ polar_turn(MASS, form, place).T)


def test_where_no_turn_is_best_there_is_none():
    assert best_turn(0.0, 0.0) == (1.0, 0.0)


def fitted(places):
    """The form PLACE where it fits places best."""
    fit = fit_of(PLACE, places, np.arange(len(PLACE)))
    turned = [rotated(*best_turn(fit.along, fit.across), x - fit.form_x, y - fit.form_y) for x, y in PLACE]
    return np.array(turned) + np.array([fit.x, fit.y])


def test_a_form_that_was_moved_and_turned_is_fitted_to_where_it_lies_and_else_as_near_as_it_can_be():
    cosine, sine = 0.6, 0.8
    moved = np.array([2.0, -5.0]) + PLACE @ np.array([[cosine, sine], [-sine, cosine]])
    assert np.allclose(fitted(moved), moved, atol=1e-12)
    bent = moved + 0.3 * VELOCITY
    best = np.sum((fitted(bent) - bent) ** 2)
    for angle in (-0.01, 0.01):
        other = fitted(bent)
        about = other - other.mean(axis=0)
        turned = about @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        assert np.sum((other.mean(axis=0) + turned - bent) ** 2) > best
