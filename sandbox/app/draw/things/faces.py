"""Faces of jellies: in the largest circle inside their outline at rest, turning with them; all in a few arrays."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.colours import CHEEK, EYE, INK
from sandbox.app.draw.raster.mark_kernels import DISC, GLOW, STROKE
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.things.level_slots import Actor, Frame, Piece, starts_of
from sandbox.physics.geometry.segment import distances_from_segments

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

# Faces are no larger [pixels at scale 1] and no smaller [pixels].
LARGEST, SMALLEST = 120.0, 24.0
# Mean strain above which a face is squeezed; speed [m/s] above which its mouth is open.
SQUEEZED, FAST = 0.10, 2.5
# A blink of this length [s] every this many seconds, and more of the others.
BLINK, BLINK_EVERY = 0.13, 3.4
GAP, EYE_SIZE, EYE_UP, MOUTH_DOWN, MOUTH_WIDE = 0.19, 0.118, -0.09, 0.125, 0.125
MOUTH_PIECES = 8
# A piece that was cut off has a face of its own if a circle of this part of the whole's largest one fits into it; the
# face that was there stays where one of that part does.
LEAST_OWN, LEAST_KEPT = 0.5, 0.3
# Places and sides that are compared to find the largest circle, at most.
MOST_COMPARED = 1_000_000
TONGUE = 0xF0708A


class DrawnFace(NamedTuple):
    """A face: slots (n,) that it turns with, their places (n, 2) [m] about their middle at rest; springs whose strain
    it shows; where it sits about that middle, the radius free there [m], how far [rad] its body was turned when made.
    """

    slots: Slots
    form: Floats
    springs: Slots
    spot: Floats
    radius: float
    angle: float


class Faces:
    """Faces of bodies and of their pieces."""

    def __init__(self, rows: list[DrawnFace]) -> None:
        self._count = len(rows)
        if not rows:
            return
        self._slots = np.concatenate([row.slots for row in rows])
        self._start = starts_of([len(row.slots) for row in rows])
        self._size = np.diff(self._start)
        # As seen: pixels count downwards.
        self._form = np.concatenate([row.form for row in rows]) * np.array([1.0, -1.0])
        self._spot = np.array([row.spot for row in rows]) * np.array([1.0, -1.0])
        self._inner = np.array([row.radius for row in rows])
        angle = np.array([row.angle for row in rows])
        self._upright = np.stack([np.cos(angle), -np.sin(angle)], axis=1)
        self._springs = np.concatenate([row.springs for row in rows])
        self._spring_start = starts_of([len(row.springs) for row in rows])

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw the faces."""
        if not self._count:
            return
        centre, turn, size = self.placed(frame)
        shown = np.isfinite(turn).all(axis=1) & (size >= SMALLEST * min(frame.scale, 1.0))
        if not shown.any():
            return
        begins = self._start[:-1]
        strain = np.abs(np.clip(np.nan_to_num(frame.strain[self._springs]), -9.0, 9.0))
        load = np.add.reduceat(strain, self._spring_start[:-1]) / np.maximum(np.diff(self._spring_start), 1)
        velocity = np.add.reduceat(frame.state.velocity[self._slots], begins, axis=0) / self._size[:, None]
        velocity = np.nan_to_num(velocity * np.array([1.0, -1.0]))
        shut = (self.blinks(frame.seconds) | frame.asleep)[shown]
        centre, turn, size, load, velocity = (each[shown] for each in (centre, turn, size, load, velocity))
        at_rest = None if frame.pointer is None else _towards(frame.pointer, centre, size)
        _draw_faces(marks, centre, turn, size, load, velocity, shut, at_rest)

    def placed(self, frame: Frame) -> tuple[Floats, Floats, Floats]:
        """Centres (f, 2) and sizes (f,) [pixels] of faces; between, cosine and sine (f, 2) of their turn, nan: none."""
        size = np.minimum(2.0 * self._inner * frame.zoom, LARGEST * frame.scale)
        at, begins = frame.at[self._slots], self._start[:-1]
        mean = np.add.reduceat(at, begins, axis=0) / self._size[:, None]
        off = at - np.repeat(mean, self._size, axis=0)
        x, y = self._form[:, 0], self._form[:, 1]
        cosine = np.add.reduceat(x * off[:, 0] + y * off[:, 1], begins)
        sine = np.add.reduceat(x * off[:, 1] - y * off[:, 0], begins)
        length = np.sqrt(cosine * cosine + sine * sine)
        length[~(np.isfinite(length) & (length > 0.0))] = np.nan
        cosine, sine = cosine / length, sine / length
        spot = self._spot * frame.zoom
        centre = mean + np.stack(
            [cosine * spot[:, 0] - sine * spot[:, 1], sine * spot[:, 0] + cosine * spot[:, 1]], axis=1
        )
        up = self._upright
        turn = np.stack([cosine * up[:, 0] - sine * up[:, 1], sine * up[:, 0] + cosine * up[:, 1]], axis=1)
        return centre, turn, size

    def blinks(self, seconds: float) -> NDArray[np.bool_]:
        """Which faces have their eyes shut at a time [s]."""
        number = np.arange(self._count)
        beat = BLINK_EVERY + 0.77 * (number % 4)
        return (seconds + 1.7 * number) % beat > beat - BLINK


class _Part(NamedTuple):
    """A part of every face: a line or a disc between two places, right and down, in parts of the face's size.

    when: a row of what `_moods` gives; gaze: how far it follows what a face looks at; light: where it is seen of it,
    however the face turns, in parts of the size.
    """

    ends: tuple[float, float, float, float]
    half: float
    colour: int
    alpha: float
    kind: int
    when: int
    gaze: float = 0.0
    light: tuple[float, float] = (0.0, 0.0)


OPEN, SQUINTING, SHUT, ALWAYS, GASPING, SMILING = range(6)


def _eye(side: float) -> list[_Part]:
    x, size = side * GAP, EYE_SIZE
    at = (x, EYE_UP) * 2
    lashes = [
        _Part((x + side * 0.55 * size, EYE_UP + up * size, x - side * 0.45 * size, EYE_UP), 0.2 * size, INK, 1.0,
              STROKE, SQUINTING) for up in (-0.6, 0.6)
    ]  # fmt: skip
    return [
        _Part(at, 1.13 * size, INK, 0.35, DISC, OPEN),
        _Part(at, size, EYE, 1.0, DISC, OPEN),
        _Part(at, 0.57 * size, INK, 1.0, DISC, OPEN, 1.0),
        _Part(at, 0.2 * size, EYE, 0.95, DISC, OPEN, 1.0, (-0.18 * size, -0.24 * size)),
        *lashes,
        _Part((x - 0.8 * size, EYE_UP, x + 0.8 * size, EYE_UP), 0.18 * size, INK, 1.0, STROKE, SHUT),
        _Part((1.5 * x, 0.075) * 2, 0.085, CHEEK, 0.45, GLOW, ALWAYS),
    ]


_MOUTH_X = np.linspace(-1.0, 1.0, MOUTH_PIECES + 1)
_MOUTH = [
    _Part((a * MOUTH_WIDE, MOUTH_DOWN, b * MOUTH_WIDE, MOUTH_DOWN), 0.02, INK, 1.0, STROKE, SMILING)
    for a, b in pairwise(_MOUTH_X.tolist())
]
_PARTS = [
    *_eye(-1.0), *_eye(1.0),
    _Part((0.0, MOUTH_DOWN + 0.02) * 2, 0.58 * MOUTH_WIDE, INK, 1.0, DISC, GASPING),
    _Part((0.0, MOUTH_DOWN + 0.02 + 0.2 * MOUTH_WIDE) * 2, 0.33 * MOUTH_WIDE, TONGUE, 1.0, DISC, GASPING),
    *_MOUTH,
]  # fmt: skip
# The same as columns: (p, 2) both ends, and (p,).
_X = np.array([part.ends[::2] for part in _PARTS])
_Y = np.array([part.ends[1::2] for part in _PARTS])
_HALF, _COLOUR, _ALPHA, _KIND, _WHEN, _GAZE, _LIGHT = (
    np.array([part[k] for part in _PARTS]) for k in range(1, len(_Part._fields))
)
_LEAST = np.where(_KIND == STROKE, 0.9, 0.0)


def _moods(load: Floats, speed: Floats, blinks: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which parts of faces (f,) are shown, by what their mean strain, speed [m/s] and time are."""
    squeezed = load > SQUEEZED
    gasps = (speed > FAST) & ~squeezed
    return np.stack([~squeezed & ~blinks, squeezed, blinks & ~squeezed, np.ones_like(gasps), gasps, ~gasps])


def _draw_faces(
    marks: MarkList, centre: Floats, turn: Floats, size: Floats, load: Floats, velocity: Floats,
    blinks: NDArray[np.bool_], at_rest: Floats | None = None,
) -> None:  # fmt: skip
    """Eyes that look where it moves, or at_rest (f, 2), cheeks, and a mouth that says how it feels, of faces (f,)."""
    speed = np.sqrt(np.sum(velocity * velocity, axis=1))
    way = np.where(speed[:, None] <= 0.25, np.array([0.0, 1.0]), velocity / np.maximum(speed, 1e-9)[:, None])
    gaze = way * (np.minimum(1.0, 0.3 + speed / 4.0) * (0.42 * EYE_SIZE) * size)[:, None]
    if at_rest is not None:
        gaze = np.where(speed[:, None] <= 0.25, at_rest * (0.42 * EYE_SIZE * size)[:, None], gaze)
    smile = MOUTH_WIDE * (0.66 - np.minimum(9.0 * load, 0.8))
    t = _MOUTH_X[:, None]
    bend = np.where(load > SQUEEZED, 0.22 * MOUTH_WIDE * np.sin(3.0 * np.pi * t), smile * (1.0 - t * t))
    # By part, face, end.
    x, y = _X[:, None] * size[:, None], np.repeat(_Y[:, None], len(size), axis=1)
    y[-MOUTH_PIECES:] += np.stack([bend[:-1], bend[1:]], axis=-1)
    y *= size[:, None]
    cosine, sine = turn[:, :1], turn[:, 1:]
    ends = np.empty((*x.shape, 2))
    ends[..., 0] = centre[:, :1] + cosine * x - sine * y
    ends[..., 1] = centre[:, 1:] + sine * x + cosine * y
    seen = _GAZE[:, None, None] * gaze + _LIGHT[:, None] * size[:, None]
    ends += seen[:, :, None]
    shown = _moods(load, speed, blinks)[_WHEN]
    half = np.maximum(_HALF[:, None] * size, _LEAST[:, None])[shown]
    part = np.nonzero(shown)[0]
    marks.rows(ends[shown].reshape(-1, 4), half, _COLOUR[part], _ALPHA[part], _KIND[part])


def _towards(pointer: tuple[float, float], centre: Floats, size: Floats) -> Floats:
    """How far faces turn their eyes (f, 2) to a pointer, 0..1: the farther the more."""
    way = (np.array(pointer) - centre) / size[:, None]
    return np.asarray(way / np.maximum(np.sqrt(np.sum(way * way, axis=1)), 1.0)[:, None])


def faces_of(actor: Actor, pieces: list[Piece]) -> list[DrawnFace]:
    """The faces of a body and of its pieces: that of the whole stays with the piece it lies on, where it fits."""
    place, radius = actor.spot(spot_of)
    if len(pieces) == 1 and len(pieces[0].left) == len(actor.triangles()):
        return [DrawnFace(actor.slots, actor.form, actor.springs, place, radius, actor.angle)]
    keeper = min(range(len(pieces)), key=lambda k: _away(actor.form[pieces[k].left], place))
    found = []
    for k, piece in enumerate(pieces):
        own = np.unique(piece.left)
        middle = actor.form[own].mean(axis=0)
        spot, inner = _spot_in(actor, piece, place if k == keeper else middle)
        if inner >= (LEAST_KEPT if k == keeper else LEAST_OWN) * radius:
            form, springs = actor.form[own] - middle, actor.springs[piece.inside]
            found.append(DrawnFace(actor.slots[own], form, springs, spot - middle, min(inner, radius), actor.angle))
    return found


def _away(triangles: Floats, place: Floats) -> float:
    """How far [m] a place is from triangles (t, 3, 2), 0 inside of one."""
    sides = np.roll(triangles, -1, axis=1) - triangles
    beyond = place - triangles
    if np.any(np.all(sides[..., 0] * beyond[..., 1] - sides[..., 1] * beyond[..., 0] >= 0.0, axis=1)):
        return 0.0
    return float(distances_from_segments(place, triangles, triangles + sides).min())


def clearance_in(actor: Actor, piece: Piece) -> float:
    """The radius [m] of the largest circle inside a piece at rest."""
    return _spot_in(actor, piece, actor.form[np.unique(piece.left)].mean(axis=0))[1]


def _spot_in(actor: Actor, piece: Piece, near: Floats) -> tuple[Floats, float]:
    """Where in the form the largest circle inside a piece lies, rather near to a place, and its radius [m]."""
    corners = actor.form[piece.left]
    tries = np.concatenate([actor.form[np.unique(piece.left)], corners.mean(axis=1),
                            0.5 * (corners + np.roll(corners, -1, axis=1)).reshape(-1, 2)])  # fmt: skip
    order = np.argsort(actor.slots, kind="stable")
    rings = [actor.form[order[np.searchsorted(actor.slots[order], loop)]] for loop in piece.loops]
    start = np.concatenate(rings)
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    if len(tries) * len(start) > MOST_COMPARED:
        tries = tries[:: 1 + len(tries) * len(start) // MOST_COMPARED]
    clearance = distances_from_segments(tries[:, None], start, end).min(axis=1)
    away = tries - near
    best = int(np.argmax(clearance - 0.12 * np.sqrt(np.sum(away * away, axis=1))))
    return tries[best], float(clearance[best])


def spot_of(actor: Actor, loop: Slots) -> tuple[Floats, float]:
    """Where a face sits, about the middle of the form, and the radius that fits there [m]."""
    form = actor.form
    index = {slot: k for k, slot in enumerate(actor.slots.tolist())}
    ring = form[[index[slot] for slot in loop.tolist()]]
    ring = np.concatenate([ring + (np.roll(ring, -1, axis=0) - ring) * k / 4 for k in range(4)])
    tries = np.concatenate([form, 0.5 * (form[:-1] + form[1:]), np.zeros((1, 2))])
    if len(tries) * len(ring) > MOST_COMPARED:
        return np.zeros(2), float(np.sqrt(np.sum(ring * ring, axis=1)).min())
    clearance = np.sqrt(np.sum((tries[:, None] - ring[None]) ** 2, axis=-1)).min(axis=1)
    best = int(np.argmax(clearance - 0.12 * np.sqrt(np.sum(tries * tries, axis=1))))
    return tries[best], float(clearance[best])
