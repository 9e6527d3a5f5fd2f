"""Probe and dump: positions and velocities of named particles, as text for other programs."""

import math
from collections.abc import Sequence
from typing import Any

from sandbox.physics.query import shown_particles
from sandbox.physics.world import World


class Probe:
    """Follows particles by name during a run and makes a table of tick, seconds, then x, y, vx, vy of each.

    Raises KeyError, with the name, for a particle that the world does not have.
    """

    def __init__(self, world: World, names: Sequence[str], every: int = 1) -> None:
        self._slots = [world.particle_slot(name) for name in names]
        self._every = every
        columns = [f"{name}.{quantity}" for name in names for quantity in ("x", "y", "vx", "vy")]
        self._lines = [["tick", "seconds", *columns]]
        self.take(world)

    def take(self, world: World) -> None:
        """Add a line, if one is due at this tick."""
        if not self._slots or world.tick % self._every:
            return
        values = [
            repr(value)
            for slot in self._slots
            for value in (*world.position[slot].tolist(), *world.velocity[slot].tolist())
        ]
        self._lines.append([str(world.tick), repr(world.tick / world.settings.tick_rate), *values])

    def table(self) -> str:
        """The table as CSV."""
        return "".join(",".join(line) + "\n" for line in self._lines)


def dump(world: World) -> dict[str, Any]:
    """Position [m] and velocity [m/s] of every particle by name, ready for JSON."""
    shown = shown_particles(world)
    return {
        "tick": world.tick,
        "particles": {
            name: finite({"position": world.position[slot].tolist(), "velocity": world.velocity[slot].tolist()})
            for slot, name in enumerate(world.particle_names)
            if shown[slot]
        },
    }


def finite(value: Any) -> Any:
    """The same value with None for the numbers that JSON cannot say."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
