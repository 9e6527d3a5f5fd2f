"""Driven parts of a level: which there are, in the order of their slots, and which keys drive them."""

from dataclasses import dataclass

from sandbox.level.format.drives import HydraulicDef, MotorDef
from sandbox.level.format.model import Level, SpringDef
from sandbox.level.kinds.bodies import WheelDef


@dataclass(frozen=True)
class Part:
    """A wheel with a motor, named by its id, or a loose spring with a hydraulic, named `:k`; owner: its index."""

    name: str
    owner: int
    drive: MotorDef | HydraulicDef

    @property
    def start_value(self) -> float:
        """The value that it begins with: a motor without keys runs from the start, all else waits."""
        keyed = self.drive.key is not None or self.drive.reverse_key is not None
        return 0.0 if keyed or isinstance(self.drive, HydraulicDef) else 1.0


def parts(level: Level) -> list[Part]:
    """The driven parts of a level: motors in the order of their wheels, then hydraulics in that of the springs."""
    wheels = [
        Part(body.id, index, body.motor)
        for index, body in enumerate(level.bodies)
        if isinstance(body, WheelDef) and body.motor is not None
    ]
    springs = [
        Part(f":{index}", index, spring.hydraulic)
        for index, spring in enumerate(level.springs)
        if spring.hydraulic is not None
    ]
    return wheels + springs


def driving_keys(level: Level) -> dict[str, list[tuple[int, float]]]:
    """What each key drives: numbers of parts, with the value of each."""
    result: dict[str, list[tuple[int, float]]] = {}
    for number, part in enumerate(parts(level)):
        for key, value in ((part.drive.key, 1.0), (part.drive.reverse_key, -1.0)):
            if key is not None:
                result.setdefault(key, []).append((number, value))
    return result


def given_length(spring: SpringDef) -> float | None:
    """Rest length [m] that a loose spring is given; None = as placed."""
    if spring.rest_length is None and spring.hydraulic is not None:
        return spring.hydraulic.shortest
    return spring.rest_length
