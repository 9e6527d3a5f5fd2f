"""The arrays of a world's state: their names, their types, and their order."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]

PARTICLE_ARRAYS = {
    "position": np.float64,
    "velocity": np.float64,
    "origin": np.float64,
    "mass": np.float64,
    "inverse_mass": np.float64,
    "radius": np.float64,
    "gravity_scale": np.float64,
    "particle_active": np.bool_,
    "slow_velocity": np.float64,
    "energy_bank": np.float64,
    "friction": np.float64,
    "restitution": np.float64,
    "owner": np.int32,
    "group": np.int64,
    "collides": np.int64,
}
SPRING_ARRAYS = {
    "particle_a": np.int32,
    "particle_b": np.int32,
    "rest_length": np.float64,
    "natural_length": np.float64,
    "stiffness": np.float64,
    "damping": np.float64,
    "law": np.int8,
    "hooke_stiffness": np.float64,
    "hooke_damping": np.float64,
    "material": np.int32,
    "spring_active": np.bool_,
    "impulse": np.float64,
    "tension": np.float64,
    "edge": np.int8,
}
ELEMENT_ARRAYS = {
    "element_kind": np.int8,
    "element_first": np.int32,
    "element_corners": np.int32,
    "element_rest": np.float64,
    "element_stiffness": np.float64,
    "element_damping": np.float64,
    "element_material": np.int32,
    "element_active": np.bool_,
}
CORNER_ARRAYS = {
    "corner_particle": np.int32,
    "corner_weight": np.float64,
    "corner_form": np.float64,
}
PART_ARRAYS = {"part_value": np.float64}
CONTACT_ARRAYS = {
    "contact_particle": np.int32,
    "contact_feature": np.int64,
    "contact_impulse": np.float64,
}
# Arrays that go together: one row for each particle, spring, element, corner of one, driven part, contact.
FAMILIES = (PARTICLE_ARRAYS, SPRING_ARRAYS, ELEMENT_ARRAYS, CORNER_ARRAYS, PART_ARRAYS, CONTACT_ARRAYS)
KINDS = {name: kind for family in FAMILIES for name, kind in family.items()}
# Every array of a world's state, in the order in which it is hashed and stored: part of the replay contract.
STATE_ARRAYS = tuple(KINDS)
# Constants of springs that the quarantine can take back.
GUARDED_CONSTANTS = ("rest_length", "stiffness", "damping", "hooke_stiffness", "hooke_damping")
# Constants of elements that it can take back.
GUARDED_ELEMENTS = ("element_rest", "element_stiffness", "element_damping", "corner_weight", "corner_form")
GUARDED = ("position", "velocity", "mass", *GUARDED_CONSTANTS, *GUARDED_ELEMENTS)
VECTOR_ARRAYS = frozenset(
    {"position", "velocity", "origin", "slow_velocity", "impulse", "element_rest", "corner_form", "contact_impulse"}
)

# An energy bank that the direct solver begins anew at its next step: something outside changed the body.
BANK_UNOPENED = -1.0


class StateArrays:
    """The state of particles, springs, elements, driven parts and contacts as a struct of arrays, float64 unless said.

    Of n particles and m springs:

    position [m] (n, 2), velocity [m/s] (n, 2), origin [m] (n, 2) = where each was created, which orders the direct
    solver's elimination, mass [kg], inverse_mass [1/kg] (0 = pinned), radius [m], gravity_scale = how many times the
    world's gravity pulls at it, particle_active (bool); particle_a, particle_b (int32 slots), rest_length [m],
    natural_length [m] = the rest length that it was made with, before it yielded or was driven, stiffness, damping
    (Cs, Cd per tick), law (int8), hooke_stiffness [N/m], hooke_damping [N s/m], material (int32 index into
    material_names, -1 = a hand's), spring_active (bool), impulse [N s] (m, 2) = what the iterative solver keeps for its
    warm start. The direct solver keeps slow_velocity [m/s] (n, 2) = the slow part of the velocity, energy_bank [J] (n,)
    = what a body's earlier losses still allow it, at its free particle of lowest slot (-1: to be begun anew), tension
    [N s] (m,) = the impulse by which a spring pulled in the last step, of a whole tick where substeps are "auto", as
    impulse then is.

    Of t elements (constraints.py) with q corners in all: element_kind (int8), element_first, element_corners (int32:
    where its corners begin, and how many), element_rest (t, 2), element_stiffness, element_damping (Cs, Cd per tick),
    element_material (int32, -1 = Cs and Cd of its own), element_active (bool); corner_particle (int32), corner_weight
    (q,), corner_form [m] (q, 2) = where it stands at rest. An element goes with any of the springs along its sides.

    part_value (k,) = how each driven part is driven, -1..1.

    For contacts: friction and restitution (n,), owner (int32) = the body that a particle belongs to, negative: its own,
    group (int64) = one bit, collides (int64) = the bits of the groups that it touches, TERRAIN_GROUP for terrain, 0 =
    nothing; edge (int8) of a spring = no line that others meet, one with two sides, or the outline of a solid body on
    its left or right. Of the c contacts of the last step: contact_particle (int32), contact_feature (int64, see
    contacts.py), contact_impulse [N s] (c, 2), along and across.
    """

    position: Floats
    velocity: Floats
    origin: Floats
    mass: Floats
    inverse_mass: Floats
    radius: Floats
    gravity_scale: Floats
    particle_active: NDArray[np.bool_]
    slow_velocity: Floats
    energy_bank: Floats
    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    natural_length: Floats
    stiffness: Floats
    damping: Floats
    law: NDArray[np.int8]
    hooke_stiffness: Floats
    hooke_damping: Floats
    material: NDArray[np.int32]
    spring_active: NDArray[np.bool_]
    impulse: Floats
    tension: Floats
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
    part_value: Floats
    friction: Floats
    restitution: Floats
    owner: NDArray[np.int32]
    group: Slots
    collides: Slots
    edge: NDArray[np.int8]
    contact_particle: NDArray[np.int32]
    contact_feature: Slots
    contact_impulse: Floats

    def __init__(self) -> None:
        for name, kind in KINDS.items():
            setattr(self, name, np.zeros((0, 2) if name in VECTOR_ARRAYS else 0, dtype=kind))
        # The last good values of what the quarantine guards; never state.
        self.good: dict[str, Floats] = {}
        self.trust()

    def trust(self) -> None:
        """Take everything as it is now for good."""
        self.good = {name: getattr(self, name).copy() for name in GUARDED}

    def _append(self, **arrays: ArrayLike) -> None:
        for name, values in arrays.items():
            present = getattr(self, name)
            added = np.asarray(values, dtype=present.dtype)
            setattr(self, name, np.concatenate([present, added]))
            if name in GUARDED:
                self.good[name] = np.concatenate([self.good[name], added])

    def _disturb(self, *particles: NDArray[np.integer] | int) -> None:
        for slots in particles:
            self.energy_bank[slots] = BANK_UNOPENED
