"""Probe and dump: positions and velocities of particles and what motors give, by name, as text for other programs."""

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sandbox.physics.analysis.applied_forces import MotorReading, motor_readings
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.world import World

# How names begin of what commands add.
ADDED = "+"
# Names that are listed as near to one that there is not, and those that it is compared with, at most.
MOST_NEAR, MOST_COMPARED = 5, 2_000


class Probe:
    """Follows particles and motors by name during a run and makes a table of tick, seconds, then the values of each.

    Of a particle x, y, vx, vy, of one that no spring holds angle and spin as well; of a motor, by its wheel's id,
    torque [N m] and share, that of it which is in use. What commands add and remove has empty columns while it is not
    there. Raises KeyError, with the name, for what the world does not have and commands do not add.
    """

    def __init__(self, world: World, names: Sequence[str], every: int = 1) -> None:
        motors = [reading.name for reading in motor_readings(world)]
        held = outline_of(world).attached
        self._every = every
        self._followed: list[_Followed] = []
        for name in names:
            later = name.startswith(ADDED) and not _exists(world, name)
            is_motor = name in motors or (later and "." not in name)
            loose = not is_motor and (name.startswith(f"{ADDED}.") if later else not held[world.particle_slot(name)])
            self._followed.append(_Followed(name, is_motor, loose))
        self._lines = [
            ["tick", "seconds", *(f"{each.name}.{what}" for each in self._followed for what in each.columns)]
        ]
        self.take(world)

    def take(self, world: World) -> None:
        """Write a line, if one is due at this tick."""
        if not self._followed or world.tick % self._every:
            return
        readings = {reading.name: reading for reading in motor_readings(world)}
        values = [value for each in self._followed for value in each.values(world, readings)]
        self._lines.append([str(world.tick), repr(world.tick / world.settings.tick_rate), *values])

    def table(self) -> str:
        """The table as CSV."""
        return "".join(",".join(line) + "\n" for line in self._lines)


@dataclass(frozen=True)
class _Followed:
    """A motor, or a particle that no spring holds (loose) or that one does."""

    name: str
    is_motor: bool
    loose: bool

    @property
    def columns(self) -> tuple[str, ...]:
        if self.is_motor:
            return "torque", "share"
        return "x", "y", "vx", "vy", *(("angle", "spin") if self.loose else ())

    def values(self, world: World, readings: Mapping[str, MotorReading]) -> list[str]:
        """Values of the probe's columns, empty while the thing is not there."""
        if self.is_motor and self.name in readings:
            found = [readings[self.name].torque, readings[self.name].share]
        elif not self.is_motor and _exists(world, self.name):
            slot = world.particle_slot(self.name)
            found = [*world.position[slot].tolist(), *world.velocity[slot].tolist(), *_turning(world, slot, self.loose)]
        else:
            return [""] * len(self.columns)
        return [repr(value) for value in found]


def _exists(world: World, name: str) -> bool:
    try:
        return bool(world.particle_active[world.particle_slot(name)])
    except KeyError:
        return False


def near_names(world: World, name: str) -> list[str]:
    """Names of particles and motors that resemble one that there is not, the nearest first."""
    named = [each for each, shown in zip(world.particle_names, shown_particles(world), strict=True) if shown]
    known = list(dict.fromkeys([*named, *(reading.name for reading in motor_readings(world))]))
    first = name.partition(".")[0].casefold()
    # Of many only those that begin alike are compared, which takes long.
    alike = known if len(known) <= MOST_COMPARED else [each for each in known if each.casefold().startswith(first)]
    return difflib.get_close_matches(name, alike[:MOST_COMPARED], n=MOST_NEAR)


def _turning(world: World, slot: int, loose: bool) -> list[float]:
    return [float(world.angle[slot]), float(world.spin[slot])] if loose else []


def dump(world: World) -> dict[str, Any]:
    """Position [m] and velocity [m/s] of every particle by name, and what motors give [N m], ready for JSON.

    Of particles that no spring holds also the angle [rad] and the spin [rad/s].
    """
    shown, held = shown_particles(world), outline_of(world).attached
    motors = {each.name: finite({"torque": each.torque, "share": each.share}) for each in motor_readings(world)}
    return {
        "tick": world.tick,
        "particles": {
            name: finite(
                {"position": world.position[slot].tolist(), "velocity": world.velocity[slot].tolist()}
                | dict(zip(("angle", "spin"), _turning(world, slot, not held[slot]), strict=False))
            )
            for slot, name in enumerate(world.particle_names)
            if shown[slot]
        },
        **({"motors": motors} if motors else {}),
    }


def finite(value: Any) -> Any:
    """The same value with None for the numbers that JSON cannot say."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
