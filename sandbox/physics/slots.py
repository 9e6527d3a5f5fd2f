"""Slots of elements: how they are added to a world's state, changed and dropped."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.constraints import AREA, BEND, Elements
from sandbox.physics.state import Floats, StateArrays

# The material index of an element with Cs and Cd of its own, which no slider reaches.
OWN_MATERIAL = -1
# Corners of an area that is all shape: it and its sides agree in one.
TRIANGLE = 3
# Cs and Cd at most of an area of more corners, whose size its sides may not allow: at 0.999 a rigid skin that is blown
# up shakes for seconds at 20 m/s, at 1 for ever at 90; at 0.95 it breathes.
HIGHEST_OF_RING = 0.99


class ElementSlots(StateArrays):
    """The part of a World that adds and removes elements (see constraints.py), and tunes them with their springs."""

    def __init__(self) -> None:
        super().__init__()
        # Bodies that keep areas, and the elements of each; no state.
        self.area_names: list[str] = []
        self.area_elements: list[range] = []

    @property
    def element_count(self) -> int:
        """Element slots in use, active or not."""
        return len(self.element_kind)

    @property
    def elements(self) -> Elements:
        """The elements as kernels read them."""
        return Elements(
            self.element_kind, self.element_first, self.element_corners, self.element_rest, self.element_active,
            self.corner_particle, self.corner_weight,
        )  # fmt: skip

    @property
    def element_coefficients(self) -> tuple[Floats, Floats]:
        """Cs and Cd (t,) of a tick, as solvers take them; those of areas of more than three corners give way."""
        stiffness, damping = self.element_stiffness, self.element_damping
        # numpy takes 2 us for nothing at all, a fifth of the tick of a rope.
        if not len(damping):
            return stiffness, damping
        gives = (self.element_corners > TRIANGLE) & (damping > HIGHEST_OF_RING)
        if not gives.any():
            return stiffness, damping
        least = np.minimum(stiffness, HIGHEST_OF_RING)
        return np.where(gives, least, stiffness), np.where(gives, HIGHEST_OF_RING, damping)

    def add_elements(
        self,
        kind: int,
        corners: ArrayLike,
        *,
        form: ArrayLike | None = None,
        inflation: ArrayLike = 1.0,
        stiffness: ArrayLike = 0.5,
        damping: ArrayLike = 0.9,
        material: ArrayLike = 0,
    ) -> int:
        """Append elements of one kind, AREA or BEND, with k corners each, and return the first slot.

        corners: particle slots (t, k), of an area in the order of its outline. form [m] (t, k, 2): their places at
        rest, None = as they stand. inflation: area wanted as a multiple of the form's. The others (t,) or one for all.
        Raises ValueError for a slot that does not exist, one that comes twice, a bend with no three corners or with a
        link of no length, and an area with fewer than three corners.
        """
        slots = np.asarray(corners, dtype=np.int64)
        count, size = slots.shape
        if size < 3 or (kind == BEND and size != 3):
            raise ValueError("an area has three corners or more, a bend three")
        if count and (slots.min() < 0 or slots.max() >= len(self.position)):
            raise ValueError("an element names a particle slot that does not exist")
        if np.any(np.diff(np.sort(slots, axis=1), axis=1) == 0):
            raise ValueError("the corners of an element are different particles")
        places = self.position[slots] if form is None else np.asarray(form, dtype=np.float64)
        rest, weight = _rest_area(places, inflation) if kind == AREA else _rest_bend(places)
        first = self.element_count
        self._append(
            element_kind=np.full(count, kind),
            element_first=len(self.corner_particle) + size * np.arange(count),
            element_corners=np.full(count, size),
            element_rest=rest,
            element_stiffness=np.broadcast_to(stiffness, count),
            element_damping=np.broadcast_to(damping, count),
            element_material=np.broadcast_to(material, count),
            element_active=np.ones(count, dtype=np.bool_),
            corner_particle=slots.reshape(-1),
            corner_weight=weight.reshape(-1),
            corner_form=places.reshape(-1, 2),
        )
        self._disturb(slots)
        return first

    def name_areas(self, name: str, elements: range) -> None:
        """Name the areas of a body, to be inflated together."""
        self.area_names.append(name)
        self.area_elements.append(elements)

    def inflate(self, body: int, inflation: float) -> None:
        """Let each area of a body, by its place in `area_names`, want this multiple of its form's."""
        first, last = self.area_elements[body].start, self.area_elements[body].stop
        self.element_rest[first:last, 0] = inflation * self.element_rest[first:last, 1]
        self.good["element_rest"][first:last] = self.element_rest[first:last]
        corners = self.element_first[first], self.element_first[last - 1] + self.element_corners[last - 1]
        self._disturb(self.corner_particle[corners[0] : corners[1]])

    def set_coefficients(self, stiffness: float | None, damping: float | None, material: int | None) -> None:
        """Set Cs, Cd or both, of one material's springs and areas or (None) of all.

        Hands, Hooke springs and elements with Cs and Cd of their own keep theirs.
        """
        for family, materials in (("", self.material), ("element_", self.element_material)):
            chosen = materials >= 0 if material is None else materials == material
            for name, value in ((f"{family}stiffness", stiffness), (f"{family}damping", damping)):
                if value is not None:
                    getattr(self, name)[chosen] = value
                self.good[name][chosen] = getattr(self, name)[chosen]
            if not family:
                self._disturb(self.particle_a[chosen], self.particle_b[chosen])
            else:
                self._disturb(self.corner_particle[np.repeat(chosen, self.element_corners)])

    def _drop_elements(self, springs: ArrayLike) -> None:
        """Take out the elements that these springs were a side of, unless another spring holds that side."""
        if not self.element_count:
            return
        active = self.spring_active
        taken = np.asarray(springs, dtype=np.int64)
        cut = _sides(self.particle_a[taken], self.particle_b[taken])
        loose = np.setdiff1d(cut, _sides(self.particle_a[active], self.particle_b[active]))
        owner = np.repeat(np.arange(self.element_count), self.element_corners)
        corner, first = np.arange(len(owner)), self.element_first[owner]
        before = np.where(corner == first, first + self.element_corners[owner] - 1, corner - 1)
        # A bend's two outer corners are no side of it.
        is_side = (self.element_kind[owner] == AREA) | (corner != first)
        gone = is_side & np.isin(_sides(self.corner_particle[before], self.corner_particle), loose)
        self.element_active[owner[gone]] = False


def _sides(a: NDArray[np.int32], b: NDArray[np.int32]) -> NDArray[np.int64]:
    """One number for each pair of particles, whichever comes first."""
    return np.minimum(a, b).astype(np.int64) << 32 | np.maximum(a, b)


def _rest_area(places: Floats, inflation: ArrayLike) -> tuple[Floats, Floats]:
    """Rest (t, 2) and weights (t, k) of areas; sums are in a written order, as those of a tick are."""
    apart = places - places[:, :1]
    area = np.zeros(len(places))
    for corner in range(1, places.shape[1] - 1):
        x, y = apart[:, corner], apart[:, corner + 1]
        area = area + 0.5 * (x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0])
    across = np.roll(places, -1, axis=1) - np.roll(places, 1, axis=1)
    weight = 0.25 * (across[..., 0] * across[..., 0] + across[..., 1] * across[..., 1])
    return np.stack([np.broadcast_to(inflation, len(places)) * area, area], axis=1), weight


def _rest_bend(places: Floats) -> tuple[Floats, Floats]:
    """Rest (t, 2) and weights (t, 3) of bends."""
    links = np.diff(places, axis=1)
    length = np.sqrt(links[..., 0] * links[..., 0] + links[..., 1] * links[..., 1])
    if np.any(length == 0.0):
        raise ValueError("a bend joins two links, each with a length")
    a, b = links[:, 0] / length[:, :1], links[:, 1] / length[:, 1:]
    cosine, sine = a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1], a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    scaled = a / length[:, :1] + b / length[:, 1:]
    middle = scaled[:, 0] * scaled[:, 0] + scaled[:, 1] * scaled[:, 1]
    ends = 1.0 / (length * length)
    return np.stack([cosine, sine], axis=1), np.stack([ends[:, 0], middle, ends[:, 1]], axis=1)
