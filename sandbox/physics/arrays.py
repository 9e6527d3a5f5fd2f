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
CONTACT_ARRAYS = {
    "contact_particle": np.int32,
    "contact_feature": np.int64,
    "contact_impulse": np.float64,
}
# Arrays that go together: one row for each particle, each spring, each contact.
FAMILIES = (PARTICLE_ARRAYS, SPRING_ARRAYS, CONTACT_ARRAYS)
KINDS = PARTICLE_ARRAYS | SPRING_ARRAYS | CONTACT_ARRAYS
# Every array of a world's state, in the order in which it is hashed and stored: part of the replay contract.
STATE_ARRAYS = tuple(KINDS)
# Constants of springs that the quarantine can take back.
GUARDED_CONSTANTS = ("rest_length", "stiffness", "damping", "hooke_stiffness", "hooke_damping")
GUARDED = ("position", "velocity", "mass", *GUARDED_CONSTANTS)
VECTOR_ARRAYS = frozenset({"position", "velocity", "origin", "slow_velocity", "impulse", "contact_impulse"})
