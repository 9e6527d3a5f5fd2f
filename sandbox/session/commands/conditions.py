"""Conditions: what must hold of a world for a command to be carried out, as data, which pages read too."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sandbox.physics.world import World


@dataclass(frozen=True)
class Condition:
    """The array of state of that name, at the row that a field names, is not 0 (is_set), or is.

    field: a slot, or `grab` for the spring of a hand. words: of the fault, with {} for the name of the row.
    """

    field: str
    array: str
    is_set: bool
    words: str

    def holds(self, world: World, row: int) -> bool:
        """Whether it does; a world without hands holds nothing."""
        if self.field == "grab":
            return world.is_held(row) == self.is_set
        return bool(getattr(world, self.array)[row]) == self.is_set


def faults_of(conditions: tuple[Condition, ...], command: Any, world: World) -> Iterator[tuple[Condition, int]]:
    """The conditions that do not hold, each with the row of which they do not."""
    for condition in conditions:
        row = getattr(command, condition.field)
        if not condition.holds(world, row):
            yield condition, row


def held_by(is_held: bool, words: str) -> Condition:
    """That a hand holds something, or nothing."""
    return Condition("grab", "spring_active", is_held, words)


def pinned(is_pinned: bool, words: str) -> Condition:
    """That a particle is pinned, or is not."""
    return Condition("particle", "inverse_mass", not is_pinned, words)
