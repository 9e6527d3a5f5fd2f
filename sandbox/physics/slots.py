"""Slots: the arrays of a world as they grow, and what is done to elements."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.arrays import GUARDED, KINDS, VECTOR_ARRAYS
from sandbox.physics.elements import AREA, BEND, Elements, drop_loose

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]

# An energy bank that the direct solver begins anew at its next step: something outside changed the body.
BANK_UNOPENED = -1.0
# The material index of an element with Cs and Cd of its own, which no slider reaches.
OWN_MATERIAL = -1


class ElementSlots:
    """The part of a World that grows arrays, and that adds and removes elements (see World and elements.py)."""

    position: Floats
    energy_bank: Floats
    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    spring_active: NDArray[np.bool_]
    element_kind: NDArray[np.int8]
    element_first: NDArray[np.int32]
    element_corners: NDArray[np.int32]
    element_rest: Floats
    element_stiffness: Floats
    element_damping: Floats
    element_material: NDArray[np.int32]
    element_active: NDArray[np.bool_]
    corner_particle: NDArray[np.int32]
    corner_weight: Floats
    corner_form: Floats

    def __init__(self) -> None:
        for name, kind in KINDS.items():
            setattr(self, name, np.zeros((0, 2) if name in VECTOR_ARRAYS else 0, dtype=kind))
        self.good: dict[str, Floats] = {name: getattr(self, name).copy() for name in GUARDED}

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

    def inflate(self, element: int, inflation: float) -> None:
        """Let an area want this multiple of its form's."""
        self.element_rest[element, 0] = inflation * self.element_rest[element, 1]
        self.good["element_rest"][element] = self.element_rest[element]
        first = self.element_first[element]
        self._disturb(self.corner_particle[first : first + self.element_corners[element]])

    def _drop_elements(self, cut: int) -> None:
        """Take out the elements that the cut spring was a side of, unless another spring holds that side."""
        drop_loose(self.elements, self.particle_a, self.particle_b, self.spring_active, cut)

    def _disturb(self, *particles: NDArray[np.integer] | int) -> None:
        for slots in particles:
            self.energy_bank[slots] = BANK_UNOPENED

    def _append(self, **arrays: Any) -> None:
        for name, values in arrays.items():
            present = getattr(self, name)
            added = np.asarray(values, dtype=present.dtype)
            setattr(self, name, np.concatenate([present, added]))
            if name in GUARDED:
                self.good[name] = np.concatenate([self.good[name], added])


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
