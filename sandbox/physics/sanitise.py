"""Quarantine: a value that no physics can give is taken back before it spreads.

A particle whose position, velocity or mass is not finite, or is absurd, gets its last good values back and is frozen:
pinned where it was, until somebody unpins it. An absurd constant of a spring or an element gets its last good value
back. Positions and velocities are good as the last tick ended with them, masses and constants as they were last set.
"""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.events import Containment
from sandbox.physics.jit import kernel
from sandbox.physics.state import GUARDED, Family
from sandbox.physics.world import World

# Larger than anything that a level or a command can ask for (1e6 m, 1e9 m/s, 1e9 kg, 1e15 N/m), and small enough that
# energies stay finite; a mistuned spring that passes it is frozen there.
ABSURD = 1e18
# What is guarded of springs and elements.
_CONSTANTS = [column for column in GUARDED if column.family is not Family.PARTICLE]


@kernel
def sound(  # type: ignore[no-untyped-def]
    position, velocity, mass, inverse_mass, rest_length, stiffness, damping, hooke_stiffness, hooke_damping
):  # fmt: skip
    """Whether every value that a tick reads is one that physics can give; NaN is in no range."""
    for p in range(mass.shape[0]):
        if not (
            -ABSURD <= position[p, 0] <= ABSURD
            and -ABSURD <= position[p, 1] <= ABSURD
            and -ABSURD <= velocity[p, 0] <= ABSURD
            and -ABSURD <= velocity[p, 1] <= ABSURD
            and 0.0 < mass[p] <= ABSURD
            and 0.0 <= inverse_mass[p] <= ABSURD
        ):
            return False
    for s in range(rest_length.shape[0]):
        if not (
            0.0 <= rest_length[s] <= ABSURD
            and 0.0 <= stiffness[s] <= 1.0
            and 0.0 <= damping[s] <= 1.0
            and 0.0 <= hooke_stiffness[s] <= ABSURD
            and 0.0 <= hooke_damping[s] <= ABSURD
        ):
            return False
    return True


@kernel
def sound_elements(element_rest, element_stiffness, element_damping, corner_weight, corner_form):  # type: ignore[no-untyped-def]
    """Whether every constant of elements is one that physics can give."""
    for k in range(element_stiffness.shape[0]):
        if not (
            -ABSURD <= element_rest[k, 0] <= ABSURD
            and -ABSURD <= element_rest[k, 1] <= ABSURD
            and 0.0 <= element_stiffness[k] <= 1.0
            and 0.0 <= element_damping[k] <= 1.0
        ):
            return False
    for c in range(corner_weight.shape[0]):
        weight = corner_weight[c]
        if not (
            0.0 <= weight <= ABSURD
            and -ABSURD <= corner_form[c, 0] <= ABSURD
            and -ABSURD <= corner_form[c, 1] <= ABSURD
        ):
            return False
    return True


@kernel
def keep_if_sound(position, velocity, good_position, good_velocity):  # type: ignore[no-untyped-def]
    """Keep positions and velocities (n, 2) as good, if all of them are; else keep nothing and say so."""
    for p in range(position.shape[0]):
        if not (
            -ABSURD <= position[p, 0] <= ABSURD
            and -ABSURD <= position[p, 1] <= ABSURD
            and -ABSURD <= velocity[p, 0] <= ABSURD
            and -ABSURD <= velocity[p, 1] <= ABSURD
        ):
            return False
    for p in range(position.shape[0]):
        good_position[p, 0] = position[p, 0]
        good_position[p, 1] = position[p, 1]
        good_velocity[p, 0] = velocity[p, 0]
        good_velocity[p, 1] = velocity[p, 1]
    return True


def contain_inputs(world: World) -> None:
    """Before a tick: take back whatever something outside the physics has put there."""
    if sound(
        world.position, world.velocity, world.mass, world.inverse_mass, world.rest_length, world.stiffness,
        world.damping, world.hooke_stiffness, world.hooke_damping,
    ) and (world.element_count == 0 or sound_elements(
        world.element_rest, world.element_stiffness, world.element_damping, world.corner_weight,
        world.corner_form,
    )):  # fmt: skip
        return
    for name in ("mass", "position", "velocity", "inverse_mass"):
        values = getattr(world, name)
        lowest = -ABSURD if values.ndim == 2 else 0.0
        bad = _outside(values, lowest) | ((values == 0.0) if name == "mass" else False)
        _freeze(world, bad, name)
    for column in _CONSTANTS:
        name, stored = column.name, column.stored
        lowest = -ABSURD if column.width > 1 else 0.0
        highest = 1.0 if name.endswith(("stiffness", "damping")) and "hooke" not in name else ABSURD
        for slot in np.flatnonzero(_outside(getattr(world, name), lowest, highest)).tolist():
            world.change(name, world.good[name][slot], slot)
            owner = world.slot_name(stored, slot)
            world.contained.append(Containment(world.tick, stored, owner, frozen=False))


def contain_outcome(world: World) -> None:
    """After a tick: take back what the tick itself has blown up, and keep the rest as good."""
    good = world.good
    if keep_if_sound(world.position, world.velocity, good["position"], good["velocity"]):
        return
    for name in ("position", "velocity"):
        _freeze(world, _outside(getattr(world, name), -ABSURD), name)
    keep_if_sound(world.position, world.velocity, good["position"], good["velocity"])


def _outside(values: NDArray[np.float64], lowest: float, highest: float = ABSURD) -> NDArray[np.bool_]:
    """Rows (n,) that hold a value outside lowest..highest, or NaN."""
    inside = (values >= lowest) & (values <= highest)
    return ~(np.logical_and.reduce(inside, axis=1) if inside.ndim == 2 else inside)


def _freeze(world: World, bad: NDArray[np.bool_], array: str) -> None:
    for slot in np.flatnonzero(bad).tolist():
        world.freeze(slot)
        world.contained.append(Containment(world.tick, array, world.particle_names[slot], frozen=True))
