"""Actuators of a level: their order, the keys that control them, and their arrays."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.document.model import Level
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.plan.plan import Plan
from sandbox.physics.arrays import Slots
from sandbox.physics.driving import Actuators, Hydraulics, Motors, Muscles
from sandbox.physics.world import World


@dataclass(frozen=True)
class Actuator:
    """A wheel with a motor, named by its id, or a loose spring with a hydraulic, named `:k`; owner: its index."""

    name: str
    owner: int
    drive: MotorDef | HydraulicDef

    @property
    def start_value(self) -> float:
        """Drive value at the start: 1 for a motor without keys, else 0."""
        keyed = self.drive.key is not None or self.drive.reverse_key is not None
        return 0.0 if keyed or isinstance(self.drive, HydraulicDef) else 1.0


def actuators(level: Level) -> list[Actuator]:
    """The actuators of a level: motors in the order of their wheels, then hydraulics in that of the springs."""
    wheels = [
        Actuator(body.id, index, motor)
        for index, body in enumerate(level.bodies)
        if (motor := expansion(body).motor) is not None
    ]
    springs = [
        Actuator(f":{index}", index, spring.hydraulic)
        for index, spring in enumerate(level.springs)
        if spring.hydraulic is not None
    ]
    return wheels + springs


def driving_keys(level: Level) -> dict[str, list[tuple[int, float]]]:
    """The actuators that each key controls, by number, with the value of each."""
    result: dict[str, list[tuple[int, float]]] = {}
    for number, part in enumerate(actuators(level)):
        for key, value in ((part.drive.key, 1.0), (part.drive.reverse_key, -1.0)):
            if key is not None:
                result.setdefault(key, []).append((number, value))
    return result


def add_actuators(world: World, level: Level, plan: Plan, slots: Slots) -> None:
    """Give the world its muscles, hydraulics and motors; slots: the slot of each particle before welds."""
    found = actuators(level)
    owners = [plan.layout.owners[each.name] for each in found if isinstance(each.drive, MotorDef)]
    motors = [each.drive for each in found if isinstance(each.drive, MotorDef)]
    rims = [slots[owner.first + 1 : owner.first + owner.size] for owner in owners]
    turning = Motors(
        hub=slots[np.array([owner.first for owner in owners], dtype=np.int64)],
        speed=np.array([motor.speed for motor in motors], dtype=np.float64),
        torque=np.array([motor.torque for motor in motors], dtype=np.float64),
        part=np.arange(len(motors), dtype=np.int64),
        rim_start=np.cumsum([0, *map(len, rims)], dtype=np.int64),
        rim=np.concatenate([*rims, np.zeros(0, dtype=np.int64)]),
    )
    hydraulics = [each.drive for each in found if isinstance(each.drive, HydraulicDef)]
    first_loose = sum(len(made.pairs) for made in plan.bodies)
    holders = [each.owner for each in found if isinstance(each.drive, HydraulicDef)]
    lifting = Hydraulics(
        spring=first_loose + np.array(holders, dtype=np.int64),
        shortest=np.array([hydraulic.shortest for hydraulic in hydraulics], dtype=np.float64),
        longest=np.array([hydraulic.longest for hydraulic in hydraulics], dtype=np.float64),
        rate=np.array([hydraulic.rate for hydraulic in hydraulics], dtype=np.float64),
        part=len(motors) + np.arange(len(hydraulics), dtype=np.int64),
        force=_forces([hydraulic.force for hydraulic in hydraulics]),
        returns=np.array([hydraulic.returns for hydraulic in hydraulics], dtype=np.bool_),
    )
    names = tuple(each.name for each in found)
    equipment = Actuators(names, _muscles(level, plan.bodies), lifting, turning)
    world.fit(equipment, [each.start_value for each in found])


def _muscles(level: Level, bodies: list[Expansion[Any]]) -> Muscles:
    """The muscles of every spring, of the bodies in file order and then of the loose springs."""
    waves = [body.drive for body in level.bodies] + [spring.drive for spring in level.springs]
    counts = [len(made.pairs) for made in bodies] + [1] * len(level.springs)
    rows = [(0.0, 0, 0.0) if wave is None else (wave.amplitude, wave.period, wave.phase) for wave in waves]
    force = _forces([None if wave is None else wave.force for wave in waves])
    amplitude, period, phase = (np.repeat(column, counts) for column in np.array(rows).reshape(-1, 3).T)
    spring = np.flatnonzero(period)
    if len(force):
        force = np.repeat(force, counts)[spring]
    return Muscles(spring, amplitude[spring], period[spring].astype(np.int64), phase[spring], force)


def _forces(limits: list[float | None]) -> NDArray[np.float64]:
    """The largest forces [N] (k,), infinite without a limit; (0,) if no spring has a limit."""
    if all(force is None for force in limits):
        return np.zeros(0)
    return np.array([np.inf if force is None else force for force in limits])
