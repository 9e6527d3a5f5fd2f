"""Plan: the expansion of a level and its slots, computed once for its check, its world and its picture."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.plan.layout import Layout
from sandbox.level.plan.welds import Slots, united


class Plan:
    """The expanded bodies of a level, the slots and names of its particles, and its welds.

    Each attribute is computed at its first use. The check uses them first, in an order that computes nothing for a
    level that is too large. Only a sound level has attributes other than `layout`, and arrays of bodies.
    bodies: expansions of the level's bodies, if they are known already.
    """

    def __init__(self, level: Level, bodies: Sequence[Expansion[Any]] | None = None) -> None:
        self.bodies = [expansion(body) for body in level.bodies] if bodies is None else list(bodies)
        # Not the level itself, which keeps its plan: neither would be gone before the collector finds both.
        self._ids = [body.id for body in level.bodies], [particle.id for particle in level.particles]
        self._springs, self._welds = level.springs, level.welds

    @cached_property
    def layout(self) -> Layout:
        """Slots by name, before welds."""
        return Layout(self._ids[0], self.bodies, self._ids[1])

    @cached_property
    def spring_ends(self) -> Slots:
        """Particles (k, 2) that each loose spring joins, before welds."""
        slot = self.layout.slot
        return np.array([(slot(spring.a), slot(spring.b)) for spring in self._springs], dtype=np.int64).reshape(-1, 2)

    @cached_property
    def first_of_weld(self) -> Slots:
        """The first particle (n,) that each particle is welded to; itself without a weld."""
        slot = self.layout.slot
        return united(self.layout.particle_count, ((slot(a), slot(b)) for a, b in self._welds))


def keep_plan(level: Level, plan: Plan) -> None:
    """Store the plan of a sound level in the level, for as long as the level lives."""
    object.__setattr__(level, "_plan", plan)


def kept_plan(level: Level) -> Plan | None:
    """The plan that a level keeps. A level that was read has one, a copy of another level has none."""
    return getattr(level, "_plan", None)
