"""Expansion: the particles and springs of a body, the base of all kinds. Each kind is one file in this folder."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import ClassVar, Generic, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from sandbox.level.format.actuator_defs import MotorDef
from sandbox.level.format.level_error import Fault, shown
from sandbox.level.format.limits import COORDINATE_LIMIT
from sandbox.level.format.quantities import Description
from sandbox.level.kinds.body_def import BendingDef, BodyDef
from sandbox.level.kinds.geometry import Pairs, Points, distances, pair_keys
from sandbox.physics.keeping.equipment import StiffForm
from sandbox.physics.marks import LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT

Body = TypeVar("Body", bound=BodyDef)
Floats = NDArray[np.float64]
WHOLE_MOTIONS = 3
NO_POLYGONS: Pairs = np.zeros((0, 3), dtype=np.int64)
NO_HULL: Pairs = np.zeros((0, 2), dtype=np.int64)


class Expansion(Generic[Body]):
    """Particles and springs of one body in generation order, before welds. Each array is made at its first use.

    A kind of body is a subclass: it defines the form, and overrides what differs from this class. The form is where
    particles stand at rest, before cuts and pose. Counts, names and faults allocate nothing.
    """

    model: ClassVar[type[BodyDef]]
    # Path of the field that sets the size of such a body; a message about a too large level names it.
    size_path: ClassVar[Sequence[str]] = ("segments",)
    # The plural, and the order of particles and springs, for the reference.
    plural: ClassVar[str]
    generation: ClassVar[str]
    # Models of alternative objects inside, by the key that chooses one.
    alternatives: ClassVar[Mapping[str, type[Description]]] = {}

    def __init__(self, body: Body) -> None:
        self.body = body

    @classmethod
    def kind(cls) -> str:
        """The `type` of the kind in a file."""
        return str(get_args(cls.model.model_fields["type"].annotation)[0])

    # ---- each kind defines this

    @property
    def form_count(self) -> tuple[int, int]:
        """Numbers of particles and springs of the form, with cut springs; a kind may stop counting at the limits."""
        raise NotImplementedError

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        """Places [m] (n, 2) of the form, relative to the body's `position`, if any, and pairs of particles (m, 2).

        Bodies of the same shape at different positions have the same local form.
        """
        raise NotImplementedError

    # ---- a kind may override this

    @property
    def polygon_work(self) -> tuple[int, int]:
        """Number of corners of its polygon, and the work of filling it [points and sides]."""
        return 0, 0

    @property
    def named_particles(self) -> dict[str, int]:
        """Index of each particle that has a name besides its number: `start` of `id.start`."""
        return {}

    def named_pins(self) -> list[int]:
        """Indices of the particles that `pin` holds: those that it names."""
        return [self.named_particles[name] for name in self.body.__dict__.get("pin", ())]

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
        """Polygons (t, k) of particles that keep their areas while no side is cut, counter-clockwise."""
        return NO_POLYGONS

    def hull(self) -> Pairs:
        """Springs (k, 2) of a closed outline that displaces water in place of triangles.

        The number of each in the form; 1 where the inside is on the left of the way from its second end to its first.
        """
        return NO_HULL

    @property
    def inflation(self) -> float:
        """Area that its polygons want, as a multiple of that in the form."""
        return 1.0

    @property
    def bending(self) -> BendingDef | None:
        """Stiffness of the angles between springs, if the body has any."""
        return self.body.__dict__.get("bending")

    @property
    def motor(self) -> MotorDef | None:
        """The motor that turns particles 1, 2, ... about particle 0."""
        return None

    def faults(self, path: str) -> Iterator[Fault]:
        """Faults that involve several fields; path: the place of the body in the file."""
        return self.outline_faults(path)

    def outline_faults(self, path: str) -> Iterator[Fault]:
        """Faults of an outline that leaves the world."""
        yield from ()

    # ---- derived from the above

    @property
    def count(self) -> tuple[int, int]:
        """Numbers of particles and springs without cut ones; else as `form_count`."""
        particles, springs = self.form_count
        return particles, springs - len({number for number in self.body.cut if number < springs})

    @property
    def origin(self) -> tuple[float, float]:
        """The origin [m] of the local form."""
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
        """Whether each particle (n,) is pinned."""
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
        """Polygons (t, k) of particles that keep their areas; no spring along a side of them is cut."""
        polygons = self.polygons()
        if not len(polygons):
            return polygons
        whole = self._have_sides(polygons)
        if not self.body.cut or polygons.shape[1] != 3:
            return polygons[whole]
        # As after a cut in a run: a cell that lost a corner keeps its other half.
        made = polygons.copy()
        for k in np.flatnonzero(~whole[:-1] & ~whole[1:]).tolist():
            halves = np.array(_halved_other_way(*made[k : k + 2].tolist()) or made[k : k + 2])
            if not whole[k : k + 2].any() and (are_whole := self._have_sides(halves)).any():
                made[k : k + 2], whole[k : k + 2] = halves, are_whole
        return made[whole]

    def _have_sides(self, polygons: Pairs) -> NDArray[np.bool_]:
        """Whether springs that are not cut lie along all sides of polygons (t, k)."""
        sides = np.stack([polygons, np.roll(polygons, -1, axis=1)], axis=-1)
        return np.asarray(np.isin(pair_keys(sides), pair_keys(self.pairs)).all(axis=1))

    @cached_property
    def bending_constraints(self) -> Pairs:
        """Triples (t, 3) of particles, in order of the middle ones, at each of which just two springs meet.

        The end of the earlier spring comes first. Both springs have a length in the form.
        """
        if self.bending is None:
            return NO_POLYGONS
        ends = self.pairs.reshape(-1)
        order = np.argsort(ends, kind="stable")
        particle, start, count = np.unique(ends[order], return_index=True, return_counts=True)
        joints = np.flatnonzero(count == 2)
        first, second = order[start[joints]], order[start[joints] + 1]
        # The two ends of a spring are neighbours in the list.
        angles = np.stack([ends[first ^ 1], particle[joints], ends[second ^ 1]], axis=1)
        return angles[(np.diff(self.form[angles], axis=1) != 0.0).any(axis=2).all(axis=1)]

    @property
    def may_be_stiff(self) -> bool:
        """Whether it has enough springs to be stiff without pins. This counts only, so it may be wrong."""
        # n particles have 2 n degrees of freedom; three of them move the whole. Two particles are a spring, not a body.
        held = len(self.pairs) + len(self.stiff_form.areas) + len(self.stiff_form.bends)
        return held >= 2 * self.form_count[0] - WHOLE_MOTIONS >= WHOLE_MOTIONS

    @cached_property
    def stiff_form(self) -> StiffForm:
        """The form, and the springs, angles and triangles that hold it; areas of more corners do not count."""
        areas = self.area_constraints if self.area_constraints.shape[1] == 3 else NO_POLYGONS
        return StiffForm(self.local_form[0], self.mass, self.pairs, areas, self.bending_constraints)

    def change_faults(self, path: str) -> Iterator[Fault]:
        """Faults of pins, cuts and pose that name particles or springs that do not exist."""
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


def directed_sides(triangles: Pairs, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Keys a n + b of the sides a to b of triangles (t, 3), counter-clockwise, of n = count particles; no diagonals."""
    ends = np.roll(triangles, -1, axis=1)
    return (triangles * count + ends).reshape(-1), np.zeros(0, dtype=np.int64)


def edges_of(pairs: Pairs, sides: NDArray[np.int64], inner: NDArray[np.int64], count: int) -> NDArray[np.int8]:
    """Kind of edge (m,) of springs of pairs (m, 2): solid along one side, none along two and where it lies inside.

    sides: keys a n + b of sides from a to b, counter-clockwise; inner: of diagonals; n = count particles.
    """
    there, back = pairs[:, 0] * count + pairs[:, 1], pairs[:, 1] * count + pairs[:, 0]
    left, right = np.isin(there, sides), np.isin(back, sides)
    hidden = np.isin(there, inner) | np.isin(back, inner) | (left & right)
    kind = np.where(left, SOLID_LEFT, np.where(right, SOLID_RIGHT, LINE))
    return np.where(hidden, NO_EDGE, kind).astype(np.int8)


def outline_of(edges: NDArray[np.int8]) -> Pairs:
    """The hull of the springs (m,) whose edges are solid."""
    outline = np.flatnonzero((edges == SOLID_LEFT) | (edges == SOLID_RIGHT))
    return np.stack([outline, edges[outline] == SOLID_RIGHT], axis=1)


def round_hull(first: int, count: int) -> Pairs:
    """The hull of a counter-clockwise ring of springs that follow each other."""
    return np.stack([np.arange(first, first + count), np.zeros(count, np.int64)], axis=1)


def round_outline_faults(path: str, kind: str, position: tuple[float, float], radius: float) -> Iterator[Fault]:
    """Faults of a disc about a position [m] that leaves the world."""
    if max(map(abs, position)) + radius > COORDINATE_LIMIT:
        yield f"{path}.radius", f"takes the {kind} beyond the limit {COORDINATE_LIMIT:.15g}"


def _halved_other_way(one: list[int], other: list[int]) -> list[list[int]]:
    """Two triangles with a common side, b x y and d y x, as b x d and b d y; empty where they have none."""
    beyond, beside = [p for p in one if p not in other], [p for p in other if p not in one]
    if len(beyond) != 1:
        return []
    at, (b,), (d,) = one.index(beyond[0]), beyond, beside
    return [[b, one[(at + 1) % 3], d], [b, d, one[(at + 2) % 3]]]
