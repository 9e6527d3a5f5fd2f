"""Expansion: what a body becomes, whatever its kind; each kind has a file of its own beside this one."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, ClassVar, Generic, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from sandbox.level.format.actuator_defs import MotorDef
from sandbox.level.format.level_error import Fault, shown
from sandbox.level.format.limits import COORDINATE_LIMIT
from sandbox.level.format.quantities import Description
from sandbox.level.kinds.body_def import BendingDef, BodyDef
from sandbox.level.kinds.geometry import Pairs, Points, distances
from sandbox.physics.collision.filter import LINE
from sandbox.physics.forms import StiffForm

Body = TypeVar("Body", bound=BodyDef)
Floats = NDArray[np.float64]
WHOLE_MOTIONS = 3
NO_POLYGONS: Pairs = np.zeros((0, 3), dtype=np.int64)


class Expansion(Generic[Body]):
    """Particles and springs of one body in generation order, before welds; each array is made when first asked for.

    A kind of body is a subclass: it says what its form is, and whatever of the rest differs from what stands here.
    The form is where particles stand at rest, before cuts and pose. Counts, names and faults allocate nothing.
    """

    model: ClassVar[type[BodyDef]]
    # Where a body of this kind says how large it is: what a refused level is told to change.
    size_path: ClassVar[Sequence[str]] = ("segments",)
    # What several of them are called, and the order of particles and springs, for the reference of the format.
    plural: ClassVar[str]
    generation: ClassVar[str]
    # Models of objects inside, by the words that a file chooses one of them with.
    alternatives: ClassVar[Mapping[str, type[Description]]] = {}

    def __init__(self, body: Body) -> None:
        self.body = body

    @classmethod
    def kind(cls) -> str:
        """The `type` that a file gives it."""
        return str(get_args(cls.model.model_fields["type"].annotation)[0])

    # ---- what each kind says

    @property
    def form_count(self) -> tuple[int, int]:
        """Particles and springs of the form, those that are cut included; beyond the limits a kind may stop short."""
        raise NotImplementedError

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        """Places [m] (n, 2) of the form, about the body's `position` if it has one, and pairs of particles (m, 2).

        Without its `position` such a form depends on no place: bodies of the same shape have the same.
        """
        raise NotImplementedError

    # ---- what a kind may say

    @property
    def polygon_work(self) -> tuple[int, int]:
        """Corners of the polygon that it fills, and how many points and sides filling looks at."""
        return 0, 0

    @property
    def named_particles(self) -> dict[str, int]:
        """Index of each particle that has a name besides its number: `start` of `id.start`."""
        return {}

    def named_pins(self) -> Any:
        """Indices of the particles that `pin` holds."""
        return []

    @cached_property
    def mass(self) -> Floats:
        """Mass [kg] (n,) of each particle."""
        return np.full(self.form_count[0], self.body.__dict__["particle_mass"])

    @cached_property
    def velocity(self) -> Points:
        """Start velocity [m/s] (n, 2) of each particle."""
        return np.zeros((self.form_count[0], 2)) + np.array(self.body.velocity)

    @cached_property
    def rest_length(self) -> Floats:
        """Rest length [m] (m,) of each spring that is not cut."""
        return distances(self.form, self.pairs)

    @property
    def edges(self) -> NDArray[np.int8]:
        """Kind of edge (m,) that others collide with, of each spring that is not cut: lines with two sides."""
        return np.full(len(self.pairs), LINE, dtype=np.int8)

    def polygons(self) -> Pairs:
        """Polygons (t, k) of particles that keep their areas, counter-clockwise, as long as no side is cut."""
        return NO_POLYGONS

    @property
    def inflation(self) -> float:
        """Area that its polygons want, as a multiple of that in the form."""
        return 1.0

    @property
    def bending(self) -> BendingDef | None:
        """The angular springs between its springs."""
        return None

    @property
    def motor(self) -> MotorDef | None:
        """What turns particles 1, 2, ... about particle 0."""
        return None

    def faults(self, path: str) -> Iterator[Fault]:
        """What its fields alone do not show, of a body at a place in the file."""
        return self.outline_faults(path)

    def outline_faults(self, path: str) -> Iterator[Fault]:
        """Whether what it expands to has an outline that stays inside the world."""
        yield from ()

    # ---- what follows

    @property
    def count(self) -> tuple[int, int]:
        """Particles and springs that the body expands to; else as `form_count`."""
        particles, springs = self.form_count
        return particles, springs - len({number for number in self.body.cut if number < springs})

    @property
    def origin(self) -> tuple[float, float]:
        """What the local form is about [m]."""
        return self.body.__dict__.get("position", (0.0, 0.0))

    @cached_property
    def form(self) -> Points:
        """Where the particles are at rest [m] (n, 2)."""
        return self.local_form[0] + np.array(self.origin, dtype=np.float64)

    @property
    def form_pairs(self) -> Pairs:
        """Pairs of particles (m, 2) of all springs of the form."""
        return self.local_form[1]

    @cached_property
    def position(self) -> Points:
        """Where the particles start [m] (n, 2)."""
        return self.form if self.body.pose is None else np.array(self.body.pose, dtype=np.float64).reshape(-1, 2)

    @cached_property
    def pinned(self) -> NDArray[np.bool_]:
        """Which particles (n,) are held."""
        pinned = np.zeros(self.form_count[0], dtype=np.bool_)
        pinned[list(self.body.pinned)] = True
        pinned[self.named_pins()] = True
        return pinned

    @cached_property
    def numbers(self) -> NDArray[np.int64]:
        """The k (m,) of the names `id:k` of the springs that are not cut."""
        kept = np.ones(len(self.form_pairs), dtype=np.bool_)
        kept[list(self.body.cut)] = False
        return np.flatnonzero(kept)

    @cached_property
    def pairs(self) -> Pairs:
        """Pairs of particles (m, 2) that springs join which are not cut."""
        return self.form_pairs[self.numbers] if self.body.cut else self.form_pairs

    @cached_property
    def area_constraints(self) -> Pairs:
        """Polygons (t, k) of particles that keep their area: those of which no spring along a side is cut."""
        polygons = self.polygons()
        if not len(polygons):
            return polygons
        sides = np.stack([polygons, np.roll(polygons, -1, axis=1)], axis=-1)
        return polygons[np.isin(_keys(sides), _keys(self.pairs)).all(axis=1)]

    @cached_property
    def bending_constraints(self) -> Pairs:
        """Triples (t, 3) of a body with bending, in order of their middle ones: where just two springs meet.

        Of the two ends, the one of the earlier spring comes first. Both springs have a length in the form, and so an
        angle.
        """
        if self.bending is None:
            return NO_POLYGONS
        ends = self.pairs.reshape(-1)
        order = np.argsort(ends, kind="stable")
        particle, start, count = np.unique(ends[order], return_index=True, return_counts=True)
        joints = np.flatnonzero(count == 2)
        first, second = order[start[joints]], order[start[joints] + 1]
        # The other end of a spring is next to it in the list.
        angles = np.stack([ends[first ^ 1], particle[joints], ends[second ^ 1]], axis=1)
        return angles[(np.diff(self.form[angles], axis=1) != 0.0).any(axis=2).all(axis=1)]

    @property
    def may_be_stiff(self) -> bool:
        """Whether enough holds it that its form may be stiff without pins: a sieve, as a count is."""
        # n particles move in 2 n ways, in three of them as a whole. One of two is a spring, and no body to be firm.
        held = len(self.pairs) + len(self.stiff_form.areas) + len(self.stiff_form.bends)
        return held >= 2 * self.form_count[0] - WHOLE_MOTIONS >= WHOLE_MOTIONS

    @cached_property
    def stiff_form(self) -> StiffForm:
        """What its firmness depends on: the form and what holds it, but an area of more than three corners."""
        areas = self.area_constraints if self.area_constraints.shape[1] == 3 else NO_POLYGONS
        return StiffForm(self.local_form[0], self.mass, self.pairs, areas, self.bending_constraints)

    def change_faults(self, path: str) -> Iterator[Fault]:
        """Whether pins, cuts and pose speak of particles and springs that the form has."""
        particles, springs = self.form_count
        for index, particle in enumerate(self.body.pinned):
            if particle >= particles:
                yield f"{path}.pinned.{index}", f"{shown(particle)} is beyond the last particle, {particles - 1}"
        for index, spring in enumerate(self.body.cut):
            if spring >= springs:
                last = f"beyond the last spring, {springs - 1}" if springs else ""
                yield (
                    f"{path}.cut.{index}",
                    f"{shown(spring)} {f'is {last}' if last else 'does not exist; the body has no springs'}",
                )
        if self.body.pose is not None and len(self.body.pose) != particles:
            yield f"{path}.pose", f"has {len(self.body.pose)} items for {particles} particles; give one each"


def round_outline_faults(path: str, kind: str, position: tuple[float, float], radius: float) -> Iterator[Fault]:
    """Whether a disc about a position [m] stays inside the world."""
    if max(map(abs, position)) + radius > COORDINATE_LIMIT:
        yield f"{path}.radius", f"takes the {kind} beyond the limit {COORDINATE_LIMIT:.15g}"


def _keys(pairs: Pairs) -> Pairs:
    low, high = pairs.min(axis=-1), pairs.max(axis=-1)
    return np.asarray(low << 32 | high)
