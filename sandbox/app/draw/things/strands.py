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
# Length of the pattern, in half widths.
PERIOD = {"chain": 5.6, "deck": 2.0}
USUAL_PERIOD = 6.5
_LINES = {"rope": 0x5B3D20, "deck": 0x4A2E16, "cable": 0x3A4252}
# Pieces that a curve has between two particles, from a length [pixels] on.
PIECES, CURVED_FROM = 3, 6.0


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
            self._found.setdefault((look.line, look.width), []).append((rows, rest[order], springs[order]))

    def groups(self) -> list[tuple[str, float, Slots, Floats, Slots, float]]:
        """Of each kind: kind, width, stretches (m, 4), metres at their ends (m, 2), springs (m,), a usual length."""
        if self._groups is None:
            self._groups = []
            for (kind, width), found in self._found.items():
                rows, rest, springs = (np.concatenate(part) for part in zip(*found, strict=True))
                # Each strand's pattern begins anew.
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
        """Draw them."""
        for kind, width, stretches, metres, springs, step in self.groups():
            half = self.half(kind, width, step, frame)
            pieces = PIECES if step * frame.zoom > CURVED_FROM else 1
            ends = _curved(frame.at, stretches, pieces)
            period = PERIOD.get(kind, USUAL_PERIOD) * half / frame.zoom
            share = np.arange(pieces + 1) / pieces
            along = (metres[:, :1] + (metres[:, 1:] - metres[:, :1]) * share) / period
            along = np.stack([along[:, :-1], along[:, 1:]], axis=-1).reshape(-1, 2)
            if kind in _LINES:
                marks.strokes(ends, half + 0.9 * frame.scale, _LINES[kind])
            tint, by = frame.flush(springs)
            marks.strips(ends, half, TILE[kind], along, np.repeat(tint, pieces), np.repeat(by, pieces))


def _curved(at: Floats, stretches: Slots, pieces: int) -> Floats:
    """Lines (m pieces, 4) of Catmull-Rom curves through stretches (m, 4) of particles; -1 = goes straight on."""
    b, c = at[stretches[:, 1]], at[stretches[:, 2]]
    if pieces == 1:
        return np.concatenate([b, c], axis=1)
    a = np.where(stretches[:, :1] >= 0, at[stretches[:, 0]], 2.0 * b - c)
    d = np.where(stretches[:, 3:] >= 0, at[stretches[:, 3]], 2.0 * c - b)
    t = (np.arange(pieces + 1) / pieces)[None, :, None]
    a, b, c, d = (points[:, None, :] for points in (a, b, c, d))
    curve = 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
    return np.concatenate([curve[:, :-1], curve[:, 1:]], axis=2).reshape(-1, 4)
