"""The arrays of a world's state: their names, their types, and their order."""

import numpy as np

PARTICLE_ARRAYS = {
    "position": np.float64,
    "velocity": np.float64,
    "origin": np.float64,
    "mass": np.float64,
    "inverse_mass": np.float64,
    "radius": np.float64,
    "particle_active": np.bool_,
    "slow_velocity": np.float64,
    "energy_bank": np.float64,
}
SPRING_ARRAYS = {
    "particle_a": np.int32,
    "particle_b": np.int32,
    "rest_length": np.float64,
    "stiffness": np.float64,
    "damping": np.float64,
    "law": np.int8,
    "hooke_stiffness": np.float64,
    "hooke_damping": np.float64,
    "material": np.int32,
    "spring_active": np.bool_,
    "impulse": np.float64,
    "tension": np.float64,
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
# Arrays of one family have one length.
FAMILIES = (PARTICLE_ARRAYS, SPRING_ARRAYS, ELEMENT_ARRAYS, CORNER_ARRAYS)
KINDS = {name: kind for family in FAMILIES for name, kind in family.items()}
# Every array of a world's state, in the order in which it is hashed and stored: part of the replay contract.
STATE_ARRAYS = tuple(KINDS)
# Constants of springs that the quarantine can take back.
GUARDED_CONSTANTS = ("rest_length", "stiffness", "damping", "hooke_stiffness", "hooke_damping")
# Constants of elements that it can take back.
GUARDED_ELEMENTS = ("element_rest", "element_stiffness", "element_damping", "corner_weight", "corner_form")
GUARDED = ("position", "velocity", "mass", *GUARDED_CONSTANTS, *GUARDED_ELEMENTS)
VECTOR_ARRAYS = frozenset({"position", "velocity", "origin", "slow_velocity", "impulse", "element_rest", "corner_form"})
