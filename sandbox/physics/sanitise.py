"""Quarantine: a value that no physics can give is taken back before it spreads.

A particle with a value out of the range that its column has (state.py) gets its last good values back and is frozen:
pinned where it was, until somebody unpins it. A constant of a spring or a constraint gets its last good value back, the
impulse of a contact is begun anew. Motion is good as the last tick ended with it, all else as it was last set.

What is found is listed, where there is a list: for each the number of its column and its slot. Without one, nothing is
changed.
"""

from dataclasses import dataclass

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.commands.changes import pin
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import GoodValues, Ranges, State

# Of a range: the lowest and the highest good value, and the number of the column.
LOWEST, HIGHEST, COLUMN = range(3)


@dataclass(frozen=True)
class Containment:
    """An impossible value that was taken back: at a tick, in the array `array` of the particle, spring or constraint
    `name`.
    """

    tick: int
    array: str
    name: str
    frozen: bool

    def __str__(self) -> str:
        text = f"tick {self.tick}: {self.name}: an impossible {self.array.replace('_', ' ')} was taken back"
        return text + ("; it is frozen where it last was, unpin it to let it go" if self.frozen else "")


@inner_kernel
def contain(state: State, good: GoodValues, ranges: Ranges, impulse: FloatRows, impact: Floats, found: Slots) -> int:
    """Look for impossible values among all that a tick begins with, impulses of contacts too; how many are found."""
    count = _find(impact, ranges.contact_impact, found, _find_rows(impulse, ranges.contact_impulse, found, 0))
    for k in range(min(count, found.shape[0] // 2)):
        contact = found[2 * k + 1]
        impulse[contact, 0] = impulse[contact, 1] = impact[contact] = 0.0
    n = _freeze(state, good, found, count, _find(state.mass, ranges.mass, found, count))
    n = contain_motion(state, good, ranges, found, n)
    n = _freeze(state, good, found, n, _find(state.inverse_mass, ranges.inverse_mass, found, n))
    n = _freeze(state, good, found, n, _find(state.radius, ranges.radius, found, n))
    n = _freeze(state, good, found, n, _find(state.gravity_scale, ranges.gravity_scale, found, n))
    n = _freeze(state, good, found, n, _find(state.friction, ranges.friction, found, n))
    n = _freeze(state, good, found, n, _find(state.restitution, ranges.restitution, found, n))
    n = _freeze(state, good, found, n, _find(state.rolling, ranges.rolling, found, n))
    n = _take_back(state.rest_length, good.rest_length, ranges.rest_length, found, n)
    n = _take_back(state.stiffness, good.stiffness, ranges.stiffness, found, n)
    n = _take_back(state.damping, good.damping, ranges.damping, found, n)
    n = _take_back(state.hooke_stiffness, good.hooke_stiffness, ranges.hooke_stiffness, found, n)
    n = _take_back(state.hooke_damping, good.hooke_damping, ranges.hooke_damping, found, n)
    n = _take_back(state.lowest_mode, good.lowest_mode, ranges.lowest_mode, found, n)
    n = _take_back_rows(state.constraint_rest, good.constraint_rest, ranges.constraint_rest, found, n)
    n = _take_back(state.constraint_stiffness, good.constraint_stiffness, ranges.constraint_stiffness, found, n)
    n = _take_back(state.constraint_damping, good.constraint_damping, ranges.constraint_damping, found, n)
    n = _take_back(state.constraint_lowest_mode, good.constraint_lowest_mode, ranges.constraint_lowest_mode, found, n)
    n = _take_back(state.corner_weight, good.corner_weight, ranges.corner_weight, found, n)
    return _take_back_rows(state.corner_form, good.corner_form, ranges.corner_form, found, n)


@inner_kernel
def contain_motion(state: State, good: GoodValues, ranges: Ranges, found: Slots, count: int) -> int:
    """Look for impossible values among all that a tick moves; how many are found, with `count` before."""
    n = _freeze(state, good, found, count, _find_rows(state.position, ranges.position, found, count))
    n = _freeze(state, good, found, n, _find_rows(state.velocity, ranges.velocity, found, n))
    n = _freeze(state, good, found, n, _find(state.angle, ranges.angle, found, n))
    return _freeze(state, good, found, n, _find(state.spin, ranges.spin, found, n))


@inner_kernel
def keep_motion(state: State, good: GoodValues) -> None:
    """Copy the motion that a tick left to the last good values."""
    for p in range(state.position.shape[0]):
        for axis in range(2):
            good.position[p, axis] = state.position[p, axis]
            good.velocity[p, axis] = state.velocity[p, axis]
        good.angle[p] = state.angle[p]
        good.spin[p] = state.spin[p]


@inner_kernel
def _list(within: Floats, slot: int, found: Slots, count: int) -> int:
    found[2 * count], found[2 * count + 1] = int(within[COLUMN]), slot
    return count + 1


@inner_kernel
def _find(values: Floats, within: Floats, found: Slots, count: int) -> int:
    # How many are found, with those of a column.
    low, high, bad = within[LOWEST], within[HIGHEST], 0
    for k in range(values.shape[0]):
        if not low <= values[k] <= high:
            bad += 1
    if bad == 0 or found.shape[0] == 0:
        return count + bad
    for k in range(values.shape[0]):
        if not low <= values[k] <= high:
            count = _list(within, k, found, count)
    return count


@inner_kernel
def _find_rows(values: FloatRows, within: Floats, found: Slots, count: int) -> int:
    low, high, bad = within[LOWEST], within[HIGHEST], 0
    for k in range(values.shape[0]):
        if not (low <= values[k, 0] <= high and low <= values[k, 1] <= high):
            bad += 1
    if bad == 0 or found.shape[0] == 0:
        return count + bad
    for k in range(values.shape[0]):
        if not (low <= values[k, 0] <= high and low <= values[k, 1] <= high):
            count = _list(within, k, found, count)
    return count


@inner_kernel
def _freeze(state: State, good: GoodValues, found: Slots, first: int, last: int) -> int:
    # The particles that were found, from a place of the list on.
    for k in range(first, min(last, found.shape[0] // 2)):
        p = found[2 * k + 1]
        for axis in range(2):
            state.position[p, axis] = good.position[p, axis]
        state.angle[p], state.mass[p] = good.angle[p], good.mass[p]
        state.radius[p], state.gravity_scale[p] = good.radius[p], good.gravity_scale[p]
        state.friction[p], state.restitution[p] = good.friction[p], good.restitution[p]
        state.rolling[p] = good.rolling[p]
        pin(state, p)
    return last


@inner_kernel
def _take_back(values: Floats, good: Floats, within: Floats, found: Slots, first: int) -> int:
    last = _find(values, within, found, first)
    for k in range(first, min(last, found.shape[0] // 2)):
        values[found[2 * k + 1]] = good[found[2 * k + 1]]
    return last


@inner_kernel
def _take_back_rows(values: FloatRows, good: FloatRows, within: Floats, found: Slots, first: int) -> int:
    last = _find_rows(values, within, found, first)
    for k in range(first, min(last, found.shape[0] // 2)):
        for axis in range(2):
            values[found[2 * k + 1], axis] = good[found[2 * k + 1], axis]
    return last
