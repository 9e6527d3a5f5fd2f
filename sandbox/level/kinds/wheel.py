"""Wheel: a braced rim, spokes and a hub, which a motor may turn."""

from collections.abc import Iterator
from functools import cached_property
from typing import Literal

import numpy as np
from pydantic import Field

from sandbox.level.format.actuator_defs import MotorDef
from sandbox.level.format.level_error import Fault, shown
from sandbox.level.format.quantities import Angle, Mass, Point, Size, empty
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.expansion import Expansion, Floats, round_hull, round_outline_faults
from sandbox.level.kinds.geometry import Pairs, Points, ring, spokes


class WheelDef(BodyDef):
    """A rim of two rings, braced crosswise, with a spoke from every particle of the inner ring to a hub."""

    type: Literal["wheel"] = Field(description="Kind of body.")
    position: Point = Field(default=(0.0, 0.0), description="Place of the hub, `id.hub`.")
    angle: Angle = Field(default=0.0, description="Direction of the first spoke, counter-clockwise from the right.")
    radius: Size = Field(description="Radius of the outer ring.")
    thickness: Size = Field(description="Distance from the outer ring to the inner one; less than the radius.")
    segments: int = Field(ge=3, description="Number of spokes, and of particles in each ring.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    hub_mass: Mass | None = Field(
        default=None, description="Mass of the hub.", json_schema_extra=empty("as the others")
    )
    pin: tuple[Literal["hub"], ...] = Field(default=(), max_length=1, description='"hub": the hub stays where it is.')
    motor: MotorDef | None = Field(
        default=None, description="Motor that turns it about its hub.", json_schema_extra=empty("none")
    )
    touches_mount: bool = Field(
        default=True,
        description="Whether it touches its mount: all bodies that welds and loose springs join to its hub, directly "
        "or through other bodies.",
    )


class Wheel(Expansion[WheelDef]):
    """A hub and two rings of particles about it."""

    model = WheelDef
    plural = "wheels"
    generation = """\
- Wheel: the hub, the inner ring, the outer ring, each counter-clockwise from the first spoke. Springs: hub to inner
  ring, inner ring, outer ring, between the rings, then per cell both diagonals."""

    @property
    def form_count(self) -> tuple[int, int]:
        """Each cell has a spoke, three sides and two diagonals."""
        return 1 + 2 * self.body.segments, 6 * self.body.segments

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        body = self.body
        directions = spokes(body.angle, body.segments)
        points = np.concatenate(
            [np.zeros((1, 2)), (body.radius - body.thickness) * directions, body.radius * directions]
        )
        inner = np.arange(1, body.segments + 1, dtype=np.int64)
        outer = inner + body.segments
        first, second = ring(1, body.segments), ring(1 + body.segments, body.segments)
        diagonals = np.stack([np.stack([inner, second[:, 1]], axis=1), np.stack([outer, first[:, 1]], axis=1)], axis=1)
        spring_rows = [np.stack([np.zeros_like(inner), inner], axis=1), first, second, np.stack([inner, outer], axis=1)]
        return points, np.concatenate([*spring_rows, diagonals.reshape(-1, 2)])

    @property
    def named_particles(self) -> dict[str, int]:
        """The hub."""
        return {"hub": 0}

    @cached_property
    def mass(self) -> Floats:
        """Mass [kg] (n,); the hub may have its own."""
        mass = np.full(self.form_count[0], self.body.particle_mass)
        if self.body.hub_mass is not None:
            mass[0] = self.body.hub_mass
        return mass

    @property
    def motor(self) -> MotorDef | None:
        """The motor that turns both rings about the hub."""
        return self.body.motor

    def hull(self) -> Pairs:
        """The outer ring."""
        return round_hull(2 * self.body.segments, self.body.segments)

    def outline_faults(self, path: str) -> Iterator[Fault]:
        """Faults of a rim without an inner ring, or that leaves the world."""
        body = self.body
        if body.thickness >= body.radius:
            yield f"{path}.thickness", f"{shown(body.thickness)} is not below the radius, {shown(body.radius)}"
        yield from round_outline_faults(path, body.type, body.position, body.radius)
