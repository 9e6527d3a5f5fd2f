"""Faces of jellies: in the largest circle inside their outline at rest, turning with them; all in a few arrays."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.raster.mark_kernels import DISC, GLOW, STROKE
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.themes import CHEEK, EYE, INK
from sandbox.app.draw.things.borders import starts_of
from sandbox.app.draw.things.cast import Actor
from sandbox.app.draw.things.frame import Frame

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

# Faces are no larger [pixels at scale 1] and no smaller [pixels].
LARGEST, SMALLEST = 120.0, 24.0
# Mean strain above which a face is squeezed; speed [m/s] above which its mouth is open.
SQUEEZED, FAST = 0.10, 2.5
# A blink of this length [s] every so many seconds, and more of the others.
BLINK, BLINK_EVERY = 0.13, 3.4
GAP, EYE_SIZE, EYE_UP, MOUTH_DOWN, MOUTH_WIDE = 0.19, 0.118, -0.09, 0.125, 0.125
MOUTH_PIECES = 8
TONGUE = 0xF0708A


class Faces:
    """Faces of bodies, given with the loops of slots that they lie in."""

    def __init__(self, rows: list[tuple[Actor, Slots]]) -> None:
        self._count = len(rows)
        if not rows:
            return
        self._slots = np.concatenate([actor.slots for actor, _ in rows])
        self._start = starts_of([len(actor.slots) for actor, _ in rows])
        self._size = np.diff(self._start)
        forms = [actor.made.form - actor.made.form.mean(axis=0) for actor, _ in rows]
        # As seen: pixels count downwards.
        self._form = np.concatenate(forms) * np.array([1.0, -1.0])
        spots = [actor.spot(loop, _spot) for actor, loop in rows]
        self._spot = np.array([place for place, _ in spots]) * np.array([1.0, -1.0])
        self._inner = np.array([radius for _, radius in spots])
        angle = np.array([float(actor.body.__dict__.get("angle", 0.0)) for actor, _ in rows])
        self._upright = np.stack([np.cos(angle), -np.sin(angle)], axis=1)
        self._springs = np.concatenate([actor.springs for actor, _ in rows])
        self._spring_start = starts_of([len(actor.springs) for actor, _ in rows])

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw them."""
        if not self._count:
            return
        size = np.minimum(2.0 * self._inner * frame.zoom, LARGEST * frame.scale)
        at, begins = frame.at[self._slots], self._start[:-1]
        mean = np.add.reduceat(at, begins, axis=0) / self._size[:, None]
        off = at - np.repeat(mean, self._size, axis=0)
        x, y = self._form[:, 0], self._form[:, 1]
        cosine = np.add.reduceat(x * off[:, 0] + y * off[:, 1], begins)
        sine = np.add.reduceat(x * off[:, 1] - y * off[:, 0], begins)
        length = np.sqrt(cosine * cosine + sine * sine)
        shown = np.isfinite(length) & (length > 0.0) & (size >= SMALLEST * min(frame.scale, 1.0))
        if not shown.any():
            return
        length = np.where(length > 0.0, length, 1.0)
        cosine, sine = cosine / length, sine / length
        spot = self._spot * frame.zoom
        centre = mean + np.stack(
            [cosine * spot[:, 0] - sine * spot[:, 1], sine * spot[:, 0] + cosine * spot[:, 1]], axis=1
        )
        up = self._upright
        turn = np.stack([cosine * up[:, 0] - sine * up[:, 1], sine * up[:, 0] + cosine * up[:, 1]], axis=1)
        strain = np.abs(np.clip(np.nan_to_num(frame.strain[self._springs]), -9.0, 9.0))
        load = np.add.reduceat(strain, self._spring_start[:-1]) / np.maximum(np.diff(self._spring_start), 1)
        velocity = np.add.reduceat(frame.state.velocity[self._slots], begins, axis=0) / self._size[:, None]
        velocity = np.nan_to_num(velocity * np.array([1.0, -1.0]))
        pen = _Pen(centre[shown], turn[shown], size[shown])
        shut = self.blinks(frame.seconds)[shown] | frame.asleep
        pen.draw(load[shown], velocity[shown], shut, _towards(frame.pointer, centre[shown], size[shown]))
        pen.into(marks)

    def blinks(self, seconds: float) -> NDArray[np.bool_]:
        """Which of them have their eyes shut at a time [s]."""
        number = np.arange(self._count)
        beat = BLINK_EVERY + 0.77 * (number % 4)
        return (seconds + 1.7 * number) % beat > beat - BLINK


class _Pen:
    """Draws in coordinates of faces (f,): right and down, in parts of their size."""

    def __init__(self, centre: Floats, turn: Floats, size: Floats) -> None:
        self._centre, self._turn, self.size = centre, turn, size
        self._rows: list[tuple[Floats, Floats, int, float, int]] = []
        self._all = np.ones(len(size), dtype=np.bool_)

    def _place(self, x: Floats | float, y: Floats | float) -> Floats:
        x, y = x * self.size, y * self.size
        cosine, sine = self._turn[:, 0], self._turn[:, 1]
        return self._centre + np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)

    def disc(
        self, x: Floats | float, y: Floats | float, radius: float, colour: int, alpha: float = 1.0, kind: int = DISC,
        only: NDArray[np.bool_] | None = None, moved: Floats | None = None,
    ) -> None:  # fmt: skip
        """A disc for each face, or those of a mask; moved (f, 2): as seen, in parts of its size."""
        at = self._place(x, y)
        if moved is not None:
            at = at + moved * self.size[:, None]
        chosen = self._all if only is None else only
        self._rows.append((np.concatenate([at, at], axis=1)[chosen], (radius * self.size)[chosen], colour, alpha, kind))

    def line(
        self, start: tuple[Floats | float, Floats | float], end: tuple[Floats | float, Floats | float], half: float,
        only: NDArray[np.bool_],
    ) -> None:  # fmt: skip
        """A line for each face of a mask."""
        ends = np.concatenate([self._place(*start), self._place(*end)], axis=1)
        self._rows.append((ends[only], np.maximum(half * self.size, 0.9)[only], INK, 1.0, STROKE))

    def draw(self, load: Floats, velocity: Floats, blinks: NDArray[np.bool_], at_rest: Floats | None) -> None:
        """Eyes that look where it moves, or at_rest (f, 2), cheeks, and a mouth that says how it feels."""
        speed = np.sqrt(np.sum(velocity * velocity, axis=1))
        squeezed = load > SQUEEZED
        open_eyes = ~squeezed & ~blinks
        resting = speed <= 0.25
        way = np.where(resting[:, None], np.array([0.0, 1.0]), velocity / np.maximum(speed, 1e-9)[:, None])
        gaze = way * np.minimum(1.0, 0.3 + speed / 4.0)[:, None] * (0.42 * EYE_SIZE)
        if at_rest is not None:
            gaze = np.where(resting[:, None], at_rest * (0.42 * EYE_SIZE), gaze)
        for side in (-1.0, 1.0):
            x = side * GAP
            self.disc(x, EYE_UP, 1.13 * EYE_SIZE, INK, 0.35, only=open_eyes)
            self.disc(x, EYE_UP, EYE_SIZE, EYE, only=open_eyes)
            self.disc(x, EYE_UP, 0.57 * EYE_SIZE, INK, only=open_eyes, moved=gaze)
            glint = gaze + EYE_SIZE * np.array([-0.18, -0.24])
            self.disc(x, EYE_UP, 0.2 * EYE_SIZE, EYE, 0.95, only=open_eyes, moved=glint)
            for way_up in (-0.6, 0.6):
                outer = (x + side * 0.55 * EYE_SIZE, EYE_UP + way_up * EYE_SIZE)
                self.line(outer, (x - side * 0.45 * EYE_SIZE, EYE_UP), 0.2 * EYE_SIZE, squeezed)
            lid = 0.8 * EYE_SIZE
            self.line((x - lid, EYE_UP), (x + lid, EYE_UP), 0.18 * EYE_SIZE, blinks & ~squeezed)
            self.disc(1.5 * x, 0.075, 0.085, CHEEK, 0.45, GLOW)
        gasps = (speed > FAST) & ~squeezed
        self.disc(0.0, MOUTH_DOWN + 0.02, 0.58 * MOUTH_WIDE, INK, only=gasps)
        self.disc(0.0, MOUTH_DOWN + 0.02 + 0.2 * MOUTH_WIDE, 0.33 * MOUTH_WIDE, TONGUE, only=gasps)
        smile = MOUTH_WIDE * (0.66 - np.minimum(9.0 * load, 0.8))
        t = np.linspace(-1.0, 1.0, MOUTH_PIECES + 1)
        bend = [
            np.where(squeezed, 0.22 * MOUTH_WIDE * np.sin(3.0 * np.pi * each), smile * (1.0 - each * each))
            for each in t
        ]
        for k in range(MOUTH_PIECES):
            start = t[k] * MOUTH_WIDE, MOUTH_DOWN + bend[k]
            self.line(start, (t[k + 1] * MOUTH_WIDE, MOUTH_DOWN + bend[k + 1]), 0.02, ~gasps)

    def into(self, marks: MarkList) -> None:
        """Add all of it to marks, in order."""
        rows = [row for row in self._rows if len(row[1])]
        if rows:
            marks.mixed(
                np.concatenate([ends for ends, *_ in rows]),
                np.concatenate([half for _, half, *_ in rows]),
                *(np.repeat([row[k] for row in rows], [len(row[1]) for row in rows]) for k in (2, 3, 4)),
            )


def _towards(pointer: tuple[float, float] | None, centre: Floats, size: Floats) -> Floats | None:
    """How far faces turn their eyes (f, 2) to a pointer, 0..1: the farther the more."""
    if pointer is None:
        return None
    way = (np.array(pointer) - centre) / size[:, None]
    return np.asarray(way / np.maximum(np.sqrt(np.sum(way * way, axis=1)), 1.0)[:, None])


def _spot(actor: Actor, loop: Slots) -> tuple[Floats, float]:
    """Where a face sits, about the middle of the form, and how much room there is [m]."""
    form = actor.made.form - actor.made.form.mean(axis=0)
    index = {slot: k for k, slot in enumerate(actor.slots.tolist())}
    ring = form[[index[slot] for slot in loop.tolist()]]
    ring = np.concatenate([ring + (np.roll(ring, -1, axis=0) - ring) * k / 4 for k in range(4)])
    tries = np.concatenate([form, 0.5 * (form[:-1] + form[1:]), np.zeros((1, 2))])
    if len(tries) * len(ring) > 1_000_000:
        return np.zeros(2), float(np.sqrt(np.sum(ring * ring, axis=1)).min())
    room = np.sqrt(np.sum((tries[:, None] - ring[None]) ** 2, axis=-1)).min(axis=1)
    best = int(np.argmax(room - 0.12 * np.sqrt(np.sum(tries * tries, axis=1))))
    return tries[best], float(room[best])
