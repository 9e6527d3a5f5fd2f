"""Mesh: particles and springs one by one."""

from collections.abc import Iterator
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sandbox.level.format.level_error import Fault, shown
from sandbox.level.format.limits import SPEED_LIMIT
from sandbox.level.format.quantities import Index, Mass, Point, Velocity, empty, unit
from sandbox.level.kinds.body_def import BENDING, BENDS_FREELY, BendingDef, BodyDef
from sandbox.level.kinds.expansion import NO_HULL, Expansion, Floats, directed_sides, edges_of, outline_of
from sandbox.level.kinds.geometry import Pairs, Points
from sandbox.physics.geometry.segment import doubled_areas


class MeshDef(BodyDef):
    """Particles and springs one by one, for forms that no other kind of body has."""

    type: Literal["mesh"] = Field(description="Kind of body.")
    particles: tuple[Point, ...] = Field(min_length=1, description="Place of each particle.")
    masses: tuple[Mass, ...] | None = Field(
        default=None, description="Mass of each particle.", json_schema_extra=unit("kg") | empty("1 each")
    )
    velocities: tuple[Velocity, ...] | None = Field(
        default=None,
        description="Start velocity of each particle, added to the body's `velocity`.",
        json_schema_extra=unit("m/s") | empty("none"),
    )
    springs: tuple[tuple[Index, Index], ...] = Field(
        default=(), description="Pairs of particles, by index. A spring joins each pair; its rest length is as placed."
    )
    triangles: tuple[tuple[Index, Index, Index], ...] = Field(
        default=(),
        description="Triangles of particles, by index, counter-clockwise, with a spring along each side. They keep "
        "their areas as a jelly's do, and it is filled: a side of only one triangle is its outline.",
    )
    bending: BendingDef | None = Field(default=None, description=BENDING, json_schema_extra=BENDS_FREELY)


class Mesh(Expansion[MeshDef]):
    """The particles, springs and triangles of its lists."""

    model = MeshDef
    size_path = ()
    plural = "meshes"
    generation = ""

    @property
    def form_count(self) -> tuple[int, int]:
        """Number of particles and of springs: the lengths of the lists."""
        return len(self.body.particles), len(self.body.springs)

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        pairs = np.array(self.body.springs, dtype=np.int64).reshape(-1, 2)
        return np.array(self.body.particles, dtype=np.float64).reshape(-1, 2), pairs

    @cached_property
    def mass(self) -> Floats:
        """Mass [kg] (n,), as listed."""
        masses = self.body.masses
        return np.ones(self.form_count[0]) if masses is None else np.array(masses, dtype=np.float64)

    @cached_property
    def velocity(self) -> Points:
        """Start velocity [m/s] (n, 2): the sum of the body's and each particle's own."""
        velocity = super().velocity
        return velocity if self.body.velocities is None else velocity + np.array(self.body.velocities)

    @property
    def edges(self) -> NDArray[np.int8]:
        """Kind of edge (m,): a side of only one triangle is solid, one of two is none, and all else is a line."""
        return edges_of(self.pairs, *directed_sides(self.polygons(), self.form_count[0]), self.form_count[0])

    def polygons(self) -> Pairs:
        """The mesh's triangles (t, 3)."""
        return np.array(self.body.triangles, dtype=np.int64).reshape(-1, 3)

    def hull(self) -> Pairs:
        """The outline of its triangles, unless one of its springs is cut."""
        return NO_HULL if self.body.cut else outline_of(self.edges)

    def faults(self, path: str) -> Iterator[Fault]:
        """Faults of lists of different lengths, and of springs that join particles that do not exist."""
        body, size = self.body, len(self.body.particles)
        for name, values in (("masses", body.masses), ("velocities", body.velocities)):
            if values is not None and len(values) != size:
                yield f"{path}.{name}", f"has {len(values)} items for {size} particles; give one each"
        for axis, base in enumerate(body.velocity):
            if any(abs(base + velocity[axis]) > SPEED_LIMIT for velocity in body.velocities or ()):
                yield f"{path}.velocities", f"with the body's velocity one goes beyond the limit {SPEED_LIMIT:.15g}"
        for index, (a, b) in enumerate(body.springs):
            if max(a, b) >= size:
                yield f"{path}.springs.{index}", f"{shown(max(a, b))} is beyond the last particle, {size - 1}"
            elif a == b:
                yield f"{path}.springs.{index}", f"joins particle {a} to itself; name two particles"
        if body.triangles:
            yield from self._triangle_faults(f"{path}.triangles")

    def _triangle_faults(self, path: str) -> Iterator[Fault]:
        """Faults of triangles that are none, run clockwise, lack a spring, or lie over one another."""
        places, size = self.body.particles, len(self.body.particles)
        joined = {frozenset(pair) for pair in self.body.springs}
        taken: set[tuple[int, int]] = set()
        for index, (a, b, c) in enumerate(self.body.triangles):
            place, sides = f"{path}.{index}", [(a, b), (b, c), (c, a)]
            bare = next((side for side in sides if frozenset(side) not in joined), None)
            twice = next((side for side in sides if side in taken), None)
            if max(a, b, c) >= size:
                yield place, f"{shown(max(a, b, c))} is beyond the last particle, {size - 1}"
            elif len({a, b, c}) < 3:
                yield place, "has a corner twice; name three particles"
            elif doubled_areas(*(np.array(places[corner]) for corner in (a, b, c))) <= 0.0:
                yield place, "does not run counter-clockwise; turn it round"
            elif bare is not None:
                yield place, f"has no spring from particle {bare[0]} to {bare[1]}; add one"
            elif twice is not None:
                yield place, f"lies on the same side of {twice[0]} and {twice[1]} as an earlier one; take one out"
            taken.update(sides)
