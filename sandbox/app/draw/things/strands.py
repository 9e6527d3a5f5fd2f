"""Strands: ropes, chains, cables and threads, smooth curves through their particles, with a pattern along them."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.looks import Look
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.textures import TILE
from sandbox.app.draw.things.borders import chains_of
from sandbox.app.draw.things.frame import Frame

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

# Half widths [pixels at scale 1], at most this part of the length between particles, and at least so much.
HALF = {"rope": 3.4, "cable": 2.6, "chain": 4.6, "deck": 6.0, "thread": 1.2, "silk": 0.9}
MOST_OF_STEP, LEAST = 0.45, 0.55
# A rope of one spring hangs something up on others: it has this part of their width.
HANGER = 0.62
# Length of the pattern, in half widths.
PERIOD = {"chain": 5.6, "deck": 2.0}
USUAL_PERIOD = 6.5
_LINES = {"rope": 0x5B3D20, "deck": 0x4A2E16, "cable": 0x3A4252}
# Pieces that a curve has between two particles, from a length [pixels] on.
PIECES, CURVED_FROM = 3, 6.0
# Corners of its way from which on a stretch is a curve [pixels]: it leaves the straight line by a twelfth of that.
LEAST_BEND = 2.5


class Strands:
    """All strands of a level that are there: stretches between two particles, with their neighbours on the way."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, float], list[tuple[Slots, Floats, Slots]]] = {}
        self._groups: list[tuple[str, float, Slots, Floats, Slots, float]] | None = None

    def add(self, look: Look, ends: Slots, springs: Slots, rest: Floats) -> None:
        """Springs (m,) between slots (m, 2), of rest lengths (m,) [m]."""
        self._groups = None
        for particles, order in chains_of(ends):
            before, after = np.r_[-1, particles[:-1]], np.r_[particles[2:], -1]
            if particles[0] == particles[-1] and len(particles) > 3:
                before[0], after[-1] = particles[-2], particles[1]
            rows = np.stack([before[:-1], particles[:-1], particles[1:], after], axis=1)
            width = look.width * (HANGER if look.line == "rope" and len(particles) == 2 else 1.0)
            self._found.setdefault((look.line, width), []).append((rows, rest[order], springs[order]))

    def groups(self) -> list[tuple[str, float, Slots, Floats, Slots, float]]:
        """Of each kind: kind, width, stretches (m, 4), metres at their ends (m, 2), springs (m,), a usual length."""
        if self._groups is None:
            self._groups = []
            for (kind, width), found in self._found.items():
                rows, rest, springs = (np.concatenate(part) for part in zip(*found, strict=True))
                # Each strand's pattern starts over.
                metres = np.concatenate([np.cumsum(own) for _, own, _ in found])
                along = np.column_stack([metres - rest, metres])
                self._groups.append((kind, width, rows, along, springs, float(np.median(rest)) if len(rest) else 1.0))
        return self._groups

    @staticmethod
    def half(kind: str, width: float, step: float, frame: Frame) -> float:
        """Half the width [pixels] of a kind with particles `step` [m] apart."""
        least = LEAST * max(frame.scale, 0.8)
        return max(min(HALF[kind] * width * frame.scale, MOST_OF_STEP * step * frame.zoom), least)

    def thrown(self, frame: Frame) -> Floats:
        """Lines (m, 5) [pixels] that throw shadows."""
        rows = [np.zeros((0, 5))]
        for kind, width, stretches, _, _, step in self.groups():
            half = np.full(len(stretches), self.half(kind, width, step, frame))
            rows.append(np.column_stack([frame.ends(stretches[:, 1:3]), half]))
        return np.concatenate(rows)

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw the strands."""
        for kind, width, stretches, metres, springs, step in self.groups():
            half = self.half(kind, width, step, frame)
            pieces = PIECES if step * frame.zoom > CURVED_FROM else 1
            along = metres * (frame.zoom / (PERIOD.get(kind, USUAL_PERIOD) * half))
            tint, by = frame.flush(springs)
            if pieces == 1:
                ends = frame.ends(stretches[:, 1:3])
            else:
                ends, whose, part = curved(frame.at, stretches, pieces)
                first = along[whose, :1]
                along, tint, by = first + (along[whose, 1:] - first) * part, tint[whose], by[whose]
            if kind in _LINES:
                marks.strokes(ends, half + 0.9 * frame.scale, _LINES[kind])
            marks.strips(ends, half, TILE[kind], along, tint, by)


def curved(at: Floats, stretches: Slots, pieces: int) -> tuple[Floats, Slots, Floats]:
    """Lines (k, 4) of Catmull-Rom curves through stretches (m, 4) of particles; -1 = goes straight on.

    And whose they are (k,), and which part (k, 2) of it. One that would not be seen to bend is one line.
    """
    points = at[stretches]
    a, b, c, d = (points[:, k] for k in range(4))
    for missing, end, near, far in ((stretches[:, 0] < 0, a, b, c), (stretches[:, 3] < 0, d, c, b)):
        end[missing] = 2.0 * near[missing] - far[missing]
    bends = np.maximum(np.abs(a - 2.0 * b + c), np.abs(b - 2.0 * c + d)).max(axis=1)
    bent = np.flatnonzero(bends > LEAST_BEND)
    straight = np.flatnonzero(~(bends > LEAST_BEND))
    t = np.arange(pieces + 1) / pieces
    weights = 0.5 * np.stack([
        -t + 2 * t**2 - t**3, 2 - 5 * t**2 + 3 * t**3, t + 4 * t**2 - 3 * t**3, t**3 - t**2
    ], axis=1)  # fmt: skip
    curve = (weights @ points[bent].transpose(1, 0, 2).reshape(4, -1)).reshape(pieces + 1, len(bent), 2)
    lines = np.concatenate([curve[:-1], curve[1:]], axis=2).reshape(-1, 4)
    ends = np.concatenate([np.concatenate([b[straight], c[straight]], axis=1), lines])
    part = np.repeat(np.column_stack([t[:-1], t[1:]]), len(bent), axis=0)
    whole = np.broadcast_to([0.0, 1.0], (len(straight), 2))
    return ends, np.concatenate([straight, np.tile(bent, pieces)]), np.concatenate([whole, part])
