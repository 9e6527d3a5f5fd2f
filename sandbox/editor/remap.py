"""What hangs on a body's particles and springs by number, when the body's form is another one: the nearest takes over."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.document import check_bodies, checked
from sandbox.editor.names import owner_of, rewired, with_owner
from sandbox.level.bodies import AnyBody
from sandbox.level.expansion import named_particles
from sandbox.level.model import Level
from sandbox.level.quantities import replaced
from sandbox.level.shapes import Pairs, Points, expand

Indices = NDArray[np.int64]

# How many neighbours a displacement is taken from where a pose is carried over to another form.
NEIGHBOURS = 4
# Distances that are computed at once; more of them take memory, fewer time.
CHUNK = 1_000_000
# Places this close, in units of the body's size, are the same: far above rounding, far below what is seen.
SAME = 1e-9


def rebuilt(level: Level, bodies: Mapping[str, AnyBody], images: Mapping[str, Points] | None = None) -> Level:
    """Put bodies, by id, in place of those that they come from; pins, cuts, poses and references go to the nearest.

    images: where the particles of the old form [m] (n, 2) lie in the new one; of bodies without an image the outline
    of the old form is laid on that of the new, and particles stay where the springs are the same ones. The poses of
    bodies with an image lie in the new place already. Raises EditError for what could not be saved.
    """
    check_bodies(level, (replaced(body, pinned=(), cut=(), pose=None) for body in bodies.values()))
    fitted, parts = [], {}
    for old in level.bodies:
        new = bodies.get(old.id, old)
        if new is not old:
            new, particles = _fitted(old, new, (images or {}).get(old.id))
            if particles is not None:
                parts[old.id] = _parts(old, new, particles)
        fitted.append(new)

    def follow(reference: str) -> str:
        owner = owner_of(reference)
        part = reference.partition(".")[2]
        return f"{owner}.{parts[owner][part]}" if owner in parts else reference

    level = replaced(level, bodies=tuple(fitted))
    return checked(rewired(level, follow)[0] if parts else level)


def _parts(old: AnyBody, new: AnyBody, particles: Indices) -> dict[str, str]:
    """The part after the dot, for each that a reference to the old body may have: a name stays a name if it can."""
    names = {index: name for name, index in named_particles(new).items()}
    numbers = particles.tolist()
    named = {name: names.get(numbers[index], str(numbers[index])) for name, index in named_particles(old).items()}
    return {str(index): str(number) for index, number in enumerate(numbers)} | named


def _fitted(old: AnyBody, new: AnyBody, image: Points | None) -> tuple[AnyBody, Indices | None]:
    """The new body with pins, cuts and pose of the old, and which particle of it each old one is; None = the same."""
    old_form, old_pairs = expand(old)
    form, pairs = expand(new)
    pose = None if new.pose is None else np.array(new.pose)
    if image is None:
        shift = None if pose is None else pose - old_form
        if np.array_equal(old_pairs, pairs):
            return _posed(new, form, shift), None
        image = _laid_on(old_form, form)
    else:
        shift = None if pose is None else pose - image
        size = max(float(np.ptp(form)), 1.0)
        if form.shape == image.shape and float(np.max(np.abs(form - image))) <= SAME * size:
            return _posed(new, form, shift), None
    particles = nearest(image, form)
    springs = _spring_map(old_pairs, pairs, particles, image, form)
    fitted = replaced(
        new,
        pinned=tuple(sorted({int(particles[index]) for index in new.pinned})),
        cut=tuple(sorted({int(springs[index]) for index in new.cut})) if len(pairs) else (),
    )
    return _posed(fitted, form, None if shift is None else spread(image, shift, form)), particles


def _posed(body: AnyBody, form: Points, shift: Points | None) -> AnyBody:
    return body if shift is None else replaced(body, pose=tuple(map(tuple, (form + shift).tolist())))


def _laid_on(old: Points, new: Points) -> Points:
    """The old points with their bounding box laid on that of the new ones."""
    low, size = old.min(axis=0), np.ptp(old, axis=0)
    share = np.divide(old - low, size, out=np.zeros_like(old), where=size > 0.0)
    return np.asarray(new.min(axis=0) + share * np.ptp(new, axis=0))


def nearest(points: Points, places: Points) -> Indices:
    """Index of the place nearest to each point (n,), the lowest on a tie."""
    result = np.zeros(len(points), dtype=np.int64)
    for rows, squared in _squared(points, places):
        result[rows] = np.argmin(squared, axis=1)
    return result


def spread(points: Points, values: Points, places: Points) -> Points:
    """Values (n, 2) known at points (n, 2), at other places (k, 2): the linear part, and what the nearest add to it."""
    base = np.column_stack([points, np.ones(len(points))])
    linear = np.linalg.lstsq(base, values, rcond=None)[0]
    rest = values - base @ linear
    result = np.column_stack([places, np.ones(len(places))]) @ linear
    count = min(NEIGHBOURS, len(points))
    for rows, squared in _squared(places, points):
        close = np.argpartition(squared, count - 1, axis=1)[:, :count]
        weight = 1.0 / np.maximum(np.take_along_axis(squared, close, axis=1), 1e-24)
        weight /= weight.sum(axis=1, keepdims=True)
        result[rows] += np.sum(weight[:, :, None] * rest[close], axis=1)
    return np.asarray(result)


def _squared(points: Points, places: Points):  # type: ignore[no-untyped-def]
    """Squared distances [m^2] of points from all places, a chunk of points at a time, with their rows."""
    step = max(1, CHUNK // max(1, len(places)))
    for first in range(0, len(points), step):
        rows = slice(first, first + step)
        apart = points[rows, None, :] - places[None, :, :]
        yield rows, np.sum(apart * apart, axis=2)


def _spring_map(old: Pairs, new: Pairs, particles: Indices, image: Points, form: Points) -> Indices:
    """The new spring for each old one: between the same two particles, or else the one with the nearest middle."""
    numbers = {pair: number for number, pair in reversed(list(enumerate(map(tuple, np.sort(new, axis=1).tolist()))))}
    wanted = np.sort(particles[old], axis=1)
    found = np.array([numbers.get(pair, -1) for pair in map(tuple, wanted.tolist())], dtype=np.int64)
    missing = np.flatnonzero(found < 0)
    if len(missing) and len(new):
        found[missing] = nearest(image[old[missing]].mean(axis=1), form[new].mean(axis=1))
    return found
