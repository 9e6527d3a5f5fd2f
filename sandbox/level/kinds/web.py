"""Web: a round net."""

from collections.abc import Iterator
from functools import cached_property
from typing import Literal

import numpy as np
from pydantic import Field

from sandbox.level.format.level_error import Fault
from sandbox.level.format.quantities import Angle, Mass, Point, Size
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.expansion import Expansion, round_outline_faults
from sandbox.level.kinds.geometry import Pairs, Points, ring, spokes


class WebDef(BodyDef):
    """A round net: a particle in the centre, rings about it, a thread along every spoke and every ring."""

    type: Literal["web"] = Field(description="Kind of body.")
    position: Point = Field(default=(0.0, 0.0), description="Place of the particle in the centre, `id.centre`.")
    angle: Angle = Field(default=0.0, description="Direction of the first spoke, counter-clockwise from the right.")
    radius: Size = Field(description="Radius of the outermost ring. The others lie evenly inside.")
    spokes: int = Field(ge=3, description="Number of spokes, and of particles in each ring.")
    rings: int = Field(ge=1, description="Number of rings.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    pin: tuple[Literal["rim"], ...] = Field(
        default=(), max_length=1, description='"rim": the outermost ring stays where it is.'
    )


class Web(Expansion[WebDef]):
    """A particle in the centre and rings about it."""

    model = WebDef
    size_path = ("rings",)
    plural = "webs"
    generation = """\
- Web: the particle in the centre, then ring by ring from the inside, each counter-clockwise from the first spoke.
  Springs: the threads along the spokes in the order of their outer particles, then those of the rings."""

    @property
    def form_count(self) -> tuple[int, int]:
        """Every particle except the centre has a thread inward and a thread along its ring."""
        return 1 + self.body.spokes * self.body.rings, 2 * self.body.spokes * self.body.rings

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        body = self.body
        centre = np.zeros((1, 2))
        radii = body.radius * np.arange(1, body.rings + 1, dtype=np.float64) / body.rings
        rings = (radii[:, None, None] * spokes(body.angle, body.spokes)).reshape(-1, 2)
        outer = np.arange(1, len(rings) + 1, dtype=np.int64)
        radial = np.stack([np.maximum(outer - body.spokes, 0), outer], axis=1)
        chords = [ring(1 + index * body.spokes, body.spokes) for index in range(body.rings)]
        return np.concatenate([centre, rings]), np.concatenate([radial, *chords])

    @property
    def named_particles(self) -> dict[str, int]:
        """The particle in the centre."""
        return {"centre": 0}

    def named_pins(self) -> list[int]:
        """The outermost ring, if `pin` names it."""
        count = self.form_count[0]
        return list(range(count - self.body.spokes, count)) if self.body.pin else []

    def outline_faults(self, path: str) -> Iterator[Fault]:
        """Faults where the web does not stay inside the world's bounds."""
        return round_outline_faults(path, self.body.type, self.body.position, self.body.radius)
