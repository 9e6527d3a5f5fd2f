"""Girder: a Warren truss, which can stand at any angle."""

import math
from collections.abc import Iterator
from functools import cached_property
from typing import Literal

import numpy as np
from pydantic import Field

from sandbox.level.format.level_error import Fault
from sandbox.level.format.limits import COORDINATE_LIMIT, SPACING_RANGE
from sandbox.level.format.quantities import Mass, Point, Size
from sandbox.level.kinds.body_def import BodyDef, End
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.geometry import Pairs, Points, chain, row


class GirderDef(BodyDef):
    """A Warren truss: a row from start to end, a row on its right half a cell further, chords and zigzag diagonals."""

    type: Literal["girder"] = Field(description="Kind of body.")
    start: Point = Field(description="Place of the first row's first particle, `id.start`.")
    end: Point = Field(description="Place of the first row's last particle, `id.end`.")
    segments: int = Field(
        ge=1, description="Number of cells, and of particles of the second row. The first row has one particle more."
    )
    height: Size = Field(
        default=1.0, description="Distance of the second row, to the right of the way from start to end."
    )
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    pin: tuple[End, ...] = Field(default=(), max_length=2, description="Ends that stay where they are.")


class Girder(Expansion[GirderDef]):
    """A beam of two rows of particles, half a cell apart along the way."""

    model = GirderDef
    plural = "girders"
    generation = """\
- Girder: the first row from start to end, then the second, each particle half a cell further and `height` to the
  right of the way from start to end. Springs: first chords, second chords, then per cell the diagonal that leaves the
  first row and the one that comes back. A girder can stand at any angle; a bridge's bottom row is straight below."""

    @property
    def form_count(self) -> tuple[int, int]:
        """Each cell has two chords and two diagonals; there is one chord less."""
        return 2 * self.body.segments + 1, 4 * self.body.segments - 1

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        body, nodes = self.body, self.body.segments + 1
        first = row(body.start, body.end, body.segments)
        second = (first[:-1] + first[1:]) / 2.0 + np.array(self._offset())
        cell = np.arange(body.segments, dtype=np.int64)
        zigzag = np.stack([np.stack([cell, cell + nodes], axis=1), np.stack([cell + nodes, cell + 1], axis=1)], axis=1)
        chords = np.concatenate([chain(body.segments), chain(body.segments - 1) + nodes])
        return np.concatenate([first, second]), np.concatenate([chords, zigzag.reshape(-1, 2)])

    @property
    def named_particles(self) -> dict[str, int]:
        """The ends of the first row."""
        return {"start": 0, "end": self.body.segments}

    def outline_faults(self, path: str) -> Iterator[Fault]:
        """Faults of a girder without length, or whose second row leaves the world."""
        body = self.body
        apart = [end - start for start, end in zip(body.start, body.end, strict=True)]
        if max(map(abs, apart)) < SPACING_RANGE[0]:
            yield f"{path}.end", f"is where start is; a girder is at least {SPACING_RANGE[0]:.15g} long"
            return
        half = 0.5 / body.segments
        for axis, offset in enumerate(self._offset()):
            inner = (body.start[axis] + half * apart[axis], body.end[axis] - half * apart[axis])
            if max(abs(place + offset) for place in inner) > COORDINATE_LIMIT:
                yield f"{path}.height", f"takes the second row beyond the limit {COORDINATE_LIMIT:.15g}"
                return

    def _offset(self) -> tuple[float, float]:
        """How far [m] the second row lies to the right of the first; start and end must be apart."""
        across, up = self.body.end[0] - self.body.start[0], self.body.end[1] - self.body.start[1]
        length = math.sqrt(across * across + up * up)
        return self.body.height * (up / length), -self.body.height * (across / length)
