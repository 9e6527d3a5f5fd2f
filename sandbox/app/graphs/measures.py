"""What graphs show: measures of a running world, in groups of one unit, read after ticks and never written."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.physics.analysis.applied_forces import motor_readings
from sandbox.physics.analysis.energy import gravity_energy, kinetic_energy, spring_energy, spring_lengths
from sandbox.physics.world import World

# Of more motors those with the first names are shown.
MOST_MOTORS = 5


@dataclass(frozen=True)
class Moment:
    """What can be measured at the end of a frame: a world, the particles that were picked [slots], times [ms].

    tick_time: of one tick; frame_time: of the whole frame before; None where no tick was made.
    """

    world: World
    picked: Sequence[int] = ()
    tick_time: float | None = None
    frame_time: float | None = None


@dataclass(frozen=True)
class Measure:
    """A group of values of one unit: its title, a word of what to do while it is empty, and how they are read.

    main: those that are shown of each of two runs; none: all. from_zero: whether the scale begins at 0.
    """

    title: str
    unit: str
    read: Callable[[Moment], dict[str, float]]
    hint: str = ""
    main: tuple[str, ...] = ()
    from_zero: bool = False


def _energies(moment: Moment) -> dict[str, float]:
    world = moment.world
    motion, springs, gravity = kinetic_energy(world), spring_energy(world), gravity_energy(world)
    return {"total": motion + springs + gravity, "motion": motion, "springs": springs, "gravity": gravity}


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def _strains(moment: Moment) -> dict[str, float]:
    world = moment.world
    kept = world.spring_active & (world.rest_length > 0.0) & (world.material >= 0)
    strain = 100.0 * (spring_lengths(world)[kept] / world.rest_length[kept] - 1.0)
    if not len(strain):
        return {}
    return {"most stretched": float(strain.max()), "mean": float(strain.mean()), "most squeezed": float(strain.min())}


def _named(moment: Moment) -> list[tuple[str, int]]:
    """The picked particles that there still are."""
    world = moment.world
    slots = [slot for slot in moment.picked if slot < world.particle_count and world.particle_active[slot]]
    return [(world.particle_names[slot], slot) for slot in slots]


@np.errstate(over="ignore", invalid="ignore")
def _speeds(moment: Moment) -> dict[str, float]:
    velocity = moment.world.velocity
    return {name: float(np.hypot(*velocity[slot])) for name, slot in _named(moment)}


def _places(moment: Moment) -> dict[str, float]:
    position = moment.world.position
    return {
        f"{name} {axis}": float(position[slot, k]) for name, slot in _named(moment) for k, axis in ((1, "y"), (0, "x"))
    }


def _torques(moment: Moment) -> dict[str, float]:
    readings = [reading for reading in motor_readings(moment.world) if reading.pushes]
    return {reading.name: reading.torque for reading in readings[:MOST_MOTORS]}


def _times(moment: Moment) -> dict[str, float]:
    found = {"one tick": moment.tick_time, "whole frame": moment.frame_time}
    return {name: value for name, value in found.items() if value is not None}


PICK = "Point at a particle and press O to follow it (four at most); press O again to stop."
MEASURES: dict[str, Measure] = {
    "energy": Measure("Energy", "J", _energies, "", ("total", "motion")),
    "strain": Measure("Strain", "%", _strains, "There is no spring here.", ("most stretched",)),
    "speed": Measure("Speed", "m/s", _speeds, PICK, from_zero=True),
    "place": Measure("Place", "m", _places, PICK),
    "torque": Measure("Torque", "N m", _torques, "This level has no motor that is running."),
    "time": Measure("Step time", "ms", _times, "The run has not started yet.", from_zero=True),
}  # fmt: skip
