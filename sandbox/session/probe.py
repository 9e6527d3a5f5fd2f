"""Probe and dump: positions and velocities of particles and what motors give, by name, as text for other programs."""

import difflib
import math
from collections.abc import Sequence
from typing import Any

from sandbox.physics.collision.outline import outline_of
from sandbox.physics.joints.readings import motor_readings
from sandbox.physics.query import shown_particles
from sandbox.physics.world import World

# Names that are listed as near to one that there is not, and those that it is compared with, at most.
MOST_NEAR, MOST_COMPARED = 5, 2_000


class Probe:
    """Follows particles and motors by name during a run and makes a table of tick, seconds, then what each does.

    Of a particle x, y, vx, vy, of one that no spring holds angle and spin as well; of a motor, by its wheel's id,
    torque [N m] and share, that of it which is in use. Raises KeyError, with the name, for what the world does not
    have.
    """

    def __init__(self, world: World, names: Sequence[str], every: int = 1) -> None:
        motors = [reading.name for reading in motor_readings(world)]
        self._followed = [
            (True, motors.index(name)) if name in motors else (False, world.particle_slot(name)) for name in names
        ]
        self._every = every
        held = outline_of(world).held
        self._loose = [not is_motor and not held[at] for is_motor, at in self._followed]
        columns = [
            f"{name}.{quantity}"
            for name, (is_motor, _), loose in zip(names, self._followed, self._loose, strict=True)
            for quantity in (
                ("torque", "share") if is_motor else ("x", "y", "vx", "vy", *(("angle", "spin") if loose else ()))
            )
        ]
        self._lines = [["tick", "seconds", *columns]]
        self.take(world)

    def take(self, world: World) -> None:
        """Add a line, if one is due at this tick."""
        if not self._followed or world.tick % self._every:
            return
        readings = motor_readings(world)
        values = [
            repr(value)
            for (is_motor, at), loose in zip(self._followed, self._loose, strict=True)
            for value in (
                (readings[at].torque, readings[at].share)
                if is_motor
                else (*world.position[at].tolist(), *world.velocity[at].tolist(), *_turning(world, at, loose))
            )
        ]
        self._lines.append([str(world.tick), repr(world.tick / world.settings.tick_rate), *values])

    def table(self) -> str:
        """The table as CSV."""
        return "".join(",".join(line) + "\n" for line in self._lines)


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
    shown, held = shown_particles(world), outline_of(world).held
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
