"""More rows for the arrays of a world."""

from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike

from sandbox.physics.state import FAMILIES, Family


def grow(world: Any, family: Family, count: int, arrays: Mapping[str, ArrayLike]) -> None:
    """Append rows of a family to a world's arrays: values that were checked, or usual ones for others to fill in."""
    room, mine = world._capacity.appended, world.__dict__
    for column in FAMILIES[family]:
        name = column.name
        grown = room(name, mine[name], count)
        grown[len(grown) - count :] = arrays.get(name, column.usual)
        # One change of topology for all of them, however many there are.
        mine[name] = grown
        if column.guarded:
            good = world.good[name] = room(f"good {name}", world.good[name], count)
            good[len(good) - count :] = grown[len(grown) - count :]
    world.topology_version += 1
    world.may_fly = True
