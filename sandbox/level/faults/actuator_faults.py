"""Faults of actuators that involve several fields: lengths that contradict each other, keys with two meanings."""

from collections.abc import Iterator

from sandbox.level.document.model import Level, SpringDef
from sandbox.level.format.actuator_defs import HydraulicDef
from sandbox.level.format.level_error import Fault, shown
from sandbox.level.format.limits import MOTOR_LIMIT, most_limited
from sandbox.level.kinds.bodies import expansion
from sandbox.level.plan.actuators import actuators


def actuator_faults(level: Level) -> Iterator[Fault]:
    """Every fault of muscles, hydraulics and motors that involves several fields."""
    for index, spring in enumerate(level.springs):
        if spring.hydraulic is not None:
            yield from _hydraulic(f"springs.{index}", spring, spring.hydraulic)
    yield from _limited(level)
    motors = 0
    for actuator in actuators(level):
        is_spring = isinstance(actuator.drive, HydraulicDef)
        path = f"springs.{actuator.owner}.hydraulic" if is_spring else f"bodies.{actuator.owner}.motor"
        if actuator.drive.key is not None and actuator.drive.key == actuator.drive.reverse_key:
            yield f"{path}.reverse_key", f"{shown(actuator.drive.key)} is the key as well; name another"
        motors += not is_spring
        if motors == MOTOR_LIMIT + 1 and not is_spring:
            yield path, f"brings the level above {MOTOR_LIMIT} motors; take some out"


def _hydraulic(path: str, spring: SpringDef, hydraulic: HydraulicDef) -> Iterator[Fault]:
    if spring.drive is not None:
        yield f"{path}.drive", "is a muscle where a hydraulic is; keep one of them"
    if hydraulic.shortest > hydraulic.longest:
        yield f"{path}.hydraulic.shortest", f"{shown(hydraulic.shortest)} is above longest, {shown(hydraulic.longest)}"
    elif spring.rest_length is not None and not hydraulic.shortest <= spring.rest_length <= hydraulic.longest:
        yield (
            f"{path}.rest_length",
            f"{shown(spring.rest_length)} is not from {shown(hydraulic.shortest)} to {shown(hydraulic.longest)}, "
            "between which the hydraulic goes",
        )


def _limited(level: Level) -> Iterator[Fault]:
    """The fault of too many springs with a limited force."""
    drives = [
        (f"bodies.{index}.drive", expansion(body).form_count[1])
        for index, body in enumerate(level.bodies)
        if body.drive is not None and body.drive.force is not None
    ]
    for index, spring in enumerate(level.springs):
        limited = [
            name
            for name, drive in (("drive", spring.drive), ("hydraulic", spring.hydraulic))
            if drive is not None and drive.force is not None
        ]
        drives += [(f"springs.{index}.{name}", 1) for name in limited]
    if not drives:
        return
    most = most_limited(len(level.particles) + sum(expansion(body).form_count[0] for body in level.bodies))
    total = 0
    for path, count in drives:
        total += count
        if total > most:
            yield f"{path}.force", f"brings the level above {most:,} springs of limited force; take some out"
            return
