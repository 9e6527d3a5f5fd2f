"""Ring: a closed ring of particles that keeps the area inside."""

from collections.abc import Iterator
from functools import cached_property
from typing import Literal

import numpy as np
from pydantic import Field

from sandbox.level.format.level_error import Fault
from sandbox.level.format.quantities import Angle, Inflation, Mass, Point, Size, empty
from sandbox.level.kinds.body_def import BENDING, BENDS_FREELY, BendingDef, BodyDef
from sandbox.level.kinds.expansion import NO_HULL, NO_POLYGONS, Expansion, round_hull, round_outline_faults
from sandbox.level.kinds.geometry import Pairs, Points, ring, spokes


class RingDef(BodyDef):
    """A closed ring of particles that keeps the area inside it: a balloon, a tyre."""

    type: Literal["ring"] = Field(description="Kind of body.")
    position: Point = Field(default=(0.0, 0.0), description="Place of the centre.")
    angle: Angle = Field(default=0.0, description="Direction of the first particle, counter-clockwise from the right.")
    radius: Size = Field(description="Radius of the ring.")
    segments: int = Field(ge=3, description="Number of springs, and of particles.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    inflation: Inflation | None = Field(
        default=1.0,
        description="Area that the ring keeps, as a multiple of the area of its own form.",
        json_schema_extra=empty("keeps no area"),
    )
    bending: BendingDef | None = Field(default=None, description=BENDING, json_schema_extra=BENDS_FREELY)


class Ring(Expansion[RingDef]):
    """A ring of particles, with the area in it, if that is kept."""

    model = RingDef
    plural = "rings"
    generation = (
        "- Ring: counter-clockwise from the first particle. Springs: each to the next, the last back to the first."
    )

    @property
    def form_count(self) -> tuple[int, int]:
        """Number of particles and of springs: equal."""
        return self.body.segments, self.body.segments

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        return self.body.radius * spokes(self.body.angle, self.body.segments), ring(0, self.body.segments)

    def polygons(self) -> Pairs:
        """The whole ring, unless it keeps no area."""
        return NO_POLYGONS if self.body.inflation is None else np.arange(self.body.segments, dtype=np.int64)[None]

    def hull(self) -> Pairs:
        """All of the ring's springs. Without an area to keep, water would press it flat, and flows through it."""
        body = self.body
        return NO_HULL if body.inflation is None else round_hull(0, body.segments)

    @property
    def inflation(self) -> float:
        """Area that the ring keeps, as a multiple of the area of its form."""
        return 1.0 if self.body.inflation is None else self.body.inflation

    def outline_faults(self, path: str) -> Iterator[Fault]:
        """Faults where the ring does not stay inside the world's bounds."""
        return round_outline_faults(path, self.body.type, self.body.position, self.body.radius)
