"""Bridge: a truss of square cells whose bottom row lies straight below the top row."""

from collections.abc import Iterator
from functools import cached_property
from typing import Literal

import numpy as np
from pydantic import Field

from sandbox.level.format.level_error import Fault
from sandbox.level.format.limits import COORDINATE_LIMIT
from sandbox.level.format.quantities import Mass, Point, Size
from sandbox.level.kinds.body_def import BodyDef, End
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.geometry import Pairs, Points, chain, row


class BridgeDef(BodyDef):
    """A truss: a top row from start to end, a bottom row `height` below, chords, verticals and crossed diagonals."""

    type: Literal["bridge"] = Field(description="Kind of body.")
    start: Point = Field(description="Place of the top row's first particle, `id.start`.")
    end: Point = Field(description="Place of the top row's last particle, `id.end`.")
    segments: int = Field(ge=1, description="Number of cells. Each row has one particle more.")
    height: Size = Field(default=1.0, description="Distance of the bottom row, straight below the top row.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    pin: tuple[End, ...] = Field(default=(), max_length=2, description="Ends where both rows stay where they are.")


class Bridge(Expansion[BridgeDef]):
    """Two rows of particles, one below the other, with diagonals."""

    model = BridgeDef
    plural = "bridges"
    generation = """\
- Bridge: the top row from start to end, then the bottom row, `height` straight below it. Springs: top chords, bottom
  chords, verticals, then per cell the diagonal that falls towards the end and the one that rises."""

    @property
    def form_count(self) -> tuple[int, int]:
        """Each cell has two chords, a vertical and two diagonals; there is one more vertical."""
        return 2 * (self.body.segments + 1), 5 * self.body.segments + 1

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        body, nodes = self.body, self.body.segments + 1
        top = row(body.start, body.end, body.segments)
        bottom = top - np.array([0.0, body.height])
        chords = chain(body.segments)
        post = np.arange(nodes, dtype=np.int64)
        posts = np.stack([post, post + nodes], axis=1)
        cell = np.arange(body.segments, dtype=np.int64)
        falling = np.stack([cell, cell + nodes + 1], axis=1)
        rising = np.stack([cell + nodes, cell + 1], axis=1)
        diagonals = np.stack([falling, rising], axis=1).reshape(-1, 2)
        return np.concatenate([top, bottom]), np.concatenate([chords, chords + nodes, posts, diagonals])

    @property
    def named_particles(self) -> dict[str, int]:
        """The ends of the top row."""
        return {"start": 0, "end": self.body.segments}

    def named_pins(self) -> list[int]:
        """Particles of both rows at the ends that `pin` names."""
        top = super().named_pins()
        return top + [particle + self.body.segments + 1 for particle in top]

    def outline_faults(self, path: str) -> Iterator[Fault]:
        """Whether the bottom row stays inside the world."""
        if min(self.body.start[1], self.body.end[1]) - self.body.height < -COORDINATE_LIMIT:
            yield f"{path}.height", f"takes the bottom row beyond the limit {-COORDINATE_LIMIT:.15g}"
