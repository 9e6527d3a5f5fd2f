"""Rope: a chain of particles."""

from functools import cached_property
from typing import Literal

import numpy as np
from pydantic import Field

from sandbox.level.format.quantities import Length, Mass, Point, empty
from sandbox.level.kinds.body_def import BENDING, BENDS_FREELY, BendingDef, BodyDef, End
from sandbox.level.kinds.expansion import Expansion, Floats
from sandbox.level.kinds.geometry import Pairs, Points, chain, row


class RopeDef(BodyDef):
    """A chain of particles, placed evenly from start to end, with a spring between each two neighbours."""

    type: Literal["rope"] = Field(description="Kind of body.")
    start: Point = Field(description="Place of the first particle, `id.start`.")
    end: Point = Field(description="Place of the last particle, `id.end`.")
    segments: int = Field(ge=1, description="Number of springs. There is one particle more.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    end_mass: Mass | None = Field(
        default=None, description="Mass of the last particle.", json_schema_extra=empty("as the others")
    )
    rest_length: Length | None = Field(
        default=None, description="Rest length of each spring.", json_schema_extra=empty("as placed")
    )
    pin: tuple[End, ...] = Field(default=(), max_length=2, description="Ends that stay where they are.")
    bending: BendingDef | None = Field(default=None, description=BENDING, json_schema_extra=BENDS_FREELY)


class Rope(Expansion[RopeDef]):
    """A row of particles with a spring between each two neighbours."""

    model = RopeDef
    plural = "ropes"
    generation = "- Rope: from start to end, at equal distances, with any rest length."

    @property
    def form_count(self) -> tuple[int, int]:
        """Number of particles and of springs: one particle more."""
        return self.body.segments + 1, self.body.segments

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        return row(self.body.start, self.body.end, self.body.segments), chain(self.body.segments)

    @property
    def named_particles(self) -> dict[str, int]:
        """The particles at both ends, by name."""
        return {"start": 0, "end": self.body.segments}

    @cached_property
    def mass(self) -> Floats:
        """Mass [kg] (n,); the last may have its own."""
        mass = np.full(self.form_count[0], self.body.particle_mass)
        if self.body.end_mass is not None:
            mass[-1] = self.body.end_mass
        return mass

    @cached_property
    def rest_length(self) -> Floats:
        """Rest length [m] (m,): the file's, or as placed."""
        if self.body.rest_length is None:
            return super().rest_length
        return np.full(len(self.pairs), self.body.rest_length)
