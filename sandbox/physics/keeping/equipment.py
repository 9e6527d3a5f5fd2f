"""What a world keeps beside its state: forms of bodies at rest, surface, constant parts, names, and room to grow."""

import bisect
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import FloatRows, Floats, SlotRows
from sandbox.physics.breaking import StrainLimits
from sandbox.physics.driving import Actuators
from sandbox.physics.jit import inner_kernel, kernel, scalar_kernel

# Gravity [m/s^2] that a sag is meant for where there is none.
USUAL_GRAVITY = 9.81
Array = NDArray[Any]
# How many times the rows in use there is room for where more room is made [1], and at least so many rows more: lower
# copies more often, higher wastes memory.
GROWTH, LEAST = 1.5, 16


@dataclass(frozen=True)
class Firmness:
    """The wanted firmness of a body: its sag, a share of its height; or the frequency [Hz] and damping ratio of its
    wobble.

    A sag of 0 is complete rigidity.
    """

    sag: float | None = None
    hz: float | None = None
    ratio: float | None = None

    def __str__(self) -> str:
        if self.sag is not None:
            return f"sag {self.sag:.3g}"
        return f"{self.hz:.4g} Hz" + ("" if self.ratio is None else f" at ratio {self.ratio:.4g}")


class StiffForm(NamedTuple):
    """The form of a body at rest: points [m] (n, 2), mass [kg] (n,), springs and constraints by index.

    pairs (m, 2); areas and bends (t, 3).
    """

    points: Annotated[FloatRows, "particles, 2"]
    mass: Annotated[Floats, "particles"]
    pairs: Annotated[SlotRows, "springs, 2"]
    areas: Annotated[SlotRows, "triangles, 3"]
    bends: Annotated[SlotRows, "turns, 3"]


@dataclass(frozen=True, eq=False)
class FirmBody:
    """A body of a world whose form may be stiff without pins, by name, with the slots of its springs and constraints.

    The constraints are of three corners each.
    """

    name: str
    shape: StiffForm
    springs: NDArray[np.int64]
    constraints: NDArray[np.int64]


@scalar_kernel
def design_gravity(gravity_x: float, gravity_y: float) -> float:
    """The strength of gravity [m/s^2] that a sag is designed for: the usual one where a level has none."""
    strength = math.sqrt(gravity_x * gravity_x + gravity_y * gravity_y)
    return strength if strength > 0.0 else USUAL_GRAVITY


@inner_kernel
def height_along(points: FloatRows, gravity_x: float, gravity_y: float) -> float:
    """Extent [m] of points (n, 2) along gravity [m/s^2]; along y where there is none."""
    strength = design_gravity(gravity_x, gravity_y)
    x, y = gravity_x / strength, gravity_y / strength
    if gravity_x == 0.0 and gravity_y == 0.0:
        y = 1.0
    lowest, highest = math.inf, -math.inf
    for k in range(points.shape[0]):
        along = points[k, 0] * x + points[k, 1] * y
        lowest, highest = min(lowest, along), max(highest, along)
    return highest - lowest


@kernel
def height_of(form: StiffForm, gravity_x: float, gravity_y: float) -> float:
    """`height_along` of a form."""
    return height_along(form.points, gravity_x, gravity_y)


@dataclass(frozen=True)
class Surface:
    """Contact properties of a particle: friction, restitution, group and collides, see StateArrays."""

    friction: float = 0.0
    restitution: float = 0.0
    group: int = 0
    collides: int = 0


@dataclass(frozen=True, eq=False)
class Joined:
    """Bodies that joined a world together while it ran.

    definition: what a command said of them. names: of the bodies. first_particle, first_spring, first_part: their
    slots, in the order of the names of particles and springs; second_names: further names of particles, with their
    slots.
    """

    definition: Mapping[str, Any]
    names: tuple[str, ...]
    first_particle: int
    first_spring: int
    first_part: int
    particle_names: tuple[str, ...]
    spring_names: tuple[str, ...]
    second_names: tuple[tuple[str, int], ...]


class Equipment(NamedTuple):
    """The constant part of a world, by the names that World has for it.

    Names of materials and the strains that each bears; driven parts; bodies that keep areas, and the constraints of
    each; bodies that may be stiff by their form; hulls, which displace water (displacers.py); what joined while the
    world ran, in order.
    """

    material_names: tuple[str, ...]
    limits: StrainLimits
    actuators: Actuators
    area_names: tuple[str, ...]
    area_constraints: tuple[range, ...]
    forms: tuple[FirmBody, ...]
    hulls: SlotRows
    joined: tuple[Joined, ...]


class Names:
    """Names of slots from 0 on, each given once; in_order: by slot. A slot may have second names to be found by."""

    def __init__(self) -> None:
        self.in_order: list[str] = []
        self._slots: dict[str, int] = {}
        self._second: list[str] = []

    @property
    def second(self) -> list[tuple[str, int]]:
        """The second names, with their slots, as they were given."""
        return [(name, self._slots[name]) for name in self._second]

    def slot(self, name: str) -> int:
        """The slot of that name. Raises KeyError."""
        if not isinstance(name, str):
            raise KeyError(f"name {name!r:.60}: a text is needed")
        return self._slots[name]

    def unused(self, prefix: str, count: int) -> list[str]:
        """Names of that prefix and a number each, the next that are free where they are given in order from 0 on."""
        beyond = 1
        while f"{prefix}{beyond - 1}" in self._slots:
            beyond *= 2
        first = bisect.bisect_left(range(beyond), True, key=lambda number: f"{prefix}{number}" not in self._slots)
        return [f"{prefix}{number}" for number in range(first, first + count)]

    def check(self, argument: str, names: Sequence[str], count: int) -> None:
        """Whether the next slots, of `count` in all, can have these names. Raises ValueError."""
        taken = next((name for name in names if name in self._slots), None)
        if taken is not None or len(set(names)) != len(names):
            raise ValueError(f"{argument}: {taken or 'of two new slots'!r} is taken")
        if len(self.in_order) + len(names) > count:
            raise ValueError(f"{argument}: {len(names)} names for {count - len(self.in_order)} slots without one")

    def append(self, names: Sequence[str]) -> None:
        """Name the next slots. Raises ValueError for a name that is taken."""
        self.check("names", names, len(self.in_order) + len(names))
        self._slots.update({name: len(self.in_order) + index for index, name in enumerate(names)})
        self.in_order.extend(names)

    def add_second(self, slot: int, name: str) -> None:
        """Give a slot a second name. Raises ValueError where that is taken."""
        if name in self._slots:
            raise ValueError(f"name {name!r}: it is taken")
        self._slots[name] = slot
        self._second.append(name)

    def forget_beyond(self, count: int) -> None:
        """Drop the names of all slots but the first `count`, second names given since included."""
        while self._second and self._slots[self._second[-1]] >= count:
            del self._slots[self._second.pop()]
        for name in self.in_order[count:]:
            del self._slots[name]
        del self.in_order[count:]


class Capacity:
    """Larger arrays, by name, of which those in use are the first rows."""

    def __init__(self) -> None:
        self._larger: dict[str, Array] = {}

    def appended(self, name: str, present: Array, count: int) -> Array:
        """The array of that name with `count` rows more, to be written; `present` must not be used any more."""
        used, larger = len(present), self._larger.get(name)
        if larger is None or present.base is not larger or used + count > len(larger):
            rows = max(used + count, int(GROWTH * used)) + LEAST
            larger = self._larger[name] = np.zeros((rows, *present.shape[1:]), present.dtype)
            larger[:used] = present
        return larger[: used + count]
