"""Snapshot: a read-only copy of every bit of a world's state; hashes of that state."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.settings import WorldSettings
from sandbox.physics.state import STATE_ARRAYS
from sandbox.physics.terrain import Terrain
from sandbox.physics.world import Floats, Slots, World


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A read-only copy of a world's state: its arrays (see World), settings and tick; and its terrain."""

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
    settings: WorldSettings
    tick: int
    hand_particle: int
    hand_spring: int
    terrain: Terrain


def take(world: World) -> Snapshot:
    """Copy a world's state."""
    copies = {name: getattr(world, name).copy() for name in STATE_ARRAYS}
    for copy in copies.values():
        copy.flags.writeable = False
    return Snapshot(
        **copies,
        settings=world.settings,
        tick=world.tick,
        hand_particle=world.hand_particle,
        hand_spring=world.hand_spring,
        terrain=world.terrain,
    )


def restore(world: World, snapshot: Snapshot) -> None:
    """Bring a world back to a snapshot of itself, slots added since then included."""
    # Before the arrays: another solver begins some of them anew.
    world.settings = snapshot.settings
    for name in STATE_ARRAYS:
        setattr(world, name, getattr(snapshot, name).copy())
    world.tick = snapshot.tick
    world.hand_particle = snapshot.hand_particle
    world.hand_spring = snapshot.hand_spring
    world.trust()
    world.see_what_touches()
    world.forget_names_beyond(len(snapshot.mass), len(snapshot.rest_length))


def canonical_bytes(array: NDArray[Any]) -> bytes:
    """The bytes that are hashed and stored: little-endian, -0.0 as 0.0 and every NaN as the same NaN."""
    if array.dtype.kind == "f":
        array = array + 0.0
        array[np.isnan(array)] = np.nan
    return array.astype(array.dtype.newbyteorder("<"), copy=False).tobytes()


def hash_by_array(world: World | Snapshot) -> dict[str, str]:
    """blake2b of each state array, 16 hexadecimal digits, by name."""
    return {
        name: hashlib.blake2b(canonical_bytes(getattr(world, name)), digest_size=8).hexdigest() for name in STATE_ARRAYS
    }


def state_hash(world: World | Snapshot, arrays: Mapping[str, str] | None = None) -> str:
    """blake2b over the hashes of every array in use, the tick and the settings, in fixed order: 32 digits.

    arrays: the result of `hash_by_array` for this state, where the caller has it already.
    """
    by_array = hash_by_array(world) if arrays is None else arrays
    state = world.settings
    settings = (
        *((component + 0.0).hex() for component in state.gravity),
        str(state.tick_rate),
        str(state.substeps),
        state.solver,
        str(state.iterations),
        float(state.warm_start).hex(),
        *((component + 0.0).hex() for component in state.wind),
        float(state.drag).hex(),
    )
    text = "\n".join([*(by_array[name] for name in STATE_ARRAYS), str(world.tick), *settings])
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()
