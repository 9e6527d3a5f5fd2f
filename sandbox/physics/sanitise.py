"""Quarantine: a value that no physics can give is taken back before it spreads.

A particle whose position, velocity, angle, spin or mass is not finite, or is absurd, gets its last good values back and
is frozen: pinned where it was, until somebody unpins it; so is one whose radius, surface or gravity scale is. An absurd
constant of a spring or a constraint gets its last good value back, the impulse of a contact is begun anew. Motion is
good as the last tick ended with it, all else as it was last set.
"""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.analysis.query import slot_name
from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.events import Containment
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import GUARDED, Family, GoodValues, State
from sandbox.physics.world import World

# Larger than anything that a level or a command can ask for (1e6 m, 1e9 m/s, 1e9 kg, 1e15 N/m), and small enough that
# energies stay finite; a mistuned spring that passes it is frozen there.
ABSURD = 1e18
# What a tick moves, and what is guarded of springs and constraints.
MOTION = ("position", "velocity", "angle", "spin")
_CONSTANTS = [column for column in GUARDED if column.family is not Family.PARTICLE]


_CONSTANTS_OF_PARTICLES = ("radius", "gravity_scale", "friction", "restitution", "rolling")


@inner_kernel
def _sound_motion(state: State) -> bool:
    position = state.position
    velocity = state.velocity
    for p in range(position.shape[0]):
        if not (
            -ABSURD <= position[p, 0] <= ABSURD
            and -ABSURD <= position[p, 1] <= ABSURD
            and -ABSURD <= velocity[p, 0] <= ABSURD
            and -ABSURD <= velocity[p, 1] <= ABSURD
            and -ABSURD <= state.angle[p] <= ABSURD
            and -ABSURD <= state.spin[p] <= ABSURD
        ):
            return False
    return True


@inner_kernel
def _sound_elements(state: State) -> bool:
    for k in range(state.constraint_stiffness.shape[0]):
        if not (
            -ABSURD <= state.constraint_rest[k, 0] <= ABSURD
            and -ABSURD <= state.constraint_rest[k, 1] <= ABSURD
            and 0.0 <= state.constraint_stiffness[k] <= 1.0
            and 0.0 <= state.constraint_damping[k] <= 1.0
            and 0.0 <= state.constraint_lowest_mode[k] <= ABSURD
        ):
            return False
    for c in range(state.corner_weight.shape[0]):
        if not (
            0.0 <= state.corner_weight[c] <= ABSURD
            and -ABSURD <= state.corner_form[c, 0] <= ABSURD
            and -ABSURD <= state.corner_form[c, 1] <= ABSURD
        ):
            return False
    return True


@inner_kernel
def are_sound(state: State, impulse: FloatRows, impact: Floats, count: int) -> bool:
    """Whether all that a tick begins with is what physics can give, impulses of `count` contacts too; NaN is not."""
    if not _sound_motion(state) or not _sound_elements(state):
        return False
    for c in range(count):
        if not (-ABSURD <= impulse[c, 0] <= ABSURD and -ABSURD <= impulse[c, 1] <= ABSURD):
            return False
        if not -ABSURD <= impact[c] <= ABSURD:
            return False
    for p in range(state.mass.shape[0]):
        if not (
            0.0 < state.mass[p] <= ABSURD
            and 0.0 <= state.inverse_mass[p] <= ABSURD
            and 0.0 <= state.radius[p] <= ABSURD
            and -ABSURD <= state.gravity_scale[p] <= ABSURD
            and 0.0 <= state.friction[p] <= ABSURD
            and 0.0 <= state.restitution[p] <= 1.0
            and 0.0 <= state.rolling[p] <= 1.0
        ):
            return False
    for s in range(state.rest_length.shape[0]):
        if not (
            0.0 <= state.rest_length[s] <= ABSURD
            and 0.0 <= state.stiffness[s] <= 1.0
            and 0.0 <= state.damping[s] <= 1.0
            and 0.0 <= state.hooke_stiffness[s] <= ABSURD
            and 0.0 <= state.hooke_damping[s] <= ABSURD
            and 0.0 <= state.lowest_mode[s] <= ABSURD
        ):
            return False
    return True


@inner_kernel
def keep_if_sound(state: State, good: GoodValues) -> bool:
    """Keep what a tick moves as good, if all of it is; else keep nothing and say so."""
    if not _sound_motion(state):
        return False
    for p in range(state.position.shape[0]):
        for axis in range(2):
            good.position[p, axis] = state.position[p, axis]
            good.velocity[p, axis] = state.velocity[p, axis]
        good.angle[p] = state.angle[p]
        good.spin[p] = state.spin[p]
    return True


def contain_inputs(world: World) -> None:
    """Before a tick: take back impossible values that code outside the physics has written."""
    for name in ("contact_impulse", "contact_impact"):
        values = getattr(world, name)
        for slot in np.flatnonzero(_outside(values, -ABSURD)).tolist():
            values[slot] = 0.0
            world.contained.append(Containment(world.tick, name, slot_name(world, name, slot), frozen=False))
    for name in ("mass", *MOTION, "inverse_mass", *_CONSTANTS_OF_PARTICLES):
        values = getattr(world, name)
        lowest = -ABSURD if name in (*MOTION, "gravity_scale") else 0.0
        highest = 1.0 if name in ("restitution", "rolling") else ABSURD
        bad = _outside(values, lowest, highest) | ((values == 0.0) if name == "mass" else False)
        _freeze(world, bad, name)
    for column in _CONSTANTS:
        name, stored = column.name, column.stored
        lowest = -ABSURD if column.width > 1 else 0.0
        highest = 1.0 if name.endswith(("stiffness", "damping")) and "hooke" not in name else ABSURD
        for slot in np.flatnonzero(_outside(getattr(world, name), lowest, highest)).tolist():
            world.change(name, world.good[name][slot], slot)
            owner = slot_name(world, stored, slot)
            world.contained.append(Containment(world.tick, stored, owner, frozen=False))


def contain_outcome(world: World) -> None:
    """After a tick: take back values that the tick itself made impossible, and keep the others as the last good
    ones.
    """
    for name in MOTION:
        _freeze(world, _outside(getattr(world, name), -ABSURD), name)
    for name in MOTION:
        world.good[name][:] = getattr(world, name)


def _outside(values: NDArray[np.float64], lowest: float, highest: float = ABSURD) -> NDArray[np.bool_]:
    """Rows (n,) that hold a value outside lowest..highest, or NaN."""
    inside = (values >= lowest) & (values <= highest)
    return ~(np.logical_and.reduce(inside, axis=1) if inside.ndim == 2 else inside)


def _freeze(world: World, bad: NDArray[np.bool_], array: str) -> None:
    for slot in np.flatnonzero(bad).tolist():
        world.freeze(slot)
        world.contained.append(Containment(world.tick, array, world.particle_names[slot], frozen=True))
