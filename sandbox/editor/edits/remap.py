"""What hangs on a body's particles and springs by number, when its form becomes another one: the nearest take over."""

import math
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.document import EditError, check_bodies, checked, subject
from sandbox.editor.edits.names import rewired
from sandbox.level.document.model import Level
from sandbox.level.format.limits import COORDINATE_LIMIT
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.geometry import Pairs, Points

Indices = NDArray[np.int64]

# How many neighbours a displacement is taken from where a pose is carried over to another form.
NEIGHBOURS = 4
# Distances that are computed at once; more of them take memory, fewer time.
CHUNK = 1_000_000
# Distances that carrying a pose over may take, about two seconds; a larger body's is carried by some of its particles.
WORK = 50_000_000
# Places this close, in units of the body's size, are the same: far above rounding, far below what is seen.
SAME = 1e-9


def rebuilt(level: Level, bodies: Mapping[str, AnyBody], images: Mapping[str, Points] | None = None) -> Level:
    """Put bodies, by id, in place of those that they come from; pins, cuts, poses and references go to the nearest.

    images: where the particles of the old form [m] (n, 2) lie in the new one; of bodies without an image the outline
    of the old form is laid on that of the new, and particles stay where the springs are the same ones. The poses of
    bodies with an image lie in the new place already. Raises EditError for what could not be saved.
    """
    check_bodies(level, (replaced(body, pinned=(), cut=(), pose=None) for body in bodies.values()))
    used = _used(level, bodies)
    fitted, parts = [], {}
    for old in level.bodies:
        new = bodies.get(old.id, old)
        if new is not old:
            new, goes = _fitted(old, new, (images or {}).get(old.id), sorted(set(used[old.id].values())))
            if goes is not None:
                names = {index: name for name, index in expansion(new).named_particles.items()}
                named = expansion(old).named_particles
                # A name stays a name where it can.
                parts[old.id] = {
                    part: names.get(goes[index], str(goes[index])) if part in named else str(goes[index])
                    for part, index in used[old.id].items()
                }
        fitted.append(new)

    def follow(reference: str) -> str:
        owner, _, part = reference.partition(".")
        return f"{owner}.{parts[owner][part]}" if part and owner in parts else reference

    level = replaced(level, bodies=tuple(fitted))
    return checked(rewired(level, follow)[0] if parts else level)


def _used(level: Level, bodies: Mapping[str, AnyBody]) -> dict[str, dict[str, int]]:
    """By body, the parts after the dot of the references to it, with the indices of their particles."""
    named = {body.id: expansion(body).named_particles for body in level.bodies if body.id in bodies}
    used: dict[str, dict[str, int]] = {name: {} for name in named}

    def note(reference: str) -> str:
        owner, _, part = reference.partition(".")
        if part and owner in used:
            used[owner][part] = named[owner][part] if part in named[owner] else int(part)
        return reference

    rewired(level, note)
    return used


def _fitted(old: AnyBody, new: AnyBody, image: Points | None, used: list[int]) -> tuple[AnyBody, dict[int, int] | None]:
    """The new body with pins, cuts and pose of the old, and where used particles go to; None = all stay."""
    before, after = expansion(old), expansion(new)
    old_form, old_pairs = before.form, before.form_pairs
    form, pairs = after.form, after.form_pairs
    pose = None if new.pose is None else np.array(new.pose)
    if image is None:
        shift = None if pose is None else pose - old_form
        if np.array_equal(old_pairs, pairs):
            return _posed(new, form, shift), None
        image = _laid_on(old_form, form)
    else:
        shift = None if pose is None else pose - image
    order = same_places(image, form)
    if order is not None and np.array_equal(order, np.arange(len(form))):
        return _posed(new, form, shift), None
    cut = old_pairs[list(new.cut)]
    kept = np.array(sorted({*used, *new.pinned, *cut.ravel().tolist()}), dtype=np.int64)
    found = order[kept] if order is not None else nearest(image[kept], form)
    goes = dict(zip(kept.tolist(), found.tolist(), strict=True))
    fitted = replaced(
        new,
        pinned=tuple(sorted({goes[index] for index in new.pinned})),
        cut=_followed(cut, pairs, goes, image, form),
    )
    if shift is not None:
        shift = shift[np.argsort(order)] if order is not None else spread(image, shift, form)
    return _posed(fitted, form, shift), goes


def _posed(body: AnyBody, form: Points, shift: Points | None) -> AnyBody:
    if shift is None:
        return body
    pose = form + shift
    if float(np.max(np.abs(pose))) > COORDINATE_LIMIT:
        raise EditError(f"{subject(body)} would lie beyond the limit {COORDINATE_LIMIT:.15g}")
    return replaced(body, pose=tuple(map(tuple, pose.tolist())))


def _laid_on(old: Points, new: Points) -> Points:
    """The old points with their bounding box laid on that of the new ones."""
    low, size = old.min(axis=0), np.ptp(old, axis=0)
    fraction = np.divide(old - low, size, out=np.zeros_like(old), where=size > 0.0)
    return np.asarray(new.min(axis=0) + fraction * np.ptp(new, axis=0))


def same_places(points: Points, places: Points) -> Indices | None:
    """Index of the place that each point is at (n,), where both are the same in another order; else None."""
    if len(points) != len(places):
        return None
    size = max(float(np.ptp(places, axis=0).max()), SAME)
    before, after = _reading_order(points, size), _reading_order(places, size)
    if float(np.max(np.abs(points[before] - places[after]))) > SAME * size:
        return None
    result = np.zeros(len(points), dtype=np.int64)
    result[before] = after
    return result


def nearest(points: Points, places: Points) -> Indices:
    """Index of the place nearest to each point (n,), the lowest on a tie."""
    result = np.zeros(len(points), dtype=np.int64)
    for rows, squared in _squared(points, places):
        result[rows] = np.argmin(squared, axis=1)
    return result


def _reading_order(points: Points, size: float) -> Indices:
    # A third of a step aside, so that what is equal but for rounding seldom falls into two steps.
    return np.lexsort(np.floor(points / (1e-6 * size) + 1.0 / 3.0).T)


def spread(points: Points, values: Points, places: Points) -> Points:
    """Values (n, 2) known at points (n, 2), at other places (k, 2): the linear part, and what the nearest add to it."""
    step = math.ceil(len(points) * len(places) / WORK)
    points, values = points[::step], values[::step]
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


def _squared(points: Points, places: Points) -> Iterator[tuple[slice, Points]]:
    """Squared distances [m^2] of points from all places, a chunk of points at a time, with their rows."""
    step = max(1, CHUNK // max(1, len(places)))
    for first in range(0, len(points), step):
        rows = slice(first, first + step)
        apart = points[rows, None, :] - places[None, :, :]
        yield rows, np.sum(apart * apart, axis=2)


def _followed(cut: Pairs, pairs: Pairs, goes: dict[int, int], image: Points, form: Points) -> tuple[int, ...]:
    """The springs to cut for those that were: between the same two particles, or else with the nearest middle."""
    if not len(cut) or not len(pairs):
        return ()
    numbers = {pair: k for k, pair in reversed(list(enumerate(map(tuple, np.sort(pairs, axis=1).tolist()))))}
    moved = [tuple(sorted((goes[a], goes[b]))) for a, b in cut.tolist()]
    close = nearest(image[cut].mean(axis=1), form[pairs].mean(axis=1)).tolist()
    return tuple(sorted({numbers.get(pair, near) for pair, near in zip(moved, close, strict=True)}))
