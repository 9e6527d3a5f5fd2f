"""Quarantine: a value that no physics can give is taken back before it spreads.

A particle whose position, velocity, angle, spin or mass is not finite, or is absurd, gets its last good values back and
is frozen: pinned where it was, until somebody unpins it; so is one whose radius, surface or gravity scale is. An absurd
constant of a spring or a constraint gets its last good value back, the impulse of a contact is begun anew. Motion is
good as the last tick ended with it, all else as it was last set.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.analysis.query import slot_name
from sandbox.physics.events import Containment
from sandbox.physics.jit import bundle, contents, inner_kernel, kernel
from sandbox.physics.state import GUARDED, Family, Floats
from sandbox.physics.world import World

# Larger than anything that a level or a command can ask for (1e6 m, 1e9 m/s, 1e9 kg, 1e15 N/m), and small enough that
# energies stay finite; a mistuned spring that passes it is frozen there.
ABSURD = 1e18
# What a kernel returns that looks at this itself, in place of a number: something that a tick begins with is not sound,
# so that nothing is done; something that it has moved is not.
UNSOUND, LOST = -2, -3
# What a tick moves, in the order of the arrays below, and what is guarded of springs and constraints.
_MOTION = ("position", "velocity", "angle", "spin")
_CONSTANTS = [column for column in GUARDED if column.family is not Family.PARTICLE]


_CONSTANTS_OF_PARTICLES = ("radius", "gravity_scale", "friction", "restitution", "rolling")


class CheckedArrays(NamedTuple):
    """The arrays of a world that are looked at, see StateArrays, and where those of its motion are kept."""

    position: Floats
    velocity: Floats
    angle: Floats
    spin: Floats
    mass: Floats
    inverse_mass: Floats
    radius: Floats
    gravity_scale: Floats
    friction: Floats
    restitution: Floats
    rolling: Floats
    rest_length: Floats
    stiffness: Floats
    damping: Floats
    hooke_stiffness: Floats
    hooke_damping: Floats
    lowest_mode: Floats
    constraint_rest: Floats
    constraint_stiffness: Floats
    constraint_damping: Floats
    constraint_lowest_mode: Floats
    corner_weight: Floats
    corner_form: Floats
    good_position: Floats
    good_velocity: Floats
    good_angle: Floats
    good_spin: Floats


@inner_kernel
def _sound_motion(arrays: CheckedArrays) -> bool:
    position = arrays.position
    velocity = arrays.velocity
    for p in range(position.shape[0]):
        if not (
            -ABSURD <= position[p, 0] <= ABSURD
            and -ABSURD <= position[p, 1] <= ABSURD
            and -ABSURD <= velocity[p, 0] <= ABSURD
            and -ABSURD <= velocity[p, 1] <= ABSURD
            and -ABSURD <= arrays.angle[p] <= ABSURD
            and -ABSURD <= arrays.spin[p] <= ABSURD
        ):
            return False
    return True


@inner_kernel
def _sound_elements(arrays: CheckedArrays) -> bool:
    for k in range(arrays.constraint_stiffness.shape[0]):
        if not (
            -ABSURD <= arrays.constraint_rest[k, 0] <= ABSURD
            and -ABSURD <= arrays.constraint_rest[k, 1] <= ABSURD
            and 0.0 <= arrays.constraint_stiffness[k] <= 1.0
            and 0.0 <= arrays.constraint_damping[k] <= 1.0
            and 0.0 <= arrays.constraint_lowest_mode[k] <= ABSURD
        ):
            return False
    for c in range(arrays.corner_weight.shape[0]):
        if not (
            0.0 <= arrays.corner_weight[c] <= ABSURD
            and -ABSURD <= arrays.corner_form[c, 0] <= ABSURD
            and -ABSURD <= arrays.corner_form[c, 1] <= ABSURD
        ):
            return False
    return True


@inner_kernel
def are_sound(arrays: CheckedArrays, impulse: Floats, impact: Floats, count: int) -> bool:
    """Whether all that a tick begins with is what physics can give, impulses of `count` contacts too; NaN is not."""
    if not _sound_motion(arrays) or not _sound_elements(arrays):
        return False
    for c in range(count):
        if not (-ABSURD <= impulse[c, 0] <= ABSURD and -ABSURD <= impulse[c, 1] <= ABSURD):
            return False
        if not -ABSURD <= impact[c] <= ABSURD:
            return False
    for p in range(arrays.mass.shape[0]):
        if not (
            0.0 < arrays.mass[p] <= ABSURD
            and 0.0 <= arrays.inverse_mass[p] <= ABSURD
            and 0.0 <= arrays.radius[p] <= ABSURD
            and -ABSURD <= arrays.gravity_scale[p] <= ABSURD
            and 0.0 <= arrays.friction[p] <= ABSURD
            and 0.0 <= arrays.restitution[p] <= 1.0
            and 0.0 <= arrays.rolling[p] <= 1.0
        ):
            return False
    for s in range(arrays.rest_length.shape[0]):
        if not (
            0.0 <= arrays.rest_length[s] <= ABSURD
            and 0.0 <= arrays.stiffness[s] <= 1.0
            and 0.0 <= arrays.damping[s] <= 1.0
            and 0.0 <= arrays.hooke_stiffness[s] <= ABSURD
            and 0.0 <= arrays.hooke_damping[s] <= ABSURD
            and 0.0 <= arrays.lowest_mode[s] <= ABSURD
        ):
            return False
    return True


@inner_kernel
def keep_if_sound(arrays: CheckedArrays) -> bool:
    """Keep what a tick moves as good, if all of it is; else keep nothing and say so."""
    if not _sound_motion(arrays):
        return False
    for p in range(arrays.position.shape[0]):
        for axis in range(2):
            arrays.good_position[p, axis] = arrays.position[p, axis]
            arrays.good_velocity[p, axis] = arrays.velocity[p, axis]
        arrays.good_angle[p] = arrays.angle[p]
        arrays.good_spin[p] = arrays.spin[p]
    return True


@kernel
def _are_sound(items: Any, impulse: Floats, impact: Floats) -> bool:
    (arrays,) = contents(items)
    return are_sound(arrays, impulse, impact, impact.shape[0])


@kernel
def _keep_if_sound(items: Any) -> bool:
    (arrays,) = contents(items)
    return keep_if_sound(arrays)


def checked_arrays(world: World) -> CheckedArrays:
    """The arrays of a world that are looked at."""
    good = [world.good[name] for name in _MOTION]
    own = [getattr(world, name) for name in CheckedArrays._fields[: -len(good)]]
    return CheckedArrays._make([*own, *good])


def _lent_arrays(world: World) -> Any:
    return bundle((checked_arrays(world),))


def contain_inputs(world: World) -> None:
    """Before a tick: take back impossible values that code outside the physics has written."""
    if _are_sound(world.derived(_lent_arrays), world.contact_impulse, world.contact_impact):
        return
    for name in ("contact_impulse", "contact_impact"):
        values = getattr(world, name)
        for slot in np.flatnonzero(_outside(values, -ABSURD)).tolist():
            values[slot] = 0.0
            world.contained.append(Containment(world.tick, name, slot_name(world, name, slot), frozen=False))
    for name in ("mass", *_MOTION, "inverse_mass", *_CONSTANTS_OF_PARTICLES):
        values = getattr(world, name)
        lowest = -ABSURD if name in (*_MOTION, "gravity_scale") else 0.0
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
    if _keep_if_sound(world.derived(_lent_arrays)):
        return
    for name in _MOTION:
        _freeze(world, _outside(getattr(world, name), -ABSURD), name)
    _keep_if_sound(world.derived(_lent_arrays))


def _outside(values: NDArray[np.float64], lowest: float, highest: float = ABSURD) -> NDArray[np.bool_]:
    """Rows (n,) that hold a value outside lowest..highest, or NaN."""
    inside = (values >= lowest) & (values <= highest)
    return ~(np.logical_and.reduce(inside, axis=1) if inside.ndim == 2 else inside)


def _freeze(world: World, bad: NDArray[np.bool_], array: str) -> None:
    for slot in np.flatnonzero(bad).tolist():
        world.freeze(slot)
        world.contained.append(Containment(world.tick, array, world.particle_names[slot], frozen=True))
